"""The last look at towers and wires before a plan leaves: no leg passes one too near. Shares no code with the drawing that rises over them.

Legs are straight from waypoint to waypoint in place and height; they are walked in steps, and each step is measured from the wires
beside it, which hang no higher than straight from top to top. Where a UAV takes off and lands is its operator's choice: the columns there
are not looked at.
"""

from weakref import WeakKeyDictionary

import numpy as np
import shapely
from numpy.typing import NDArray

from inspection.geodesy.local_frame import LocalFrame
from inspection.graph.spans import Spans
from missions.flight_plan.heights import GroundHeights
from missions.flight_plan.rules import FlightRules
from missions.flight_plan.waypoints import BASE, FloatArray, RoutePoints, Waypoints

BESIDE_M = 24.0  # across the ground; drawing keeps a little more
STEP_M = 4.0
SHORT_M = 2.0  # by so much a leg may come short of the clearance right over a wire: rounding, steps, a tower come to on a slope
SLOPE = 0.3  # and by that much more for each metre beside it: then it is farther away all the same
SAME_M = 2.0
NEAR_DEG = 0.002

IntArray = NDArray[np.int64]

_by_west: WeakKeyDictionary[Spans, tuple[IntArray, FloatArray, float]] = WeakKeyDictionary()


def spans_too_near(waypoints: Waypoints, spans: Spans, ground_heights_m: GroundHeights | None, rules: FlightRules) -> set[int]:
    """Numbers of the spans that a leg of a finished route passes too near; not those that hang at what it inspects there."""
    points = waypoints.points
    if len(points) < 2 or not len(spans):
        return set()
    near = _rows_near(spans, points.position)
    is_known = waypoints.amsl_m is not None and ground_heights_m is not None
    if not is_known:
        near = near[spans.highest_m[near] + rules.clearance_m - SHORT_M > points.agl_m.min()]
    if not len(near):
        return set()
    frame = LocalFrame.around(*points.position.mean(axis=0).tolist())
    line, start, end = frame.to_metres(points.position), frame.to_metres(spans.start[near]), frame.to_metres(spans.end[near])
    leg, span = _pairs(line, start, end)
    is_flown = (points.kind[leg] != BASE) & (points.kind[leg + 1] != BASE)
    leg, span = leg[is_flown], span[is_flown]
    if not len(leg):
        return set()
    level_m = points.agl_m if waypoints.amsl_m is None or not is_known else waypoints.amsl_m
    top_m = np.column_stack([spans.start_height_m[near], spans.end_height_m[near]])
    if is_known and ground_heights_m is not None:
        used = np.unique(span)
        highest_m = float((level_m - points.agl_m).max())
        for side, places in enumerate((spans.start[near], spans.end[near])):
            told_m = ground_heights_m(places[used])
            top_m[used, side] += np.where(np.isnan(told_m), highest_m, told_m)
    found = set()
    for own_leg, own_span in zip(leg.tolist(), span.tolist(), strict=True):
        if int(near[own_span]) in found or not _is_too_near(line, level_m, own_leg, start[own_span], end[own_span], top_m[own_span], rules):
            continue
        if not _is_inspected(points, line, own_leg, start[own_span], end[own_span]):
            found.add(int(near[own_span]))
    return found


def _rows_near(spans: Spans, position: FloatArray) -> IntArray:
    """Spans of which the box comes near that of the route."""
    if spans not in _by_west:
        west = np.minimum(spans.start[:, 0], spans.end[:, 0])
        order = np.argsort(west, kind="stable")
        _by_west[spans] = order, west[order], float(np.abs(spans.end[:, 0] - spans.start[:, 0]).max())
    order, west, widest = _by_west[spans]
    low, high = position.min(axis=0), position.max(axis=0)
    stretch = max(np.cos(np.radians(np.abs(position[:, 1]).max())), 0.01)
    about = np.array([NEAR_DEG / stretch, NEAR_DEG])
    low, high = low - about, high + about
    rows = order[np.searchsorted(west, low[0] - widest) : np.searchsorted(west, high[0], side="right")]
    start, end = spans.start[rows], spans.end[rows]
    near = (np.maximum(start, end) >= low).all(axis=1) & (np.minimum(start, end) <= high).all(axis=1)
    return rows[near]


def _pairs(line: FloatArray, start: FloatArray, end: FloatArray) -> tuple[IntArray, IntArray]:
    """Legs and spans that come near each other across the ground."""
    span, leg = shapely.STRtree(_drawn(line[:-1], line[1:])).query(_drawn(start, end), predicate="dwithin", distance=BESIDE_M)
    return leg.astype(np.int64), span.astype(np.int64)


def _drawn(start: FloatArray, end: FloatArray) -> NDArray[np.object_]:
    """Lines, and points where one would have no length."""
    drawn: NDArray[np.object_] = np.array(shapely.points(start), dtype=object)
    moves = (start != end).any(axis=1)
    drawn[moves] = shapely.linestrings(np.stack([start[moves], end[moves]], axis=1))
    return drawn


def _is_too_near(
    line: FloatArray, level_m: FloatArray, leg: int, start: FloatArray, end: FloatArray, top_m: FloatArray, rules: FlightRules
) -> bool:
    steps = int(np.ceil(np.hypot(*(line[leg + 1] - line[leg])) / STEP_M)) + 1
    share = np.linspace(0.0, 1.0, max(steps, 2))
    at = line[leg] + share[:, None] * (line[leg + 1] - line[leg])
    along = end - start
    squared = float(along @ along)
    where = np.clip((at - start) @ along / squared, 0.0, 1.0) if squared > 0 else np.zeros(len(at))
    beside_m = np.hypot(*(at - start - where[:, None] * along).T)
    over_m = level_m[leg] + share * (level_m[leg + 1] - level_m[leg]) - (top_m[0] + where * (top_m[1] - top_m[0]))
    return bool(((beside_m <= BESIDE_M) & (over_m < rules.clearance_m - SHORT_M - SLOPE * beside_m)).any())


def _is_inspected(points: RoutePoints, line: FloatArray, leg: int, start: FloatArray, end: FloatArray) -> bool:
    """Whether the leg belongs to a target, or comes down to one or rises from it, at which the span hangs or along which it is flown."""
    target = int(max(points.target[leg], points.target[leg + 1]))
    moves = bool((line[leg] != line[leg + 1]).any())
    if target < 0 or (moves and points.target[leg] != points.target[leg + 1]):
        return False
    places = line[points.target == target]
    hangs = min(float(np.hypot(*(places - place).T).min()) for place in (start, end)) <= SAME_M
    return hangs or bool((shapely.distance(shapely.points(line[leg : leg + 2]), _drawn(start[None], end[None])[0]) <= SAME_M).all())
