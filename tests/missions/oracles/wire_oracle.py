"""Judges finished plans by how near they come to towers, wires, catenaries and bridges: by the rows of the database, step by step.

Shares no code with the planner or its last look. A wire hangs no higher than straight from top to top.
"""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from inspection.models import Asset
from tests.missions.plane import EARTH_M

CLEARANCE_M, ROUNDING_M = 15.0, 1.0
BESIDE_M = 24.0
STEEPEST = 0.26  # a tower is come to on a slope: so much less than the clearance for each metre that it still is away
STEP_M = 3.0
FLAT_M = 2.0
HIGHEST_VOLTAGE_V, HIGHEST_VOLTAGE_M = 300_000, 60.0  # lines of such a voltage and the towers on them, where no height is tagged
USUAL_M = {"tower": 45.0, "line": 45.0, "railway": 8.0, "bridge": 30.0}

Ground = Callable[[Any], Any]


class WireJudge:
    """Of all plans over the assets that are in the database now; ground: metres above the sea at (n, 2) lon, lat."""

    def __init__(self, ground: Ground | None = None) -> None:
        self.ground = ground
        rows = list(Asset.objects.filter(is_flyable=True, vanished_at=None).order_by("pk"))
        tops = {tuple(row.centre.coords): self._height(row) for row in reversed(rows) if row.kind == "tower"}
        untagged = {tuple(row.centre.coords) for row in rows if row.kind == "tower" and row.height_m is None}
        for row in rows:
            if row.kind == "line":
                for place in untagged.intersection(_vertices(row)):
                    tops[place] = max(tops[place], self._height(row))
        wires, hung, hangs = [], set(), []
        for row in rows:
            if row.kind == "bridge":
                wires.append((tuple(row.centre.coords), tuple(row.centre.coords), self._height(row), self._height(row)))
            elif row.kind in {"line", "railway"}:
                shape = shapely.from_wkb(bytes(row.geometry.wkb))
                for part in shapely.get_parts(shape):
                    course = [tuple(place[:2]) for place in part.coords]
                    hung.update(course)
                    for start, end in pairwise(course):
                        hangs.append((len(wires), row.pk))
                        wires.append((start, end, *(self._top(row, place, tops) for place in (start, end))))
        wires += [(place, place, top, top) for place, top in tops.items() if place not in hung]  # else a wire ends at its top
        self.origin = np.array([wires[0][0][0], wires[0][0][1]])
        self.start, self.end = (self._metres(np.array([wire[side] for wire in wires])) for side in (0, 1))
        self.top_m = np.array([wire[2:] for wire in wires])
        self.asset = dict(hangs)
        if ground is not None:
            self.top_m = self.top_m + np.column_stack([ground(np.array([wire[side] for wire in wires])) for side in (0, 1)])
        self.decks = [deck for row in rows if row.kind == "bridge" for deck in self._decks(row)]
        self.tree = shapely.STRtree([shapely.LineString([a, b]) if a != b else shapely.Point(a) for a, b in self._ends()])
        self.passed = 0

    def faults(self, plan: dict[str, Any]) -> list[str]:
        return [fault for route in plan["routes"] for fault in self._faults(route)]

    def highest_m(self, start: Any, end: Any, beside_m: float, over_m: float) -> float:
        """The highest point so near to the straight way from start to end, lon, lat; -inf where none is above over_m. Step by step."""
        here, there = self._metres([start, end])
        highest_m = -math.inf
        line = shapely.LineString([here, there]) if (here != there).any() else shapely.Point(here)
        for wire in self.tree.query(line, predicate="dwithin", distance=beside_m).tolist():
            if self.top_m[wire].max() <= max(over_m, highest_m):
                continue
            share = np.linspace(0.0, 1.0, int(math.dist(self.start[wire], self.end[wire]) / STEP_M) + 2)[:, None]
            off = self.start[wire] + share * (self.end[wire] - self.start[wire]) - here
            along = there - here
            where = np.clip(off @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
            top_m = self.top_m[wire, 0] + share[:, 0] * (self.top_m[wire, 1] - self.top_m[wire, 0])
            near = np.hypot(*(off - where[:, None] * along).T) <= beside_m
            highest_m = max(highest_m, float(top_m[near].max(initial=-math.inf)))
        return highest_m if highest_m > over_m else -math.inf

    def _faults(self, route: dict[str, Any]) -> Iterator[str]:
        waypoints = route["waypoints"]
        if not waypoints:
            return
        places = self._metres(np.array([waypoint["position"] for waypoint in waypoints]))
        name = "altitude_agl_m" if self.ground is None else "altitude_amsl_m"
        level_m = [waypoint[name] for waypoint in waypoints]
        for leg, (one, other) in enumerate(pairwise(waypoints)):
            if "base" in {one["kind"], other["kind"]}:
                continue  # up from the ground, or down to it
            line = shapely.LineString(places[leg : leg + 2]) if (places[leg] != places[leg + 1]).any() else shapely.Point(places[leg])
            if (one["task"] or {}).get("view") is None and (other["task"] or {}).get("view") is None:
                yield from self._low_over_decks(f"{route['uav']}: leg {leg}", places[leg : leg + 2], level_m[leg : leg + 2])
            target = self._target(one, other, line)
            at_target = [waypoint for waypoint in waypoints if target is not None and waypoint["target"] == target]
            own = self._metres(np.array([waypoint["position"] for waypoint in at_target]).reshape(-1, 2))
            assets = {waypoint["asset"] for waypoint in at_target}
            for wire in self.tree.query(line, predicate="dwithin", distance=BESIDE_M).tolist():
                self.passed += 1
                short_m = self._short_m(places[leg], places[leg + 1], level_m[leg], level_m[leg + 1], wire)
                if short_m > ROUNDING_M and not self._is_inspected(own, assets, wire):
                    yield f"{route['uav']}: leg {leg} at {one['position']} is {short_m:.1f} m too low over {self.top_m[wire].tolist()}"

    def _decks(self, row: Asset) -> Iterator[tuple[Any, float]]:
        """The area of a bridge and the height of what stands on it: 30 m over its centre and 20 m over its banks; as stated, and 12 m."""
        area = shapely.from_wkb(bytes(row.geometry.wkb))
        metres = shapely.transform(area, self._metres)
        if area.area == 0.0:
            return
        height_m, is_stated = self._height(row), row.height_m is not None
        if self.ground is None:
            yield metres, height_m
            return
        hull = shapely.get_coordinates(shapely.convex_hull(area))
        highest_m = float(self.ground(hull).max()) - FLAT_M  # planners look at no more than 16 corners
        at_centre_m = float(self.ground(np.array([row.centre.coords]))[0])
        yield metres, max(at_centre_m + height_m, highest_m + (min(height_m, 12.0) if is_stated else 20.0))

    def _low_over_decks(self, leg: str, places: Any, level_m: list[float]) -> Iterator[str]:
        share = np.linspace(0.0, 1.0, int(math.dist(*places) / STEP_M) + 2)
        line = shapely.LineString(places) if (places[0] != places[1]).any() else shapely.Point(places[0])
        for area, top_m in self.decks:
            if shapely.distance(area, line) > BESIDE_M - 1.0:
                continue
            at = places[0] + share[:, None] * (places[1] - places[0])
            is_over = shapely.distance(area, shapely.points(at)) <= BESIDE_M - 1.0
            over_m = (level_m[0] + share * (level_m[1] - level_m[0]) - top_m)[is_over].min(initial=math.inf)
            if over_m < CLEARANCE_M - ROUNDING_M:
                yield f"{leg} is {CLEARANCE_M - over_m:.1f} m too low over a bridge"

    def _short_m(self, start: Any, end: Any, start_m: float, end_m: float, wire: int) -> float:
        share = np.linspace(0.0, 1.0, int(math.dist(start, end) / STEP_M) + 2)
        at = start + share[:, None] * (end - start)
        along = self.end[wire] - self.start[wire]
        where = np.clip((at - self.start[wire]) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
        beside_m = np.hypot(*(at - self.start[wire] - where[:, None] * along).T)
        top_m = self.top_m[wire, 0] + where * (self.top_m[wire, 1] - self.top_m[wire, 0])
        over_m = start_m + share * (end_m - start_m) - top_m
        short_m = CLEARANCE_M - STEEPEST * beside_m - over_m
        return float(short_m[beside_m <= BESIDE_M].max(initial=-math.inf))

    def _is_inspected(self, own: Any, assets: set[int | None], wire: int) -> bool:
        """Whether it hangs at a place of the target, or the target lies along it, as a part of the same line."""
        if not len(own):
            return False
        ends = np.array([self.start[wire], self.end[wire]])
        if min(np.hypot(*(own - end).T).min() for end in ends) < 2.0:
            return True
        if self.asset.get(wire, -1) not in assets:
            return False
        near = shapely.distance(shapely.points(own), shapely.LineString(ends) if (ends[0] != ends[1]).any() else shapely.Point(ends[0]))
        return bool((np.sort(near)[: 2 if len(own) > 1 else 1] < 2.0).all())

    @staticmethod
    def _target(one: dict[str, Any], other: dict[str, Any], line: Any) -> int | None:
        if line.geom_type == "Point":
            return one["target"] if one["target"] is not None else other["target"]
        return one["target"] if one["target"] == other["target"] else None

    @staticmethod
    def _height(row: Asset) -> float:
        if row.height_m is not None:
            return row.height_m
        is_highest = row.kind == "line" and (row.max_voltage_v or 0) >= HIGHEST_VOLTAGE_V
        return HIGHEST_VOLTAGE_M if is_highest else USUAL_M[row.kind]

    def _top(self, row: Asset, place: Any, tops: dict[Any, float]) -> float:
        return tops.get(place, self._height(row)) if row.kind == "line" else self._height(row)

    def _ends(self) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
        return [(tuple(start), tuple(end)) for start, end in zip(self.start.tolist(), self.end.tolist(), strict=True)]

    def _metres(self, places: Any) -> Any:
        degree_m = math.radians(1.0) * EARTH_M
        return (np.asarray(places)[:, :2] - self.origin) * (degree_m * math.cos(math.radians(self.origin[1])), degree_m)


def _vertices(row: Asset) -> list[tuple[float, ...]]:
    return [tuple(place) for place in shapely.get_coordinates(shapely.from_wkb(bytes(row.geometry.wkb))).tolist()]
