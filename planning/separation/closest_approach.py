"""How near two routes come in place and time: the compiled part of keeping UAVs apart.

A route is cut into pieces that are straight in lon/lat, height and time: flying, holding, climbing, hovering. Take a moment s of one
piece and a moment t of another. Where the two UAVs' places then lie within the limits, (s, t) is in a convex set: a rectangle (the pieces'
times), cut by a strip (height) and an ellipse (metres across the ground). The times s - t over that set are one interval, whose ends lie
at the ellipse's own extremes or on an edge of the polygon that rectangle and strip make; both have a closed form.

Pieces of two routes are paired by walking down two trees of boxes, one of each route, that do not lie apart.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.wgs84 import FLATTENING, MAJOR_M

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LON, LAT, HEIGHT, TIME = range(4)  # columns of a piece: these at its start, then again at its end
SIDES = 4
ECCENTRICITY_2 = FLATTENING * (2.0 - FLATTENING)
TOUCHING_M = 1e-6  # UAVs that are just as far apart as they have to be are apart, whatever rounding does to it
EDGE = 1e-9  # of a piece: what rounding may put an extreme outside it
NOTHING = np.inf  # seconds between two routes that share no place
MAX_CORNERS = 8  # of a square cut by a strip


@njit(cache=True, nogil=True)
def metres_per_degree(lat: float) -> tuple[float, float]:
    """East and north, on the ellipsoid's radii of curvature at a latitude [deg]."""
    sine = math.sin(math.radians(lat))
    curvature = 1.0 - ECCENTRICITY_2 * sine * sine
    east = math.radians(MAJOR_M / math.sqrt(curvature)) * max(math.cos(math.radians(lat)), 1e-9)
    return east, math.radians(MAJOR_M * (1.0 - ECCENTRICITY_2) / (curvature * math.sqrt(curvature)))


@njit(cache=True, nogil=True)
def box_tree(pieces: FloatArray) -> FloatArray:
    """Boxes over runs of pieces (n, 8): node 1 holds all, node i those of 2i and 2i + 1, the last half one piece each.

    Shape (2 * leaves, 8): least lon, lat, height, time, then the greatest. An unknown height, NaN, may be any.
    """
    leaves = 1
    while leaves < len(pieces):
        leaves *= 2
    tree = np.empty((2 * leaves, 2 * SIDES))
    tree[:, :SIDES], tree[:, SIDES:] = np.inf, -np.inf
    for number in range(len(pieces)):
        for side in range(SIDES):
            first, last = pieces[number, side], pieces[number, SIDES + side]
            if math.isnan(first) or math.isnan(last):
                tree[leaves + number, side], tree[leaves + number, SIDES + side] = -np.inf, np.inf
            else:
                tree[leaves + number, side], tree[leaves + number, SIDES + side] = min(first, last), max(first, last)
    for node in range(leaves - 1, 0, -1):
        for side in range(SIDES):
            tree[node, side] = min(tree[2 * node, side], tree[2 * node + 1, side])
            tree[node, SIDES + side] = max(tree[2 * node, SIDES + side], tree[2 * node + 1, SIDES + side])
    return tree


@njit(cache=True, nogil=True)
def _are_apart(one: FloatArray, other: FloatArray, margin: FloatArray) -> bool:
    """Whether two boxes lie at least the margins apart in longitude, latitude or height. An empty box is apart from all."""
    return bool(
        one[LON] - other[SIDES + LON] >= margin[LON]
        or other[LON] - one[SIDES + LON] >= margin[LON]
        or one[LAT] - other[SIDES + LAT] >= margin[LAT]
        or other[LAT] - one[SIDES + LAT] >= margin[LAT]
        or one[HEIGHT] - other[SIDES + HEIGHT] >= margin[HEIGHT]
        or other[HEIGHT] - one[SIDES + HEIGHT] >= margin[HEIGHT]
    )


