"""Judges whether what a plan leaves out can truly not be done: by zones, by what a straight flight would take at most, and by flying it.

A way that the planner finds cheaper, along infrastructure, may be up to twice as long as the straight one.
"""

import math
from collections.abc import Collection, Iterator
from dataclasses import replace
from datetime import timedelta
from typing import Any

import numpy as np
import shapely
from django.contrib.gis.geos import GEOSGeometry, Polygon

from inspection.models import Asset
from missions.services import PlanRequest
from planning.problem import Priority
from tests.missions.air import CLIMB_MPS, density, limit_mps, speeds_mps, watts, wind_mps
from tests.missions.oracles.terrain_oracle import TALLEST_M, TallThings
from tests.missions.oracles.zone_oracle import WIDER, ZoneJudge
from tests.missions.plane import apart_m

DIRECT_M = 4_900.0  # of the 5 km that a UAV may fly straight
ACCESS_M = 9_800.0  # of the 10 km that it may fly to the network
OFF_NETWORK_FACTOR = 2.0  # what a metre away from infrastructure costs
MAX_FLIGHT_S = 4 * 3_600.0
MAX_AGL_M = 120.0
STAYS_S = 100.0  # more than any task of these missions takes, with taking off, stopping and landing
REASONS = {"inside_zone", "beyond_range", "beyond_energy", "above_height_limit", "too_far_from_network", "no_path", "wind"}
OF_WAYS = {"no_path", "wind", "beyond_range", "beyond_energy", "too_far_from_network"}
NO_NUMBER = {"in_range_alone", "in_reach_alone"}  # beside others nothing is missing that has one number


