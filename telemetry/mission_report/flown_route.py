"""How a route was flown: the legs flown, and the errors across and in height."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from inspection.geodesy import LonLat, path_length_m
from mavlink.approved_route import Flight, FrozenRoute
from telemetry.alerting.route_line import RouteLine, RoutePlace
from telemetry.mission_report.fix import Fix, airborne, uav_span_s

PASSED_END_M = 15.0  # of the last waypoint: later reports belong to the RTL path or the descent
MAX_GAP_S = 60.0  # between two reports joined to a flown line


@dataclass(frozen=True, slots=True)
class FlownLeg:
    """One leg between two waypoints of the route; errors are None without a report.

    across_* is the distance from the leg [m]; height_* the distance from the planned heights there, 0 within.
    """

    from_sequence: int
    to_sequence: int
    length_m: float
    reports: int
    began_s: float | None = None
    ended_s: float | None = None
    across_rms_m: float | None = None
    across_max_m: float | None = None
    height_rms_m: float | None = None
    height_max_m: float | None = None


@dataclass(frozen=True, slots=True)
class FlownStage:
    """All legs of one flight from a target, or its take-off, to the next; the last stage has no target. `flight` counts from 1."""

    flight: int
    target: int | None
    whole: FlownLeg


@dataclass(frozen=True, slots=True)
class TrackGap:
    """A time in the air without reports for longer than MAX_GAP_S; length_m: length of the route between its ends."""

    began_s: float
    ended_s: float
    length_m: float


@dataclass(frozen=True, slots=True)
class ReportedRoute:
    """A whole route, from its first take-off to its last landing, by the reports in the air.

    flown_m is the length of the reported track without gaps. duration_s is by the vehicle's clock; clock_rate is its seconds per server
    second, as a simulation may fly faster than real time.
    """

    legs: tuple[FlownLeg, ...]
    stages: tuple[FlownStage, ...]
    reports: int
    began_s: float | None
    ended_s: float | None
    flown_m: float
    across_rms_m: float | None
    across_max_m: float | None
    height_rms_m: float | None
    height_max_m: float | None
    battery_start_percent: float | None
    battery_end_percent: float | None
    battery_lowest_percent: float | None
    battery_used_percent: float | None
    duration_s: float | None = None
    clock_rate: float = 1.0
    gaps: tuple[TrackGap, ...] = ()


@dataclass(frozen=True, slots=True)
class _Seen:
    fix: Fix
    place: RoutePlace
    height_error_m: float | None


def flown_route(route: FrozenRoute, fixes: Sequence[Fix]) -> ReportedRoute:
    """Return the flown route. fixes: of its UAV in this mission, sorted by time."""
    in_air = airborne(fixes)
    legs: list[FlownLeg] = []
    stages: list[FlownStage] = []
    seen: list[_Seen] = []
    gaps: list[TrackGap] = []
    for flight, own in zip(route.flights, _by_flight(route.flights, in_air), strict=True):
        line = RouteLine(flight, route.charging_stops)
        on_line = _on_line(line, own)
        seen += on_line
        gaps += _gaps(on_line)
        by_leg = [[one for one in on_line if one.place.leg == number] for number in range(len(line.vertices) - 1)]
        legs += [_between(line, number, number + 1, own) for number, own in enumerate(by_leg)]
        stages += _stages(flight, line, by_leg)
    across_m, height_m = _errors(seen)
    batteries = [fix.battery_percent for fix in in_air if fix.battery_percent is not None]
    duration_s = uav_span_s([in_air]) if in_air else None
    lasted_s = in_air[-1].at_s - in_air[0].at_s if in_air else 0.0
    return ReportedRoute(
        legs=tuple(legs),
        stages=tuple(stages),
        reports=len(in_air),
        began_s=in_air[0].at_s if in_air else None,
        ended_s=in_air[-1].at_s if in_air else None,
        flown_m=sum(path_length_m(np.array(line)) for line in track_of(in_air)),
        across_rms_m=_rms(across_m),
        across_max_m=max(across_m, default=None),
        height_rms_m=_rms(height_m),
        height_max_m=max(height_m, default=None),
        battery_start_percent=batteries[0] if batteries else None,
        battery_end_percent=batteries[-1] if batteries else None,
        battery_lowest_percent=min(batteries, default=None),
        battery_used_percent=sum(max(a - b, 0.0) for a, b in pairwise(batteries)) if batteries else None,
        duration_s=duration_s,
        clock_rate=duration_s / lasted_s if duration_s and lasted_s > 0.0 else 1.0,
        gaps=tuple(gaps),
    )


def _gaps(seen: Sequence[_Seen]) -> Iterator[TrackGap]:
    for one, after in pairwise(seen):
        if after.fix.at_s - one.fix.at_s > MAX_GAP_S:
            yield TrackGap(one.fix.at_s, after.fix.at_s, max(after.place.along_m - one.place.along_m, 0.0))


def _by_flight(flights: Sequence[Flight], fixes: Sequence[Fix]) -> list[list[Fix]]:
    """Return the fixes by flight, by their reported waypoint; one without a waypoint belongs to the flight of the previous fix."""
    found: list[list[Fix]] = [[] for _ in flights]
    ends = [flight.waypoints[-1].sequence for flight in flights]
    number = 0
    for fix in fixes:
        if fix.waypoint_sequence is not None:
            reported = next((place for place, end in enumerate(ends) if fix.waypoint_sequence <= end), len(ends) - 1)
            number = max(number, reported)
        found[number].append(fix)
    return found


def _on_line(line: RouteLine, fixes: Sequence[Fix]) -> list[_Seen]:
    """Return each fix with its place on the line.

    After a gap, the reported waypoint may be outdated until it changes. Until then the UAV may be on any later leg.
    """
    seen: list[_Seen] = []
    before: RoutePlace | None = None
    before_s, is_old = math.inf, False
    old_sequence: int | None = None
    for fix in fixes:
        if fix.at_s - before_s > MAX_GAP_S:
            is_old = fix.waypoint_sequence == old_sequence
        is_old = is_old and fix.waypoint_sequence == old_sequence
        before_s, old_sequence = fix.at_s, fix.waypoint_sequence
        place = line.place_from(fix.position, before) if is_old and before else line.place(fix.position, fix.waypoint_sequence, before)
        if before is not None and line.length_m - before.along_m <= PASSED_END_M and place.along_m <= before.along_m:
            break
        before = place
        seen.append(_Seen(fix, place, _height_error_m(line, place, fix.altitude_relative_m)))
    return seen


def _height_error_m(line: RouteLine, place: RoutePlace, altitude_m: float | None) -> float | None:
    if altitude_m is None:
        return None
    lowest_m, highest_m = line.heights_at(place)
    return max(lowest_m - altitude_m, altitude_m - highest_m, 0.0)


def _stages(flight: Flight, line: RouteLine, by_leg: Sequence[Sequence[_Seen]]) -> Iterator[FlownStage]:
    begin, last = 0, len(flight.waypoints) - 1
    for end, waypoint in enumerate(flight.waypoints):
        if end > begin and (waypoint.target is not None or end == last):
            own = [one for leg in by_leg[begin:end] for one in leg]
            yield FlownStage(flight.number + 1, waypoint.target, _between(line, begin, end, own))
            begin = end


def _between(line: RouteLine, begin: int, end: int, own: Sequence[_Seen]) -> FlownLeg:
    """Return the leg between two vertices of the line. own: the fixes on it."""
    across_m, height_m = _errors(own)
    return FlownLeg(
        from_sequence=line.sequences[begin],
        to_sequence=line.sequences[end],
        length_m=line.along_m[end] - line.along_m[begin],
        reports=len(own),
        began_s=min((one.fix.at_s for one in own), default=None),
        ended_s=max((one.fix.at_s for one in own), default=None),
        across_rms_m=_rms(across_m),
        across_max_m=max(across_m, default=None),
        height_rms_m=_rms(height_m),
        height_max_m=max(height_m, default=None),
    )


def _errors(seen: Sequence[_Seen]) -> tuple[list[float], list[float]]:
    return [one.place.across_m for one in seen], [one.height_error_m for one in seen if one.height_error_m is not None]


def _rms(values: Sequence[float]) -> float | None:
    return math.sqrt(sum(value * value for value in values) / len(values)) if values else None


def track_of(fixes: Sequence[Fix]) -> list[list[LonLat]]:
    """Return the lines of the flown track, split where nothing was reported for longer than MAX_GAP_S."""
    lines: list[list[LonLat]] = []
    before_s: float | None = None
    for fix in fixes:
        if before_s is None or fix.at_s - before_s > MAX_GAP_S:
            lines.append([])
        lines[-1].append(fix.position)
        before_s = fix.at_s
    return [line for line in lines if len(line) > 1]