@njit(cache=True, nogil=True)
def _margins(tree: FloatArray, other_tree: FloatArray, lateral_m: float, vertical_m: float) -> FloatArray:
    """The limits in degrees, no smaller than they are anywhere on the two routes, and in metres of height."""
    lat = 0.0
    for box in (tree[1], other_tree[1]):
        lat = max(lat, abs(box[LAT]), abs(box[SIDES + LAT]))
    lat = min(lat + 0.01, 90.0)
    _, north = metres_per_degree(0.0)  # least at the equator
    east, _ = metres_per_degree(lat)
    return np.array([1.001 * lateral_m / east, 1.001 * lateral_m / north, vertical_m])


@njit(cache=True, nogil=True)
def _cut(corners: FloatArray, count: int, at: float, along: float, across: float, limit: float, cut: FloatArray) -> int:
    """Write the part of a convex polygon where at + along * x + across * y <= limit into `cut`; how many corners it has."""
    kept = 0
    for number in range(count):
        here, there = corners[number], corners[(number + 1) % count]
        over = at + along * here[0] + across * here[1] - limit
        next_over = at + along * there[0] + across * there[1] - limit
        if over <= 0.0:
            cut[kept, 0], cut[kept, 1] = here[0], here[1]
            kept += 1
        if (over < 0.0 < next_over) or (next_over < 0.0 < over):
            share = over / (over - next_over)
            cut[kept, 0] = here[0] + share * (there[0] - here[0])
            cut[kept, 1] = here[1] + share * (there[1] - here[1])
            kept += 1
    return kept


@njit(cache=True, nogil=True)
def _corners(h0: float, h1: float, h2: float, vertical_m: float) -> tuple[FloatArray, int]:
    """The polygon of shares a and b of two pieces at which h0 + h1 a + h2 b is within the limit, and how many corners it has.

    All shares where heights cannot be compared: where one is NaN.
    """
    corners = np.empty((MAX_CORNERS, 2))
    corners[0, 0], corners[0, 1], corners[1, 0], corners[1, 1] = 0.0, 0.0, 1.0, 0.0
    corners[2, 0], corners[2, 1], corners[3, 0], corners[3, 1] = 1.0, 1.0, 0.0, 1.0
    count = 4
    if not math.isnan(h0 + h1 + h2) and max(abs(h0), abs(h0 + h1), abs(h0 + h2), abs(h0 + h1 + h2)) > vertical_m:
        lower = np.empty((MAX_CORNERS, 2))
        count = _cut(corners, count, h0, h1, h2, vertical_m, lower)
        count = _cut(lower, count, -h0, -h1, -h2, vertical_m, corners)
    return corners, count


