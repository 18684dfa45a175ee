"""Telemetry's entries in the event log of missions: alerts, take-offs and landings, and crashes reported in status texts."""

from collections.abc import Mapping, Sequence
from typing import Any

from django.utils import translation

from missions.hooks.events import EventKind, EventPlace, EventSource, MissionEvent
from telemetry.models import Alert, FlightEvent, VehicleText
from telemetry.selectors.alert_facts import WARNING_SEVERITY
from telemetry.selectors.alert_words import alert_words

_ALERTS = """
SELECT id::text, 'opened', opened_at, mission_id FROM telemetry_alert WHERE mission_id = ANY(%(missions)s)
UNION ALL
SELECT alert.id::text, turn.place || '-' || (turn.step ->> 'what'), (turn.step ->> 'at')::timestamptz, alert.mission_id
FROM telemetry_alert alert, jsonb_array_elements(alert.course) WITH ORDINALITY AS turn(step, place)
WHERE alert.mission_id = ANY(%(missions)s) AND turn.step ->> 'what' <> 'opened'
"""
_KINDS = {"rose": EventKind.ALERT_RAISED, "acknowledged": EventKind.ALERT_ACKNOWLEDGED, "closed": EventKind.ALERT_RESOLVED}
_WORDS = {EventKind.ALERT_RAISED: "Raised", EventKind.ALERT_ACKNOWLEDGED: "Acknowledged", EventKind.ALERT_RESOLVED: "Resolved"}

_FLIGHTS = "SELECT id::text, kind, at, mission_id FROM telemetry_flightevent WHERE mission_id = ANY(%(missions)s)"
_FLIGHT_WORDS = {EventKind.TAKE_OFF: "took off", EventKind.LANDING: "landed"}

# During the mission and shortly after: the UAV may report it after the end.
_CRASHES = rf"""
SELECT said.id::text, 'crash', said.received_at, mission.id FROM missions_mission mission
JOIN missions_missionuav place ON place.mission_id = mission.id
JOIN missions_route route ON route.mission_uav_id = place.id AND route.geometry IS NOT NULL
JOIN telemetry_vehicletext said ON said.uav_id = place.uav_id AND said.received_at >= mission.started_at
    AND said.received_at <= coalesce(mission.ended_at + interval '2 minutes', now())
WHERE mission.id = ANY(%(missions)s) AND said.severity <= {WARNING_SEVERITY} AND said.text ~* '\mcrash'
"""  # noqa: S608 (a constant number)


def _read_alerts(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = Alert.objects.select_related("uav").in_bulk([int(place.row) for place in places])
    return {place: _of_alert(row, place.step) for place in places if (row := rows.get(int(place.row))) is not None}


def _of_alert(alert: Alert, step: str) -> MissionEvent:
    number, _, what = step.partition("-")
    kind = _KINDS.get(what, EventKind.ALERT_OPENED)
    facts: dict[str, Any] = {}
    if alert.course:
        facts = alert.course[0] if kind is EventKind.ALERT_OPENED else alert.course[int(number) - 1]
    who = facts.get("by")
    with translation.override("en"):
        english = alert_words(alert.message, alert.values)
    stated = _WORDS.get(kind, "") + (f" by {who}" if who else "")
    level = facts.get("level", alert.level) if kind in (EventKind.ALERT_OPENED, EventKind.ALERT_RAISED) else None
    values = {"alert": alert.pk, "code": alert.code, "message": alert_words(alert.message, alert.values)}
    if kind is EventKind.ALERT_RESOLVED:
        values["reason"] = facts.get("reason", alert.close_reason)
    return MissionEvent(
        kind, f"{stated}: {english}" if stated else english, alert.uav_id, "" if alert.uav is None else alert.uav.name,
        alert.uav is not None and alert.uav.is_simulated, who, level, values,
    )  # fmt: skip


def _read_flights(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = FlightEvent.objects.select_related("uav").in_bulk([int(place.row) for place in places])
    found = {}
    for place in places:
        if (row := rows.get(int(place.row))) is not None:
            kind = EventKind(row.kind)
            found[place] = MissionEvent(kind, f"{row.uav.name} {_FLIGHT_WORDS[kind]}", row.uav_id, row.uav.name, row.uav.is_simulated)
    return found


def _read_crashes(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = VehicleText.objects.select_related("uav").in_bulk([int(place.row) for place in places])
    return {
        place: MissionEvent(
            EventKind.CRASH, f"{row.uav.name} has crashed: {row.text}", row.uav_id, row.uav.name, row.uav.is_simulated, level="critical",
            values={"text": row.text},
        )
        for place in places
        if (row := rows.get(int(place.row))) is not None
    }  # fmt: skip


SOURCES = (
    EventSource("alert", _ALERTS, _read_alerts),
    EventSource("flight", _FLIGHTS, _read_flights),
    EventSource("crash", _CRASHES, _read_crashes),
)
