"""Judges times and energy of finished plans by arithmetic of its own, leg by leg, flight by flight, from the figures of the request.

Between two flights a UAV stands on the ground with its turnaround, and gets a full battery; at a stop to charge it comes down to the tower,
charges, and rises again.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from inspection.models import Asset
from missions.services import PlanRequest
from tests.missions.air import CLIMB_MPS, LIFTS_S, SETTLES_S, TOUCHES_S, brakes_s, density, speeds_mps, watts, wind_mps
from tests.missions.oracles.turn_oracle import turns_s
from tests.missions.plane import apart_m, east_north

CLOCK_SHARE, CLOCK_S = 0.005, 2.0  # what times may differ by: another Earth, rounding to tenths
ENERGY_SHARE, ENERGY_WH = 0.01, 0.05
TURNAROUND_S = 600.0
UNTAGGED_TOWER_M = 45.0
HIGHEST_VOLTAGE_V, HIGHEST_VOLTAGE_TOWER_M = 300_000, 60.0  # towers of such lines, where no height is tagged
USUAL_SPEED_MPS = 12.0  # at which it is reckoned to come to a tower where it charges, and to leave it
DOWN_ON_TOWER_S = brakes_s(USUAL_SPEED_MPS) + SETTLES_S + TOUCHES_S  # beside the way down
OFF_TOWER_S = LIFTS_S + brakes_s(USUAL_SPEED_MPS)


@dataclass
class Clock:
    """What a route takes as the judge counts it. `left_wh` tells of all moments at which the battery may be lowest, `full_wh` fullest."""

    arrival_s: list[float] = field(default_factory=list)
    used_wh: list[float] = field(default_factory=list)
    charged_wh: list[float] = field(default_factory=list)  # by each waypoint, in this flight
    flights_wh: list[float] = field(default_factory=list)
    left_wh: list[float] = field(default_factory=list)
    full_wh: list[float] = field(default_factory=list)
    total_s: float = 0.0
    turning_s: float = 0.0  # of total_s: what turns of the course take beside the legs
    hover_w: float = 0.0  # at the end


def wrong_clocks(request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
    """Times or watt-hours that are not the route's, batteries that do not last, flights and stops to charge that are none."""
    for uav, route in zip(request.uavs, plan["routes"], strict=True):
        if not route["waypoints"]:
            continue
        yield from (f"{uav.name} {fault}" for fault in (*_wrong_flights(uav, route), *_wrong_stops(request, uav, route)))
        clock = clock_of(request, uav, route)
        reported = [arrival_s - route["departs_s"] for arrival_s in route["arrival_s"]] + [route["duration_s"]]
        own = [*clock.arrival_s, clock.total_s]
        if len(reported) != len(own) or any(
            abs(mine - other) > CLOCK_SHARE * mine + CLOCK_S for mine, other in zip(own, reported, strict=True)
        ):
            yield f"{uav.name} takes {own[-1]:.0f} s, not {reported[-1]:.0f} s"
        yield from (f"{uav.name} {fault}" for fault in _wrong_energy(uav, route, clock))


