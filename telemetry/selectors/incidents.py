"""Incidents of a mission's UAVs: crashes, failsafes, low batteries, lost links, and users' commands."""

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from inspection.geodesy import LonLat
from missions.models import CommandKind, CommandState, Mission, UavCommand
from telemetry.alerting.modes import ModeKind, mode_kind
from telemetry.mission_report.fix import Fix
from telemetry.mission_report.outcomes import Incident, IncidentKind, OutcomeReason, cause_in
from telemetry.models import Alert, AlertLevel, VehicleText
from telemetry.selectors.alert_facts import WARNING_SEVERITY
from telemetry.selectors.alert_words import alert_words
from workspace.models import AuditEntry, User

NEAR_S = 60.0  # of an incident, to take the UAV's position from a report
ABOUT = timedelta(minutes=2)  # before the first and after the last report: status texts in it belong to the flight
ONE_FALL_S = 180.0  # between a crash text and the alert that the UAV is down: the same crash
_CRASH = re.compile(r"\bcrash", re.IGNORECASE)
_ORDERED = {CommandKind.RETURN: IncidentKind.ORDERED_RETURN, CommandKind.LAND: IncidentKind.ORDERED_LAND}
_REACHED_UAV = (CommandState.SENT, CommandState.ACKNOWLEDGED, CommandState.APPLIED)

Flown = tuple[int, str, Sequence[Fix]]  # place in the mission, name, reports


def incidents_of(mission: Mission, flown: Mapping[int, Flown]) -> list[Incident]:
    """Return the incidents sorted by time. flown: by the UAV's id."""
    texts = {uav_id: _texts(uav_id, fixes) for uav_id, (_place, _name, fixes) in flown.items()}
    found = [*_of_alerts(mission, flown, texts), *_of_commands(mission, flown), *_of_aborts(mission)]
    for uav_id, (place, name, fixes) in flown.items():
        found = _with_crash(found, place, name, fixes, texts[uav_id])
    return sorted(found, key=lambda one: one.at_s)


def _texts(uav_id: int, fixes: Sequence[Fix]) -> list[tuple[float, str]]:
    """Return its status texts of severity warning or worse during its flight."""
    if not fixes:
        return []
    since, until = (datetime.fromtimestamp(at_s, UTC) for at_s in (fixes[0].at_s, fixes[-1].at_s))
    rows = VehicleText.objects.filter(uav=uav_id, severity__lte=WARNING_SEVERITY, received_at__range=(since - ABOUT, until + ABOUT))
    return [(at.timestamp(), text) for at, text in rows.order_by("received_at", "pk").values_list("received_at", "text")]


def _of_alerts(mission: Mission, flown: Mapping[int, Flown], texts: Mapping[int, list[tuple[float, str]]]) -> list[Incident]:
    found = []
    for alert in Alert.objects.filter(mission=mission, level=AlertLevel.CRITICAL).order_by("opened_at", "pk"):
        place, name, fixes = flown.get(alert.uav_id or 0, (None, "", ()))
        at_s = alert.opened_at.timestamp()
        kind, reason = _kind_of(alert, name, at_s, texts.get(alert.uav_id or 0, []))
        stated = alert.details.get("position")
        found.append(Incident(kind, reason, at_s, place, LonLat(*stated[:2]) if stated else _position(fixes, at_s)))
    return found


def _kind_of(alert: Alert, name: str, at_s: float, texts: list[tuple[float, str]]) -> tuple[IncidentKind, OutcomeReason]:
    cause = cause_in(texts, at_s)
    if alert.code == "down-off-plan":
        return IncidentKind.DOWN, OutcomeReason("down", {"uav": name, "metres": round(alert.details.get("away_m", 0.0))}, at_s)
    if alert.code == "mode-changed":
        lands = mode_kind(str(alert.details.get("mode", ""))) is ModeKind.LAND
        kind = IncidentKind.FAILSAFE_LAND if lands else IncidentKind.FAILSAFE_RETURN
        return kind, _with_cause(kind, name, cause, at_s)
    if alert.code == "battery-short":
        return IncidentKind.BATTERY, OutcomeReason("battery", {"uav": name}, at_s)
    if alert.code == "link-lost":
        return IncidentKind.LINK_LOST, OutcomeReason("link-lost", {"uav": name}, at_s)
    return IncidentKind.ALERT, OutcomeReason("stated", {"words": alert_words(alert.message, alert.values)}, at_s)


def _with_cause(kind: IncidentKind, name: str, cause: str, at_s: float) -> OutcomeReason:
    return OutcomeReason(f"{kind}-cause" if cause else kind, {"uav": name, "cause": cause}, at_s)


def _with_crash(found: list[Incident], place: int, name: str, fixes: Sequence[Fix], texts: list[tuple[float, str]]) -> list[Incident]:
    """Replace the alert that a UAV is down by the crash that its status texts report, if any."""
    stated_s = next((at_s for at_s, text in texts if _CRASH.search(text)), None)
    if stated_s is None:
        return found
    downs = [one for one in found if one.place == place and one.kind is IncidentKind.DOWN]
    down = next((one for one in downs if abs(one.at_s - stated_s) <= ONE_FALL_S), None)
    position = down.position if down is not None else _position(fixes, stated_s)
    reason = _with_cause(IncidentKind.CRASHED, name, cause_in(texts, stated_s), stated_s)
    return [*(one for one in found if one is not down), Incident(IncidentKind.CRASHED, reason, stated_s, place, position)]


def _of_commands(mission: Mission, flown: Mapping[int, Flown]) -> list[Incident]:
    rows = UavCommand.objects.filter(mission=mission, kind__in=list(_ORDERED), state__in=_REACHED_UAV, created_by__isnull=False)
    found = []
    for command in rows.select_related("created_by").order_by("created_at"):
        place, name, fixes = flown.get(command.uav_id, (None, "", ()))
        if place is None:
            continue
        kind, at_s = _ORDERED[CommandKind(command.kind)], (command.sent_at or command.created_at).timestamp()
        values = {"uav": name, "who": _name(command.created_by), "why": command.why}
        found.append(
            Incident(kind, OutcomeReason(f"{kind}-why" if command.why else kind, values, at_s), at_s, place, _position(fixes, at_s))
        )
    return found


def _of_aborts(mission: Mission) -> list[Incident]:
    rows = AuditEntry.objects.filter(subject_type="mission", subject_id=str(mission.pk), action="abort").select_related("actor")
    found = []
    for entry in rows.order_by("recorded_at")[:1]:
        facts: dict[str, Any] = entry.after or {}
        values, at_s = {"who": _name(entry.actor), "why": facts.get("why", "")}, entry.recorded_at.timestamp()
        found.append(Incident(IncidentKind.ABORTED, OutcomeReason("aborted-why" if values["why"] else "aborted", values, at_s), at_s))
    return found


def _name(user: User | None) -> str:
    return user.display_name if user else ""


def _position(fixes: Sequence[Fix], at_s: float) -> LonLat | None:
    nearest = min(fixes, key=lambda fix: abs(fix.at_s - at_s), default=None)
    return None if nearest is None or abs(nearest.at_s - at_s) > NEAR_S else nearest.position
