"""Wind, air and power for judges of plans, from the figures that a request states, without the program's own formulas.

Rotors are one disk of momentum theory with Glauert's inflow, as the planner says that it counts them; the equations are solved here by
SciPy.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.optimize import brentq

from missions.services import PlanRequest
from planning.energy.performance import Performance

CLIMB_MPS = 2.5
# Until it climbs; to a stand or from it, beside flying at its speed; until it stands; the last metres of a landing.
LIFTS_S, ACCELERATION_MPS2, SETTLES_S = 1.5, 2.0, 1.5
TOUCHES_S = 8.0 / 0.7 - 8.0 / CLIMB_MPS


def wind_mps(request: PlanRequest, agl_m: float) -> tuple[float, float]:
    """To east and north, interpolated between the layers."""
    layers = request.conditions.wind
    if not layers:
        return 0.0, 0.0
    heights = [layer.agl_m for layer in layers]
    turned = [math.radians(layer.from_deg + 180.0) for layer in layers]
    east = [layer.speed_mps * math.sin(angle) for layer, angle in zip(layers, turned, strict=True)]
    north = [layer.speed_mps * math.cos(angle) for layer, angle in zip(layers, turned, strict=True)]
    return float(np.interp(agl_m, heights, east)), float(np.interp(agl_m, heights, north))


def density(amsl_m: float, temperature_c: float) -> float:
    """ISO 2533's pressure, and the temperature on the ground."""
    return 101_325.0 * (1.0 - 0.0065 * amsl_m / 288.15) ** 5.25588 / (287.05287 * (temperature_c + 273.15))


def brakes_s(speed_mps: float) -> float:
    """Slowing down takes v / a for a way of v² / 2 a."""
    return 0.5 * speed_mps / ACCELERATION_MPS2


def limit_mps(uav: Any) -> float:
    """Of its speed through the air."""
    return float(uav.performance.max_airspeed_mps or uav.cruise_speed_mps)


def speeds_mps(
    uav: Any, way: tuple[float, float], wind: tuple[float, float], by_hand_mps: float | None = None
) -> tuple[float, float] | None:
    """Over ground and through the air: the wanted speed over ground, or what the airspeed's limit leaves of it; None for no headway."""
    length = math.hypot(*way)
    along = (way[0] * wind[0] + way[1] * wind[1]) / length
    across = (way[0] * wind[1] - way[1] * wind[0]) / length
    wanted, limit = uav.cruise_speed_mps if by_hand_mps is None else by_hand_mps, limit_mps(uav)
    air_mps = math.hypot(wanted - along, across)
    if air_mps <= limit:
        return wanted, air_mps
    if math.hypot(*wind) > limit:
        return None
    spare = math.sqrt(limit**2 - across**2)
    ground_mps = along + spare if wanted > along else along - spare
    return (ground_mps, limit) if ground_mps >= 0.5 else None


def watts(performance: Performance, air_mps: float, climb_mps: float, air_density: float) -> float:
    """To the nearest 0.1 m/s and 0.01 kg/m3; 0 without a battery."""
    return 0.0 if performance.battery_wh is None else _power_w(performance, round(air_mps, 1), climb_mps, round(air_density, 2))


@lru_cache(maxsize=50_000)
def _power_w(performance: Performance, air_mps: float, climb_mps: float, air_density: float) -> float:
    weight_n, drag_n_per_mps = (
        performance.mass_kg * 9.80665,
        0.5 * air_density * performance.body_drag_area_m2 * math.hypot(air_mps, climb_mps),
    )

    def flow(tilt: float) -> tuple[float, float, float]:
        along_axis = air_mps * math.sin(tilt) + climb_mps * math.cos(tilt)
        in_plane = air_mps * math.cos(tilt) - climb_mps * math.sin(tilt)
        return along_axis, in_plane, weight_n * math.cos(tilt) + 2.0 * drag_n_per_mps * along_axis

    def pull(tilt: float) -> float:
        _axis, in_plane, thrust_n = flow(tilt)
        return weight_n * math.sin(tilt) - (performance.disk_drag * thrust_n + drag_n_per_mps) * in_plane

    along_axis, in_plane, thrust_n = flow(brentq(pull, -1.5, 1.5))
    hover_mps = math.sqrt(thrust_n / (2.0 * air_density * performance.rotor_disk_m2))
    inflow_mps = brentq(lambda speed: speed * math.hypot(in_plane, along_axis + speed) - hover_mps**2, 0.0, hover_mps * 1.0001)
    efficiency = performance.hover_efficiency
    share = min(1.0, 1.15 * efficiency / 0.85)
    return performance.avionics_w + thrust_n * ((hover_mps * (1 - share) + inflow_mps * share) / efficiency + along_axis / 0.85)
