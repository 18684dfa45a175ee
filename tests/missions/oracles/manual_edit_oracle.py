"""Changes routes of stored missions by hand at random and takes that back, and judges what is kept and why the rest is refused."""

import math
import random
import re
from collections import Counter
from collections.abc import Iterator
from datetime import timedelta
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from inspection.geodesy import LonLat
from inspection.models import Asset
from missions.models import Mission
from missions.services import EditedPoint, InvalidRequest, PlanRequest, change_route, take_back_change
from tests.missions.air import limit_mps, wind_mps
from tests.missions.oracles.clock_oracle import clock_of
from tests.missions.oracles.flight_oracle import Judge, flights_m
from tests.missions.oracles.return_oracle import MORE
from tests.missions.oracles.separation_oracle import stored_route
from tests.missions.oracles.terrain_oracle import CLEARANCE_M
from tests.missions.oracles.wire_oracle import BESIDE_M
from tests.missions.oracles.zone_oracle import legs_of
from tests.missions.plane import apart_m, east_north
from tests.missions.property_tests.random_flights import stored
from workspace.models import User

TRANSIT_M, MAX_HEIGHT_M = 60.0, 120.0
HIGHER = MORE._replace(height_m=MORE.height_m + 10.0)  # waypoints that are put in over terrain may lie so much above a leg
ROUNDING_M = 0.06
SHORT_M = 2.2
MIN_MPS, HAIR_MPS, SAME_PLACE_M = 0.5, 0.02, 0.01
TAKEN_BACK_SHARE = 0.5
UNTAGGED_M = {"tower": 45.0, "line": 60.0, "bridge": 30.0, "railway": 8.0}  # at most
_LACKS = re.compile(r"lacks ([\d.]+) Wh")
_SHORT = re.compile(r"is ([\d.]+) m too low")
_NO_STOPS: dict[int, float] = {}