@njit(cache=True, nogil=True)
def gaps(one: FloatArray, other: FloatArray, lateral_m: float, vertical_m: float) -> tuple[float, float, float, float, float, float]:
    """The least and the greatest s - t over moments s of one piece and t of another at which they are within both limits.

    Returns least s - t, its s and t, greatest s - t, its s and t; NOTHING as the least where there are no such moments.
    Metres are taken on a flat frame between the pieces, right to 0.1 % over a few kilometres.
    """
    east_m, north_m = metres_per_degree(0.25 * (one[LAT] + one[SIDES + LAT] + other[LAT] + other[SIDES + LAT]))
    lateral_m, vertical_m = lateral_m - TOUCHING_M, vertical_m - TOUCHING_M
    # The gap across the ground is x0 + x1 a + x2 b east and y0 + y1 a + y2 b north, at the shares a and b of the two pieces.
    x0, y0 = (one[LON] - other[LON]) * east_m, (one[LAT] - other[LAT]) * north_m
    x1, y1 = (one[SIDES + LON] - one[LON]) * east_m, (one[SIDES + LAT] - one[LAT]) * north_m
    x2, y2 = -(other[SIDES + LON] - other[LON]) * east_m, -(other[SIDES + LAT] - other[LAT]) * north_m
    long_s, other_long_s = one[SIDES + TIME] - one[TIME], other[SIDES + TIME] - other[TIME]

    h0, h1, h2 = one[HEIGHT] - other[HEIGHT], one[SIDES + HEIGHT] - one[HEIGHT], other[HEIGHT] - other[SIDES + HEIGHT]
    is_comparable = not math.isnan(h0 + h1 + h2)
    corners, count = _corners(h0, h1, h2, vertical_m)
    least, greatest = np.inf, -np.inf
    at_least, at_greatest = (0.0, 0.0), (0.0, 0.0)
    for number in range(count):
        a, b = corners[number, 0], corners[number, 1]
        along_a, along_b = corners[(number + 1) % count, 0] - a, corners[(number + 1) % count, 1] - b
        east, north = x0 + x1 * a + x2 * b, y0 + y1 * a + y2 * b
        along_east, along_north = x1 * along_a + x2 * along_b, y1 * along_a + y2 * along_b
        square = along_east * along_east + along_north * along_north
        first, last = 0.0, 1.0
        if square > 0.0:
            middle = -(east * along_east + north * along_north) / square
            miss = east * along_north - north * along_east
            under = lateral_m * lateral_m - miss * miss / square
            if under < 0.0:
                continue
            half = math.sqrt(under / square)
            first, last = max(first, middle - half), min(last, middle + half)
            if first > last:
                continue
        elif east * east + north * north > lateral_m * lateral_m:
            continue
        for share in (first, last):
            here_a, here_b = a + share * along_a, b + share * along_b
            apart_s = long_s * here_a - other_long_s * here_b
            if apart_s < least:
                least, at_least = apart_s, (here_a, here_b)
            if apart_s > greatest:
                greatest, at_greatest = apart_s, (here_a, here_b)

    turn = x1 * y2 - x2 * y1
    if abs(turn) > 1e-9 * (math.hypot(x1, y1) * math.hypot(x2, y2)) > 0.0:
        # s - t is linear in the gap on the ground, too; over the circle of the limit it is extreme along its own gradient.
        slope_x, slope_y = (long_s * y2 + other_long_s * y1) / turn, -(long_s * x2 + other_long_s * x1) / turn
        steep = math.hypot(slope_x, slope_y)
        for sign in (-1.0, 1.0):
            east = -x0 + (sign * lateral_m * slope_x / steep if steep > 0.0 else 0.0)
            north = -y0 + (sign * lateral_m * slope_y / steep if steep > 0.0 else 0.0)
            a, b = (east * y2 - north * x2) / turn, (north * x1 - east * y1) / turn
            is_on_both = -EDGE <= a <= 1.0 + EDGE and -EDGE <= b <= 1.0 + EDGE
            if not is_on_both or (is_comparable and abs(h0 + h1 * a + h2 * b) > vertical_m + EDGE):
                continue
            apart_s = long_s * a - other_long_s * b
            if apart_s < least:
                least, at_least = apart_s, (a, b)
            if apart_s > greatest:
                greatest, at_greatest = apart_s, (a, b)
    if least > greatest:
        return NOTHING, 0.0, 0.0, NOTHING, 0.0, 0.0
    begin_s = one[TIME] - other[TIME]
    return (
        begin_s + least,
        one[TIME] + long_s * at_least[0],
        other[TIME] + other_long_s * at_least[1],
        begin_s + greatest,
        one[TIME] + long_s * at_greatest[0],
        other[TIME] + other_long_s * at_greatest[1],
    )


@njit(cache=True, nogil=True)
def _at(piece: FloatArray, time_s: float) -> tuple[float, float, float]:
    """Longitude, latitude and height of a piece at a moment."""
    long_s = piece[SIDES + TIME] - piece[TIME]
    share = (time_s - piece[TIME]) / long_s if long_s > 0.0 else 0.0
    return (
        piece[LON] + share * (piece[SIDES + LON] - piece[LON]),
        piece[LAT] + share * (piece[SIDES + LAT] - piece[LAT]),
        piece[HEIGHT] + share * (piece[SIDES + HEIGHT] - piece[HEIGHT]),
    )


