"""Assesses a rehearsed mission under one set of conditions against the limits: a level, and its reasons."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from inspection.zones.reach import ZoneTable
from mavlink.approved_route import FrozenRoute
from operation.reasons import Reason
from planning.energy.conditions import Conditions
from simulation.assessment.closest_approach import ClosestApproach, closest_approaches_of
from simulation.assessment.flown import AssessedRoute, FloatArray, TrackEnding
from simulation.assessment.following import AssessedVisit, Following, following_of, visits_of
from simulation.assessment.limits import AssessmentFinding, AssessmentLimits, Facts, Level, level_of
from simulation.assessment.obstacles import (
    Approach,
    Standing,
    StandingApproaches,
    ZoneApproach,
    lowest_of,
    nearest_standing,
    zone_approaches,
)

APPROACH_STEP_S = 0.2
AS_PLANNED = 1.05  # factor on the planned energy
NEAR_ZONES = 5  # reported for a route
GroundHeights = Callable[[FloatArray], FloatArray]


def wind_finding(uav: int, route: FrozenRoute, conditions: Conditions, max_airspeed_mps: float) -> AssessmentFinding | None:
    """Return the strongest mean wind at the heights of a route, if it exceeds the airspeed limit. Known before the flight."""
    heights_m = {waypoint.altitude_agl_m for waypoint in route.waypoints}
    speed_mps, agl_m = max(((math.hypot(*conditions.wind_at(agl_m)), agl_m) for agl_m in heights_m), default=(0.0, 0.0))
    if speed_mps <= max_airspeed_mps:
        return None
    facts: dict[str, float | int | str | None] = {"wind_mps": speed_mps, "agl_m": agl_m, "limit_mps": max_airspeed_mps}
    return AssessmentFinding(Level.FAIL, "wind", uav, facts=facts)


@dataclass(frozen=True)
class FlightEnergy:
    """One flight: watt-hours used, percent left at its end, and the minimum on the way."""

    flight: int
    used_wh: float
    left_percent: float
    lowest_percent: float


def energy_of(route: AssessedRoute) -> list[FlightEnergy]:
    """Return the energy of each flown flight."""
    return [
        FlightEnergy(
            number,
            float(flown.track.used_wh[-1]),
            float(flown.track.battery_percent[-1]),
            float(flown.track.battery_percent.min()),
        )
        for number, flown in enumerate(route.flights)
        if flown.track is not None and len(flown.track)
    ]


@dataclass(frozen=True, eq=False)
class AssessmentSurroundings:
    """Surroundings to assess flights against. ground_amsl_m takes (n, 2) lon, lat and returns (n,) metres, NaN if unknown.

    departs_s: the mission's departure [Unix s]; None: any time.
    """

    zones: ZoneTable
    standing: Standing
    ground_amsl_m: GroundHeights
    departs_s: float | None


@dataclass(frozen=True)
class TargetAssessment:
    """One target. `closest_m` is the worst of its waypoints; at_s is when the first was reached, battery_percent the charge then."""

    target: int
    level: Level
    is_reached: bool
    closest_m: float | None
    at_s: float | None
    late_s: float | None
    held_s: float
    planned_hold_s: float
    battery_percent: float | None


@dataclass(frozen=True)
class RouteAssessment:
    """Assessment of one UAV's route."""

    uav: int
    name: str
    level: Level
    endings: tuple[TrackEnding | None, ...]  # of its flights; None: not begun
    following: Following
    energy: tuple[FlightEnergy, ...]
    used_wh: float
    planned_wh: float | None
    reserve_percent: float
    flown_s: float
    planned_s: float | None
    zones: tuple[ZoneApproach, ...]
    lowest: Approach | None
    obstacle: Approach | None
    widest_waypoint_m: float | None  # largest distance at which any waypoint was passed
    targets: tuple[TargetAssessment, ...]


@dataclass(frozen=True)
class Assessment:
    level: Level
    findings: tuple[AssessmentFinding, ...]
    routes: tuple[RouteAssessment, ...]
    closest_approaches: tuple[ClosestApproach, ...]


def judge(
    routes: Sequence[AssessedRoute], around: AssessmentSurroundings, limits: AssessmentLimits, *, known: Sequence[AssessmentFinding] = ()
) -> Assessment:
    """Return the assessment. known: findings from before the flight, such as a wind above the airframe's limit."""
    closest_approaches = closest_approaches_of(routes, step_s=APPROACH_STEP_S)
    findings = [*known, *_of_closest_approaches(closest_approaches, limits)]
    assessments = []
    for route in routes:
        reported, assessment = _of_route(route, around, limits, [finding for finding in findings if finding.uav == route.uav])
        findings += reported
        assessments.append(assessment)
    return Assessment(level_of(findings), tuple(findings), tuple(assessments), tuple(closest_approaches))


