"""Electrical power in flight, and the speed over ground that the wind leaves.

Momentum theory with Glauert's inflow in forward flight (Leishman, Principles of Helicopter Aerodynamics, 2.14 and 5.4): the rotors are
one disk, tilted so far that its thrust, its own drag and the body's drag are in balance; each newton of thrust is paid with the speed
of the air through the disk.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planning.energy.performance import STANDARD_DENSITY, Performance

FloatArray = NDArray[np.float64]

INDUCED_FACTOR = 1.15  # an uneven inflow costs more than momentum theory's even one (Leishman 2.6.2: 1.1 to 1.2)
DRIVE_EFFICIENCY = 0.85  # shaft power for electrical power: motor 0.88 x speed controller 0.97, common for small UAVs
ACROSS_ROTORS = 2.0  # drag area along the rotors' axis for each m2 in their plane: the Iris is flat
MIN_HEADWAY_MPS = 0.5  # slower over ground than this is no flight plan
TOO_STRONG = 0.0  # metres a second over ground where the wind leaves no headway

# The table of watts that routes are timed with; between its rows and columns the error is below 0.1 %.
AIRSPEED_STEP_MPS = 0.5
AIRSPEEDS = 201
MIN_DENSITY, DENSITY_STEP, DENSITIES = 0.3, 0.1, 14  # kg/m3, from 9 km above sea to the frost of -60 °C
LEVEL, CLIMBING = 0, 1


class NoHeadway(ValueError):
    """The wind is stronger than the airspeed that the UAV may fly; `leg` is the first waypoint that it cannot reach or hold."""

    def __init__(self, leg: int) -> None:
        super().__init__(f"The wind leaves no headway before waypoint {leg}.")
        self.leg = leg


def power_w(performance: Performance, *, airspeed_mps: float = 0.0, climb_mps: float = 0.0, air_density: float = STANDARD_DENSITY) -> float:
    """Watts that steady flight draws from the battery.

    A descent costs as much as level flight: what it saves is small beside the doubt of flying into one's own wake.
    """
    return float(_power_w(float(airspeed_mps), float(climb_mps), float(air_density), _rotors(performance)))


@lru_cache(maxsize=64)
def power_table(performance: Performance, climb_mps: float) -> FloatArray:
    """Watts in level flight and climbing, (2, DENSITIES, AIRSPEEDS), as `watts` reads them."""
    table = np.empty((2, DENSITIES, AIRSPEEDS))
    _fill(table, float(climb_mps), _rotors(performance))
    return table


class Rotors(NamedTuple):
    """What the power of a UAV follows from, as in Performance."""

    weight_n: float
    disk_m2: float
    efficiency: float
    avionics_w: float
    drag_area_m2: float
    rotor_drag: float


def _rotors(performance: Performance) -> Rotors:
    return Rotors(
        performance.weight_n,
        performance.rotor_disk_m2,
        performance.hover_efficiency,
        performance.avionics_w,
        performance.body_drag_area_m2,
        performance.disk_drag,
    )


def ground_speed_mps(course_deg: float, max_airspeed_mps: float | None, wanted_mps: float, wind_mps: tuple[float, float]) -> float | None:
    """Speed over ground along a course [m/s]; None where the wind leaves no headway.

    The autopilot holds the wanted speed over ground, as PX4 does, as long as the airspeed that this takes is not above the limit; else
    it flies what the limit leaves: less against the wind, more where even the limit does not hold back enough. A UAV that could not stay
    over a place in this wind has no headway anywhere. wind_mps: the air's velocity to east and north.
    """
    east, north = math.sin(math.radians(course_deg)), math.cos(math.radians(course_deg))
    along, across = wind_mps[0] * east + wind_mps[1] * north, wind_mps[0] * north - wind_mps[1] * east
    speed_mps, _ = ground_and_air_speed(wanted_mps, math.inf if max_airspeed_mps is None else max_airspeed_mps, along, across)
    return None if speed_mps == TOO_STRONG else speed_mps


@njit(cache=True, nogil=True)
def ground_and_air_speed(wanted_mps: float, limit_mps: float, along_mps: float, across_mps: float) -> tuple[float, float]:
    """Speed over ground and through the air, both TOO_STRONG where there is no headway; the wind along the course and across it."""
    if along_mps * along_mps + across_mps * across_mps > limit_mps * limit_mps:
        return TOO_STRONG, TOO_STRONG
    air_mps = math.sqrt((wanted_mps - along_mps) ** 2 + across_mps * across_mps)
    if air_mps <= limit_mps:
        return wanted_mps, air_mps
    spare_mps = math.sqrt(limit_mps * limit_mps - across_mps * across_mps)
    ground_mps = along_mps + spare_mps if wanted_mps > along_mps else along_mps - spare_mps
    return (TOO_STRONG, TOO_STRONG) if ground_mps < MIN_HEADWAY_MPS else (ground_mps, limit_mps)


@njit(cache=True, nogil=True)
def watts(table: FloatArray, phase: int, airspeed_mps: float, air_density: float) -> float:
    """What the table says between its rows and columns; beyond the last of them as there."""
    row = min(max((air_density - MIN_DENSITY) / DENSITY_STEP, 0.0), DENSITIES - 1.0)
    column = min(max(airspeed_mps / AIRSPEED_STEP_MPS, 0.0), AIRSPEEDS - 1.0)
    lower, left = min(int(row), DENSITIES - 2), min(int(column), AIRSPEEDS - 2)
    row, column = row - lower, column - left
    below = table[phase, lower, left] + column * (table[phase, lower, left + 1] - table[phase, lower, left])
    above = table[phase, lower + 1, left] + column * (table[phase, lower + 1, left + 1] - table[phase, lower + 1, left])
    return float(below + row * (above - below))


@njit(cache=True, nogil=True)
def _fill(table: FloatArray, climb_mps: float, rotors: Rotors) -> None:
    for row in range(DENSITIES):
        air_density = MIN_DENSITY + DENSITY_STEP * row
        for column in range(AIRSPEEDS):
            airspeed_mps = AIRSPEED_STEP_MPS * column
            for phase in range(2):
                table[phase, row, column] = _power_w(airspeed_mps, climb_mps if phase == CLIMBING else 0.0, air_density, rotors)


@njit(cache=True, nogil=True)
def _power_w(airspeed_mps: float, climb_mps: float, air_density: float, rotors: Rotors) -> float:
    weight_n, disk_m2, efficiency, avionics_w, drag_area_m2, rotor_drag = rotors
    climb_mps = max(climb_mps, 0.0)
    total_mps = math.hypot(airspeed_mps, climb_mps)
    drag_of_speed = 0.5 * air_density * drag_area_m2 * total_mps  # times the speed along an axis: newtons along it
    # The tilt at which drag in the rotors' plane is the weight's part in it: drag falls with the tilt and that part grows.
    low, high = -math.pi / 2.0, math.pi / 2.0
    thrust_n, axial_mps, plane_mps = weight_n, climb_mps, airspeed_mps
    for _ in range(40):
        tilt = 0.5 * (low + high)
        plane_mps = airspeed_mps * math.cos(tilt) - climb_mps * math.sin(tilt)
        axial_mps = airspeed_mps * math.sin(tilt) + climb_mps * math.cos(tilt)
        thrust_n = max(weight_n * math.cos(tilt) + ACROSS_ROTORS * drag_of_speed * axial_mps, 0.0)
        if weight_n * math.sin(tilt) < (rotor_drag * thrust_n + drag_of_speed) * plane_mps:
            low = tilt
        else:
            high = tilt
    if thrust_n <= 0.0:
        return avionics_w
    hover_mps = math.sqrt(thrust_n / (2.0 * air_density * disk_m2))  # through the disk, in still air
    low, high = 0.0, hover_mps
    for _ in range(40):
        induced_mps = 0.5 * (low + high)
        if induced_mps * math.hypot(plane_mps, axial_mps + induced_mps) < hover_mps * hover_mps:
            low = induced_mps
        else:
            high = induced_mps
    # Of a hover's power one share makes the inflow and the rest turns the blades, which forward flight does not save.
    inflow_share = min(1.0, INDUCED_FACTOR * efficiency / DRIVE_EFFICIENCY)
    lifting_w = thrust_n * (hover_mps * (1.0 - inflow_share) + induced_mps * inflow_share) / efficiency
    return float(avionics_w + lifting_w + thrust_n * axial_mps / DRIVE_EFFICIENCY)