def _wrong_energy(uav: Any, route: dict[str, Any], clock: Clock) -> Iterator[str]:
    battery_wh, usable_wh = uav.performance.battery_wh, uav.performance.usable_wh
    if battery_wh is None:
        return
    watt_hours = sum(clock.flights_wh)
    if abs(watt_hours - route["energy_wh"]) > ENERGY_SHARE * watt_hours + ENERGY_WH:
        yield f"takes {watt_hours:.2f} Wh, not {route['energy_wh']:.2f} Wh"
    if any(abs(own - reported) > ENERGY_SHARE * own + ENERGY_WH for own, reported in zip(clock.used_wh, route["used_wh"], strict=True)):
        yield "has not used what is told at a waypoint"
    reserve_wh = battery_wh - usable_wh
    give_wh = ENERGY_SHARE * max(clock.flights_wh) + ENERGY_WH
    if min(clock.left_wh) < reserve_wh - give_wh:
        yield f"has {min(clock.left_wh):.2f} Wh left, below its reserve of {reserve_wh:.2f} Wh"
    if max(clock.full_wh) > battery_wh + give_wh:
        yield f"has {max(clock.full_wh):.2f} Wh in a battery of {battery_wh:.2f} Wh"
    percents = [*route["battery_left_percent"], route["battery_percent"]]
    if min(percents) < uav.performance.reserve_percent - 0.06 or max(percents) > 100.0:
        yield f"is said to have {min(percents)} to {max(percents)} % left"
    for used_wh, charged_wh, percent in zip(route["used_wh"], clock.charged_wh, route["battery_left_percent"], strict=True):
        if abs(100.0 - 100.0 * (used_wh - charged_wh) / battery_wh - percent) > 0.06 + (1.0 + 0.6 * len(route["charging"])) / battery_wh:
            yield f"is said to have {percent} % left after {used_wh} Wh"
            return


def _wrong_flights(uav: Any, route: dict[str, Any]) -> Iterator[str]:
    """Flights that do not begin and end at home, on the ground, for the turnaround."""
    points = route["waypoints"]
    stops = [place for place, point in enumerate(points) if point["kind"] == "base"]
    if len(stops) + 1 > uav.sorties:
        yield f"makes {len(stops) + 1} flights of {uav.sorties}"
    for stop in stops:
        if any(apart_m(points[place]["position"], uav.position) > 1.0 for place in (stop - 1, stop, stop + 1)):
            yield "lands between its flights elsewhere than at home"
        if points[stop]["altitude_agl_m"] != 0.0 or abs((points[stop]["task"] or {}).get("hold_s", 0.0) - TURNAROUND_S) > 0.1:
            yield "does not stand on the ground for its turnaround"
        if route["arrival_s"][stop + 1] - route["arrival_s"][stop] < TURNAROUND_S:
            yield f"takes off {route['arrival_s'][stop + 1] - route['arrival_s'][stop]:.0f} s after it has landed"


def _wrong_stops(request: PlanRequest, uav: Any, route: dict[str, Any]) -> Iterator[str]:
    """Stops that are not at towers, or do not give what they say in the time that they take."""
    if route["charging"] and request.charging_w is None:
        yield "charges, though that is not wished"
        return
    for stop in route["charging"]:
        point = route["waypoints"][stop["waypoint"]]
        tower = Asset.objects.filter(pk=point["asset"], kind="tower").first()
        if tower is None or apart_m(point["position"], tower.centre.coords) > 3.0:
            yield f"charges where no tower is, at waypoint {stop['waypoint']}"
            continue
        given_wh = stop["charging_s"] * (request.charging_w - uav.performance.avionics_w) / 3_600.0
        if abs(given_wh - stop["charged_wh"]) > 0.01 * given_wh + 0.02:
            yield f"gets {given_wh:.2f} Wh at a tower, not {stop['charged_wh']:.2f} Wh"
        way_s = 2.0 * (point["altitude_agl_m"] - tower_top_m(point)) / CLIMB_MPS + DOWN_ON_TOWER_S + OFF_TOWER_S
        if abs(stop["charging_s"] + way_s - stop["stopped_s"]) > 0.3:
            yield f"stops for {stop['stopped_s']:.0f} s at a tower, not {stop['charging_s'] + way_s:.0f} s"


def tower_top_m(point: dict[str, Any]) -> float:
    """How high above ground a UAV stands that charges under this waypoint."""
    return min(_height_m(Asset.objects.filter(pk=point["asset"]).first()), float(point["altitude_agl_m"]))