def _of_route(
    route: AssessedRoute, around: AssessmentSurroundings, limits: AssessmentLimits, met: Sequence[AssessmentFinding]
) -> tuple[list[AssessmentFinding], RouteAssessment]:
    visits, energy, following = visits_of(route, within_m=limits.waypoint_fail_m), energy_of(route), following_of(route)
    grounds = [np.zeros(0) if flown.track is None else around.ground_amsl_m(flown.track.position) for flown in route.flights]
    zones = _nearest_zones(route, grounds, around)
    lowest, standing = _nearest(route, grounds, around, limits)
    flown_s = sum(float(track.t_s[-1] - track.t_s[0]) for track in route.tracks if len(track))
    targets = [_of_target(target, visits, limits) for target in dict.fromkeys(_targets(visits))]
    findings = [
        *_of_endings(route),
        *_of_energy(route, energy, visits, limits),
        *_of_following(route, following, limits),
        *_of_visits(route, visits, limits),
        *_of_times(route, visits, limits),
        *(_zone_finding(route, zone, limits) for zone in zones if _is_near(zone, limits)),
        *_of_ground(route, lowest, limits),
        *_of_standing(route, standing, limits),
    ]
    reported = [*met, *findings]
    by_target = [_with_level(assessment, reported) for assessment in targets]
    passed_m = [visit.closest_m for visit in visits if visit.closest_m is not None]
    return findings, RouteAssessment(
        uav=route.uav,
        name=route.name,
        level=level_of(reported),
        endings=tuple(None if flown.track is None else flown.track.ending for flown in route.flights),
        following=following,
        energy=tuple(energy),
        used_wh=sum(one.used_wh for one in energy),
        planned_wh=route.planned_wh,
        reserve_percent=route.reserve_percent,
        flown_s=flown_s,
        planned_s=route.planned_s,
        zones=tuple(zones[:NEAR_ZONES]),
        lowest=min(lowest, key=lambda one: one.away_m, default=None),
        obstacle=min(standing, key=lambda one: one.away_m, default=None),
        widest_waypoint_m=max(passed_m, default=None),
        targets=tuple(by_target),
    )


def _targets(visits: Sequence[AssessedVisit]) -> Iterator[int]:
    return (visit.waypoint.target for visit in visits if visit.waypoint.target is not None)


def _of_target(target: int, visits: Sequence[AssessedVisit], limits: AssessmentLimits) -> TargetAssessment:
    own = [visit for visit in visits if visit.waypoint.target == target]
    metres = [visit.closest_m for visit in own]
    is_reached = all(one is not None and one <= limits.waypoint_fail_m for one in metres)
    first = next((visit for visit in own if visit.at_s is not None), None)
    return TargetAssessment(
        target=target,
        level=Level.PASS,
        is_reached=is_reached,
        closest_m=None if any(one is None for one in metres) else max(one for one in metres if one is not None),
        at_s=None if first is None else first.at_s,
        late_s=None if first is None else first.late_s,
        held_s=sum(visit.held_s for visit in own if _hold_s(visit) > 0),
        planned_hold_s=sum(_hold_s(visit) for visit in own),
        battery_percent=None if first is None else first.battery_percent,
    )


def _hold_s(visit: AssessedVisit) -> float:
    return 0.0 if visit.waypoint.task is None else visit.waypoint.task.hold_s


def _with_level(assessment: TargetAssessment, findings: Sequence[AssessmentFinding]) -> TargetAssessment:
    level = level_of(finding for finding in findings if finding.target == assessment.target)
    return replace(assessment, level=level)


def _of_endings(route: AssessedRoute) -> Iterator[AssessmentFinding]:
    for number, flown in enumerate(route.flights):
        facts: Facts = {"name": route.name, "flight": number + 1, "flights": len(route.flights)}
        if flown.track is None:
            yield AssessmentFinding(Level.FAIL, "not-begun", route.uav, facts=facts)
        elif not flown.track.is_over_well:
            stated = flown.track.stated[-1] if flown.track.stated else ""
            at_s = float(flown.track.t_s[-1]) if len(flown.track) else None
            said = {"said": str(stated), "said_why": stated.to_json() if isinstance(stated, Reason) else None}
            yield AssessmentFinding(Level.FAIL, str(flown.track.ending), route.uav, facts=facts | said | {"at_s": at_s})


