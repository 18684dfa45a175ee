"""From the ways between targets to one list of points: start, what is passed, targets, end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m, path_length_m
from missions.flight_plan.waypoints import RoutePoint, RoutePoints, WaypointKind, point_between
from missions.routing.problem import Task

SAME_PLACE_DEG = 1e-9  # a tenth of a millimetre: rounding, not movement


@dataclass(frozen=True, eq=False)
class PassedNodes:
    """Nodes of the graph on a way, column by column: [lon, lat], the height above ground at which each is passed, and its asset.

    has_repeats tells that some node may stand where the one before it does.
    """

    position: Sequence[list[float]]
    agl_m: Sequence[float]
    asset: Sequence[int | None]
    has_repeats: bool

    def __len__(self) -> int:
        return len(self.position)


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
    ways: Sequence[PassedNodes],
    way_home: PassedNodes | None,
    home: LonLat | None = None,
) -> RoutePoints:
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
        self.points = RoutePoints()

    def add_way(self, way: PassedNodes) -> None:
        if not way:
            return
        if way.has_repeats or min(way.agl_m) < self.transit_agl_m:  # as on hardly any way
            for node in range(len(way)):
                self._add_node(way, node)
        else:
            self._add_node(way, 0)
            self.points.extend_passed(way.position[1:], way.agl_m[1:], way.asset[1:])

    def _add_node(self, way: PassedNodes, node: int) -> None:
        lon, lat = way.position[node]
        self.add(RoutePoint(LonLat(lon, lat), WaypointKind.PASS, way.agl_m[node], way.asset[node]))

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


def with_short_legs(points: RoutePoints, longest_leg_m: float) -> tuple[RoutePoints, float]:
    """The points, and in between as many more, evenly on the straight lon/lat line, as keep every leg within the longest; and metres."""
    position = points.positions()
    lengths_m = distance_m(position[:-1], position[1:])
    if not (lengths_m > longest_leg_m).any():
        return points, float(lengths_m.sum())
    divided = RoutePoints()
    first = 0
    for leg in np.flatnonzero(lengths_m > longest_leg_m).tolist():
        divided.extend(points, first, leg + 1)
        parts = math.ceil(lengths_m[leg] / longest_leg_m)
        for part in range(1, parts):
            divided.append(point_between(points[leg], points[leg + 1], part / parts))
        first = leg + 1
    divided.extend(points, first, len(points))
    return divided, path_length_m(divided.positions())


def _same_place(left: LonLat, right: LonLat) -> bool:
    return abs(left[0] - right[0]) <= SAME_PLACE_DEG and abs(left[1] - right[1]) <= SAME_PLACE_DEG


def repeats(position: NDArray[np.float64], ends: Sequence[int]) -> bool:
    """Whether any of the positions (n, 2) of several ways, put end to end, is the one before it on its way; a way ends before ends[i]."""
    same: NDArray[np.bool_] = np.all(np.abs(np.diff(position, axis=0)) <= SAME_PLACE_DEG, axis=1)
    if not same.any():
        return False
    same[[end - 1 for end in ends if 0 < end < len(position)]] = False
    return bool(same.any())


def line_of(points: RoutePoints) -> NDArray[np.float64]:
    """The route on the map, shape (n, 2), n >= 2: positions without repeated ones; a UAV that stays in its place has it twice."""
    positions = points.positions()
    moved = np.append(True, (np.diff(positions, axis=0) != 0).any(axis=1))
    line: NDArray[np.float64] = positions[moved]
    return line if len(line) > 1 else np.repeat(line, 2, axis=0)
