"""From the ways between targets to one list of points: start, what is passed, targets, end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, pairwise, repeat
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from missions.flight_plan.waypoints import RoutePoint, WaypointKind, point_between
from missions.routing.problem import Task

SAME_PLACE_DEG = 1e-9  # a tenth of a millimetre: rounding, not movement


class PassedNode(NamedTuple):
    """A node of the graph on the way, and the height above ground at which it is passed."""

    position: LonLat
    agl_m: float
    asset: int | None


@dataclass(frozen=True)
class TargetPoints:
    """What is flown at a target: one point, or the vertices of a stretch in the direction flown."""

    target: int
    positions: tuple[LonLat, ...]
    agl_m: float
    task: Task
    asset: int | None


def route_points(
    *,
    start: LonLat,
    transit_agl_m: float,
    targets: Sequence[TargetPoints],
    ways: Sequence[Sequence[PassedNode]],
    way_home: Sequence[PassedNode] | None,
    home: LonLat | None = None,
) -> list[RoutePoint]:
    """The points of one route; ways[i] leads to targets[i], way_home on to `home` (None: the start), or the route ends at the last target.

    The route begins at transit height above the start, after a vertical climb, and ends above the place where the UAV hovers, lands or
    comes home to. Each target has exactly one point of kind `target`: where it is, or where its stretch is entered; the stretch's other
    vertices are passed and carry the target's index. A target that is inspected from below transit height is reached by a vertical
    descent and left by a vertical climb, so that the UAV is never lower than that between targets. Passing the same place twice in a
    row at the same height is one point.
    """
    route = _Route(transit_agl_m)
    route.add(RoutePoint(start, WaypointKind.START, transit_agl_m))
    for points, way in zip(targets, ways, strict=True):
        route.add_way(way)
        route.add_target(points)
    if way_home is not None:
        route.add_way(way_home)
        route.add(RoutePoint(start if home is None else home, WaypointKind.END, transit_agl_m))
    else:
        last = route.points[-1]
        route.points.append(RoutePoint(last.position, WaypointKind.END, last.agl_m))
    return route.points


class _Route:
    def __init__(self, transit_agl_m: float) -> None:
        self.transit_agl_m = transit_agl_m
        self.points: list[RoutePoint] = []

    def add_way(self, way: Sequence[PassedNode]) -> None:
        if not way:
            return
        self._add_node(way[0])
        rest = way[1:]
        if not rest:
            return
        positions, agl_m, assets = zip(*rest, strict=True)
        if min(agl_m) >= self.transit_agl_m <= way[0].agl_m and not _repeats(way):  # as on nearly every way
            self.points += map(RoutePoint, positions, repeat(WaypointKind.PASS), agl_m, assets)
        else:
            for node in rest:
                self._add_node(node)

    def _add_node(self, node: PassedNode) -> None:
        self.add(RoutePoint(node.position, WaypointKind.PASS, node.agl_m, node.asset))

    def add_target(self, points: TargetPoints) -> None:
        entry = points.positions[0]
        self.add(RoutePoint(entry, WaypointKind.PASS, max(points.agl_m, self.transit_agl_m), points.asset))
        before = self.points[-1]
        if before.kind is WaypointKind.PASS and before.target is None and before.agl_m == points.agl_m:
            self.points.pop()  # the target's own point takes its place
        self.points.append(RoutePoint(entry, WaypointKind.TARGET, points.agl_m, points.asset, points.target, points.task))
        for position in points.positions[1:]:
            if not _same_place(position, self.points[-1].position):
                self.points.append(RoutePoint(position, WaypointKind.PASS, points.agl_m, points.asset, points.target))

    def add(self, point: RoutePoint) -> None:
        """Put in a point outside targets, after a climb from a low target, unless it repeats the point before."""
        if self.points:
            before = self.points[-1]
            here = _same_place(point.position, before.position)
            if before.agl_m < self.transit_agl_m and not here:
                self.points.append(RoutePoint(before.position, WaypointKind.PASS, self.transit_agl_m, before.asset))
            elif here and point.kind is WaypointKind.PASS and point.agl_m == before.agl_m:
                return
        self.points.append(point)


def with_short_legs(points: Sequence[RoutePoint], longest_leg_m: float) -> list[RoutePoint]:
    """The points, and in between as many more, evenly on the straight lon/lat line, as keep every leg within the longest."""
    position = positions_of(points)
    lengths_m = distance_m(position[:-1], position[1:])
    if not (lengths_m > longest_leg_m).any():
        return list(points)
    divided: list[RoutePoint] = list(points[:1])
    for (left, right), length_m in zip(pairwise(points), lengths_m.tolist(), strict=True):
        if length_m > longest_leg_m:
            parts = math.ceil(length_m / longest_leg_m)
            divided += [point_between(left, right, part / parts) for part in range(1, parts)]
        divided.append(right)
    return divided


def _same_place(left: LonLat, right: LonLat) -> bool:
    return abs(left[0] - right[0]) <= SAME_PLACE_DEG and abs(left[1] - right[1]) <= SAME_PLACE_DEG


def _repeats(way: Sequence[PassedNode]) -> bool:
    """Whether any node stands where the one before it does."""
    return bool((np.abs(np.diff(positions_of(way), axis=0)) <= SAME_PLACE_DEG).all(axis=1).any())


def positions_of(points: Sequence[RoutePoint] | Sequence[PassedNode]) -> NDArray[np.float64]:
    """Lon lat of each, shape (n, 2)."""
    flat = np.fromiter(chain.from_iterable([point.position for point in points]), dtype=np.float64, count=2 * len(points))
    return flat.reshape(-1, 2)


def line_of(points: Sequence[RoutePoint]) -> NDArray[np.float64]:
    """The route on the map, shape (n, 2), n >= 2: positions without repeated ones; a UAV that stays in its place has it twice."""
    positions = positions_of(points)
    moved = np.append(True, (np.diff(positions, axis=0) != 0).any(axis=1))
    line: NDArray[np.float64] = positions[moved]
    return line if len(line) > 1 else np.repeat(line, 2, axis=0)