def _of_energy(
    route: AssessedRoute, energy: Sequence[FlightEnergy], visits: Sequence[AssessedVisit], limits: AssessmentLimits
) -> Iterator[AssessmentFinding]:
    """Report a shortfall for the route and for the flight's last target, as omitting that one would have saved energy."""
    for one in energy:
        facts: Facts = {
            "name": route.name, "flight": one.flight + 1, "flights": len(route.flights), "percent": one.left_percent,
            "limit_percent": route.reserve_percent,
        }  # fmt: skip
        if one.left_percent < route.reserve_percent:
            last = next((v.waypoint.target for v in reversed(visits) if v.flight == one.flight and v.waypoint.target is not None), None)
            yield AssessmentFinding(Level.FAIL, "reserve", route.uav, last, facts)
        elif one.left_percent < route.reserve_percent + limits.reserve_spare_percent and not _is_as_planned(route, energy):
            yield AssessmentFinding(Level.WARNINGS, "reserve-near", route.uav, None, facts)


def _is_as_planned(route: AssessedRoute, energy: Sequence[FlightEnergy]) -> bool:
    """Return whether it used no more than planned, so that the operator has seen the remaining charge in the plan."""
    return route.planned_wh is not None and sum(one.used_wh for one in energy) <= AS_PLANNED * route.planned_wh


def _of_following(route: AssessedRoute, following: Following, limits: AssessmentLimits) -> Iterator[AssessmentFinding]:
    kinds = (
        ("across", following.across, following.worst_across_waypoint, limits.across_warn_m, limits.across_fail_m),
        ("height", following.height, following.worst_height_waypoint, limits.height_warn_m, limits.height_fail_m),
    )
    for code, error, waypoint, warn_m, fail_m in kinds:
        if error.max_m is not None and error.max_m > warn_m:
            level = Level.FAIL if error.max_m > fail_m else Level.WARNINGS
            limit_m = fail_m if level is Level.FAIL else warn_m
            facts: Facts = {"name": route.name, "metres": error.max_m, "limit_m": limit_m, "waypoint": waypoint}
            yield AssessmentFinding(level, code, route.uav, facts=facts)


def _of_visits(route: AssessedRoute, visits: Sequence[AssessedVisit], limits: AssessmentLimits) -> Iterator[AssessmentFinding]:
    for visit in visits:
        facts: Facts = {"name": route.name, "waypoint": visit.waypoint.sequence}
        target = visit.waypoint.target
        if visit.closest_m is None:
            if target is not None:
                yield AssessmentFinding(Level.FAIL, "not-flown-to", route.uav, target, facts)
        elif visit.closest_m > limits.waypoint_fail_m:
            yield AssessmentFinding(
                Level.FAIL, "missed", route.uav, target, facts | {"metres": visit.closest_m, "limit_m": limits.waypoint_fail_m}
            )
        elif visit.closest_m > limits.waypoint_warn_m:
            reported = facts | {"metres": visit.closest_m, "limit_m": limits.waypoint_warn_m}
            yield AssessmentFinding(Level.WARNINGS, "passed-wide", route.uav, target, reported)
        if target is not None and visit.closest_m is not None and visit.held_s < _hold_s(visit) - limits.hold_slack_s:
            yield AssessmentFinding(Level.FAIL, "not-held", route.uav, target, facts | {"held_s": visit.held_s, "hold_s": _hold_s(visit)})


def _of_times(route: AssessedRoute, visits: Sequence[AssessedVisit], limits: AssessmentLimits) -> Iterator[AssessmentFinding]:
    """Report the waypoint with the largest deviation from its time."""
    late = max((visit for visit in visits if visit.late_s is not None), key=lambda visit: abs(visit.late_s or 0.0), default=None)
    if late is not None and late.late_s is not None and abs(late.late_s) > limits.late_warn_s:
        code = "late" if late.late_s > 0 else "early"
        facts: Facts = {"name": route.name, "seconds": abs(late.late_s), "limit_s": limits.late_warn_s, "waypoint": late.waypoint.sequence}
        yield AssessmentFinding(Level.WARNINGS, code, route.uav, facts=facts)


def _nearest_zones(route: AssessedRoute, grounds: Sequence[FloatArray], around: AssessmentSurroundings) -> list[ZoneApproach]:
    """Return the closest approach of the route's flights to each zone, the nearest first."""
    found: dict[int, ZoneApproach] = {}
    for flown, ground_m in zip(route.flights, grounds, strict=True):
        if flown.track is None:
            continue
        for zone in zone_approaches(flown.track, ground_m, around.zones, around.departs_s):
            if zone.zone not in found or zone.away_m < found[zone.zone].away_m:
                found[zone.zone] = zone
    return sorted(found.values(), key=lambda zone: zone.away_m)


