"""The compiled look at what a route passes: which spans are near which legs, and where these pass them too low."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.network.spans import BESIDE_M, DECK, Spans, cell_of
from inspection.network.zones.zone_index import METRES_PER_DEGREE_LAT, METRES_PER_DEGREE_LON
from planning.trajectory.waypoints import NONE, FloatArray, IntArray

AT_M = 1.0  # rounding of positions
SLACK_M = 0.5
GENTLE = 0.25  # so steeply a UAV may come to a tower over whose top it is high enough: it keeps 97 % of its clearance on the way

BoolArray = NDArray[np.bool_]


class _Columns(NamedTuple):
    """Spans as compiled code reads them; see Spans."""

    start: FloatArray
    stop: FloatArray
    highest_m: FloatArray
    asset: IntArray
    low: FloatArray
    step: FloatArray
    shape: IntArray
    first: NDArray[np.int32]
    member: NDArray[np.int32]


def legs_beside(
    position: FloatArray, level_m: FloatArray, own: IntArray, asset: IntArray, clearance_m: float, spans: Spans
) -> tuple[IntArray, IntArray]:
    """Legs, by the places of their starts, and the spans within BESIDE_M of each that may be too high for it.

    position (n, 2), level_m (n,), own, asset (n,): the target that is inspected at each point and what it lies on, NONE for none. With
    a clearance levels count from flat ground, and what they clear everywhere is left out; with inf all heights may be too high.
    """
    return _legs_beside(_Points(position, level_m, own, asset), clearance_m, _columns(spans))


def points_beside(
    position: FloatArray, level_m: FloatArray, own: IntArray, asset: IntArray, clearance_m: float, spans: Spans
) -> tuple[IntArray, IntArray]:
    """The same for points over or under which the route goes straight up or down."""
    return _points_beside(_Points(position, level_m, own, asset), clearance_m, _columns(spans))


def stretches_too_low(
    position: FloatArray, level_m: FloatArray, place: IntArray, is_leg: BoolArray, span: IntArray, least_m: FloatArray, spans: Spans
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Of pairs of a leg, or a point, and a span, (p,), where it is too low: pair, from and to as shares of the leg, and the level.

    least_m (p, 2): how high it is to be over the span's start and over its end, clearance included.
    """
    return _stretches_too_low(position, level_m, place, is_leg, span, least_m, spans.start, spans.end)


def _columns(spans: Spans) -> _Columns:
    return _Columns(spans.start, spans.end, spans.highest_m, spans.asset, spans.low, spans.step, spans.shape, spans.first, spans.member)


@njit(cache=True, nogil=True)
def _metres_east(lat: float) -> float:
    return METRES_PER_DEGREE_LON * math.cos(math.radians(lat))


@njit(cache=True, nogil=True)
def _clipped(low: float, high: float, offset: float, slope: float, least: float, most: float) -> tuple[float, float]:
    """Of the shares from low to high those where offset + share * slope lies between two values; low above high for none."""
    if slope == 0.0:
        return (low, high) if least <= offset <= most else (1.0, 0.0)
    one, other = (least - offset) / slope, (most - offset) / slope
    return max(low, min(one, other)), min(high, max(one, other))


@njit(cache=True, nogil=True)
def _within(east: float, north: float, start_x: float, start_y: float, end_x: float, end_y: float, radius_m: float) -> tuple[float, float]:
    """The shares of a leg by (east, north) within the radius of a span, whose ends count from the leg's start; none: first above second."""
    first, last = 1.0, 0.0
    squared = east * east + north * north
    for side in range(2):  # within the radius of an end
        off_x, off_y = (-start_x, -start_y) if side == 0 else (-end_x, -end_y)
        half_b, rest = east * off_x + north * off_y, off_x * off_x + off_y * off_y - radius_m * radius_m
        if squared == 0.0:
            if rest <= 0.0:
                return 0.0, 1.0
            continue
        root = half_b * half_b - squared * rest
        if root >= 0.0:
            low, high = (-half_b - math.sqrt(root)) / squared, (-half_b + math.sqrt(root)) / squared
            low, high = max(low, 0.0), min(high, 1.0)
            if low <= high:
                first, last = (low, high) if first > last else (min(first, low), max(last, high))
    length = math.hypot(end_x - start_x, end_y - start_y)
    if length > 0.0:  # or beside it
        along_x, along_y = (end_x - start_x) / length, (end_y - start_y) / length
        off_x, off_y = -start_x, -start_y
        low, high = _clipped(0.0, 1.0, off_x * along_x + off_y * along_y, east * along_x + north * along_y, 0.0, length)
        low, high = _clipped(low, high, off_y * along_x - off_x * along_y, north * along_x - east * along_y, -radius_m, radius_m)
        if low <= high:
            first, last = (low, high) if first > last else (min(first, low), max(last, high))
    return first, last


