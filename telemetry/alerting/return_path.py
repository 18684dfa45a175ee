"""RTL path along the rest of an approved flight: straight to a waypoint ahead, then on as approved to its landing place.

Only the leg to that waypoint is new. It is checked as the autopilot flies it, straight in position and height.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat, distance_m
from inspection.network.spans import Spans
from mavlink.approved_route import HOVER, Flight, FrozenWaypoint
from planning.clearance.obstacle_clearance import legs_too_near
from planning.clearance.zone_clearance import TAKE_OFF, FlownRoute, Margins, ZoneFacts, breaches
from planning.rules import FlightRules
from planning.trajectory.heights import GroundHeights
from planning.trajectory.waypoints import FloatArray, RoutePoint, RoutePoints, WaypointKind, Waypoints

SAMPLED_EVERY_M = 10.0
ROUNDING_M = 0.5  # heights are stored to 0.1 m


@dataclass(frozen=True)
class Here:
    """Position and height above take-off of a UAV, and the index of the waypoint that it flies to."""

    position: LonLat
    height_m: float
    ahead: int


@dataclass(frozen=True)
class ReturnPath:
    """A path. `first` is the index of the waypoint that it flies to directly, `sequence` that in the stored route.

    `speed_mps` applies from there on. `targets` are the sequences of the mission's targets that it still visits.
    """

    first: int
    sequence: int
    speed_mps: float
    length_m: float
    duration_s: float
    targets: tuple[int, ...]


def return_path(
    flight: Flight, here: Here, *, cruise_mps: float, base_m: float | None, ground_heights_m: GroundHeights | None, spans: Spans,
    zones: ZoneFacts, margins: Margins, rules: FlightRules,
) -> ReturnPath | None:  # fmt: skip
    """Return the quickest path that meets no zone and stays clear of terrain and obstacles; None if there is none.

    base_m: take-off altitude AMSL. Without it or without ground_heights_m, flat ground is assumed. zones: those in force meanwhile.
    """
    points = flight.waypoints
    if flight.end_action == HOVER or not 0 <= here.ahead < len(points):
        return None
    ground = None if base_m is None else ground_heights_m
    for first in _quickest_first(flight, here, cruise_mps, rules):
        if _is_clear(points[first:], here, base_m, ground, spans, zones, margins, rules):
            length_m, duration_s = _length_and_time(points[first:], here, cruise_mps, rules)
            targets = tuple(dict.fromkeys(point.target for point in points[first:] if point.target is not None))
            speed_mps = points[first].speed_mps or cruise_mps
            return ReturnPath(first, points[first].sequence, speed_mps, length_m, duration_s, targets)
    return None


def return_path_points(flight: Flight, path: ReturnPath, here: Here) -> list[tuple[LonLat, float, float]]:
    """Return position, height above take-off and hold seconds of each point, from its position to its landing."""
    ahead = [(point.position, point.altitude_relative_m, _hold_s(point)) for point in flight.waypoints[path.first :]]
    return [(here.position, here.height_m, 0.0), *ahead]


def _quickest_first(flight: Flight, here: Here, cruise_mps: float, rules: FlightRules) -> list[int]:
    points = flight.waypoints
    numbers = range(here.ahead, len(points))
    return sorted(numbers, key=lambda first: _length_and_time(points[first:], here, cruise_mps, rules)[1])


def _length_and_time(points: Sequence[FrozenWaypoint], here: Here, cruise_mps: float, rules: FlightRules) -> tuple[float, float]:
    """Return metres over ground and seconds, with holds and the descent at the end."""
    places = np.array([here.position, *(point.position for point in points)], dtype=np.float64)
    legs_m = distance_m(places[:-1], places[1:])
    speeds = np.array([point.speed_mps or cruise_mps for point in points])
    rises = np.abs(np.diff([here.height_m, *(point.altitude_relative_m for point in points)]))
    climb_mps, slow_m, landing_mps = rules.climb_speed_mps, rules.manoeuvres.slow_below_m, rules.manoeuvres.landing_mps
    down_m = points[-1].altitude_agl_m
    down_s = max(down_m - slow_m, 0.0) / climb_mps + min(down_m, slow_m) / landing_mps
    flown_s = float(np.maximum(legs_m / speeds, rises / climb_mps).sum()) + sum(map(_hold_s, points))
    return float(legs_m.sum()), flown_s + down_s


def _hold_s(point: FrozenWaypoint) -> float:
    return 0.0 if point.task is None else point.task.hold_s


def _is_clear(
    points: Sequence[FrozenWaypoint], here: Here, base_m: float | None, ground: GroundHeights | None, spans: Spans, zones: ZoneFacts,
    margins: Margins, rules: FlightRules,
) -> bool:  # fmt: skip
    position = np.array([here.position, *(point.position for point in points)], dtype=np.float64)
    relative_m = np.array([here.height_m, *(point.altitude_relative_m for point in points)])
    under_m = _under_m(position[:1], base_m, ground)
    own_agl_m = here.height_m - float(under_m[0])
    agl_m = np.array([own_agl_m, *(point.altitude_agl_m for point in points)])
    if math.isnan(own_agl_m) or not _keeps_above_ground(position[:2], relative_m[:2], agl_m[:2], base_m, ground, rules):
        return False
    amsl_m = None if base_m is None or ground is None else relative_m + base_m
    leg = Waypoints(
        RoutePoints.of([RoutePoint(LonLat(*position[0]), WaypointKind.PASS, own_agl_m), _as_passed(points[0])]),
        None if amsl_m is None else amsl_m[:2],
        relative_m[:2],
    )
    if legs_too_near(leg, spans, ground, rules):
        return False
    flown = FlownRoute(position, agl_m, amsl_m, lands=True)
    return not any(breach.leg != TAKE_OFF for breach in breaches(flown, zones, margins))


def _as_passed(point: FrozenWaypoint) -> RoutePoint:
    return RoutePoint(point.position, WaypointKind.PASS, point.altitude_agl_m)


def _under_m(position: FloatArray, base_m: float | None, ground: GroundHeights | None) -> FloatArray:
    """Return the ground height above the take-off; NaN if unknown."""
    if base_m is None or ground is None:
        return np.zeros(len(position))
    under_m: FloatArray = ground(position) - base_m
    return under_m


def _keeps_above_ground(
    position: FloatArray, relative_m: FloatArray, agl_m: FloatArray, base_m: float | None, ground: GroundHeights | None, rules: FlightRules
) -> bool:
    """Return whether the leg keeps the clearance, or the height above ground of its lower end if that is less."""
    length_m = float(distance_m(position[:1], position[1:])[0])
    share = np.linspace(0.0, 1.0, max(1, math.ceil(length_m / SAMPLED_EVERY_M)) + 1)
    under_m = _under_m(position[0] + share[:, None] * (position[1] - position[0]), base_m, ground)
    kept_m = min(rules.clearance_m, float(agl_m.min())) - ROUNDING_M
    above_m = relative_m[0] + share * (relative_m[1] - relative_m[0]) - under_m
    return bool((above_m >= kept_m).all())  # NaN: unknown
