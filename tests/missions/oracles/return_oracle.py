"""Judges what a plan says of UAVs that lose their link: from which waypoints the straight way to a return point would not go well.

What lies within the tolerances of two ways to count it is not judged; what does not has to be told, and nothing else may be.
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from datetime import timedelta
from typing import Any

import numpy as np

from missions.services import PlanRequest
from tests.missions.air import CLIMB_MPS, SETTLES_S, TOUCHES_S, brakes_s, density, speeds_mps, watts, wind_mps
from tests.missions.oracles.terrain_oracle import CLEARANCE_M, Hills, along
from tests.missions.oracles.wire_oracle import WireJudge
from tests.missions.oracles.zone_oracle import Leg, Margins, ZoneJudge
from tests.missions.plane import apart_m, east_north

TRANSIT_M, MAX_HEIGHT_M = 60.0, 120.0
CLEARLY_M = 1.5
LESS, MORE = Margins(11.3, 18.4, 290.0), Margins(13.2, 21.6, 820.0)  # the sun counts as 4 min uncertain
SHARE, WH = 0.015, 0.1


class ReturnJudge:
    def __init__(self, zones: ZoneJudge, hills: Hills | None, wires: WireJudge) -> None:
        self.zones, self.hills, self.wires = zones, hills, wires
        self.seen = 0  # failures that were told, and are true

    def faults(self, request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
        wished, reported = request.lost_link, plan["lost_link"]
        if wished.behaviour == "go_on":
            if reported["failed"]:
                yield "a UAV that goes on is said to fail to return"
            return
        failed: dict[tuple[int, int], list[dict[str, Any]]] = defaultdict(list)
        for item in reported["failed"]:
            failed[item["route"], item["waypoint"]].append(item)
        for number, (uav, route) in enumerate(zip(request.uavs, plan["routes"], strict=True)):
            for place in range(len(route["waypoints"])):
                own = failed.pop((number, place), [])
                before = self.seen
                for fault in self._wrong(request, uav, route, place, own):
                    yield f"{uav.name} without a link at waypoint {place}: {fault}"
                self.seen = before + len(own)
        if failed:
            yield f"returns from nowhere: {sorted(failed)}"

    def _wrong(self, request: PlanRequest, uav: Any, route: dict[str, Any], place: int, reported: list[dict[str, Any]]) -> Iterator[str]:
        point = route["waypoints"][place]
        if point["kind"] == "base":
            if reported:
                yield f"it stands on the ground, and is said to fail: {reported}"
            return
        here = point["position"]
        return_points = [route["waypoints"][0]["position"], *request.lost_link.rally_points]
        metres = [apart_m(here, return_point) for return_point in return_points]
        return_point = int(np.argmin(metres))
        if sorted(metres)[:2][-1] < 1.01 * metres[return_point] + 1.0 and len(metres) > 1:
            return  # either may be the nearest
        if any(item["return_point"] != return_point for item in reported):
            yield f"the nearest return point is {return_point}, not {reported}"
            return
        under, _shares = along(here, return_points[return_point])
        is_known = point["altitude_amsl_m"] is not None and self.hills is not None
        ground_m = self.hills.metres(under) if is_known and self.hills is not None else np.zeros(len(under))
        least_m, most_m = self._levels_m(here, return_points[return_point], ground_m, point["altitude_agl_m"])
        troubles = {item["trouble"] for item in reported}
        is_too_high = bool(troubles & {"too_high", "obstacle"})
        if least_m - ground_m.min() > MAX_HEIGHT_M + CLEARLY_M and not is_too_high:
            yield f"it would fly {least_m - ground_m.min():.0f} m above ground"
        if most_m - ground_m.min() < MAX_HEIGHT_M - CLEARLY_M and is_too_high:
            yield f"it would fly no more than {most_m - ground_m.min():.0f} m above ground"
        taken = [
            self._taken(request, uav, point, return_points[return_point], ground_m, level_m, is_known) for level_m in (least_m, most_m)
        ]
        if None in taken or "wind" in troubles:
            if all(one is None for one in taken) != ("wind" in troubles):
                yield f"the wind is judged otherwise: {taken}"
            return
        yield from self._wrong_battery(uav, route, place, reported, taken)
        yield from self._wrong_zones(
            request, route, place, return_points[return_point], reported, (ground_m, least_m, most_m, is_known), taken
        )

    def _levels_m(self, here: Any, return_point: Any, ground_m: Any, agl_m: float) -> tuple[float, float]:
        """The height above the sea of the way, at least and at most: nobody knows to the metre what stands beside it."""
        least_m = max(float(ground_m[0]) + agl_m, float(ground_m.max()) + TRANSIT_M)
        near_m, far_m = (self.wires.highest_m(here, return_point, beside_m, least_m - CLEARANCE_M) for beside_m in (20.0, 100.0))
        return max(least_m, near_m + CLEARANCE_M), max(least_m, far_m + CLEARANCE_M)

    def _taken(
        self, request: PlanRequest, uav: Any, point: dict[str, Any], return_point: Any, ground_m: Any, level_m: float, is_known: bool
    ) -> tuple[list[float], float] | None:
        """Seconds until it has stayed and climbed, is over the return point, has landed; and Wh. None where the wind is too strong."""
        stays_s = (request.lost_link.hold_s if request.lost_link.behaviour == "hold" else 0.0) + (point["task"] or {}).get("hold_s", 0.0)
        stays_s += 2.0 * brakes_s(uav.cruise_speed_mps) + SETTLES_S
        agl_m, here_m = point["altitude_agl_m"], float(ground_m[0]) + point["altitude_agl_m"]
        air_here, air = (density(height_m if is_known else 0.0, request.conditions.temperature_c) for height_m in (here_m, level_m))
        up_agl_m, down_m = level_m - float(ground_m[0]), level_m - float(ground_m[-1])

        def power(at_m: float, climb_mps: float, air_density: float) -> float:
            return watts(uav.performance, math.hypot(*wind_mps(request, at_m)), climb_mps, air_density)

        up_s, down_s = (level_m - here_m) / CLIMB_MPS, down_m / CLIMB_MPS + brakes_s(uav.cruise_speed_mps) + SETTLES_S + TOUCHES_S
        joules = stays_s * power(agl_m, 0.0, air_here) + up_s * power((agl_m + up_agl_m) / 2, CLIMB_MPS, air_here)
        joules += down_s * power(down_m / 2, 0.0, air)
        length_m = apart_m(point["position"], return_point)
        across = [(0.0, 0.0)]
        limit_mps = uav.performance.max_airspeed_mps or uav.cruise_speed_mps
        heights = [agl_m, up_agl_m, level_m - float(ground_m.min()), level_m - float(ground_m.max()), down_m, *np.linspace(0.0, down_m, 7)]
        if any(math.hypot(*wind_mps(request, height_m)) > limit_mps for height_m in heights):
            return None
        if length_m > 0.01:
            across = []
            for height_m in (level_m - float(ground_m.min()), level_m - float(ground_m.max())):
                flown = speeds_mps(uav, east_north(point["position"], return_point), wind_mps(request, height_m))
                if flown is None:
                    return None
                across.append((length_m / flown[0], length_m / flown[0] * watts(uav.performance, flown[1], 0.0, air)))
        over_s, over_j = max(across, key=lambda one: one[::-1])
        return list(np.cumsum([stays_s + up_s, over_s, down_s])), (joules + over_j) / 3_600.0

    def _wrong_battery(
        self, uav: Any, route: dict[str, Any], place: int, reported: list[dict[str, Any]], taken: list[Any]
    ) -> Iterator[str]:
        battery = [item for item in reported if item["trouble"] == "battery"]
        battery_wh = uav.performance.battery_wh
        if battery_wh is None:
            if battery:
                yield "it has no battery that could not do"
            return
        if any(stop["waypoint"] == place for stop in route["charging"]):
            return  # before it has charged, or after
        spare_wh = battery_wh * (route["battery_left_percent"][place] - uav.performance.reserve_percent) / 100.0
        give_wh = WH + SHARE * battery_wh
        least_wh, most_wh = sorted(wh for _seconds, wh in taken)  # higher up the wind may help
        if least_wh - spare_wh > give_wh and not battery:
            yield f"it needs {least_wh:.2f} Wh of {spare_wh:.2f} Wh"
        if battery and most_wh - spare_wh < -give_wh:
            yield f"it needs no more than {most_wh:.2f} Wh of {spare_wh:.2f} Wh"
        elif battery and not least_wh - spare_wh - give_wh <= battery[0]["missing_wh"] <= most_wh - spare_wh + give_wh:
            yield f"it lacks {least_wh - spare_wh:.2f} Wh, not {battery[0]['missing_wh']} Wh"

    def _wrong_zones(
        self,
        request: PlanRequest,
        route: dict[str, Any],
        place: int,
        return_point: Any,
        reported: list[dict[str, Any]],
        over: Any,
        taken: list[Any],
    ) -> Iterator[str]:
        ground_m, least_m, most_m, is_known = over
        stated = {item["zone"] for item in reported if item["trouble"] == "zone"}
        legs = [
            self._legs(request, route, place, return_point, ground_m, level_m, is_known, seconds)
            for level_m, (seconds, _wh) in zip((least_m, most_m), taken, strict=True)
        ]
        met = [{zone.name for _, zone in self.zones.met(of_level, LESS)} for of_level in legs]
        surely = met[0] & met[1]
        if surely - stated:
            yield f"it meets {sorted(surely - stated)}"
        wide = [
            one._replace(agl_m=_both(one.agl_m, other.agl_m), amsl_m=one.amsl_m and other.amsl_m and _both(one.amsl_m, other.amsl_m))
            for one, other in zip(*legs, strict=True)
        ]
        perhaps = {zone.name for _, zone in self.zones.met(wide, MORE)}
        if stated - perhaps:
            yield f"it does not meet {sorted(stated - perhaps)}"

    def _legs(
        self,
        request: PlanRequest,
        route: dict[str, Any],
        place: int,
        return_point: Any,
        ground_m: Any,
        level_m: float,
        is_known: bool,
        seconds: Any,
    ) -> list[Leg]:
        point = route["waypoints"][place]
        here, agl_m = tuple(point["position"]), point["altitude_agl_m"]
        heights = [
            (agl_m, level_m - float(ground_m[0])),
            (level_m - float(ground_m.max()), level_m - float(ground_m.min())),
            (0.0, level_m - float(ground_m[-1])),
        ]
        above_sea: list[Any] = [None] * 3
        if is_known:
            above_sea = [(float(ground_m[0]) + agl_m, level_m), (level_m, level_m), (float(ground_m[-1]), level_m)]
        times: list[Any] = [None] * 3
        if request.departs_at is not None:
            moments = [request.departs_at + timedelta(seconds=route["arrival_s"][place] + after_s) for after_s in (0.0, *seconds)]
            times = [tuple(moments[leg : leg + 2]) for leg in range(3)]
        ends = [(here, here), (here, tuple(return_point)), (tuple(return_point), tuple(return_point))]
        return [Leg(*end, agl, amsl, when) for end, agl, amsl, when in zip(ends, heights, above_sea, times, strict=True)]


def _both(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    return min(one[0], other[0]), max(one[1], other[1])