class ManualEditOracle:
    def __init__(self, judge: Judge, author: User) -> None:
        self.judge, self.author = judge, author

    def faults(self, asked: PlanRequest, plan: dict[str, Any], draw: random.Random, seen: Counter[str]) -> list[str]:
        """A plan is kept, one of its routes is changed by hand once or twice, and what was kept may be taken back."""
        flying = [number for number, route in enumerate(plan["routes"]) if route["waypoints"]]
        if not flying:
            return []
        mission = stored(asked, plan, self.author)
        number = draw.choice(flying)
        kept = [(_as_flown(mission, plan), mission.plan_quality)]
        faults: list[str] = []
        for _ in range(draw.choice([1, 1, 2])):
            wished = _wished(kept[-1][0]["routes"][number]["waypoints"], draw)
            try:
                mission = change_route(mission=mission, actor=self.author, uav=number, points=[_hand_point(point) for point in wished])
            except InvalidRequest as error:
                seen["by hand refused"] += 1
                faults += self._falsely_refused(asked, number, kept[-1][0]["routes"][number], wished, error.faults)
                continue
            seen["changed by hand"] += 1
            seen["speeds by hand"] += any(point["speed_mps"] is not None for point in wished)
            kept.append((_as_flown(mission, plan), mission.plan_quality))
            flown = kept[-1][0]
            faults += [*self._of_flown(asked, flown), *_too_fast(asked, number, flown), *_not_as_wished(flown["routes"][number], wished)]
        if draw.random() < TAKEN_BACK_SHARE:
            faults += self._taken_back(asked, plan, mission, number, kept, seen)
        return [f"by hand: {fault}" for fault in faults]

    def _of_flown(self, asked: PlanRequest, flown: dict[str, Any]) -> list[str]:
        return [*self.judge.faults_of_routes(asked, flown), *self._too_low(flown), *self.judge.returns.faults(asked, flown)]

    def _taken_back(
        self, asked: PlanRequest, plan: dict[str, Any], mission: Mission, number: int, kept: list[tuple[Any, Any]], seen: Counter[str]
    ) -> Iterator[str]:
        """All steps, the last one first, and one too many."""
        for before, quality in reversed(kept[:-1]):
            try:
                mission = take_back_change(mission=mission, actor=self.author, uav=number)
            except InvalidRequest as error:
                yield f"not taken back: {error.faults}"
                return
            seen["taken back"] += 1
            flown = _as_flown(mission, plan)
            yield from (f"taken back: {fault}" for fault in self._of_flown(asked, flown))
            yield from (f"taken back: {fault}" for fault in _differences(flown["routes"][number], before["routes"][number]))
            if mission.plan_quality != quality:
                yield f"taken back, it is {mission.plan_quality}, not {quality}"
        try:
            take_back_change(mission=mission, actor=self.author, uav=number)
            yield "what was never changed is taken back"
        except InvalidRequest as error:
            if set(error.faults) != {"uav"}:
                yield f"what was never changed is not taken back otherwise: {error.faults}"

    def _falsely_refused(
        self, asked: PlanRequest, number: int, route: dict[str, Any], wished: list[dict[str, Any]], refused: dict[str, str]
    ) -> Iterator[str]:
        if route["charging"]:
            if set(refused) != {"uav"}:
                yield f"a route with stops to charge is refused otherwise: {refused}"
            return
        for place, stated in refused.items():
            if not self._is_true(asked, number, route, wished, place, stated):
                yield f"falsely refused: {place}: {stated}"

    def _too_low(self, flown: dict[str, Any]) -> list[str]:
        """Over wires: a hand may come by so little short of the clearance as rounding and slopes do."""
        return [fault for fault in self.judge.wires.faults(flown) if float(_SHORT.search(fault)[1]) > SHORT_M]

    def _is_true(
        self, asked: PlanRequest, number: int, route: dict[str, Any], wished: list[dict[str, Any]], place: str, stated: str
    ) -> bool:
        what, _, rest = place.partition(".")
        if what == "waypoints" and rest:
            point = wished[int(rest.split(".")[0])]
            if rest.endswith("position"):
                return _is_moved(point)
            if rest.endswith("speed_mps"):
                return _is_no_speed(asked, asked.uavs[number], wished, int(rest.split(".")[0]))
            if "stands" not in stated:
                return _is_at_wrong_height(point)
        uav = asked.uavs[number]
        drawn = self._drawn(asked, uav, route, wished)
        if "stands" in stated:
            return self._is_too_low(drawn["waypoints"], int(rest.split(".")[0]), is_leg=what == "legs")
        if what == "legs":
            return self._is_true_of_leg(asked, drawn, int(rest), stated)
        if "mast, wires or a bridge" in stated:
            return bool(self.judge.wires.faults({"routes": [drawn]}))
        if "range" in stated:
            return uav.max_range_m is not None and max(flights_m(drawn["waypoints"])) > 0.99 * uav.max_range_m
        clock = clock_of(asked, uav, drawn)
        if "wind" in stated:
            return clock.total_s > 1e6
        lacks = _LACKS.search(stated)
        if lacks is None or uav.performance.usable_wh is None:
            return False
        own_wh = max(clock.flights_wh) - uav.performance.usable_wh
        return abs(own_wh - float(lacks[1])) < 0.06 * max(clock.flights_wh) + 0.3

    def _is_true_of_leg(self, asked: PlanRequest, drawn: dict[str, Any], leg: int, stated: str) -> bool:
        """The leg from one wished waypoint to the next; the first and the last with the columns beside them."""
        points = drawn["waypoints"]
        legs = legs_of(drawn, asked.departs_at, drawn["departs_s"] + drawn["duration_s"], _NO_STOPS)
        own = [legs[leg + 1], *(legs[:1] if leg == 0 else []), *(legs[-1:] if leg >= len(points) - 2 else [])]
        if drawn["end_action"] == "hover":
            own = [one if one.times is None else one._replace(times=(one.times[0], one.times[1] + timedelta(hours=4))) for one in own]
        return any(zone.name in stated for _, zone in self.judge.zones.met(own, HIGHER))

    def _is_too_low(self, points: list[dict[str, Any]], place: int, *, is_leg: bool) -> bool:
        """Over a wire, a tower or a bridge beside a leg or a waypoint."""
        wires, name = self.judge.wires, "altitude_agl_m" if self.judge.hills is None else "altitude_amsl_m"
        ends = [points[place], points[place + 1 if is_leg else place]]
        start, end = wires._metres([point["position"] for point in ends])
        level_m = [point[name] for point in ends]
        shape = shapely.LineString([start, end]) if is_leg and (start != end).any() else shapely.Point(start)  # no distance to no length
        near = wires.tree.query(shape, predicate="dwithin", distance=BESIDE_M)
        return any(wires._short_m(start, end, *level_m, wire) > 0.5 for wire in near.tolist())

    def _drawn(self, asked: PlanRequest, uav: Any, route: dict[str, Any], wished: list[dict[str, Any]]) -> dict[str, Any]:
        """The wished waypoints as a route, with heights above the sea and times as judges count them."""
        hills = self.judge.hills
        places = [point["position"] for point in wished]
        ground_m = [0.0] * len(places) if hills is None else hills.metres(places).tolist()
        points = [
            point
            | {
                "altitude_amsl_m": None if hills is None else under_m + point["altitude_agl_m"],
                "altitude_relative_m": under_m + point["altitude_agl_m"] - ground_m[0],
            }
            for point, under_m in zip(wished, ground_m, strict=True)
        ]
        drawn = route | {"waypoints": points}
        clock = clock_of(asked, uav, drawn)
        return drawn | {"arrival_s": [route["departs_s"] + arrival_s for arrival_s in clock.arrival_s], "duration_s": clock.total_s}


