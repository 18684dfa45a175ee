"""Alerts as they are, and in words."""

from collections import defaultdict
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from django.utils.translation import gettext

from telemetry.models import Alert

MIXED = "mission-mixed"  # a code


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


def alert_words(message: str, values: Mapping[str, Any]) -> str:
    """What an alert says, in the reader's language; a message without values is as it was stored."""
    try:
        return gettext(message) % values if values else gettext(message) if message else ""
    except (KeyError, TypeError, ValueError):
        return message
