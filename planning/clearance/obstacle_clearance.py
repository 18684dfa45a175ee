"""The last look at towers, wires and bridges before a plan leaves: no leg passes one too near. Shares no code with the drawing of rises.

Legs are straight from waypoint to waypoint in place and height; they are walked in steps, and each step is measured from the wires
beside it, which hang no higher than straight from top to top. A flight through photos comes nearer: it keeps its own clearance, from the
wires of its target too, over them or beside them. Where a UAV takes off and lands is its operator's choice: the columns there
are not looked at.
"""

import math
from weakref import WeakKeyDictionary

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.local_frame import LocalFrame
from inspection.network.spans import DECK, Spans
from planning.rules import FlightRules
from planning.trajectory.heights import GroundHeights
from planning.trajectory.photo_flights import clearances_m
from planning.trajectory.waypoints import BASE, NONE, FloatArray, RoutePoints, Waypoints

BESIDE_M = 24.0  # across the ground; drawing keeps a little more
STEP_M, STEPS_BESIDE = 4.0, 5.0  # of a leg; as many at least as fit in what is kept beside a wire
SHORT_M = 2.0  # by so much a leg may come short of the clearance right over a wire: rounding, steps, a tower come to on a slope
SLOPE = 0.3  # and by that much more for each metre beside it: then it is farther away all the same
PHOTO_SHORT_M = 0.5  # the same of a flight through photos, of its own clearance: rounding, and the frames of both
SAME_M = 2.0
NEAR_DEG = 0.002
UNKNOWN_TOP_M = 1e6  # of what stands on ground that is not known: nothing is clear of it

IntArray = NDArray[np.int64]

_by_west: WeakKeyDictionary[Spans, tuple[IntArray, FloatArray, float]] = WeakKeyDictionary()


def spans_too_near(waypoints: Waypoints, spans: Spans, ground_heights_m: GroundHeights | None, rules: FlightRules) -> set[int]:
    """Numbers of the spans that a leg of a finished route passes too near; not those that hang at what it inspects there."""
    return {span for _leg, span in legs_too_near(waypoints, spans, ground_heights_m, rules)}


def legs_too_near(waypoints: Waypoints, spans: Spans, ground_heights_m: GroundHeights | None, rules: FlightRules) -> set[tuple[int, int]]:
    """The same with the leg, by the place of its start, that passes each."""
    points = waypoints.points
    if len(points) < 2 or not len(spans):
        return set()
    is_known = waypoints.amsl_m is not None and ground_heights_m is not None
    near = spans_near(spans, points.position, 0.0 if is_known else float(points.agl_m.min()) - rules.clearance_m + SHORT_M)
    if not len(near):
        return set()
    frame = LocalFrame.around(*points.position.mean(axis=0).tolist())
    line, start, end = frame.to_metres(points.position), frame.to_metres(spans.start[near]), frame.to_metres(spans.end[near])
    leg, span = _pairs(line, start, end, BESIDE_M)
    is_flown = (points.kind[leg] != BASE) & (points.kind[leg + 1] != BASE)
    leg, span = leg[is_flown], span[is_flown]
    if not len(leg):
        return set()
    level_m = points.agl_m if waypoints.amsl_m is None or not is_known else waypoints.amsl_m
    top_m = np.column_stack([spans.start_height_m[near], spans.end_height_m[near]])
    if is_known and ground_heights_m is not None:
        used = np.unique(span)
        top_m[used] = np.nan_to_num(spans.tops_m(near[used], ground_heights_m), nan=UNKNOWN_TOP_M)
    found: set[tuple[int, int]] = set()
    kept_m = clearances_m(points)[leg + 1]
    is_photo = ~np.isnan(kept_m)
    kept = np.column_stack([np.full(len(leg), rules.clearance_m - SHORT_M), np.full(len(leg), SLOPE), np.full(len(leg), BESIDE_M)])
    kept[spans.asset[near[span]] == DECK, 1] = 0.0  # beside a piece of a deck may be the deck
    kept[is_photo] = np.column_stack([kept_m - PHOTO_SHORT_M, np.zeros(len(leg)), kept_m - PHOTO_SHORT_M])[is_photo]
    too_near = _too_near(line, level_m, leg, start[span], end[span], top_m[span], kept)
    for own_leg, own_span, photo in zip(leg[too_near].tolist(), span[too_near].tolist(), is_photo[too_near].tolist(), strict=True):
        if photo or not _is_inspected(points, line, own_leg, start[own_span], end[own_span], int(spans.asset[near[own_span]])):
            found.add((own_leg, int(near[own_span])))
    return found