def _wished(until_now: list[dict[str, Any]], draw: random.Random) -> list[dict[str, Any]]:
    """Up to three changes; each point keeps what it was, and `from`, where it was. Few of them are such as nobody may make."""
    points = [point | {"was": number, "from": point["position"]} for number, point in enumerate(until_now)]
    for _ in range(draw.randint(0, 3)):
        passed = [number for number, point in enumerate(points) if point["kind"] == "pass" and 0 < number < len(points) - 1]
        kind = draw.choice(
            ["put in", "put in", "move", "move", "take out", "height", "height", "speed", "speed", "wrong height", "move a target"]
        )
        if kind == "put in":
            after = draw.randrange(len(points) - 1)
            ends = points[after]["position"], points[after + 1]["position"]
            share, stray_deg = draw.random(), draw.choice([0.0002, 0.002, 0.01])
            position = [start + share * (end - start) + draw.uniform(-stray_deg, stray_deg) for start, end in zip(*ends, strict=True)]
            new = {"position": position, "altitude_agl_m": draw.uniform(60.0, 120.0), "was": None, "from": position}
            points.insert(after + 1, new | {"kind": "pass", "task": None, "asset": None, "target": None, "speed_mps": None})
        elif kind == "move" and passed:
            number = draw.choice(passed)
            stray_deg = draw.choice([0.0002, 0.002, 0.01])
            position = [value + draw.uniform(-stray_deg, stray_deg) for value in points[number]["position"]]
            points[number] = points[number] | {"position": position, "altitude_agl_m": max(points[number]["altitude_agl_m"], 60.0)}
        elif kind == "take out" and passed:
            del points[draw.choice(passed)]
        elif kind == "height" and passed:
            number = draw.choice(passed)
            points[number] = points[number] | {"altitude_agl_m": draw.uniform(60.0, 120.0)}
        elif kind == "speed":
            number = draw.choice([number for number, point in enumerate(points) if point["kind"] not in {"start", "base"}])
            points[number] = points[number] | {
                "speed_mps": draw.choice([None, draw.uniform(0.6, 12.0), draw.uniform(0.6, 12.0), draw.uniform(0.1, 25.0)])
            }
        elif kind == "wrong height" and passed and draw.random() < 0.3:
            number = draw.choice(passed)
            points[number] = points[number] | {"altitude_agl_m": draw.choice([25.0, 40.0, 121.0, 150.0])}
        elif kind == "move a target" and draw.random() < 0.2:
            number = draw.choice([number for number, point in enumerate(points) if point["kind"] != "pass"])
            position = [value + draw.uniform(-0.001, 0.001) for value in points[number]["position"]]
            points[number] = points[number] | {"position": position}
    return points


def _is_moved(point: dict[str, Any]) -> bool:
    return point["kind"] != "pass" and apart_m(point["position"], point["from"]) > 0.09


def _is_at_wrong_height(point: dict[str, Any]) -> bool:
    """Above the greatest height, below that between targets, or without the clearance above what is there."""
    agl_m, least_m = point["altitude_agl_m"], TRANSIT_M
    if point["asset"] is not None:
        kind, height_m = Asset.objects.values_list("kind", "height_m").get(pk=point["asset"])
        least_m = max(least_m, (UNTAGGED_M.get(kind, 0.0) if height_m is None else height_m) + CLEARANCE_M)
    return bool(agl_m > MAX_HEIGHT_M + ROUNDING_M or agl_m < least_m - 0.04)


def _is_no_speed(asked: PlanRequest, uav: Any, wished: list[dict[str, Any]], place: int) -> bool:
    """Whether the leg to a waypoint cannot be flown at its speed, in the wind of a height between its ends; a hair is left to rounding."""
    before, after = wished[place - 1], wished[place]
    heights_m = sorted((before["altitude_agl_m"], after["altitude_agl_m"]))
    winds = [wind_mps(asked, height_m) for height_m in np.linspace(*heights_m, 9)]
    return any(
        _is_out_of_range(uav, after["speed_mps"], east_north(before["position"], after["position"]), wind, -HAIR_MPS) for wind in winds
    )


