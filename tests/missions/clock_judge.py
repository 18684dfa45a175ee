"""Judges times, energy and separation of finished plans by arithmetic of its own, from the figures that the request states.

Rotors are one disk of momentum theory with Glauert's inflow, as the planner says that it counts them; the equations are solved here by
SciPy, leg by leg. Routes are kept apart if no two samples of them, a second apart, are near in space and time.
"""

import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.spatial import cKDTree

from missions.flight_plan.performance import Performance
from missions.services import PlanRequest
from tests.missions.plane import apart_m, east_north

CLIMB_MPS = 2.5
CLOCK_SHARE, CLOCK_S = 0.005, 2.0  # what times may differ by: another Earth, rounding to tenths
ENERGY_SHARE, ENERGY_WH = 0.01, 0.05
LATERAL_M, VERTICAL_M, TIME_S = 28.0, 13.5, 57.0  # of 30 m, 15 m and 60 s, less what lies between samples


def wrong_clocks(request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
    """Times or watt-hours that are not the route's, and batteries that do not last."""
    for uav, route in zip(request.uavs, plan["routes"], strict=True):
        if not route["waypoints"]:
            continue
        seconds, watt_hours = _flown(request, uav, route)
        told = [arrival_s - route["departs_s"] for arrival_s in route["arrival_s"]] + [route["duration_s"]]
        if any(abs(own - other) > CLOCK_SHARE * own + CLOCK_S for own, other in zip(seconds, told, strict=True)):
            yield f"{uav.name} takes {seconds[-1]:.0f} s, not {told[-1]:.0f} s"
        usable_wh = uav.performance.usable_wh
        if usable_wh is None:
            continue
        if abs(watt_hours - route["energy_wh"]) > ENERGY_SHARE * watt_hours + ENERGY_WH:
            yield f"{uav.name} takes {watt_hours:.2f} Wh, not {route['energy_wh']:.2f} Wh"
        if watt_hours > usable_wh * (1 + ENERGY_SHARE) + ENERGY_WH or route["energy_wh"] > usable_wh + 0.006:
            yield f"{uav.name} takes {watt_hours:.2f} Wh of {usable_wh:.2f} Wh"


def _flown(request: PlanRequest, uav: Any, route: dict[str, Any]) -> tuple[list[float], float]:
    """Seconds after take-off at each waypoint and in all, and watt-hours: each leg level first, then straight up or down."""
    points = route["waypoints"]
    lands = route["end_action"] != "hover"
    first, last = points[0], points[-1]
    steps = [(0.0, (0.0, 0.0), first["altitude_agl_m"] / 2, first["altitude_agl_m"], first)]
    for before, after in pairwise(points):
        way = east_north(before["position"], after["position"])
        middle_m = (before["altitude_agl_m"] + after["altitude_agl_m"]) / 2
        rise_m = after["altitude_relative_m"] - before["altitude_relative_m"]
        steps.append((apart_m(before["position"], after["position"]), way, middle_m, rise_m, after))
    if lands:
        steps.append((0.0, (0.0, 0.0), last["altitude_agl_m"] / 2, -last["altitude_agl_m"], last))
    now_s = joules = 0.0
    moments = []
    for number, (length_m, way, middle_m, rise_m, point) in enumerate(steps):
        wind = _wind(request, middle_m)
        density = _density(point["altitude_amsl_m"] or 0.0, request.conditions.temperature_c)
        if length_m > 0.01:
            ground_mps, air_mps = _speeds(uav, way, wind)
            now_s += length_m / ground_mps
            joules += length_m / ground_mps * _watts(uav.performance, air_mps, 0.0, density)
        climb_s = abs(rise_m) / CLIMB_MPS
        now_s += climb_s
        joules += climb_s * _watts(uav.performance, math.hypot(*wind), CLIMB_MPS if rise_m > 0 else 0.0, density)
        if number < len(points):
            moments.append(now_s)
            hold_s = (point["task"] or {}).get("hold_s", 0.0)
            now_s += hold_s
            joules += hold_s * _watts(uav.performance, math.hypot(*_wind(request, point["altitude_agl_m"])), 0.0, density)
    return [*moments, now_s], joules / 3_600.0


def _wind(request: PlanRequest, agl_m: float) -> tuple[float, float]:
    """To east and north, interpolated between the layers."""
    layers = request.conditions.wind
    if not layers:
        return 0.0, 0.0
    heights = [layer.agl_m for layer in layers]
    turned = [math.radians(layer.from_deg + 180.0) for layer in layers]
    east = [layer.speed_mps * math.sin(angle) for layer, angle in zip(layers, turned, strict=True)]
    north = [layer.speed_mps * math.cos(angle) for layer, angle in zip(layers, turned, strict=True)]
    return float(np.interp(agl_m, heights, east)), float(np.interp(agl_m, heights, north))


def _density(amsl_m: float, temperature_c: float) -> float:
    """ISO 2533's pressure, and the temperature on the ground."""
    return 101_325.0 * (1.0 - 0.0065 * amsl_m / 288.15) ** 5.25588 / (287.05287 * (temperature_c + 273.15))


def _speeds(uav: Any, way: tuple[float, float], wind: tuple[float, float]) -> tuple[float, float]:
    """Over ground and through the air: the wanted speed over ground, or what the airspeed's limit leaves of it."""
    length = math.hypot(*way)
    along = (way[0] * wind[0] + way[1] * wind[1]) / length
    across = (way[0] * wind[1] - way[1] * wind[0]) / length
    wanted, limit = uav.cruise_speed_mps, uav.performance.max_airspeed_mps
    air_mps = math.hypot(wanted - along, across)
    if limit is None or air_mps <= limit:
        return wanted, air_mps
    spare = math.sqrt(limit**2 - across**2)
    return (along + spare if wanted > along else along - spare), limit


def _watts(performance: Performance, air_mps: float, climb_mps: float, density: float) -> float:
    """To the nearest 0.1 m/s and 0.01 kg/m3."""
    return 0.0 if performance.battery_wh is None else _power_w(performance, round(air_mps, 1), climb_mps, round(density, 2))


@lru_cache(maxsize=50_000)
def _power_w(performance: Performance, air_mps: float, climb_mps: float, density: float) -> float:
    weight_n, drag_n_per_mps = performance.mass_kg * 9.80665, 0.5 * density * performance.drag_area_m2 * math.hypot(air_mps, climb_mps)

    def flow(tilt: float) -> tuple[float, float, float]:
        along_axis = air_mps * math.sin(tilt) + climb_mps * math.cos(tilt)
        in_plane = air_mps * math.cos(tilt) - climb_mps * math.sin(tilt)
        return along_axis, in_plane, weight_n * math.cos(tilt) + 2.0 * drag_n_per_mps * along_axis

    def pull(tilt: float) -> float:
        _axis, in_plane, thrust_n = flow(tilt)
        return weight_n * math.sin(tilt) - (performance.rotor_drag * thrust_n + drag_n_per_mps) * in_plane

    along_axis, in_plane, thrust_n = flow(brentq(pull, -1.5, 1.5))
    hover_mps = math.sqrt(thrust_n / (2.0 * density * performance.rotor_disk_m2))
    inflow_mps = brentq(lambda speed: speed * math.hypot(in_plane, along_axis + speed) - hover_mps**2, 0.0, hover_mps * 1.0001)
    efficiency = performance.hover_efficiency
    share = min(1.0, 1.15 * efficiency / 0.85)
    return performance.avionics_w + thrust_n * ((hover_mps * (1 - share) + inflow_mps * share) / efficiency + along_axis / 0.85)


def too_near(plan: dict[str, Any]) -> Iterator[str]:
    """UAVs that pass the same place at nearly the same time, though the plan says that all are kept apart."""
    if plan["separation"]["unresolved"]:
        return
    routes = [route for route in plan["routes"] if route["waypoints"]]
    for one, other in combinations(routes, 2):
        until_s = max(route["departs_s"] + route["duration_s"] for route in (one, other)) + TIME_S
        (first, first_s), (second, second_s) = (_samples(route, one["waypoints"][0]["position"], until_s) for route in (one, other))
        near = cKDTree(first[:, :2]).sparse_distance_matrix(cKDTree(second[:, :2]), LATERAL_M, output_type="coo_matrix")
        heights_m = np.abs(first[near.row, 2] - second[near.col, 2])
        apart_s = np.abs(first_s[near.row] - second_s[near.col])
        bad = (heights_m < VERTICAL_M) & (apart_s < TIME_S)
        if bad.any():
            place = int(np.flatnonzero(bad)[apart_s[bad].argmin()])
            yield f"{one['uav']} and {other['uav']} pass one place {apart_s[place]:.0f} s apart at {first_s[near.row[place]]:.0f} s"


def _samples(route: dict[str, Any], origin: Any, until_s: float) -> tuple[Any, Any]:
    """East, north, height [m] each second in the air, and the seconds; a UAV that hovers at its end stays. Unknown ground is flat."""
    points = route["waypoints"]
    is_known = all(point["altitude_amsl_m"] is not None for point in points)
    heights = [point["altitude_amsl_m"] if is_known else 0.0 for point in points]
    grounds = [heights[end] - points[end]["altitude_agl_m"] if is_known else 0.0 for end in (0, -1)]
    places = [east_north(origin, point["position"]) for point in points]
    leaves = [arrival_s + (point["task"] or {}).get("hold_s", 0.0) for arrival_s, point in zip(route["arrival_s"], points, strict=True)]
    ends_s = route["departs_s"] + route["duration_s"]
    knots = [(route["departs_s"], *places[0], grounds[0])]
    for place, height, arrival_s, leaves_s in zip(places, heights, route["arrival_s"], leaves, strict=True):
        knots += [(arrival_s, *place, height), (leaves_s, *place, height)]
    lands = route["end_action"] != "hover"
    knots.append((ends_s, *places[-1], grounds[1] if lands else heights[-1]))
    if not lands:
        knots.append((max(until_s, ends_s), *places[-1], heights[-1]))
    table = np.array(knots)
    moments = np.arange(table[0, 0], table[-1, 0] + 1.0)
    return np.column_stack([np.interp(moments, table[:, 0], table[:, column]) for column in (1, 2, 3)]), moments
