"""What one leg takes of time and battery: the arithmetic that routes drawn and routes not drawn share."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planning.energy.conditions import Conditions, wind_in_table
from planning.energy.performance import Performance
from planning.energy.power import CLIMBING, LEVEL, TOO_STRONG, ground_and_air_speed, power_table, watts
from planning.rules import FlightRules

FloatArray = NDArray[np.float64]

J_PER_WH = 3_600.0
NO_TABLE = np.zeros((0, 0, 0))  # in place of a table of power: without a battery joules are not counted


class Speeds(NamedTuple):
    """Of a UAV on a plan, m/s: wanted over ground, most through the air, straight up, straight down.

    And seconds that these do not tell, each beside flying at them: slowing down to a stand, or speeding up from it; settling there;
    leaving the ground; coming down on it.
    """

    cruise_mps: float
    limit_mps: float
    climb_mps: float
    descent_mps: float
    brake_s: float
    settle_s: float
    lift_s: float
    touch_s: float


def speeds(performance: Performance, cruise_speed_mps: float, rules: FlightRules) -> Speeds:
    """Up and down as the UAV has it, else as the plan's rules do."""
    limit, up, down = performance.max_airspeed_mps, performance.climb_speed_mps, performance.descent_speed_mps
    manoeuvres = rules.manoeuvres
    down_mps = float(rules.climb_speed_mps if down is None else down)
    return Speeds(
        float(cruise_speed_mps),
        float(cruise_speed_mps if limit is None else limit),  # of an airspeed that is not stated it is known to fly its speed
        float(rules.climb_speed_mps if up is None else up),
        down_mps,
        brake_s=cruise_speed_mps / (2.0 * manoeuvres.acceleration_mps2),
        settle_s=manoeuvres.settle_s,
        lift_s=manoeuvres.lift_s,
        touch_s=max(manoeuvres.slow_below_m / manoeuvres.landing_mps - manoeuvres.slow_below_m / down_mps, 0.0),
    )


class Air(NamedTuple):
    """What is flown in, and how, as compiled code reads it: layers of wind, the temperature, speeds, watts."""

    wind: FloatArray
    temperature_c: float
    own: Speeds
    table: FloatArray

    @classmethod
    def of(cls, performance: Performance, cruise_speed_mps: float, conditions: Conditions, rules: FlightRules) -> "Air":
        own = speeds(performance, cruise_speed_mps, rules)
        table = NO_TABLE if performance.battery_wh is None else power_table(performance, own.climb_mps)
        return cls(conditions.wind_table, float(conditions.temperature_c), own, table)


@njit(cache=True, nogil=True)
def leg_taken(
    length_m: float,
    east: float,
    north: float,
    start_agl_m: float,
    end_agl_m: float,
    rise_m: float,
    density: float,
    air: Air,
) -> tuple[float, float]:
    """Seconds and joules of a leg between two heights above ground: flown straight, as slowly as its length and its rise ask for.

    In the wind of its middle height. Endless where the wind leaves no headway at any height that the leg comes through, so that a part of
    an open leg is open. (east, north) is the leg's direction, of length 1; rise_m counts the ground's rise, too.
    """
    if start_agl_m != end_agl_m and is_closed(length_m > 0.0, east, north, start_agl_m, end_agl_m, air):
        return np.inf, np.inf
    wind_mps = wind_in_table(air.wind, 0.5 * (start_agl_m + end_agl_m))
    return taken_in_wind(length_m, east, north, rise_m, wind_mps, density, air.own, air.table)