@njit(cache=True, nogil=True)
def _apart(one: FloatArray, other: FloatArray, time_s: float, other_time_s: float) -> tuple[float, float]:
    """Metres across the ground and in height (NaN where not known) between a moment of one piece and one of another."""
    lon, lat, height_m = _at(one, time_s)
    other_lon, other_lat, other_height_m = _at(other, other_time_s)
    east_m, north_m = metres_per_degree(0.5 * (lat + other_lat))
    return math.hypot((lon - other_lon) * east_m, (lat - other_lat) * north_m), abs(height_m - other_height_m)


@njit(cache=True, nogil=True)
def meeting(one: FloatArray, other: FloatArray, vertical_m: float) -> tuple[bool, float]:
    """The moment that both pieces have in common at which they are nearest across the ground, of those at which their heights are near."""
    first, last = max(one[TIME], other[TIME]), min(one[SIDES + TIME], other[SIDES + TIME])
    if first > last:
        return False, 0.0
    lon, lat, height_m = _at(one, first)
    other_lon, other_lat, other_height_m = _at(other, first)
    end_lon, end_lat, end_height_m = _at(one, last)
    other_end_lon, other_end_lat, other_end_height_m = _at(other, last)
    low, high = 0.0, 1.0
    h0, h1 = height_m - other_height_m, (end_height_m - other_end_height_m) - (height_m - other_height_m)
    if not math.isnan(h0 + h1):
        if h1 == 0.0:
            if abs(h0) > vertical_m:
                return False, 0.0
        else:
            one_share, other_share = (-vertical_m - h0) / h1, (vertical_m - h0) / h1
            low, high = max(low, min(one_share, other_share)), min(high, max(one_share, other_share))
            if low > high:
                return False, 0.0
    east_m, north_m = metres_per_degree(0.5 * (lat + other_lat))
    x0, y0 = (lon - other_lon) * east_m, (lat - other_lat) * north_m
    x1, y1 = (end_lon - other_end_lon) * east_m - x0, (end_lat - other_end_lat) * north_m - y0
    square = x1 * x1 + y1 * y1
    share = min(max(-(x0 * x1 + y0 * y1) / square, low), high) if square > 0.0 else low
    return True, first + share * (last - first)


@njit(cache=True, nogil=True)
def _wait_s(one: FloatArray, other: FloatArray) -> float:
    """Seconds between two boxes in time; 0 where they overlap."""
    return float(max(0.0, one[TIME] - other[SIDES + TIME], other[TIME] - one[SIDES + TIME]))


@njit(cache=True, nogil=True)
def _split(stack: IntArray, size: int, node: int, other_node: int, leaves: int, other_leaves: int) -> int:
    """Of two boxes, one a node of each tree, halves the one nearer to its root: two pairs more on the stack, and how many it has then."""
    splits_other = node >= leaves or (other_node < other_leaves and other_node < node)
    for child in range(1, -1, -1):
        stack[size, 0] = node if splits_other else 2 * node + child
        stack[size, 1] = 2 * other_node + child if splits_other else other_node
        size += 1
    return size