@njit(cache=True, nogil=True)
def _is_own(
    target: int, begin: int, end: int, position: FloatArray, own: IntArray, start: FloatArray, stop: FloatArray, is_along: bool
) -> bool:
    """Whether a span hangs at what the target's points, around those from begin to end, inspect; or they follow it.

    is_along: whether the target lies on what hangs there. Over a tower that stands under the wires of another line it does not.
    """
    east_m = _metres_east(position[begin, 1])
    follows = is_along
    for place in range(begin, end + 1):
        x, y = position[place, 0], position[place, 1]
        low, high = _within(
            0.0, 0.0,
            (start[0] - x) * east_m, (start[1] - y) * METRES_PER_DEGREE_LAT, (stop[0] - x) * east_m, (stop[1] - y) * METRES_PER_DEGREE_LAT,
            AT_M,
        )  # fmt: skip
        follows = follows and low <= high
    if follows:
        return True
    first, last = begin, end
    while first > 0 and own[first - 1] == target:
        first -= 1
    while last + 1 < len(own) and own[last + 1] == target:
        last += 1
    for place in range(first, last + 1):
        for side in range(2):
            lon, lat = (start[0], start[1]) if side == 0 else (stop[0], stop[1])
            if math.hypot((lon - position[place, 0]) * east_m, (lat - position[place, 1]) * METRES_PER_DEGREE_LAT) <= AT_M:
                return True
    return False


class _Points(NamedTuple):
    """Waypoints: lon, lat [deg], height of each, the target that it is a point of and its asset, NONE for none."""

    position: FloatArray
    level_m: FloatArray
    own: IntArray
    asset: IntArray


@njit(cache=True, nogil=True)
def _beside(begin: int, end: int, points: _Points, clearance_m: float, on: _Columns, found: list[int]) -> None:
    """Puts the spans beside the leg between two points, or at one, behind those found."""
    position, level_m, own, asset = points
    start, stop, low, step, shape = on.start, on.stop, on.low, on.step, on.shape
    lat = 0.5 * (position[begin, 1] + position[end, 1])
    east_m = _metres_east(lat)
    wide, tall = BESIDE_M / max(east_m, 1.0), BESIDE_M / METRES_PER_DEGREE_LAT
    west, east = min(position[begin, 0], position[end, 0]) - wide, max(position[begin, 0], position[end, 0]) + wide
    south, north = min(position[begin, 1], position[end, 1]) - tall, max(position[begin, 1], position[end, 1]) + tall
    column, row = cell_of(west, south, low, step, shape)
    last_column, last_row = cell_of(east, north, low, step, shape)
    x, y = position[begin, 0], position[begin, 1]
    by_x, by_y = (position[end, 0] - x) * east_m, (position[end, 1] - y) * METRES_PER_DEGREE_LAT
    lowest_m = min(level_m[begin], level_m[end])
    for own_row in range(row, last_row + 1):
        for own_column in range(column, last_column + 1):
            cell = own_row * shape[0] + own_column
            for number in range(on.first[cell], on.first[cell + 1]):
                span = int(on.member[number])
                if on.highest_m[span] + clearance_m <= lowest_m + SLACK_M:
                    continue
                span_west, span_south = min(start[span, 0], stop[span, 0]), min(start[span, 1], stop[span, 1])
                if span_west > east or span_south > north or max(start[span, 0], stop[span, 0]) < west:
                    continue
                if max(start[span, 1], stop[span, 1]) < south:
                    continue
                span_column, span_row = cell_of(span_west, span_south, low, step, shape)
                if own_column != max(column, span_column) or own_row != max(row, span_row):
                    continue  # told of in another cell
                share, until = _within(
                    by_x, by_y,
                    (start[span, 0] - x) * east_m, (start[span, 1] - y) * METRES_PER_DEGREE_LAT,
                    (stop[span, 0] - x) * east_m, (stop[span, 1] - y) * METRES_PER_DEGREE_LAT,
                    BESIDE_M,
                )  # fmt: skip
                if share > until:
                    continue
                target = own[begin]
                if target != NONE and target == own[end] and on.asset[span] != DECK:
                    is_along = asset[begin] != NONE and asset[begin] == on.asset[span]
                    if _is_own(target, begin, end, position, own, start[span], stop[span], is_along):
                        continue
                found.append(span)


