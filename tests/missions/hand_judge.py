"""Changes routes of stored missions by hand at random, and judges what is kept and why the rest is refused."""

import random
import re
from collections import Counter
from collections.abc import Iterator
from datetime import timedelta
from typing import Any

import shapely

from inspection.geodesy import LonLat
from inspection.models import Asset
from missions.services import HandPoint, InvalidRequest, PlanRequest, change_route
from tests.missions.apart_judge import stored_route
from tests.missions.clock_judge import clock_of
from tests.missions.flight_judge import Judge, flights_m
from tests.missions.ground_judge import CLEARANCE_M
from tests.missions.plane import apart_m
from tests.missions.random_flights import stored
from tests.missions.return_judge import MORE
from tests.missions.wire_judge import BESIDE_M
from tests.missions.zone_judge import legs_of
from workspace.models import User

TRANSIT_M, HIGHEST_M = 60.0, 120.0
ROUNDING_M = 0.06
SHORT_M = 2.2
UNTAGGED_M = {"tower": 45.0, "line": 60.0, "bridge": 30.0, "railway": 8.0}  # at most
_LACKS = re.compile(r"lacks ([\d.]+) Wh")
_SHORT = re.compile(r"is ([\d.]+) m too low")
_NO_STOPS: dict[int, float] = {}