def _is_near(zone: ZoneApproach, limits: AssessmentLimits) -> bool:
    return zone.beside_m < limits.zone_beside_m and zone.height_m < limits.zone_height_m


def _zone_finding(route: AssessedRoute, zone: ZoneApproach, limits: AssessmentLimits) -> AssessmentFinding:
    facts: Facts = {"name": route.name, "zone": zone.name, "at_s": zone.t_s, "waypoint": zone.waypoint, "metres": zone.away_m}
    if zone.is_inside:
        return AssessmentFinding(Level.FAIL, "zone-entered", route.uav, facts=facts)
    limit_m = limits.zone_height_m if zone.beside_m == 0.0 else limits.zone_beside_m
    return AssessmentFinding(Level.WARNINGS, "zone-near", route.uav, facts=facts | {"limit_m": limit_m})


def _nearest(
    route: AssessedRoute, grounds: Sequence[FloatArray], around: AssessmentSurroundings, limits: AssessmentLimits
) -> tuple[list[Approach], StandingApproaches]:
    """Return the lowest heights, on the way and in flights through photos, and the closest approaches to obstacles."""

    def nearest(found: Iterable[Approach | None]) -> Approach | None:
        return min((one for one in found if one is not None), key=lambda one: one.away_m - (one.kept_m or 0.0), default=None)

    flown = [(own, ground_m) for own, ground_m in zip(route.flights, grounds, strict=True) if own.track is not None and len(own.track)]
    column_m = limits.column_m
    lowest = [nearest(lowest_of(own, ground_m, column_m=column_m, photos=photos) for own, ground_m in flown) for photos in (False, True)]
    standing = [nearest_standing(own, around.standing, column_m=column_m) for own, _ in flown]
    return [one for one in lowest if one is not None], StandingApproaches(
        nearest(own.way for own in standing), nearest(own.column for own in standing), nearest(own.photos for own in standing)
    )


def _of_ground(route: AssessedRoute, lowest: Sequence[Approach], limits: AssessmentLimits) -> Iterator[AssessmentFinding]:
    for one in lowest:
        warn_m, fail_m = limits.ground_warn_m, limits.ground_fail_m
        if one.kept_m is not None:
            warn_m, fail_m = limits.photo_ground_warn_m, limits.photo_ground_fail_m
        if one.away_m >= warn_m:
            continue
        level = Level.FAIL if one.away_m < fail_m else Level.WARNINGS
        limit_m = fail_m if level is Level.FAIL else warn_m
        facts: Facts = {"name": route.name, "metres": one.away_m, "limit_m": limit_m, "waypoint": one.waypoint, "at_s": one.t_s}
        yield AssessmentFinding(level, "low", route.uav, facts=facts)


def _of_standing(route: AssessedRoute, standing: StandingApproaches, limits: AssessmentLimits) -> Iterator[AssessmentFinding]:
    for one in standing:
        warn_m, fail_m = limits.obstacle_warn_m, limits.obstacle_fail_m
        if one.kept_m is not None:
            warn_m = fail_m = one.kept_m
        if one.away_m >= warn_m:
            continue
        level = Level.FAIL if one.away_m < fail_m and not one.is_column else Level.WARNINGS
        limit_m = fail_m if level is Level.FAIL else warn_m
        facts: Facts = {"name": route.name, "metres": one.away_m, "limit_m": limit_m, "waypoint": one.waypoint, "at_s": one.t_s}
        yield AssessmentFinding(level, "obstacle-column" if one.is_column else "obstacle", route.uav, facts=facts)


def _of_closest_approaches(closest_approaches: Sequence[ClosestApproach], limits: AssessmentLimits) -> Iterator[AssessmentFinding]:
    """Report each for both UAVs."""
    for closest in closest_approaches:
        is_hit = closest.away_m < limits.apart_fail_m
        if not is_hit and not (closest.beside_m < limits.apart_warn_beside_m and closest.height_m < limits.apart_warn_height_m):
            continue
        limit_m = limits.apart_fail_m if is_hit else limits.apart_warn_beside_m
        for uav, other in (closest.uavs, closest.uavs[::-1]):
            facts: Facts = {"metres": closest.away_m, "limit_m": limit_m, "at_s": closest.t_s, "other": other}
            yield AssessmentFinding(Level.FAIL if is_hit else Level.WARNINGS, "apart", uav, facts=facts)
