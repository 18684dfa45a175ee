"""Input of detectors other than reports, read for all UAVs at once."""

import json
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from uuid import UUID

from django.db import connection
from django.db.models import Exists, OuterRef

from mavlink.rtl import RtlBehaviour, rtl_behaviour
from missions.command_rules import ALONG_ROUTE
from missions.models import OPEN_COMMANDS, CommandAxis, CommandKind, CommandState, Mission, Uav, UavCommand
from telemetry.alerting.modes import RETURN_ALONG
from telemetry.alerting.status_texts import KEPT_S, AutopilotText
from telemetry.alerting.surroundings import IssuedOrder, LinkFacts
from telemetry.estimation.uav_clock import plausible_rate
from telemetry.models import Alert, UavLink, VehicleText
from telemetry.selectors.alerts import BY_PERSON

WARNING_SEVERITY, MAX_TEXTS = 4, 30  # MAV_SEVERITY_WARNING


@dataclass(frozen=True, slots=True)
class LoadedFacts:
    """The last readback of a UAV."""

    sha256: str = ""
    approval_id: UUID | None = None
    flight: int | None = None
    doubt: str = ""
    autopilot: str = ""


def links_of(uav_ids: Collection[int]) -> dict[int, tuple[LinkFacts, LoadedFacts]]:
    """Return link and readback by UAV.

    A clock rate other than 1 is used for simulated UAVs only: a real UAV's rate only appears to differ while its link lags.
    """
    rows = UavLink.objects.filter(uav__in=uav_ids).values_list(
        "uav_id", "last_message_at", "mode", "is_armed", "is_in_air", "uav__is_simulated", "clock_rate",
        "loaded_sha256", "loaded_approval", "loaded_flight", "loaded_doubt", "autopilot", "battery_state",
        "uav__autopilot_return",
    )  # fmt: skip
    found = {}
    for row in rows:
        uav_id, last_message_at, mode, is_armed, is_in_air, is_simulated, clock_rate = row[:7]
        sha256, approval, flight, doubt, autopilot, battery, reported = row[7:]
        rate = plausible_rate(clock_rate if is_simulated else None)
        last_message_s = None if last_message_at is None else last_message_at.timestamp()
        facts = LinkFacts(last_message_s, mode, is_armed, is_in_air, rate, battery, autopilot, _rtl_behaviour(reported))
        found[uav_id] = (facts, LoadedFacts(sha256, approval, flight, doubt, autopilot))
    return found


def _rtl_behaviour(reported: Mapping[str, Any]) -> RtlBehaviour | None:
    return rtl_behaviour(reported.get("autopilot", ""), reported.get("parameters", {}))


def status_texts_of(uav_ids: Collection[int], now_s: float) -> dict[int, tuple[AutopilotText, ...]]:
    """Return the recent status texts of severity warning or worse by UAV, the newest last."""
    since = datetime.fromtimestamp(now_s - KEPT_S, UTC)
    rows = VehicleText.objects.filter(uav__in=uav_ids, received_at__gt=since, severity__lte=WARNING_SEVERITY).order_by("received_at", "pk")
    found: dict[int, list[AutopilotText]] = defaultdict(list)
    for uav_id, received_at, text in rows.values_list("uav_id", "received_at", "text"):
        found[uav_id].append(AutopilotText(received_at.timestamp(), text))
    return {uav_id: tuple(words[-MAX_TEXTS:]) for uav_id, words in found.items()}


def closed_by_users(pairs: Collection[tuple[int, UUID]], code: str) -> set[tuple[int, UUID, str]]:
    """Return UAV, mission and subject of alerts of a code that a user has closed since the UAV's last start."""
    started = UavCommand.objects.filter(
        uav=OuterRef("uav"), mission=OuterRef("mission"), kind=CommandKind.START, state=CommandState.APPLIED,
        finished_at__gt=OuterRef("closed_at"),
    )  # fmt: skip
    rows = Alert.objects.filter(
        ~Exists(started), code=code, uav__in={uav for uav, _ in pairs}, close_reason=BY_PERSON, mission__isnull=False
    )
    return {(uav, mission, subject) for uav, mission, subject in rows.values_list("uav_id", "mission_id", "subject") if uav and mission}


