"""From the ways between targets to one list of points: start, what is passed, targets, end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import short_distance_m
from planning.task import Task
from planning.trajectory.waypoints import END, NONE, PASS, START, TARGET, FloatArray, IntArray, RoutePoints, Waypoints

SAME_PLACE_DEG = 1e-9  # a tenth of a millimetre: rounding, not movement

SAME_HEIGHT_M = 1e-6


class PassedNodes(NamedTuple):
    """Nodes of the graph and bends round zones on the ways of a route, one way after another.

    position float64 (n, 2), lon lat [deg]; agl_m float64 (n,), the height above ground at which each is passed; asset int64 (n,), NONE
    where there is none; way w has the nodes first[w] up to but without first[w + 1], (w + 1,).
    """

    position: FloatArray
    agl_m: FloatArray
    asset: IntArray
    first: IntArray


@dataclass(frozen=True)
class TargetPoints:
    """What is flown at a target: one point, or the vertices of a stretch in the direction flown."""

    target: int
    positions: tuple[LonLat, ...]
    agl_m: float
    task: Task
    asset: int | None


def route_points(
    *, start: LonLat, transit_agl_m: float, targets: Sequence[TargetPoints], ways: PassedNodes, home: LonLat | None
) -> RoutePoints:
    """The points of one route. The first way leads to the first target, and so on; with a home one way more leads there.

    The route begins at transit height above the start, after a vertical climb, and ends above the place where the UAV hovers, lands or
    comes home to; without a home, over the last target. Each target has exactly one point of kind `target`: where it is, or where its
    stretch is entered; the stretch's other vertices are passed and carry the target's index. A target that is inspected from below
    transit height is reached by a vertical descent and left by a vertical climb, so that the UAV is never lower than that between
    targets. Passing the same place twice in a row at the same height is one point.
    """
    stops = [place for stop in targets for place in stop.positions]
    position, agl_m, kind, asset, target, own = _route_points(
        np.array([start, start if home is None else home], dtype=np.float64),
        home is not None,
        float(transit_agl_m),
        ways,
        _Stops(
            np.array(stops, dtype=np.float64).reshape(-1, 2),
            np.array([len(stop.positions) for stop in targets], dtype=np.int64),
            np.array([stop.agl_m for stop in targets], dtype=np.float64),
            np.array([NONE if stop.asset is None else stop.asset for stop in targets], dtype=np.int64),
            np.array([stop.target for stop in targets], dtype=np.int64),
        ),
    )
    task = {place: stop.task for place, stop in zip(own.tolist(), targets, strict=True)}
    return RoutePoints(position, agl_m, kind, asset, target, task)


class _Stops(NamedTuple):
    """The points of targets one after another, and how many each has; its height, asset and number."""

    position: FloatArray
    points: IntArray
    agl_m: FloatArray
    asset: IntArray
    target: IntArray


class _Written(NamedTuple):
    position: FloatArray
    agl_m: FloatArray
    asset: IntArray


@njit(cache=True, nogil=True)
def _route_points(
    ends: FloatArray, comes_home: bool, transit_agl_m: float, passed: PassedNodes, stops: _Stops
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray, IntArray]:
    """Columns as in RoutePoints, and the places of the targets' own points."""
    # a climb before each node, before each stop's entry, and before the end; the stops' own points; start and end
    most = 2 * (len(passed.position) + len(stops.points)) + len(stops.position) + 3
    position, agl_m = np.empty((most, 2)), np.empty(most)
    kind, asset = np.full(most, PASS, dtype=np.int64), np.full(most, NONE, dtype=np.int64)
    target = np.full(most, NONE, dtype=np.int64)
    own = np.empty(len(stops.points), dtype=np.int64)
    written = _Written(position, agl_m, asset)

    position[0, 0], position[0, 1], agl_m[0], kind[0] = ends[0, 0], ends[0, 1], transit_agl_m, START
    at, stop = 1, 0
    for number in range(len(stops.points)):
        for node in range(passed.first[number], passed.first[number + 1]):
            lon, lat = passed.position[node, 0], passed.position[node, 1]
            at = _pass(lon, lat, passed.agl_m[node], passed.asset[node], transit_agl_m, at, written)
        lon, lat, low_m = stops.position[stop, 0], stops.position[stop, 1], stops.agl_m[number]
        at = _pass(lon, lat, max(low_m, transit_agl_m), stops.asset[number], transit_agl_m, at, written)
        if kind[at - 1] == PASS and target[at - 1] == NONE and agl_m[at - 1] == low_m:
            at -= 1  # the target's own point takes its place
        own[number] = at
        for vertex in range(stop, stop + stops.points[number]):
            lon, lat = stops.position[vertex, 0], stops.position[vertex, 1]
            if vertex > stop and _is_at(lon, lat, position, at - 1):
                continue
            position[at, 0], position[at, 1], agl_m[at] = lon, lat, low_m
            kind[at], asset[at], target[at] = TARGET if vertex == stop else PASS, stops.asset[number], stops.target[number]
            at += 1
        stop += stops.points[number]
    if comes_home:
        for node in range(passed.first[-2], passed.first[-1]):
            lon, lat = passed.position[node, 0], passed.position[node, 1]
            at = _pass(lon, lat, passed.agl_m[node], passed.asset[node], transit_agl_m, at, written)
        at = _climb(ends[1, 0], ends[1, 1], transit_agl_m, at, written)
        position[at, 0], position[at, 1], agl_m[at] = ends[1, 0], ends[1, 1], transit_agl_m
    else:
        position[at, 0], position[at, 1], agl_m[at] = position[at - 1, 0], position[at - 1, 1], agl_m[at - 1]
    kind[at], asset[at] = END, NONE
    at += 1
    return position[:at].copy(), agl_m[:at].copy(), kind[:at].copy(), asset[:at].copy(), target[:at].copy(), own


