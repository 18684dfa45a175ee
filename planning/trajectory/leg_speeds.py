"""How fast a leg is flown over ground: as its target asks for, and how fast and how slow it can be in its wind."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from inspection.geodesy.local_frame import short_vector_m
from planning.energy.conditions import Conditions, wind_in_table
from planning.energy.performance import Performance
from planning.energy.power import MIN_HEADWAY_MPS, TOO_STRONG, ground_and_air_speed
from planning.trajectory.waypoints import Waypoints

ROUNDING_MPS = 1e-6


class SpeedRange(NamedTuple):
    """Over ground; least_mps above most_mps where the wind is too strong for any speed."""

    least_mps: float
    most_mps: float


def inspection_speeds(
    target: Sequence[int | None], speed_of: Mapping[int, float], cruise_speed_mps: float, *, begins_in_air: bool = False
) -> dict[int, float]:
    """Return the speeds [m/s] of the legs along the stretches of targets, by the waypoint that they lead to.

    target: that of each waypoint, None or below 0 for none; speed_of: the inspection speeds of targets that have one. A UAV that flies
    slower keeps its own. Where the route begins in the air, the UAV may be on the stretch that its first leg leads to: that leg counts.
    """
    found: dict[int, float] = {}
    for number, speed_mps in speed_of.items():
        if speed_mps < cruise_speed_mps and number in target:
            first = target.index(number)
            first -= 1 if begins_in_air and first == 1 else 0
            last = len(target) - 1 - target[::-1].index(number)
            found |= dict.fromkeys(range(first + 1, last + 1), speed_mps)
    return found


def speeds_out_of_range(
    waypoints: Waypoints, *, cruise_speed_mps: float, performance: Performance, conditions: Conditions
) -> dict[int, SpeedRange]:
    """Of the legs with a speed of their own those that cannot be flown at it, by the waypoint that they lead to, with what can be.

    In the wind of the leg's middle height, as it is timed. Of a UAV whose top airspeed is not stated, no more is known than that it flies
    its cruising speed.
    """
    found = {}
    for place, speed_mps in waypoints.points.speed_mps.items():
        own = _range(waypoints, place, cruise_speed_mps, performance.max_airspeed_mps, conditions)
        if not own.least_mps - ROUNDING_MPS <= speed_mps <= own.most_mps + ROUNDING_MPS:
            found[place] = own
    return found


def ground_speeds(waypoints: Waypoints, *, cruise_speed_mps: float, performance: Performance, conditions: Conditions) -> list[float | None]:
    """How fast the leg to each waypoint is flown over ground [m/s], as it is timed; None where no leg leads or there is no headway.

    That is as wished, or as fast as its wind leaves it.
    """
    limit_mps = cruise_speed_mps if performance.max_airspeed_mps is None else performance.max_airspeed_mps
    found: list[float | None] = []
    for place in range(len(waypoints)):
        wind = _wind_on_leg(waypoints, place, conditions)
        wished_mps = waypoints.points.speed_mps.get(place, cruise_speed_mps)
        speed_mps = TOO_STRONG if wind is None else ground_and_air_speed(wished_mps, limit_mps, *wind)[0]
        found.append(None if speed_mps == TOO_STRONG else float(speed_mps))
    return found


def _range(waypoints: Waypoints, place: int, cruise_speed_mps: float, max_airspeed_mps: float | None, conditions: Conditions) -> SpeedRange:
    limit_mps = cruise_speed_mps if max_airspeed_mps is None else max_airspeed_mps
    wind = _wind_on_leg(waypoints, place, conditions)
    if wind is None:
        return SpeedRange(MIN_HEADWAY_MPS, limit_mps)
    along_mps, across_mps = wind
    spare_mps = math.sqrt(max(limit_mps**2 - across_mps**2, 0.0))
    most_mps = along_mps + spare_mps
    return SpeedRange(max(MIN_HEADWAY_MPS, along_mps - spare_mps), most_mps if max_airspeed_mps is not None else min(most_mps, limit_mps))


def _wind_on_leg(waypoints: Waypoints, place: int, conditions: Conditions) -> tuple[float, float] | None:
    """Along the leg to a waypoint and across it [m/s], at its middle height; None where it has no length."""
    points, before = waypoints.points, max(place - 1, 0)
    start, end = points.position[before], points.position[place]
    east_m, north_m = short_vector_m(start[0], start[1], end[0], end[1])
    length_m = math.hypot(east_m, north_m)
    if length_m == 0.0:
        return None
    east, north = east_m / length_m, north_m / length_m
    east_mps, north_mps = wind_in_table(conditions.wind_table, 0.5 * (float(points.agl_m[before]) + float(points.agl_m[place])))
    return east * east_mps + north * north_mps, east * north_mps - north * east_mps