def spans_near(spans: Spans, position: FloatArray, lowest_m: float) -> IntArray:
    """Spans that are higher, and of which the box comes near that of the route."""
    if spans not in _by_west:
        low, high = np.minimum(spans.start, spans.end), np.maximum(spans.start, spans.end)
        order = np.argsort(low[:, 0], kind="stable")
        boxes = np.ascontiguousarray(np.column_stack([low, high, spans.highest_m])[order])
        _by_west[spans] = order, boxes, float((high - low)[:, 0].max(initial=0.0))
    order, boxes, widest = _by_west[spans]
    low, high = position.min(axis=0), position.max(axis=0)
    stretch = max(np.cos(np.radians(np.abs(position[:, 1]).max())), 0.01)
    about = np.array([NEAR_DEG / stretch, NEAR_DEG])
    chosen: IntArray = order[_boxes_near(boxes, widest, low - about, high + about, lowest_m)]
    return chosen


@njit(cache=True, nogil=True)
def _boxes_near(boxes: FloatArray, widest: float, low: FloatArray, high: FloatArray, lowest_m: float) -> IntArray:
    """Rows of boxes (n, 5): west, south, east, north, height; by their west, none wider than so many degrees."""
    west = boxes[:, 0]
    found = np.empty(64, dtype=np.int64)
    count = 0
    for row in range(np.searchsorted(west, low[0] - widest), np.searchsorted(west, high[0], side="right")):
        if boxes[row, 1] > high[1] or boxes[row, 3] < low[1] or boxes[row, 2] < low[0] or not boxes[row, 4] > lowest_m:
            continue
        if count == len(found):
            found = np.concatenate((found, found))
        found[count] = row
        count += 1
    return found[:count].copy()


@njit(cache=True, nogil=True)
def _pairs(line: FloatArray, start: FloatArray, end: FloatArray, within_m: float) -> tuple[IntArray, IntArray]:
    """Legs and spans that come so near each other across the ground; of each leg only spans that begin beside it in the west are tried."""
    west = np.minimum(start[:, 0], end[:, 0])
    order = np.argsort(west)
    from_west = west[order]
    widest = np.abs(end[:, 0] - start[:, 0]).max()
    legs, spans = np.empty(64, dtype=np.int64), np.empty(64, dtype=np.int64)
    count = 0
    for leg in range(len(line) - 1):
        low_x, high_x = min(line[leg, 0], line[leg + 1, 0]) - within_m, max(line[leg, 0], line[leg + 1, 0]) + within_m
        low_y, high_y = min(line[leg, 1], line[leg + 1, 1]) - within_m, max(line[leg, 1], line[leg + 1, 1]) + within_m
        for place in range(np.searchsorted(from_west, low_x - widest), len(order)):
            span = order[place]
            if west[span] > high_x:
                break
            if max(start[span, 0], end[span, 0]) < low_x or max(start[span, 1], end[span, 1]) < low_y:
                continue
            if min(start[span, 1], end[span, 1]) > high_y:
                continue
            if _apart_squared(line[leg], line[leg + 1], start[span], end[span]) > within_m * within_m:
                continue
            if count == len(legs):
                legs, spans = np.concatenate((legs, legs)), np.concatenate((spans, spans))
            legs[count], spans[count] = leg, span
            count += 1
    return legs[:count].copy(), spans[:count].copy()