@njit(cache=True, nogil=True)
def _pass(lon: float, lat: float, passed_agl_m: float, passed_asset: int, transit_agl_m: float, at: int, written: _Written) -> int:
    """Put in a point that is passed outside targets, unless it repeats the one before; returns how many points there are."""
    position, agl_m, asset = written
    if agl_m[at - 1] == passed_agl_m and _is_at(lon, lat, position, at - 1):
        return at
    at = _climb(lon, lat, transit_agl_m, at, written)
    position[at, 0], position[at, 1], agl_m[at], asset[at] = lon, lat, passed_agl_m, passed_asset
    return at + 1


@njit(cache=True, nogil=True)
def _climb(lon: float, lat: float, transit_agl_m: float, at: int, written: _Written) -> int:
    """Before the way leads on from a low target to somewhere else, rise above it; returns how many points there are."""
    position, agl_m, asset = written
    if agl_m[at - 1] >= transit_agl_m or _is_at(lon, lat, position, at - 1):
        return at
    position[at, 0], position[at, 1], agl_m[at], asset[at] = position[at - 1, 0], position[at - 1, 1], transit_agl_m, asset[at - 1]
    return at + 1


@njit(cache=True, nogil=True)
def _is_at(lon: float, lat: float, position: FloatArray, place: int) -> bool:
    """Whether the point at this place in the list lies there."""
    return bool(abs(lon - position[place, 0]) <= SAME_PLACE_DEG and abs(lat - position[place, 1]) <= SAME_PLACE_DEG)


def with_short_legs(points: RoutePoints, longest_leg_m: float) -> tuple[RoutePoints, float]:
    """The points, and in between as many more, evenly on the straight lon/lat line, as keep every leg within the longest; and metres."""
    legs, shares, lengths_m = _divisions(points.position, float(longest_leg_m))
    return points.with_points_between(legs, shares) if len(legs) else points, float(lengths_m.sum())