@njit(cache=True, nogil=True)
def nearest(
    pieces: FloatArray,
    tree: FloatArray,
    other_pieces: FloatArray,
    other_tree: FloatArray,
    lateral_m: float,
    vertical_m: float,
    below_s: float,
) -> tuple[float, float, float, float, float, int, int]:
    """Where two routes pass the same place with the least time between, if with less than below_s; then where they are nearest.

    Returns these seconds, metres across the ground, metres of height (NaN where not known), the moments of both, and their pieces;
    NOTHING for the seconds where there is no such place.
    """
    best_s, best_m, best_height_m, best_time_s, best_other_s = NOTHING, np.inf, np.nan, 0.0, 0.0
    best_piece, best_other = -1, -1
    if not len(pieces) or not len(other_pieces):
        return best_s, best_m, best_height_m, best_time_s, best_other_s, best_piece, best_other
    margin = _margins(tree, other_tree, lateral_m, vertical_m)
    leaves, other_leaves = len(tree) // 2, len(other_tree) // 2
    stack = np.empty((256, 2), dtype=np.int64)
    stack[0, 0], stack[0, 1] = 1, 1
    size = 1
    while size:
        size -= 1
        node, other_node = stack[size, 0], stack[size, 1]
        box, other_box = tree[node], other_tree[other_node]
        wait_s = _wait_s(box, other_box)
        if wait_s >= below_s or wait_s > best_s or _are_apart(box, other_box, margin):
            continue
        if node < leaves or other_node < other_leaves:
            size = _split(stack, size, node, other_node, leaves, other_leaves)
            continue
        piece, other_piece = pieces[node - leaves], other_pieces[other_node - other_leaves]
        low, low_s, low_t, high, high_s, high_t = gaps(piece, other_piece, lateral_m, vertical_m)
        if low == NOTHING:
            continue
        least_s, time_s, other_time_s = (low, low_s, low_t) if low > 0.0 else (-high, high_s, high_t)
        if low <= 0.0 <= high:
            least_s = 0.0
            is_found, moment_s = meeting(piece, other_piece, vertical_m)
            if is_found:
                time_s, other_time_s = moment_s, moment_s
        if least_s >= below_s or least_s > best_s:
            continue
        metres, height_m = _apart(piece, other_piece, time_s, other_time_s)
        if least_s < best_s or metres < best_m:
            best_s, best_m, best_height_m, best_time_s, best_other_s = least_s, metres, height_m, time_s, other_time_s
            best_piece, best_other = node - leaves, other_node - other_leaves
    return best_s, best_m, best_height_m, best_time_s, best_other_s, best_piece, best_other


@njit(cache=True, nogil=True)
def shared_places(
    pieces: FloatArray,
    tree: FloatArray,
    other_pieces: FloatArray,
    other_tree: FloatArray,
    lateral_m: float,
    vertical_m: float,
    time_s: float,
) -> FloatArray:
    """What the second route may not be delayed by against the first: open intervals of seconds, (k, 2), in order and disjoint."""
    found = np.empty((64, 2))
    count = 0
    if len(pieces) and len(other_pieces):
        margin = _margins(tree, other_tree, lateral_m, vertical_m)
        leaves, other_leaves = len(tree) // 2, len(other_tree) // 2
        stack = np.empty((256, 2), dtype=np.int64)
        stack[0, 0], stack[0, 1] = 1, 1
        size = 1
        while size:
            size -= 1
            node, other_node = stack[size, 0], stack[size, 1]
            box, other_box = tree[node], other_tree[other_node]
            if _are_apart(box, other_box, margin):
                continue
            least = box[TIME] - other_box[SIDES + TIME] - time_s
            greatest = box[SIDES + TIME] - other_box[TIME] + time_s
            if count and found[count - 1, 0] <= least and greatest <= found[count - 1, 1]:
                continue
            if node < leaves or other_node < other_leaves:
                size = _split(stack, size, node, other_node, leaves, other_leaves)
                continue
            low, _, _, high, _, _ = gaps(pieces[node - leaves], other_pieces[other_node - other_leaves], lateral_m, vertical_m)
            if low == NOTHING:
                continue
            low, high = low - time_s, high + time_s
            if count and low <= found[count - 1, 1] and high >= found[count - 1, 0]:
                found[count - 1, 0], found[count - 1, 1] = min(found[count - 1, 0], low), max(found[count - 1, 1], high)
                continue
            if count == len(found):
                found = np.append(found, found).reshape(-1, 2)
            found[count, 0], found[count, 1] = low, high
            count += 1
    return _joined(found[:count])


@njit(cache=True, nogil=True)
def _joined(intervals: FloatArray) -> FloatArray:
    """Intervals in order, those that meet made one."""
    order = np.argsort(intervals[:, 0])
    joined = np.empty((len(intervals), 2))
    count = 0
    for number in order:
        first, last = intervals[number, 0], intervals[number, 1]
        if count and first <= joined[count - 1, 1]:
            joined[count - 1, 1] = max(joined[count - 1, 1], last)
        else:
            joined[count, 0], joined[count, 1] = first, last
            count += 1
    return joined[:count].copy()