_ORDERS = """
SELECT wanted.uav, CASE WHEN command.parameters ? %(along)s THEN %(return_along)s ELSE command.kind END,
    command.created_at, command.finished_at, command.state,
    EXISTS (SELECT 1 FROM missions_uavcommand open WHERE open.uav_id = wanted.uav
        AND (open.axis = %(mission_axis)s OR open.parameters ? 'hand_over') AND open.state = ANY(%(open)s))
FROM unnest(%(uavs)s::bigint[], %(missions)s::uuid[]) AS wanted(uav, mission) LEFT JOIN LATERAL (
    SELECT kind, parameters, created_at, finished_at, state FROM missions_uavcommand command
    WHERE uav_id = wanted.uav AND axis = %(flight_axis)s AND state = ANY(%(counting)s)
        AND (mission_id = wanted.mission OR (mission_id IS NULL AND created_at > now() - interval '4 hours'))
    ORDER BY sequence DESC LIMIT 1
) command ON true
"""


def orders_to(flying: Sequence[tuple[int, UUID]]) -> dict[int, tuple[IssuedOrder | None, bool]]:
    """Return by UAV, for its mission, the latest flight command in force, and whether a mission is being uploaded or cleared.

    The latter is also true while a UAV is held to receive another mission.
    """
    values: dict[str, str | list[int] | list[UUID] | list[CommandState]] = {
        "along": ALONG_ROUTE, "return_along": RETURN_ALONG,
        "uavs": [uav for uav, _ in flying], "missions": [mission for _, mission in flying],
        "mission_axis": CommandAxis.MISSION, "flight_axis": CommandAxis.FLIGHT,
        "open": list(OPEN_COMMANDS), "counting": [*OPEN_COMMANDS, CommandState.APPLIED],
    }  # fmt: skip
    with connection.cursor() as cursor:
        cursor.execute(_ORDERS, values)
        rows = cursor.fetchall()
    return {uav: (_order(kind, given_at, finished_at, state), is_changing) for uav, kind, given_at, finished_at, state, is_changing in rows}


def _order(kind: str | None, given_at: datetime | None, finished_at: datetime | None, state: str | None) -> IssuedOrder | None:
    if kind is None:
        return None
    done_s = finished_at.timestamp() if state == CommandState.APPLIED and finished_at is not None else None
    return IssuedOrder(kind, done_s, None if given_at is None else given_at.timestamp())


def stated_limits(pairs: Collection[tuple[int, UUID]]) -> dict[int, tuple[Mapping[str, float], Mapping[str, float]]]:
    """Return the alert limits of type and mission by UAV."""
    of_type = dict(Uav.objects.filter(pk__in={uav for uav, _ in pairs}).values_list("pk", "uav_type__alert_limits"))
    of_mission = dict(Mission.objects.filter(pk__in={mission for _, mission in pairs}).values_list("pk", "alert_limits"))
    return {uav: (of_type.get(uav) or {}, of_mission.get(mission) or {}) for uav, mission in pairs}


_OTHERS = """
SELECT watch.uav_id, uav.name, watch.organisation_id, watch.estimated, CASE WHEN uav.is_simulated THEN link.clock_rate END,
    uav.twin_of_id IS NOT NULL
FROM telemetry_uavwatch watch JOIN missions_uav uav ON uav.id = watch.uav_id LEFT JOIN telemetry_uavlink link ON link.uav_id = uav.id
WHERE watch.organisation_id = ANY(%s) AND NOT watch.uav_id = ANY(%s) AND watch.estimated IS NOT NULL AND watch.lease_expires_at > now()
"""


def estimated_by_other_watches(
    organisations: Collection[int], uav_ids: Collection[int]
) -> dict[int, list[tuple[int, str, Any, float, bool]]]:
    """Return by organisation the UAVs of other estimators: id, name, stored estimate (services/watches.py), clock rate, is_twin."""
    with connection.cursor() as cursor:
        cursor.execute(_OTHERS, [sorted(organisations), sorted(uav_ids)])
        rows = cursor.fetchall()
    found: dict[int, list[tuple[int, str, Any, float, bool]]] = defaultdict(list)
    for uav_id, name, organisation_id, estimated, clock_rate, is_twin in rows:
        read = json.loads(estimated) if isinstance(estimated, str) else estimated
        found[organisation_id].append((uav_id, name, read, plausible_rate(clock_rate), is_twin))
    return found
