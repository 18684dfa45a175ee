"""When a route reaches each of its waypoints, and what is left of the battery there."""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.short_vector import short_vector_m
from missions.flight_plan.conditions import Conditions, air_density, wind_in_table
from missions.flight_plan.performance import Performance
from missions.flight_plan.power import CLIMBING, LEVEL, TOO_STRONG, NoHeadway, ground_and_air_speed, power_table, watts
from missions.flight_plan.rules import FlightRules
from missions.flight_plan.waypoints import Waypoints

FloatArray = NDArray[np.float64]

J_PER_WH = 3_600.0


@dataclass(frozen=True, eq=False)
class Timing:
    """A route of n waypoints by the clock and the battery. What tells of the battery is None without one.

    arrival_s             (n,)  after taking off, on reaching the waypoint, before what is done there
    used_wh               (n,)  of the battery by then
    battery_left_percent  (n,)  of the full battery then, below 0 where it does not suffice
    total_s, total_wh           with what is done at the last waypoint, and with the landing
    end_percent                 of the full battery after all
    """

    arrival_s: FloatArray
    used_wh: FloatArray | None
    battery_left_percent: FloatArray | None
    total_s: float
    total_wh: float | None
    end_percent: float | None


def vertical_speeds_mps(performance: Performance, rules: FlightRules) -> tuple[float, float]:
    """Up and down: the UAV's own, else those of the plan's rules."""
    up, down = performance.climb_speed_mps, performance.descent_speed_mps
    return rules.climb_speed_mps if up is None else up, rules.climb_speed_mps if down is None else down


def airspeed_limit_mps(performance: Performance) -> float:
    return math.inf if performance.max_airspeed_mps is None else performance.max_airspeed_mps


def timing(
    waypoints: Waypoints,
    *,
    cruise_speed_mps: float,
    performance: Performance,
    conditions: Conditions,
    lands: bool,
    rules: FlightRules,
) -> Timing:
    """Seconds and watt-hours to each waypoint. Raises NoHeadway where the wind is too strong for the UAV.

    Each leg is flown level, in the wind of its middle height, and then straight up or down to its end, in the same wind; a UAV that does
    both at once is sooner there, so this errs on the long side. The column from the ground at the start counts, and with `lands` the one
    at the end. Turns and changes of speed do not: flights with a turn each 500 m were measured to take 3 to 7 % longer. Without heights
    above sea level the air is taken to be that of the sea.
    """
    points = waypoints.points
    battery_wh = performance.battery_wh
    hold_s = np.zeros(len(points))
    for place, task in points.task.items():
        hold_s[place] = task.hold_s
    climb_mps, descent_mps = vertical_speeds_mps(performance, rules)
    arrival_s, used_j, total_s, total_j, too_strong = _timing(
        points.position,
        points.agl_m,
        waypoints.relative_m,
        _NO_HEIGHTS if waypoints.amsl_m is None else waypoints.amsl_m,
        hold_s,
        conditions.wind_table,
        float(conditions.temperature_c),
        _NO_TABLE if battery_wh is None else power_table(performance, climb_mps),
        float(cruise_speed_mps),
        airspeed_limit_mps(performance),
        climb_mps,
        descent_mps,
        lands,
    )
    if too_strong >= 0:
        raise NoHeadway(too_strong)
    if battery_wh is None:
        return Timing(arrival_s, None, None, total_s, None, None)
    used_wh = used_j / J_PER_WH
    return Timing(
        arrival_s,
        used_wh,
        100.0 - used_wh * (100.0 / battery_wh),
        total_s,
        total_j / J_PER_WH,
        100.0 - total_j / J_PER_WH * (100.0 / battery_wh),
    )


_NO_TABLE = np.zeros((0, 0, 0))
_NO_HEIGHTS = np.zeros(0)


@njit(cache=True, nogil=True)
def _timing(
    position: FloatArray,
    agl_m: FloatArray,
    relative_m: FloatArray,
    amsl_m: FloatArray,
    hold_s: FloatArray,
    wind: FloatArray,
    temperature_c: float,
    table: FloatArray,
    cruise_mps: float,
    limit_mps: float,
    climb_mps: float,
    descent_mps: float,
    lands: bool,
) -> tuple[FloatArray, FloatArray, float, float, int]:
    """Arrival and joules at each waypoint, both in total, and the first waypoint that the wind keeps the UAV from, -1 for none.

    amsl_m is empty where not known, the table empty without a battery.
    """
    count = len(position)
    arrival_s, used_j = np.empty(count), np.zeros(count)
    now_s = now_j = 0.0
    if count == 0:
        return arrival_s, used_j, 0.0, 0.0, -1
    has_battery = len(table) > 0
    density = air_density(0.0, temperature_c)
    is_known = len(amsl_m) > 0
    for place in range(count + 1):
        # The leg to this waypoint; the last goes down to the ground.
        is_column = place == 0 or place == count
        if place == count and not lands:
            break
        if place == 0:
            before_m, after_m, rise_m = 0.0, agl_m[0], agl_m[0]
        elif place == count:
            before_m, after_m, rise_m = agl_m[count - 1], 0.0, -agl_m[count - 1]
        else:
            before_m, after_m, rise_m = agl_m[place - 1], agl_m[place], relative_m[place] - relative_m[place - 1]
        if has_battery and is_known:
            density = air_density(amsl_m[min(place, count - 1)], temperature_c)
        east_wind_mps, north_wind_mps = wind_in_table(wind, 0.5 * (before_m + after_m))
        wind_mps = math.hypot(east_wind_mps, north_wind_mps)
        if wind_mps > limit_mps:
            return arrival_s, used_j, now_s, now_j, min(place, count - 1)
        if not is_column:
            east_m, north_m = short_vector_m(position[place - 1, 0], position[place - 1, 1], position[place, 0], position[place, 1])
            length_m = math.hypot(east_m, north_m)
            if length_m > 0.0:
                along_mps = (east_m * east_wind_mps + north_m * north_wind_mps) / length_m
                across_mps = (east_m * north_wind_mps - north_m * east_wind_mps) / length_m
                ground_mps, air_mps = ground_and_air_speed(cruise_mps, limit_mps, along_mps, across_mps)
                if ground_mps == TOO_STRONG:
                    return arrival_s, used_j, now_s, now_j, place
                now_s += length_m / ground_mps
                if has_battery:
                    now_j += length_m / ground_mps * watts(table, LEVEL, air_mps, density)
        if rise_m != 0.0:
            vertical_s = rise_m / climb_mps if rise_m > 0.0 else -rise_m / descent_mps
            now_s += vertical_s
            if has_battery:
                now_j += vertical_s * watts(table, CLIMBING if rise_m > 0.0 else LEVEL, wind_mps, density)
        if place < count:
            arrival_s[place], used_j[place] = now_s, now_j
            if hold_s[place] > 0.0:
                east_wind_mps, north_wind_mps = wind_in_table(wind, agl_m[place])
                held_mps = math.hypot(east_wind_mps, north_wind_mps)
                if held_mps > limit_mps:
                    return arrival_s, used_j, now_s, now_j, place
                now_s += hold_s[place]
                if has_battery:
                    now_j += hold_s[place] * watts(table, LEVEL, held_mps, density)
    return arrival_s, used_j, now_s, now_j, -1