def _is_out_of_range(uav: Any, speed_mps: float, way: tuple[float, float], wind: tuple[float, float], give_mps: float) -> bool:
    """Over ground less than a headway, or through the air more than its limit; without a way it stands in the wind."""
    length_m = math.hypot(*way)
    if length_m < SAME_PLACE_M:
        return speed_mps > limit_mps(uav) + give_mps or speed_mps < MIN_MPS - give_mps
    along = [speed_mps * part / length_m for part in way]
    through_air_mps = math.hypot(along[0] - wind[0], along[1] - wind[1])
    is_known = uav.performance.max_airspeed_mps is not None
    return (
        speed_mps < MIN_MPS - give_mps
        or through_air_mps > limit_mps(uav) + give_mps
        or (not is_known and speed_mps > limit_mps(uav) + give_mps)
    )


def _too_fast(asked: PlanRequest, number: int, flown: dict[str, Any]) -> Iterator[str]:
    uav, points = asked.uavs[number], flown["routes"][number]["waypoints"]
    for place, (before, after) in enumerate(pairwise(points)):
        middle_m = (before["altitude_agl_m"] + after["altitude_agl_m"]) / 2
        way, wind = east_north(before["position"], after["position"]), wind_mps(asked, middle_m)
        if after["speed_mps"] is not None and _is_out_of_range(uav, after["speed_mps"], way, wind, HAIR_MPS):
            yield f"leg {place} cannot be flown at {after['speed_mps']} m/s in a wind of {wind}"


def _not_as_wished(route: dict[str, Any], wished: list[dict[str, Any]]) -> Iterator[str]:
    """Waypoints that are not flown where, as high and as fast as they were wished, in their order."""
    points, number = route["waypoints"], 0
    for wish in wished:
        first = number
        while number < len(points) and not _is_the_same(points[number], wish):
            number += 1
        if number == len(points):
            yield f"it does not come through {wish['position']} at {wish['altitude_agl_m']:.1f} m"
            return
        if first and any(not _is_same_speed(point["speed_mps"], wish["speed_mps"]) for point in points[first : number + 1]):
            yield f"it does not fly at {wish['speed_mps']} m/s to {wish['position']}"
        number += 1


def _differences(route: dict[str, Any], before: dict[str, Any]) -> Iterator[str]:
    """Between a route and what it was before, but for rounding."""
    if len(route["waypoints"]) != len(before["waypoints"]):
        yield f"{len(route['waypoints'])} waypoints, not {len(before['waypoints'])}"
        return
    for place, (point, was) in enumerate(zip(route["waypoints"], before["waypoints"], strict=True)):
        same = ("kind", "asset", "target", "task")
        if (
            not _is_the_same(point, was)
            or not _is_same_speed(point["speed_mps"], was["speed_mps"])
            or any(point[k] != was[k] for k in same)
        ):
            yield f"waypoint {place} is {point}, not {was}"
    for name in ("length_m", "duration_s", "energy_wh"):
        if route[name] is not None and abs(route[name] - before[name]) > 0.002 * before[name] + 0.2:
            yield f"{name} is {route[name]}, not {before[name]}"


def _is_same_speed(one_mps: float | None, other_mps: float | None) -> bool:
    if one_mps is None or other_mps is None:
        return one_mps is other_mps
    return abs(one_mps - other_mps) < HAIR_MPS


def _as_flown(mission: Mission, plan: dict[str, Any]) -> dict[str, Any]:
    """The plan with the routes that are stored by now."""
    routes = [
        stored_route(row) if row.geometry is not None else planned
        for row, planned in zip(mission.routes.order_by("mission_uav__sequence"), plan["routes"], strict=True)
    ]
    return plan | {"routes": routes, "separation": mission.separation, "lost_link": mission.lost_link_check}


def _hand_point(point: dict[str, Any]) -> EditedPoint:
    return EditedPoint(LonLat(*point["position"]), point["altitude_agl_m"], point["was"], point["speed_mps"])


def _is_the_same(point: dict[str, Any], wish: dict[str, Any]) -> bool:
    return apart_m(point["position"], wish["position"]) < 0.2 and abs(point["altitude_agl_m"] - wish["altitude_agl_m"]) < ROUNDING_M
