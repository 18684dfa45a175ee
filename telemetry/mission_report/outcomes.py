"""Outcome of a target and its reason: from the UAV's reports, incidents, and statements of users."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from inspection.geodesy import LonLat
from telemetry.mission_report.visits import ReportedVisit

CAUSE_BEFORE_S, CAUSE_AFTER_S = 60.0, 5.0  # of an incident: status texts in this time may name its cause
_CAUSES = {
    "motor": re.compile(r"motor|thrust|\besc\b|propeller", re.IGNORECASE),
    "battery": re.compile(r"\bbatt", re.IGNORECASE),
    "position": re.compile(r"\bgps\b|\bekf|position", re.IGNORECASE),
    "link": re.compile(r"\blink\b|\brc\b|\bgcs\b|radio", re.IGNORECASE),
}


class Result(StrEnum):
    INSPECTED = "inspected"
    NOT_CONFIRMED = "not-confirmed"  # counted as complete, but no report confirms it
    NOT_INSPECTED = "not-inspected"
    OPEN = "open"  # the mission is not over


class IncidentKind(StrEnum):
    CRASHED = "crashed"
    DOWN = "down"  # on the ground off plan
    FAILSAFE_RETURN = "failsafe-return"
    FAILSAFE_LAND = "failsafe-land"
    ORDERED_RETURN = "told-return"
    ORDERED_LAND = "told-land"
    ABORTED = "aborted"
    BATTERY = "battery"
    LINK_LOST = "link-lost"
    ALERT = "alert"  # any other critical one


ENDS_A_FLIGHT = frozenset(IncidentKind) - {IncidentKind.BATTERY, IncidentKind.LINK_LOST, IncidentKind.ALERT}
EXPLAINS = ENDS_A_FLIGHT | {IncidentKind.BATTERY, IncidentKind.LINK_LOST}


@dataclass(frozen=True, slots=True)
class OutcomeReason:
    """`code` selects the text, `values` are inserted into it; `at_s` is when it happened [Unix s], None if not applicable."""

    code: str
    values: Mapping[str, Any] = field(default_factory=dict)
    at_s: float | None = None


@dataclass(frozen=True, slots=True)
class Incident:
    """`place` is the UAV's in the mission, None for all UAVs; `position` is where it was, as far as known."""

    kind: IncidentKind
    reason: OutcomeReason
    at_s: float
    place: int | None = None
    position: LonLat | None = None


@dataclass(frozen=True, slots=True)
class TargetFacts:
    """Stored data of a target. `stated` is the text of a user or a plan, `reported` the last outcome and note of a UAV."""

    state: str
    state_reason: str = ""
    unassigned: str = ""
    why: Sequence[Mapping[str, Any]] = ()
    reached_s: float | None = None
    reported: tuple[str, str] | None = None


@dataclass(frozen=True, slots=True)
class FlightFacts:
    """The UAV assigned to a target, and its flight: name, visit of the target, and time of its last visit to any target [Unix s]."""

    place: int
    name: str
    visit: ReportedVisit | None
    has_reports: bool
    last_visit_s: float | None
    is_continued: bool = False


@dataclass(frozen=True, slots=True)
class TargetOutcome:
    result: Result
    reason: OutcomeReason | None = None


def cause_in(texts: Iterable[tuple[float, str]], at_s: float) -> str:
    """Return motor, battery, position or link if the vehicle's status texts [Unix s, text] around then name it, else ""."""
    about = [text for stated_s, text in texts if at_s - CAUSE_BEFORE_S <= stated_s <= at_s + CAUSE_AFTER_S]
    return next((cause for cause, pattern in _CAUSES.items() if any(pattern.search(text) for text in about)), "")


def outcome_of(target: TargetFacts, flight: FlightFacts | None, incidents: Sequence[Incident], *, is_over: bool) -> TargetOutcome:
    """Return the outcome of a target. flight: None without a route. incidents: of the whole mission, sorted by time."""
    if target.state == "complete":
        return _complete(target, flight)
    reason = _why(target, flight, incidents)
    if target.state in ("pending", "in-progress") and not is_over:
        return TargetOutcome(Result.OPEN, reason)
    return TargetOutcome(Result.NOT_INSPECTED, reason or OutcomeReason("ended"))


def _complete(target: TargetFacts, flight: FlightFacts | None) -> TargetOutcome:
    """Return the outcome of a complete target. Without records, the stored data of the visit counts."""
    visit = flight.visit if flight is not None and flight.has_reports else None
    if target.reported is not None and target.reported[0] == "complete":
        return TargetOutcome(Result.INSPECTED)
    if visit is None:
        return (
            TargetOutcome(Result.INSPECTED)
            if target.reached_s is not None
            else TargetOutcome(Result.NOT_CONFIRMED, OutcomeReason("no-report"))
        )
    if visit.is_confirmed:
        return TargetOutcome(Result.INSPECTED)
    if visit.closest_m is None:
        return TargetOutcome(Result.NOT_CONFIRMED, OutcomeReason("no-report"))
    return TargetOutcome(Result.NOT_CONFIRMED, OutcomeReason("nearest-report", {"metres": round(visit.closest_m)}))


def _why(target: TargetFacts, flight: FlightFacts | None, incidents: Sequence[Incident]) -> OutcomeReason | None:
    """Return the reason; None if there is none yet."""
    if target.reported is not None:
        outcome, note = target.reported
        values = {"uav": flight.name if flight else "", "outcome": outcome, "note": note}
        return OutcomeReason("reported-note" if note else "reported", values)
    if flight is None:
        return _stated(target.state_reason or target.unassigned, target.why) or OutcomeReason("not-planned")
    visit = flight.visit
    if target.state_reason == "not-reached":
        metres = None if visit is None or visit.closest_m is None else round(visit.closest_m)
        return (
            OutcomeReason("not-seen", {"uav": flight.name})
            if metres is None
            else OutcomeReason("not-reached", {"uav": flight.name, "metres": metres})
        )
    if target.state_reason == "not-held" and visit is not None:
        held = {"held": math.floor(visit.held_s), "planned": round(visit.planned_hold_s)}
        return OutcomeReason("not-held", {"uav": flight.name, **held})
    if target.state_reason not in ("", "flight-failed", "not-held"):
        return _stated(target.state_reason, target.why)
    if flight.is_continued:
        return OutcomeReason("continued")
    found = _decisive(flight, incidents)
    if found is not None:
        return found.reason
    if target.state_reason == "flight-failed":
        return OutcomeReason("flight-failed", {"uav": flight.name})
    return None if flight.has_reports else OutcomeReason("not-flown", {"uav": flight.name})


def _stated(words: str, why: Sequence[Mapping[str, Any]]) -> OutcomeReason | None:
    return OutcomeReason("stated", {"words": words, "why": why}) if words else None


def _decisive(flight: FlightFacts, incidents: Sequence[Incident]) -> Incident | None:
    """Return the incident that kept the UAV from the target: a crash, else the first that ended its flight after its last visit."""
    own = [one for one in incidents if one.place in (None, flight.place) and one.kind in EXPLAINS]
    since_s = -math.inf if flight.last_visit_s is None else flight.last_visit_s
    after = [one for one in own if one.at_s >= since_s] or own[-1:]
    crash = next((one for one in after if one.kind is IncidentKind.CRASHED), None)
    return crash or next((one for one in after if one.kind in ENDS_A_FLIGHT), None) or next(iter(after), None)