def _height_m(tower: Asset | None) -> float:
    """Return the height as tagged, or else that of the tallest line on the tower."""
    if tower is not None and tower.height_m is not None:
        return float(tower.height_m)
    heights_m = [UNTAGGED_TOWER_M]
    if tower is not None and tower.osm_id is not None:
        lines = Asset.objects.filter(kind="line", is_flyable=True, vanished_at=None, node_osm_ids__contains=[tower.osm_id])
        for height_m, voltage_v in lines.values_list("height_m", "max_voltage_v"):
            is_highest = voltage_v is not None and voltage_v >= HIGHEST_VOLTAGE_V
            heights_m.append(height_m or (HIGHEST_VOLTAGE_TOWER_M if is_highest else UNTAGGED_TOWER_M))
    return max(heights_m)


def clock_of(request: PlanRequest, uav: Any, route: dict[str, Any]) -> Clock:
    """Seconds after take-off at each waypoint and in all, and watt-hours: each leg straight; each turn; and each stop."""
    points = route["waypoints"]
    stops = [place for place, point in enumerate(points) if point["kind"] == "base"]
    charging = {stop["waypoint"]: stop for stop in route["charging"]}
    clock = Clock()
    for number, (begin, end) in enumerate(zip([0, *(stop + 1 for stop in stops)], [*stops, len(points)], strict=True)):
        _fly(request, uav, points, range(begin, end), charging, clock, lands=number < len(stops) or route["end_action"] != "hover")
        if number < len(stops):
            clock.arrival_s.append(clock.total_s)
            clock.used_wh.append(clock.flights_wh[-1])
            clock.charged_wh.append(0.0)
            clock.total_s += TURNAROUND_S
    return clock