class RefusalJudge:
    def __init__(self, zones: ZoneJudge, tall: TallThings, steepest: float) -> None:
        self.zones, self.tall, self.steepest = zones, tall, steepest
        self._free_towers: dict[tuple[float, float], bool] = {}

    def untrue(self, request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
        grounded = {warning["uav"]: warning["message"] for warning in plan["warnings"] if warning["code"] == "uav_inside_zone"}
        for uav, message in grounded.items():
            if not self._is_barred(shapely.Point(request.uavs[uav].position), request, message):
                yield f"{request.uavs[uav].name} stands in no zone: {message}"
        for item in plan["unassigned"]:
            course = course_of(request, item["target"])
            yield from (f"target {item['target']} is not {item['reason']}: {why}" for why in self._untrue_reason(request, item, course))
            if item["reason"] in OF_WAYS and course.geom_type == "Point":
                yield from self._could_be_done(request, plan, course, item, grounded)

    def _untrue_reason(self, request: PlanRequest, item: dict[str, Any], course: Any) -> Iterator[str]:
        reason, message = item["reason"], item["message"]
        if reason == "inside_zone" and not self._is_barred(course, request, message):
            yield f"no zone is there: {message}"
        elif reason == "beyond_range" and all(uav.max_range_m is None for uav in request.uavs):
            yield "no UAV has a range"
        elif reason == "above_height_limit" and max(_tallest_m(request, item["target"]), self.tall.tallest_m(course)) <= TALLEST_M:
            yield "it is not that tall"
        elif reason == "too_far_from_network" and course.geom_type == "Point" and self._network_near(course):
            yield "there is a free tower near it"
        elif reason == "beyond_energy" and all(uav.performance.battery_wh is None for uav in request.uavs):
            yield "no UAV has a battery"
        elif reason not in REASONS:
            yield "that is no reason here"
        is_reported = missing(item) is not None or item["why"][0]["code"] in NO_NUMBER
        if reason in {"beyond_range", "beyond_energy"} and not is_reported:
            yield f"it does not say what is missing: {message}"
        if missing(item) is not None and not any(_is_so_long(item, uav) for uav in request.uavs):
            yield f"that are not the minutes of any UAV: {message}"

    def _bars(self, course: Any, request: PlanRequest) -> bool:
        """Whether a zone that a flight could meet there lies within its clearance, at some time of the flight."""
        begin = request.departs_at
        is_alone = len(request.uavs) == 1 and request.organisation is None
        longest_s = MAX_FLIGHT_S if is_alone else 2.0 * MAX_FLIGHT_S  # who is put off until others have landed comes so late
        return any(
            self.zones.is_at_height(self.zones.zones[zone], (0.0, MAX_AGL_M), None, WIDER)
            and (begin is None or self.zones.applies_between(zone, begin, begin + timedelta(seconds=longest_s), WIDER))
            for zone in self.zones.lie_near(course, WIDER.lateral_m)
        )

    def _is_barred(self, course: Any, request: PlanRequest, message: str) -> bool:
        """By a zone, or by what cannot be flown over, where that is said."""
        return ("mast" in message and self._is_at_what_is_too_tall(course)) or self._bars(course, request)

    def _is_at_what_is_too_tall(self, course: Any) -> bool:
        """Whether a mast stands there that cannot be flown over, or wires hang there that may hang too high."""
        near = {"geometry__dwithin": (GEOSGeometry(course.wkt, srid=4326), 0.0005), "vanished_at": None}
        lines = Asset.objects.filter(kind__in=["line", "railway"], **near)
        towers = self.tall.beside(course.coords[0], course.coords[-1], 30.0)
        return lines.exists() or any(self.tall.heights[tower] > TALLEST_M for tower in towers)

    def _network_near(self, course: Any) -> bool:
        """Whether a tower outside all zones stands near enough to fly from."""
        lon, lat = course.x, course.y
        if (lon, lat) not in self._free_towers:
            wide = 0.15
            towers = Asset.objects.filter(
                kind="tower", is_flyable=True, vanished_at=None, line__isnull=False, height_m=None,
                centre__within=Polygon.from_bbox((lon - wide, lat - wide, lon + wide, lat + wide)),
            ).values_list("centre", flat=True)[:500]  # fmt: skip
            places = self.zones.metres(np.array([tower.coords for tower in towers]).reshape(-1, 2))
            free = np.ones(len(places), dtype=bool)
            free[self.zones.tree.query(shapely.points(places), predicate="dwithin", distance=24.0)[0]] = False
            away_m = np.hypot(*(places - self.zones.metres((lon, lat))).T)
            self._free_towers[lon, lat] = bool((away_m[free] < ACCESS_M).any())
        return self._free_towers[lon, lat]

    def _could_be_done(
        self, request: PlanRequest, plan: dict[str, Any], course: Any, item: dict[str, Any], grounded: Collection[int]
    ) -> Iterator[str]:
        """A UAV with nothing to do, or a flight to spare, could fly there straight, free of all zones, and back where it has to."""
        place = np.array([course.x, course.y])
        for number, (uav, route) in enumerate(zip(request.uavs, plan["routes"], strict=True)):
            returns = request.end_action(number) == "return"
            flights = sum(point["kind"] == "base" for point in route["waypoints"]) + bool(route["waypoints"])
            is_free = not flights or (returns and flights < uav.sorties)
            if not is_free or number in grounded or request.end_action(number) == "base":
                continue
            start = np.array(uav.position)
            way_m = apart_m(start, place)
            needed_m = way_m * (2.0 if returns else 1.0)
            if way_m > DIRECT_M or (uav.max_range_m is not None and needed_m * OFF_NETWORK_FACTOR * 1.005 > uav.max_range_m):
                continue
            needed_wh = self._most_wh(request, uav, start, place, needed_m)
            usable_wh = uav.performance.usable_wh
            if needed_wh is None or (usable_wh is not None and needed_wh > usable_wh):
                continue
            if not len(self.zones.lie_near(shapely.LineString([start, place]), 10.0)):
                figures = f"{way_m:.0f} m, {needed_wh:.1f} Wh"
                yield f"target {item['target']} is not {item['reason']}: {uav.name} could fly there straight, {figures}"

    def _most_wh(self, request: PlanRequest, uav: Any, start: Any, place: Any, needed_m: float) -> float | None:
        """What such a flight takes at most, whatever its course and height; None where the wind may be too strong for one of them."""
        limit_mps = uav.performance.max_airspeed_mps or uav.cruise_speed_mps
        winds = [wind_mps(request, height_m) for height_m in np.linspace(0.0, MAX_AGL_M, 13)]
        if max(math.hypot(*wind) for wind in winds) > limit_mps - 1.0:
            return None
        if uav.performance.battery_wh is None:
            return 0.0
        airs = [density(height_m, request.conditions.temperature_c) for height_m in (0.0, 700.0)]
        worst_j_per_m = worst_w = 0.0
        for wind in {(round(east, 2), round(north, 2)) for east, north in winds}:
            for turn in np.linspace(0.0, 2 * math.pi, 12, endpoint=False):
                flown = speeds_mps(uav, (math.sin(turn), math.cos(turn)), wind)
                if flown is None:
                    return None
                worst_j_per_m = max(worst_j_per_m, *(watts(uav.performance, flown[1], 0.0, air) / flown[0] for air in airs))
            worst_w = max(worst_w, *(watts(uav.performance, math.hypot(*wind), climb, air) for climb in (0.0, CLIMB_MPS) for air in airs))
        reach_m = OFF_NETWORK_FACTOR * needed_m
        near = np.hypot(*(self.tall.metres(self.tall.places) - self.tall.metres(start)).T) < reach_m if len(self.tall.heights) else []
        up_and_down_m = 6 * MAX_AGL_M + self.steepest * reach_m + 2 * 60.0 * int(np.sum(near))
        return (1.05 * worst_j_per_m * reach_m + worst_w * (STAYS_S + up_and_down_m / CLIMB_MPS)) / 3_600.0


# --- by flying it -------------------------------------------------------------------------------------------------------------


def missing(item: dict[str, Any]) -> tuple[float, float] | None:
    """Metres and Wh that a refusal says to be missing."""
    params = item["why"][0]["params"]
    if "missing_m" not in params and "missing_wh" not in params:
        return None
    return params.get("missing_m", 0.0), params.get("missing_wh", 0.0)


def _is_so_long(item: dict[str, Any], uav: Any) -> bool:
    """Whether what is missing is what this UAV flies in so many seconds, and the message rounds them up to minutes."""
    minutes = item["why"][0]["params"].get("minutes")
    if minutes is None or item["missing_s"] is None:
        return False
    if item["missing_wh"] is None:
        seconds = item["missing_m"] / uav.cruise_speed_mps
    elif uav.performance.battery_wh is None:
        return False
    else:
        seconds = item["missing_wh"] * 3_600.0 / watts(uav.performance, min(uav.cruise_speed_mps, limit_mps(uav)), 0.0, 1.225)
    is_rounded = -0.2 <= minutes * 60.0 - item["missing_s"] <= 6.2
    return is_rounded and abs(seconds - item["missing_s"]) <= 0.01 * seconds + 0.3


def first_of_all(request: PlanRequest, target: int, more_m: float = 0.0, more_wh: float = 0.0) -> PlanRequest:
    """The same mission with this target before all others, and with more range or battery."""
    return replace(
        request,
        lost_link=replace(request.lost_link, behaviour=type(request.lost_link.behaviour)("go_on")),
        targets=tuple(
            replace(asked, priority=Priority.HIGH if number == target else Priority.LOW) for number, asked in enumerate(request.targets)
        ),
        uavs=tuple(
            replace(
                uav,
                max_range_m=None if uav.max_range_m is None else uav.max_range_m + more_m,
                performance=uav.performance
                if uav.performance.battery_wh is None
                else replace(
                    uav.performance, battery_wh=uav.performance.battery_wh + more_wh / (1.0 - uav.performance.reserve_percent / 100.0)
                ),
            )
            for uav in request.uavs
        ),
    )


# --- the ground ---------------------------------------------------------------------------------------------------------------


def course_of(request: PlanRequest, target: int) -> Any:
    """What is to be inspected: a point, or a whole line."""
    asked = request.targets[target]
    if asked.position is not None:
        return shapely.Point(asked.position)
    asset = Asset.objects.get(pk=asked.asset)
    if asset.kind in {"line", "railway"}:
        return shapely.from_wkb(bytes(asset.geometry.wkb))
    return shapely.Point(asset.centre.coords)


def _tallest_m(request: PlanRequest, target: int) -> float:
    asked = request.targets[target]
    if asked.asset is None:
        return 0.0
    heights = Asset.objects.filter(pk=asked.asset).values_list("height_m", "supports__height_m")
    return max((height for row in heights for height in row if height is not None), default=0.0)
