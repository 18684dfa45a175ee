"""Alerts as they are, and in words."""

from collections import defaultdict
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from django.utils.translation import gettext

from missions.models import Mission, Uav
from telemetry.models import Alert


@dataclass(frozen=True, slots=True)
class OpenRow:
    """An open alert, as far as the watch needs it."""

    id: int
    uav_id: int
    code: str
    subject: str
    level: str
    message: str
    values: Mapping[str, Any]
    written_at: datetime


def open_alerts_of(uav_ids: Collection[int], codes: Collection[str]) -> dict[int, list[OpenRow]]:
    found: dict[int, list[OpenRow]] = defaultdict(list)
    rows = Alert.objects.filter(uav__in=uav_ids, code__in=codes, closed_at=None)
    for row in rows.values_list("pk", "uav_id", "code", "subject", "level", "message", "values", "written_at"):
        found[row[1]].append(OpenRow(*row))
    return found


def stated_limits(pairs: Collection[tuple[int, UUID]]) -> dict[tuple[int, UUID], tuple[Mapping[str, float], Mapping[str, float]]]:
    """Of UAVs in missions, what the type and the mission state of alerts' limits."""
    of_type = dict(Uav.objects.filter(pk__in={uav for uav, _ in pairs}).values_list("pk", "uav_type__alert_limits"))
    of_mission = dict(Mission.objects.filter(pk__in={mission for _, mission in pairs}).values_list("pk", "alert_limits"))
    return {(uav, mission): (of_type.get(uav) or {}, of_mission.get(mission) or {}) for uav, mission in pairs}


def alert_words(message: str, values: Mapping[str, Any]) -> str:
    """What an alert says, in the reader's language; a message without values is as it was stored."""
    try:
        return gettext(message) % values if values else gettext(message) if message else ""
    except (KeyError, TypeError, ValueError):
        return message