@njit(cache=True, nogil=True)
def _divisions(position: FloatArray, longest_leg_m: float) -> tuple[IntArray, FloatArray, FloatArray]:
    """Where legs are divided, as in with_points_between, and the metres of every leg then."""
    undivided_m = np.empty(max(len(position) - 1, 0))
    more = 0
    for leg in range(len(undivided_m)):
        undivided_m[leg] = short_distance_m(position[leg, 0], position[leg, 1], position[leg + 1, 0], position[leg + 1, 1])
        more += max(math.ceil(undivided_m[leg] / longest_leg_m) - 1, 0)
    legs, shares = np.empty(more, dtype=np.int64), np.empty(more)
    lengths_m = np.empty(len(undivided_m) + more)
    at = count = 0
    for leg in range(len(undivided_m)):
        parts = math.ceil(undivided_m[leg] / longest_leg_m)
        if parts <= 1:
            lengths_m[count] = undivided_m[leg]
            count += 1
            continue
        lon, lat, to_lon, to_lat = position[leg, 0], position[leg, 1], position[leg + 1, 0], position[leg + 1, 1]
        before_lon, before_lat = lon, lat
        for part in range(1, parts + 1):
            next_lon, next_lat = to_lon, to_lat
            if part < parts:
                legs[at], shares[at] = leg, part / parts
                next_lon, next_lat = lon + shares[at] * (to_lon - lon), lat + shares[at] * (to_lat - lat)
                at += 1
            lengths_m[count] = short_distance_m(before_lon, before_lat, next_lon, next_lat)
            count += 1
            before_lon, before_lat = next_lon, next_lat
    return legs, shares, lengths_m


def without_idle_points(waypoints: Waypoints) -> Waypoints:
    """Without what is passed straight above or below where the UAV comes to a place, does something there and leaves it.

    Of points one above another stay the first, the last, and those at which something is done: in between the UAV would go up and down
    for nothing. Heights stay within those of the points that were there.
    """
    points = waypoints.points
    kept = np.ones(len(points), dtype=bool)
    same = np.zeros(len(points) + 1, dtype=bool)  # as the point before
    same[1:-1] = (np.abs(np.diff(points.position, axis=0)) <= SAME_PLACE_DEG).all(axis=1)
    is_idle = (points.kind == PASS) & (points.target == NONE)
    is_idle[list(points.task)] = False
    kept[is_idle & same[:-1] & same[1:]] = False
    where, agl_m, idle = np.cumsum(~same).tolist(), points.agl_m.tolist(), is_idle.tolist()  # points of one place have one number
    before = None  # the last that is kept
    for place in np.flatnonzero(kept).tolist():
        has_repeat = before is not None and where[before] == where[place] and abs(agl_m[before] - agl_m[place]) <= SAME_HEIGHT_M
        if has_repeat and idle[place]:
            kept[place] = False
        elif has_repeat and before is not None and idle[before]:
            kept[before], before = False, place
        else:
            before = place
    if kept.all():
        return waypoints
    number = np.cumsum(kept) - 1
    left = RoutePoints(
        points.position[kept], points.agl_m[kept], points.kind[kept], points.asset[kept], points.target[kept],
        {int(number[place]): task for place, task in points.task.items()},
        {int(number[place]): speed_mps for place, speed_mps in points.speed_mps.items() if kept[place]},
    )  # fmt: skip
    relative_m = left.agl_m if waypoints.relative_m is points.agl_m else waypoints.relative_m[kept]
    return Waypoints(left, None if waypoints.amsl_m is None else waypoints.amsl_m[kept], relative_m)


def line_of(points: RoutePoints) -> NDArray[np.float64]:
    """The route on the map, shape (n, 2), n >= 2: positions without repeated ones; a UAV that stays in its place has it twice."""
    line: NDArray[np.float64] = _without_repeats(points.position)
    return line if len(line) > 1 else np.repeat(line, 2, axis=0)


@njit(cache=True, nogil=True)
def _without_repeats(position: FloatArray) -> FloatArray:
    line = np.empty_like(position)
    count = 0
    for place in range(len(position)):
        lon, lat = position[place, 0], position[place, 1]
        if place == 0 or lon != position[place - 1, 0] or lat != position[place - 1, 1]:
            line[count, 0], line[count, 1] = lon, lat
            count += 1
    return line[:count]