@njit(cache=True, nogil=True)
def _apart_squared(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float:
    """Of the lines from a to b and from c to d, (2,) each, either of which may be a point."""
    ways = _side(a, b, c) * _side(a, b, d), _side(c, d, a) * _side(c, d, b)
    if ways[0] < 0.0 and ways[1] < 0.0:
        return 0.0
    return min(min(_beside_squared(a, c, d), _beside_squared(b, c, d)), min(_beside_squared(c, a, b), _beside_squared(d, a, b)))


@njit(cache=True, nogil=True)
def _side(start: FloatArray, end: FloatArray, place: FloatArray) -> float:
    side: float = (end[0] - start[0]) * (place[1] - start[1]) - (end[1] - start[1]) * (place[0] - start[0])
    return side


@njit(cache=True, nogil=True)
def _beside_squared(place: FloatArray, start: FloatArray, end: FloatArray) -> float:
    along_x, along_y = end[0] - start[0], end[1] - start[1]
    off_x, off_y = place[0] - start[0], place[1] - start[1]
    squared = along_x * along_x + along_y * along_y
    share = min(max((off_x * along_x + off_y * along_y) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    squared_m: float = (off_x - share * along_x) ** 2 + (off_y - share * along_y) ** 2
    return squared_m


def lines_between(start: FloatArray, end: FloatArray) -> NDArray[np.object_]:
    """Lines, and points where one would have no length."""
    drawn: NDArray[np.object_] = np.array(shapely.points(start), dtype=object)
    moves = (start != end).any(axis=1)
    drawn[moves] = shapely.linestrings(np.stack([start[moves], end[moves]], axis=1))
    return drawn


@njit(cache=True, nogil=True)
def _too_near(
    line: FloatArray, level_m: FloatArray, leg: IntArray, start: FloatArray, end: FloatArray, top_m: FloatArray, kept: FloatArray
) -> NDArray[np.bool_]:
    """Of pairs of a leg and a wire from start to end, (p, 2) each, between tops (p, 2): whether a step of the leg is too near to it.

    kept (p, 3): the height over the wire [m], how much less of it does for each metre beside it, and how far beside it matters [m].
    """
    too_near = np.zeros(len(leg), dtype=np.bool_)
    for pair in range(len(leg)):
        here, there = leg[pair], leg[pair] + 1
        over_kept_m, slope, beside_kept_m = kept[pair]
        if min(level_m[here], level_m[there]) >= max(top_m[pair, 0], top_m[pair, 1]) + over_kept_m:
            continue
        by_x, by_y = line[there, 0] - line[here, 0], line[there, 1] - line[here, 1]
        along_x, along_y = end[pair, 0] - start[pair, 0], end[pair, 1] - start[pair, 1]
        squared = along_x * along_x + along_y * along_y
        steps = math.ceil(math.hypot(by_x, by_y) / min(STEP_M, beside_kept_m / STEPS_BESIDE)) + 1
        for step in range(steps + 1):
            share = step / steps
            off_x, off_y = line[here, 0] + share * by_x - start[pair, 0], line[here, 1] + share * by_y - start[pair, 1]
            where = min(max((off_x * along_x + off_y * along_y) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
            beside_m = math.hypot(off_x - where * along_x, off_y - where * along_y)
            if beside_m > beside_kept_m:
                continue
            over_m = level_m[here] + share * (level_m[there] - level_m[here]) - top_m[pair, 0] - where * (top_m[pair, 1] - top_m[pair, 0])
            if over_m < over_kept_m - slope * beside_m:
                too_near[pair] = True
                break
    return too_near


def _is_inspected(points: RoutePoints, line: FloatArray, leg: int, start: FloatArray, end: FloatArray, asset: int) -> bool:
    """Whether the leg belongs to a target, or comes down to one or rises from it, at which the span hangs or which lies along it.

    asset: what hangs there. A target on something else that is crossed by it does not lie along it, however near.
    """
    target = int(max(points.target[leg], points.target[leg + 1]))
    moves = bool((line[leg] != line[leg + 1]).any())
    if target < 0 or asset == DECK or (moves and points.target[leg] != points.target[leg + 1]):
        return False
    places = line[points.target == target]
    if min(float(np.hypot(*(places - place).T).min()) for place in (start, end)) <= SAME_M:
        return True
    is_along = asset != NONE and bool((points.asset[points.target == target] == asset).any())
    return is_along and bool(
        (shapely.distance(shapely.points(line[leg : leg + 2]), lines_between(start[None], end[None])[0]) <= SAME_M).all()
    )