def _fly(
    request: PlanRequest, uav: Any, points: list[dict[str, Any]], places: range, charging: dict[int, Any], clock: Clock, *, lands: bool
) -> None:
    """One flight, on a full battery."""
    performance = uav.performance
    battery_wh = performance.battery_wh or math.inf
    first, last = points[places[0]], points[places[-1]]
    steps = [(0.0, (0.0, 0.0), first["altitude_agl_m"] / 2, first["altitude_agl_m"], first)]
    for before, after in pairwise([points[place] for place in places]):
        way = east_north(before["position"], after["position"])
        middle_m = (before["altitude_agl_m"] + after["altitude_agl_m"]) / 2
        rise_m = after["altitude_relative_m"] - before["altitude_relative_m"]
        steps.append((apart_m(before["position"], after["position"]), way, middle_m, rise_m, after))
    if lands:
        steps.append((0.0, (0.0, 0.0), last["altitude_agl_m"] / 2, -last["altitude_agl_m"], last))
    legs = steps[1 : len(places)]
    stands = [number == 0 or (points[place]["task"] or {}).get("hold_s", 0.0) > 0.0 for number, place in enumerate(places)]
    stands[-1] = stands[-1] or lands
    ways = [(way[0], way[1], rise_m) for _length_m, way, _middle_m, rise_m, _point in legs]
    turning_s = [0.0, *turns_s(ways, [_leg_s(request, uav, leg) for leg in legs], stands, brakes_s(uav.cruise_speed_mps)), 0.0]
    clock.turning_s += sum(turning_s)
    now_s, joules, charged_wh = clock.total_s, 0.0, 0.0

    def spend(seconds: float, air_mps: float, climb_mps: float, air_density: float) -> None:
        nonlocal now_s, joules
        now_s += seconds
        joules += seconds * watts(performance, air_mps, climb_mps, air_density)

    for number, (length_m, way, middle_m, rise_m, point) in enumerate(steps):
        wind = wind_mps(request, middle_m)
        air = density(point["altitude_amsl_m"] or 0.0, request.conditions.temperature_c)
        # A leg is straight: where the rise takes longer than the way, the UAV flies slower along it.
        rise_s, lift_mps = abs(rise_m) / CLIMB_MPS, CLIMB_MPS if rise_m > 0.0 else 0.0
        if length_m > 0.01:
            flown = speeds_mps(uav, way, wind, point.get("speed_mps"))
            ground_mps, air_mps = flown or (1e-6, 0.0)  # no headway: it takes for ever, and the clock is seen to be wrong
            level_s = length_m / ground_mps
            if rise_s > level_s:
                slow = length_m / rise_s / math.hypot(*way)
                air_mps = math.hypot(slow * way[0] - wind[0], slow * way[1] - wind[1])
            spend(rise_s, air_mps, lift_mps, air)
            spend(max(level_s - rise_s, 0.0), air_mps, 0.0, air)
        else:
            spend(rise_s, math.hypot(*wind), lift_mps, air)
        hold_s, here_mps = (point["task"] or {}).get("hold_s", 0.0), math.hypot(*wind_mps(request, point["altitude_agl_m"]))
        spend(turning_s[number], here_mps, 0.0, air)
        if number == 0:
            spend(LIFTS_S + brakes_s(uav.cruise_speed_mps), math.hypot(*wind), 0.0, air)
        if number == len(places):
            spend(brakes_s(uav.cruise_speed_mps) + SETTLES_S + TOUCHES_S, math.hypot(*wind), 0.0, air)
        elif hold_s > 0.0:
            spend(brakes_s(uav.cruise_speed_mps), here_mps, 0.0, air)
        clock.left_wh.append(battery_wh - joules / 3_600.0 + charged_wh)
        if number < len(places):
            clock.arrival_s.append(now_s)
            clock.used_wh.append(joules / 3_600.0)
            clock.charged_wh.append(charged_wh)
            stop = charging.get(places[number])
            if stop is not None:
                agl_m, top_m = point["altitude_agl_m"], tower_top_m(point)
                column = math.hypot(*wind_mps(request, (agl_m + top_m) / 2))
                spend((agl_m - top_m) / CLIMB_MPS + DOWN_ON_TOWER_S, column, 0.0, air)
                clock.left_wh.append(battery_wh - joules / 3_600.0 + charged_wh)
                now_s += stop["charging_s"]
                charged_wh += stop["charged_wh"]
                clock.full_wh.append(battery_wh - joules / 3_600.0 + charged_wh)
                spend((agl_m - top_m) / CLIMB_MPS, column, CLIMB_MPS, air)
                spend(OFF_TOWER_S, column, 0.0, air)
            if hold_s > 0.0:
                spend(SETTLES_S + hold_s + brakes_s(uav.cruise_speed_mps), here_mps, 0.0, air)
    clock.left_wh.append(battery_wh - joules / 3_600.0 + charged_wh)
    clock.full_wh.append(battery_wh)
    clock.flights_wh.append(joules / 3_600.0)
    clock.total_s = now_s
    clock.hover_w = watts(
        performance,
        math.hypot(*wind_mps(request, last["altitude_agl_m"])),
        0.0,
        density(last["altitude_amsl_m"] or 0.0, request.conditions.temperature_c),
    )


def _leg_s(request: PlanRequest, uav: Any, step: tuple[float, tuple[float, float], float, float, dict[str, Any]]) -> float:
    """Seconds of one leg at one speed: the longer of its way and its rise."""
    length_m, way, middle_m, rise_m, point = step
    if length_m <= 0.01:
        return abs(rise_m) / CLIMB_MPS
    flown = speeds_mps(uav, way, wind_mps(request, middle_m), point.get("speed_mps"))
    return max(length_m / flown[0], abs(rise_m) / CLIMB_MPS) if flown else math.inf


def stays_s(request: PlanRequest, uav: Any, route: dict[str, Any]) -> float:
    """How long after its take-off a UAV is in the air: who hovers at the end does so as long as the battery lasts, at most 4 h in all."""
    if route["end_action"] != "hover":
        return float(route["duration_s"])
    longest_s = 4 * 3_600.0
    if uav.performance.battery_wh is not None:
        clock = clock_of(request, uav, route)
        longest_s = min(longest_s, clock.total_s + 3_600.0 * max(clock.left_wh[-1], 0.0) / clock.hover_w)
    return float(max(route["duration_s"], longest_s))