@njit(cache=True, nogil=True)
def taken_in_wind(
    length_m: float,
    east: float,
    north: float,
    rise_m: float,
    wind_mps: tuple[float, float],
    density: float,
    own: Speeds,
    table: FloatArray,
) -> tuple[float, float]:
    """As leg_taken, all of it in one wind: the air's velocity to east and north."""
    east_mps, north_mps = wind_mps
    air_2 = east_mps * east_mps + north_mps * north_mps
    if air_2 > own.limit_mps * own.limit_mps:
        return np.inf, np.inf
    along_mps, across_mps = east * east_mps + north * north_mps, east * north_mps - north * east_mps
    level_s = level_air_mps = 0.0
    if length_m > 0.0:
        ground_mps, level_air_mps = ground_and_air_speed(own.cruise_mps, own.limit_mps, along_mps, across_mps)
        if ground_mps == TOO_STRONG:
            return np.inf, np.inf
        level_s = length_m / ground_mps
    vertical_s = rise_m / own.climb_mps if rise_m > 0.0 else -rise_m / own.descent_mps
    if len(table) == 0:
        return max(level_s, vertical_s), 0.0
    if vertical_s > level_s:  # the rise takes longer: slower along
        air_mps = math.hypot(length_m / vertical_s - along_mps, across_mps) if length_m > 0.0 else math.sqrt(air_2)
        return vertical_s, vertical_s * watts(table, CLIMBING if rise_m > 0.0 else LEVEL, air_mps, density)
    level_w = watts(table, LEVEL, level_air_mps, density)
    joules = level_s * level_w
    if rise_m > 0.0:  # power between level flight and the full climb is a convex function of the climb: this is no less
        joules += vertical_s * (watts(table, CLIMBING, level_air_mps, density) - level_w)
    return level_s, joules


@njit(cache=True, nogil=True)
def is_closed(is_flown: bool, east: float, north: float, start_agl_m: float, end_agl_m: float, air: Air) -> bool:
    """Whether there is no headway at some height between the two, in wind that changes with height.

    Then it is so at one of the two or at a layer in between: from layer to layer the wind changes evenly, and headway is a concave
    function of the wind.
    """
    if len(air.wind) < 2 or math.isinf(air.own.limit_mps):
        return False
    low_m, high_m = min(start_agl_m, end_agl_m), max(start_agl_m, end_agl_m)
    for number in range(-2, len(air.wind)):
        agl_m = low_m if number == -2 else high_m if number == -1 else air.wind[number, 0]
        if not low_m <= agl_m <= high_m:
            continue
        east_mps, north_mps = wind_in_table(air.wind, agl_m)
        if east_mps * east_mps + north_mps * north_mps > air.own.limit_mps * air.own.limit_mps:
            return True
        if is_flown:
            along_mps, across_mps = east * east_mps + north * north_mps, east * north_mps - north * east_mps
            if ground_and_air_speed(air.own.cruise_mps, air.own.limit_mps, along_mps, across_mps)[0] == TOO_STRONG:
                return True
    return False


@njit(cache=True, nogil=True)
def hold_taken(hold_s: float, agl_m: float, density: float, air: Air) -> tuple[float, float]:
    """Seconds and joules of staying in one place; endless where the wind is too strong for it."""
    east_mps, north_mps = wind_in_table(air.wind, agl_m)
    wind_mps = math.sqrt(east_mps * east_mps + north_mps * north_mps)
    if wind_mps > air.own.limit_mps:
        return np.inf, np.inf
    return hold_s, hold_s * watts(air.table, LEVEL, wind_mps, density) if len(air.table) > 0 else 0.0


@njit(cache=True, nogil=True)
def stay_taken(hold_s: float, agl_m: float, density: float, air: Air) -> tuple[float, float]:
    """As hold_taken, with what slowing down before a stay, settling and speeding up after it take beside flying on."""
    stops_s = 2.0 * air.own.brake_s + air.own.settle_s if hold_s > 0.0 else 0.0
    return hold_taken(hold_s + stops_s, agl_m, density, air)


@njit(cache=True, nogil=True)
def take_off_taken(agl_m: float, density: float, air: Air) -> tuple[float, float]:
    """What a take-off to this height takes beside the climb: until it climbs, and then until it flies at its speed."""
    return hold_taken(air.own.lift_s + air.own.brake_s, 0.5 * agl_m, density, air)


@njit(cache=True, nogil=True)
def landing_taken(agl_m: float, density: float, air: Air) -> tuple[float, float]:
    """What a landing from this height takes beside the descent: to a stand before it, and slowly near the ground.

    One that lands where it has stayed stands already: for it this errs on the long side.
    """
    return hold_taken(air.own.brake_s + air.own.settle_s + air.own.touch_s, 0.5 * agl_m, density, air)