@njit(cache=True, nogil=True)
def _legs_beside(points: _Points, clearance_m: float, on: _Columns) -> tuple[IntArray, IntArray]:
    position = points.position
    legs, found = [0 for _ in range(0)], [0 for _ in range(0)]
    for leg in range(len(position) - 1):
        if position[leg, 0] == position[leg + 1, 0] and position[leg, 1] == position[leg + 1, 1]:
            continue
        _beside(leg, leg + 1, points, clearance_m, on, found)
        while len(legs) < len(found):
            legs.append(leg)
    return np.array(legs, dtype=np.int64), np.array(found, dtype=np.int64)


@njit(cache=True, nogil=True)
def _points_beside(points: _Points, clearance_m: float, on: _Columns) -> tuple[IntArray, IntArray]:
    position = points.position
    numbers, found = [0 for _ in range(0)], [0 for _ in range(0)]
    for point in range(len(position)):
        is_column = False
        for other in (point - 1, point + 1):
            if 0 <= other < len(position):
                is_column = is_column or (position[point, 0] == position[other, 0] and position[point, 1] == position[other, 1])
        if is_column:
            _beside(point, point, points, clearance_m, on, found)
        while len(numbers) < len(found):
            numbers.append(point)
    return np.array(numbers, dtype=np.int64), np.array(found, dtype=np.int64)


@njit(cache=True, nogil=True)
def _stretches_too_low(
    position: FloatArray,
    level_m: FloatArray,
    place: IntArray,
    is_leg: BoolArray,
    span: IntArray,
    least_m: FloatArray,
    start: FloatArray,
    stop: FloatArray,
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    most = 3 * len(place)  # beside the start, the span and the end
    pair, begin, until, needed_m = np.empty(most, dtype=np.int64), np.empty(most), np.empty(most), np.empty(most)
    count = 0
    for number in range(len(place)):
        here, own = place[number], span[number]
        there = here + 1 if is_leg[number] else here
        east_m = _metres_east(0.5 * (position[here, 1] + position[there, 1]))
        x, y = position[here, 0], position[here, 1]
        by_x, by_y = (position[there, 0] - x) * east_m, (position[there, 1] - y) * METRES_PER_DEGREE_LAT
        from_x, from_y = (start[own, 0] - x) * east_m, (start[own, 1] - y) * METRES_PER_DEGREE_LAT
        to_x, to_y = (stop[own, 0] - x) * east_m, (stop[own, 1] - y) * METRES_PER_DEGREE_LAT
        first, last = _within(by_x, by_y, from_x, from_y, to_x, to_y, BESIDE_M)
        if first > last:
            continue
        # Where on the span the nearest place to each share of the leg is: at `offset` plus share times `slope`, no farther than its ends.
        squared = (to_x - from_x) ** 2 + (to_y - from_y) ** 2
        offset = slope = 0.0
        if squared > 0.0:
            offset = -(from_x * (to_x - from_x) + from_y * (to_y - from_y)) / squared
            slope = (by_x * (to_x - from_x) + by_y * (to_y - from_y)) / squared
        rise_m = level_m[there] - level_m[here]
        is_gentle = abs(rise_m) <= GENTLE * math.hypot(by_x, by_y)
        for part in range(3):
            if not is_leg[number]:
                low, high = (0.0, 0.0) if part == 1 else (1.0, 0.0)
            elif squared == 0.0:
                low, high = (first, last) if part == 0 else (1.0, 0.0)
            elif part == 0:
                low, high = _clipped(first, last, offset, slope, -np.inf, 0.0)
            elif part == 1:
                low, high = _clipped(first, last, offset, slope, 0.0, 1.0)
            else:
                low, high = _clipped(first, last, offset, slope, 1.0, np.inf)
            if low > high:
                continue
            if part != 1 and is_gentle:
                end_x, end_y, end_m = (from_x, from_y, least_m[number, 0]) if part == 0 else (to_x, to_y, least_m[number, 1])
                at_start = math.hypot(end_x, end_y) <= AT_M and level_m[here] >= end_m - SLACK_M
                at_end = math.hypot(end_x - by_x, end_y - by_y) <= AT_M and level_m[there] >= end_m - SLACK_M
                if at_start or at_end:
                    continue
            low_at, high_at = min(max(offset + low * slope, 0.0), 1.0), min(max(offset + high * slope, 0.0), 1.0)
            low_m = least_m[number, 0] + low_at * (least_m[number, 1] - least_m[number, 0])
            high_m = least_m[number, 0] + high_at * (least_m[number, 1] - least_m[number, 0])
            if level_m[here] + low * rise_m >= low_m - SLACK_M and level_m[here] + high * rise_m >= high_m - SLACK_M:
                continue
            pair[count], begin[count], until[count], needed_m[count] = number, low, high, max(low_m, high_m)
            count += 1
    return pair[:count].copy(), begin[:count].copy(), until[:count].copy(), needed_m[:count].copy()