class HandJudge:
    def __init__(self, judge: Judge, author: User) -> None:
        self.judge, self.author = judge, author

    def faults(self, asked: PlanRequest, plan: dict[str, Any], draw: random.Random, seen: Counter[str]) -> list[str]:
        """A plan is kept, and one of its routes changed by hand."""
        flying = [number for number, route in enumerate(plan["routes"]) if route["waypoints"]]
        if not flying:
            return []
        mission = stored(asked, plan, self.author)
        number = draw.choice(flying)
        until_now = plan["routes"][number]["waypoints"]
        wished = _wished(until_now, draw)
        points = [HandPoint(LonLat(*point["position"]), point["altitude_agl_m"], point["was"]) for point in wished]
        try:
            mission = change_route(mission=mission, actor=self.author, uav=number, points=points)
        except InvalidRequest as error:
            seen["by hand refused"] += 1
            if plan["routes"][number]["charging"]:
                return [] if set(error.faults) == {"uav"} else [f"a route with stops to charge is refused otherwise: {error.faults}"]
            return [
                f"by hand, falsely refused: {place}: {said}"
                for place, said in error.faults.items()
                if not self._is_true(asked, number, plan["routes"][number], wished, place, said)
            ]
        seen["changed by hand"] += 1
        routes = [stored_route(row) for row in mission.routes.all()]
        flown = plan | {"routes": routes, "separation": mission.separation, "lost_link": mission.lost_link_check}
        faults = [*self.judge.faults_of_routes(asked, flown), *self._too_low(flown), *self.judge.returns.faults(asked, flown)]
        return [f"by hand: {fault}" for fault in (*faults, *_not_as_wished(routes[number]["waypoints"], wished))]

    def _too_low(self, flown: dict[str, Any]) -> list[str]:
        """Over wires: a hand may come by so little short of the clearance as rounding and slopes do."""
        return [fault for fault in self.judge.wires.faults(flown) if float(_SHORT.search(fault)[1]) > SHORT_M]

    def _is_true(self, asked: PlanRequest, number: int, route: dict[str, Any], wished: list[dict[str, Any]], place: str, said: str) -> bool:
        what, _, rest = place.partition(".")
        if what == "waypoints" and rest:
            point = wished[int(rest.split(".")[0])]
            if rest.endswith("position"):
                return _is_moved(point)
            if "stands" not in said:
                return _is_at_wrong_height(point)
        uav = asked.uavs[number]
        drawn = self._drawn(asked, uav, route, wished)
        if "stands" in said:
            return self._is_too_low(drawn["waypoints"], int(rest.split(".")[0]), is_leg=what == "legs")
        if what == "legs":
            return self._is_true_of_leg(asked, drawn, int(rest), said)
        if "mast or wires" in said:
            return bool(self.judge.wires.faults({"routes": [drawn]}))
        if "range" in said:
            return uav.max_range_m is not None and max(flights_m(drawn["waypoints"])) > 0.99 * uav.max_range_m
        clock = clock_of(asked, uav, drawn)
        if "wind" in said:
            return clock.total_s > 1e6
        lacks = _LACKS.search(said)
        if lacks is None or uav.performance.usable_wh is None:
            return False
        own_wh = max(clock.flights_wh) - uav.performance.usable_wh
        return abs(own_wh - float(lacks[1])) < 0.06 * max(clock.flights_wh) + 0.3

    def _is_true_of_leg(self, asked: PlanRequest, drawn: dict[str, Any], leg: int, said: str) -> bool:
        """The leg from one wished waypoint to the next; the first and the last with the columns beside them."""
        points = drawn["waypoints"]
        legs = legs_of(drawn, asked.departs_at, drawn["departs_s"] + drawn["duration_s"], _NO_STOPS)
        own = [legs[leg + 1], *(legs[:1] if leg == 0 else []), *(legs[-1:] if leg >= len(points) - 2 else [])]
        if drawn["end_action"] == "hover":
            own = [one if one.times is None else one._replace(times=(one.times[0], one.times[1] + timedelta(hours=4))) for one in own]
        return any(zone.name in said for _, zone in self.judge.zones.met(own, MORE))

    def _is_too_low(self, points: list[dict[str, Any]], place: int, *, is_leg: bool) -> bool:
        """Over a wire, a tower or a bridge beside a leg or a waypoint."""
        wires, name = self.judge.wires, "altitude_agl_m" if self.judge.hills is None else "altitude_amsl_m"
        ends = [points[place], points[place + 1 if is_leg else place]]
        start, end = wires._metres([point["position"] for point in ends])
        level_m = [point[name] for point in ends]
        near = wires.tree.query(shapely.LineString([start, end]), predicate="dwithin", distance=BESIDE_M)
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
    points = [point | {"was": number, "from": point["position"], "put_in": False} for number, point in enumerate(until_now)]
    for _ in range(draw.randint(0, 3)):
        passed = [number for number, point in enumerate(points) if point["kind"] == "pass" and 0 < number < len(points) - 1]
        kind = draw.choice(["put in", "put in", "move", "move", "take out", "height", "height", "wrong height", "move a target"])
        if kind == "put in":
            after = draw.randrange(len(points) - 1)
            ends = points[after]["position"], points[after + 1]["position"]
            share, stray_deg = draw.random(), draw.choice([0.0002, 0.002, 0.01])
            position = [start + share * (end - start) + draw.uniform(-stray_deg, stray_deg) for start, end in zip(*ends, strict=True)]
            new = {"position": position, "altitude_agl_m": draw.uniform(60.0, 120.0), "was": None, "from": position, "put_in": True}
            points.insert(after + 1, new | {"kind": "pass", "task": None, "asset": None, "target": None})
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
    return bool(agl_m > HIGHEST_M + ROUNDING_M or agl_m < least_m - 0.04)


def _not_as_wished(points: list[dict[str, Any]], wished: list[dict[str, Any]]) -> Iterator[str]:
    """Waypoints that are not flown where and as high as they were wished, in their order."""
    number = 0
    for wish in wished:
        while number < len(points) and not _is_the_same(points[number], wish):
            number += 1
        if number == len(points):
            yield f"it does not come through {wish['position']} at {wish['altitude_agl_m']:.1f} m"
            return


def _is_the_same(point: dict[str, Any], wish: dict[str, Any]) -> bool:
    return apart_m(point["position"], wish["position"]) < 0.2 and abs(point["altitude_agl_m"] - wish["altitude_agl_m"]) < ROUNDING_M
