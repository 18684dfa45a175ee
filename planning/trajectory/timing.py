"""When a route reaches each of its waypoints, and what is left of the battery there."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.local_frame import short_vector_m
from planning.energy.conditions import Conditions, air_density, wind_in_table
from planning.energy.leg_cost import (
    J_PER_WH,
    Air,
    Speeds,
    hold_taken,
    is_closed,
    landing_taken,
    take_off_taken,
    taken_in_wind,
)
from planning.energy.performance import Performance
from planning.energy.power import NoHeadway
from planning.rules import FlightRules
from planning.trajectory.turns import turning_s
from planning.trajectory.waypoints import Waypoints

FloatArray = NDArray[np.float64]

SAME_AIR_M = 5.0  # up or down, over which density is taken as one: it changes by 0.05 %


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

    Each leg is flown straight, in the wind of its middle height, as slowly as its length and its rise ask for. The column from the ground
    at the start counts, and with `lands` the one at the end. A leg with a speed of its own is flown at that, within the airspeed limit like
    any other. Taking off, stopping to stay, turns of the course (turns.py) and landing count with what `Manoeuvres` say of them. Without
    heights above sea level the air is taken to be that of the sea.
    """
    points = waypoints.points
    battery_wh = performance.battery_wh
    hold_s = np.zeros(len(points))
    for place, task in points.task.items():
        hold_s[place] = task.hold_s
    air = Air.of(performance, cruise_speed_mps, conditions, rules)
    wanted_mps = np.full(len(points) if points.speed_mps else 0, air.own.cruise_mps)
    for place, speed_mps in points.speed_mps.items():
        wanted_mps[place] = speed_mps
    arrival_s, used_j, total_s, total_j, too_strong = _timing(
        _Flown(
            points.position, points.agl_m, waypoints.relative_m, _NO_HEIGHTS if waypoints.amsl_m is None else waypoints.amsl_m, wanted_mps
        ),
        hold_s,
        air,
        lands,
        (rules.manoeuvres.acceleration_mps2, rules.manoeuvres.corner_mps2),
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


_NO_HEIGHTS = np.zeros(0)


class _Flown(NamedTuple):
    """Where waypoints lie: lon, lat [deg]; metres above ground, above take-off, and above sea level, empty where not known.

    wanted_mps are speeds over ground to each waypoint, empty where all are as the UAV does.
    """

    position: FloatArray
    agl_m: FloatArray
    relative_m: FloatArray
    amsl_m: FloatArray
    wanted_mps: FloatArray


@njit(cache=True, nogil=True)
def _timing(
    flown: _Flown, hold_s: FloatArray, air: Air, lands: bool, manoeuvres: tuple[float, float]
) -> tuple[FloatArray, FloatArray, float, float, int]:
    """Arrival and joules at each waypoint, both in total, and the first waypoint that the wind keeps the UAV from, -1 for none.

    manoeuvres: acceleration and speed round corners, as in `Manoeuvres`.
    """
    count, agl_m, own = len(flown.position), flown.agl_m, air.own
    arrival_s, used_j = np.empty(count), np.empty(count)
    leg_m, leg_s, leg_j, density = _legs(flown, air, lands)
    # A slower leg is braked and settled from in less time; the last is for none behind.
    turning, brake_s, settle_s = np.zeros(len(leg_s)), np.full(len(leg_s) + 1, own.brake_s), np.full(len(leg_s) + 1, own.settle_s)
    for place in range(len(flown.wanted_mps)):
        slower = min(flown.wanted_mps[place] / own.cruise_mps, 1.0)
        brake_s[place], settle_s[place] = own.brake_s * slower, own.settle_s * slower
    if count > 1 and np.isfinite(leg_s).all():
        is_stop = hold_s > 0.0
        is_stop[0], is_stop[-1] = True, is_stop[-1] or lands
        turning[1:count] = turning_s(leg_m[1:count], leg_s[1:count], is_stop, brake_s[1:count], manoeuvres[0], manoeuvres[1])
    now_s = now_j = 0.0
    for place in range(len(leg_s)):
        now_s, now_j = now_s + leg_s[place], now_j + leg_j[place]
        beside_s = turning[place]
        if place < count and hold_s[place] > 0.0:
            beside_s += brake_s[place]
        if place == 0:
            seconds, joules = take_off_taken(agl_m[0], density[0], air)
            now_s, now_j = now_s + seconds, now_j + joules
        if beside_s > 0.0:
            seconds, joules = hold_taken(beside_s, agl_m[place], density[place], air)
            now_s, now_j = now_s + seconds, now_j + joules
        if place < count:
            arrival_s[place], used_j[place] = now_s, now_j
            if hold_s[place] > 0.0:
                stays_s = settle_s[place] + hold_s[place] + brake_s[place + 1]
                seconds, joules = hold_taken(stays_s, agl_m[place], density[place], air)
                now_s, now_j = now_s + seconds, now_j + joules
        else:
            seconds, joules = landing_taken(agl_m[count - 1], density[place], air)
            now_s, now_j = now_s + seconds, now_j + joules
        if math.isinf(now_s):
            return arrival_s, used_j, now_s, now_j, min(place, count - 1)
    return arrival_s, used_j, now_s, now_j, -1


@njit(cache=True, nogil=True)
def _legs(flown: _Flown, air: Air, lands: bool) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Metres to east, north and up, seconds and joules of the leg to each waypoint, and the air's density there.

    The first leg leads up from the ground; with `lands` there is one more, down to it.
    """
    position, agl_m, relative_m, amsl_m = flown.position, flown.agl_m, flown.relative_m, flown.amsl_m
    count, own = len(position), air.own
    legs = count + 1 if lands and count else count
    leg_m, leg_s, leg_j, density = np.zeros((legs, 3)), np.empty(legs), np.empty(legs), np.empty(legs)
    density_amsl_m, here = 0.0, air_density(0.0, air.temperature_c)
    wind_agl_m, wind_here = (0.0, 0.0), wind_in_table(air.wind, 0.0)
    for place in range(legs):
        length_m = east = north = 0.0
        before_m, after_m = agl_m[place - 1] if place > 0 else 0.0, agl_m[place] if place < count else 0.0
        rise_m = after_m - before_m
        if 0 < place < count:
            rise_m = relative_m[place] - relative_m[place - 1]
            east, north = short_vector_m(position[place - 1, 0], position[place - 1, 1], position[place, 0], position[place, 1])
            leg_m[place, 0], leg_m[place, 1], leg_m[place, 2] = east, north, rise_m
            length_m = math.sqrt(east * east + north * north)
            if length_m > 0.0:
                east, north = east / length_m, north / length_m
        if len(air.table) > 0 and len(amsl_m) > 0 and abs(amsl_m[min(place, count - 1)] - density_amsl_m) > SAME_AIR_M:
            density_amsl_m = amsl_m[min(place, count - 1)]
            here = air_density(density_amsl_m, air.temperature_c)
        if before_m != wind_agl_m[0] or after_m != wind_agl_m[1]:
            wind_agl_m, wind_here = (before_m, after_m), wind_in_table(air.wind, 0.5 * (before_m + after_m))
        on_leg = air
        if place < len(flown.wanted_mps):
            wanted = Speeds(
                flown.wanted_mps[place], own.limit_mps, own.climb_mps, own.descent_mps, own.brake_s, own.settle_s, own.lift_s, own.touch_s
            )
            on_leg = Air(air.wind, air.temperature_c, wanted, air.table)
        # As leg_taken: most legs are level, and in the wind of the leg before.
        seconds, joules = taken_in_wind(length_m, east, north, rise_m, wind_here, here, on_leg.own, on_leg.table)
        if before_m != after_m and is_closed(length_m > 0.0, east, north, before_m, after_m, on_leg):
            seconds = joules = np.inf
        leg_s[place], leg_j[place], density[place] = seconds, joules, here
    return leg_m, leg_s, leg_j, density
