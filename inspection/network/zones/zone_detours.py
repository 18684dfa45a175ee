"""The shortest way round no-fly zones: over the corners of the widened polygons that see one another.

A way is looked for round the zones that are in the way of the straight leg, then round those too that the way found would meet, until
it meets none (Lozano-Pérez and Wesley 1979, with the obstacles taken up as they are met). A way round some of the zones is never longer
than one round more of them, so the first that is clear is the shortest. What is handed out has passed `ZoneIndex.meets` leg by leg.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from threading import Lock
from weakref import WeakKeyDictionary

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import distance_m
from inspection.network.zones.zone_index import METRES_PER_DEGREE_LAT, METRES_PER_DEGREE_LON, ZoneIndex, plane_scale

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

OUTLINE_GAP_M = 0.05  # of an outline from the zone as ZoneIndex widens it
CORNER_GAP_M = 0.25  # of a corner from its outline
CORNER_EXCESS = 1.007  # of an outline's clearance over that of ZoneIndex, whose round corners excel by 1.005
MITRE = 2.0  # how many clearances a corner may stand out; sharper ones are cut off there
MAX_CORNERS = 64  # of one outline: rounder ones are drawn coarser, always on the outer side
COARSER = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05)  # of the outline's breadth
MAX_CORNERS_OF_ALL = 480  # of all outlines of one errand
MAX_ROUNDS = 12
REACH = 0.52  # of the longest way; more than half of it for what a plane does to metres
OUTSIDE = -1  # in place of an outline's number

_Leg = tuple[tuple[float, ...], tuple[float, ...]]  # positions of both ends, the lesser first


@dataclass(frozen=True, eq=False)
class Errand:
    """Ways that are wanted between some places, all flown between the same heights.

    place (s, 2) lon, lat [deg]; pair (p, 2) numbers of places; low_m, high_m above ground, as ZoneIndex.meets takes them.
    """

    place: FloatArray
    pair: IntArray
    low_m: float | None = None
    high_m: float | None = None


@dataclass(frozen=True, eq=False)
class WayRound:
    """bend (b, 2) lon, lat [deg], in order, without the places at both ends; none where the straight leg is clear."""

    bend: FloatArray
    length_m: float


@dataclass(frozen=True, eq=False)
class _Outline:
    """What stands for a part of a zone: side (m, 4), ends lon, lat, lon, lat [deg]; corner (k, 2) just outside."""

    shape: Polygon
    side: FloatArray
    corner: FloatArray


class _Outlines:
    """The outlines of an index's parts, each drawn when it is first in the way."""

    def __init__(self, zones: ZoneIndex) -> None:
        self._parts = zones.parts
        self._drawn: dict[tuple[int, float], _Outline] = {}
        self._one_thread = Lock()

    def of(self, part: int, clearance_m: float, reach: Polygon) -> list[_Outline]:
        """Of the whole part; of one with many corners, what lies in reach, so that it is drawn no coarser than it has to be."""
        whole = self._parts[part]
        scale = plane_scale(shapely.bounds(whole)[None])[0]  # in which ZoneIndex widens it
        if shapely.get_num_coordinates(whole) > MAX_CORNERS and not reach.contains(shapely.box(*whole.bounds)):
            pieces = shapely.get_parts(shapely.intersection(Polygon(whole.exterior), reach))
            return [_outline(piece, clearance_m, scale) for piece in pieces if isinstance(piece, Polygon) and piece.area > 0]
        with self._one_thread:
            if (part, clearance_m) not in self._drawn:
                self._drawn[part, clearance_m] = _outline(whole, clearance_m, scale)
            return [self._drawn[part, clearance_m]]


_outlines_of: WeakKeyDictionary[ZoneIndex, _Outlines] = WeakKeyDictionary()


def ways_round(zones: ZoneIndex, errands: Sequence[Errand], clearance_m: float, longest_m: float) -> list[list[WayRound | None]]:
    """For each pair of each errand the shortest way that keeps the clearance from every zone; None where none is short enough.

    Nor is one found where a place is in a zone, between zones that leave a gap of no more than some clearances, inside of a zone that
    curls round it in more corners than MAX_CORNERS, across the antimeridian, or among more than MAX_CORNERS_OF_ALL corners.
    """
    tasks = [_Task(errand, longest_m) for errand in errands]
    found: list[list[WayRound | None]] = [[None] * len(errand.pair) for errand in errands]
    outlines = _outlines_of.setdefault(zones, _Outlines(zones))
    asked = [(number, task) for number, task in enumerate(tasks) if len(errands[number].pair)]
    for _ in range(MAX_ROUNDS):
        asked = [(number, task) for number, task in asked if task.is_open]
        if not asked:
            break
        tried = [task.legs_to_try() for _, task in asked]
        begin = np.cumsum([0, *map(len, tried)])
        leg = np.concatenate(tried)
        low_m = np.concatenate([np.full(len(legs), task.low_m) for (_, task), legs in zip(asked, tried, strict=True)])
        high_m = np.concatenate([np.full(len(legs), task.high_m) for (_, task), legs in zip(asked, tried, strict=True)])
        met, part = zones.meetings(leg[:, :2], leg[:, 2:], clearance_m, low_m, high_m)
        order = np.argsort(met, kind="stable")
        met, part = met[order], part[order]
        first, last = np.searchsorted(met, begin[:-1]), np.searchsorted(met, begin[1:])
        for (_, task), start, one, end in zip(asked, begin.tolist(), first.tolist(), last.tolist(), strict=False):
            task.learn(met[one:end] - start, part[one:end], outlines, clearance_m)
    for number, task in enumerate(tasks):
        if len(task.errand.pair):
            found[number] = task.ways()
    return _measured(found, errands, longest_m)


class _Task:
    """One errand under way: the outlines known to be in the way, the shortest ways round these, and which of their legs are clear."""

    def __init__(self, errand: Errand, longest_m: float) -> None:
        self.errand, self.longest_m = errand, longest_m
        self.low_m = -np.inf if errand.low_m is None else errand.low_m
        self.high_m = np.inf if errand.high_m is None else errand.high_m
        middle = errand.place.mean(axis=0) if len(errand.place) else np.zeros(2)
        self._scale = np.array([METRES_PER_DEGREE_LON * np.cos(np.radians(middle[1])), METRES_PER_DEGREE_LAT])
        self._parts: dict[int, list[_Outline]] = {}
        self._barred: set[_Leg] = set()
        self._clear: set[_Leg] = set()
        self._point = np.asarray(errand.place, dtype=np.float64)
        pair = errand.pair
        seamless = np.abs(self._point[pair[:, 0], 0] - self._point[pair[:, 1], 0]) <= 180.0
        self._way: list[IntArray | None] = [row if is_usable else None for row, is_usable in zip(pair, seamless.tolist(), strict=True)]
        self._tried: list[_Leg] = []
        self._metres = np.zeros((0, 0))  # between points that see one another
        self._doubted: set[int] = set()  # places nearer to a zone than its outline
        self.is_open = True

    def legs_to_try(self) -> FloatArray:
        """Legs of the ways of now that nobody has looked at, (n, 4)."""
        legs = dict.fromkeys(leg for way in self._way if way is not None for leg in self._legs(way))
        for place in self._doubted:
            legs |= dict.fromkeys(
                leg for other in np.flatnonzero(np.isfinite(self._metres[place])).tolist() for leg in self._legs([place, other])
            )
        self._tried = [leg for leg in legs if leg not in self._clear]
        return np.array(self._tried, dtype=np.float64).reshape(-1, 4)

    def learn(self, met: IntArray, part: IntArray, outlines: _Outlines, clearance_m: float) -> None:
        """Take note of which of these legs meet which parts, and look for ways round them."""
        bad = set(met.tolist())
        self._clear.update(leg for number, leg in enumerate(self._tried) if number not in bad)
        if not bad:
            self.is_open = False
            return
        known, places = set(self._parts), len(self.errand.place)
        of_leg: dict[int, set[int]] = {}
        for leg, one in zip(met.tolist(), part.tolist(), strict=True):
            of_leg.setdefault(leg, set()).add(one)
        for leg, parts in of_leg.items():
            if parts & known:  # one end is a place nearer to the zone than its outline, which therefore is not in the way
                self._barred.add(self._tried[leg])
                self._doubted.update(place for place in range(places) if tuple(self._point[place].tolist()) in self._tried[leg])
        for one in sorted(set(part.tolist()) - known):
            self._parts[one] = outlines.of(one, clearance_m, self._reach())
        self._search()

    def _reach(self) -> Polygon:
        """A box that no way leaves: whoever strays farther than half the longest way from both its ends cannot be back in time."""
        low, high = self.errand.place.min(axis=0), self.errand.place.max(axis=0)
        give = REACH * self.longest_m / self._scale
        return Polygon(shapely.box(*(low - give), *(high + give)))

    def _search(self) -> None:
        outlines = [outline for pieces in self._parts.values() for outline in pieces]
        places = len(self.errand.place)
        corner = np.concatenate([outline.corner for outline in outlines])
        owner = np.repeat(np.arange(len(outlines)), [len(outline.corner) for outline in outlines])
        for number, outline in enumerate(outlines):
            buried = shapely.intersects_xy(outline.shape, corner[:, 0], corner[:, 1]) & (owner != number)
            corner, owner = corner[~buried], owner[~buried]
        if len(corner) > MAX_CORNERS_OF_ALL:
            self._way, self.is_open = [None] * len(self._way), False
            return
        self._point = np.concatenate([np.asarray(self.errand.place, dtype=np.float64), corner])
        within = np.full((len(self._point), len(outlines)), False)
        for number, outline in enumerate(outlines):
            within[:places, number] = shapely.intersects_xy(outline.shape, self.errand.place[:, 0], self.errand.place[:, 1])
        side = np.concatenate([outline.side for outline in outlines])
        side_of = np.repeat(np.arange(len(outlines)), [len(outline.side) for outline in outlines])
        metres = _visible_m(self._point * self._scale, places, within, side * np.tile(self._scale, 2), side_of)
        number_of = {tuple(place): number for number, place in enumerate(self._point.tolist())}
        for one, other in self._barred:
            left, right = number_of.get(one), number_of.get(other)
            if left is not None and right is not None:
                metres[left, right] = metres[right, left] = np.inf
        self._metres = metres
        before = {source: _shortest(metres, int(source), places, self.longest_m) for source in np.unique(self.errand.pair[:, 0]).tolist()}
        self._way = [
            None if way is None else _way_back(before[source], source, sink)
            for way, (source, sink) in zip(self._way, self.errand.pair.tolist(), strict=True)
        ]
        self.is_open = any(way is not None for way in self._way)

    def _legs(self, way: IntArray | list[int]) -> list[_Leg]:
        """Each with its ends in one order: a leg is the same in both directions."""
        places = [tuple(place) for place in self._point[way].tolist()]
        return [(one, other) if one <= other else (other, one) for one, other in pairwise(places)]

    def ways(self) -> list[WayRound | None]:
        """Those of which every leg is known to be clear."""
        return [
            WayRound(self._point[way[1:-1]], 0.0) if way is not None and all(leg in self._clear for leg in self._legs(way)) else None
            for way in self._way
        ]


def _measured(found: list[list[WayRound | None]], errands: Sequence[Errand], longest_m: float) -> list[list[WayRound | None]]:
    """The same ways with their geodesic lengths, without those that are too long."""
    lines = [
        np.concatenate([errand.place[pair[:1]], way.bend, errand.place[pair[1:]]])
        for errand, ways in zip(errands, found, strict=True)
        for pair, way in zip(errand.pair, ways, strict=True)
        if way is not None
    ]
    if not lines:
        return found
    legs_m = distance_m(np.concatenate([line[:-1] for line in lines]), np.concatenate([line[1:] for line in lines]))
    length_m = iter(np.add.reduceat(legs_m, np.cumsum([0, *(len(line) - 1 for line in lines[:-1])])).tolist())
    return [
        [
            None if way is None or (metres := next(length_m)) > longest_m else WayRound(way.bend, metres)
            for way in ways
        ]
        for ways in found
    ]  # fmt: skip


def _outline(part: Polygon, clearance_m: float, scale: FloatArray) -> _Outline:
    """In metres of the scale, (2,) in a degree of longitude and latitude. Without holes: what lies in one cannot get out."""
    in_metres = shapely.transform(Polygon(part.exterior), lambda points: points * scale)
    wide = _widened(in_metres, clearance_m * CORNER_EXCESS + OUTLINE_GAP_M)
    breadth_m = max(wide.bounds[2] - wide.bounds[0], wide.bounds[3] - wide.bounds[1])
    for share in COARSER:
        if len(wide.exterior.coords) - 1 <= MAX_CORNERS:
            break
        give_m = share * breadth_m
        wide = _filled(_widened(wide, give_m).simplify(give_m * 0.99))
    if len(wide.exterior.coords) - 1 > MAX_CORNERS:
        wide = _filled(shapely.convex_hull(wide))
    ring = shapely.get_coordinates(wide.exterior) / scale
    corners = shapely.get_coordinates(shapely.orient_polygons(_widened(wide, CORNER_GAP_M)).exterior)[:-1]
    into, out_of = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    turns_left = into[:, 0] * out_of[:, 1] - into[:, 1] * out_of[:, 0] > 0  # convex: the others are on no shortest way
    return _Outline(Polygon(ring), np.hstack([ring[:-1], ring[1:]]), corners[turns_left] / scale)


def _widened(polygon: Polygon, by_m: float) -> Polygon:
    """Holes that the widening closes or leaves are filled."""
    return _filled(shapely.buffer(polygon, by_m, join_style="mitre", mitre_limit=MITRE))


def _filled(shape: BaseGeometry) -> Polygon:
    if not isinstance(shape, Polygon):
        raise TypeError(shape.geom_type)
    return Polygon(shape.exterior)


def _way_back(before: IntArray, source: int, sink: int) -> IntArray | None:
    if before[sink] < 0:
        return None
    way = [sink]
    while way[-1] != source:
        way.append(int(before[way[-1]]))
    return np.array(way[::-1], dtype=np.int64)


@njit(cache=True, nogil=True)
def _visible_m(point: FloatArray, places: int, within: BoolArray, side: FloatArray, side_of: IntArray) -> FloatArray:
    """Metres between points that see one another, inf where a side lies between them: (n, n). Points are in metres.

    The first `places` points may lie within outlines; the sides of these are not in their way.
    """
    count = len(point)
    metres = np.full((count, count), np.inf)
    for one in range(count):
        for other in range(one + 1, count):
            ax, ay, bx, by = point[one, 0], point[one, 1], point[other, 0], point[other, 1]
            west, east, south, north = min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)
            sees = True
            for edge in range(len(side)):
                cx, cy, dx, dy = side[edge, 0], side[edge, 1], side[edge, 2], side[edge, 3]
                if max(cx, dx) < west or min(cx, dx) > east or max(cy, dy) < south or min(cy, dy) > north:
                    continue
                if (one < places and within[one, side_of[edge]]) or (other < places and within[other, side_of[edge]]):
                    continue
                a_side = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
                b_side = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
                c_side = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
                d_side = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
                if a_side * b_side <= 0 and c_side * d_side <= 0:
                    sees = False
                    break
            if sees:
                metres[one, other] = metres[other, one] = np.hypot(bx - ax, by - ay)
    return metres


@njit(cache=True, nogil=True)
def _shortest(metres: FloatArray, source: int, places: int, longest_m: float) -> IntArray:
    """The point before each on the shortest way from the source, -1 where none leads there; places are no way through."""
    count = len(metres)
    best = np.full(count, np.inf)
    before = np.full(count, -1, dtype=np.int64)
    is_done = np.zeros(count, dtype=np.bool_)
    best[source] = 0.0
    while True:
        nearest = -1
        for point in range(count):
            if not is_done[point] and (nearest < 0 or best[point] < best[nearest]):
                nearest = point
        if nearest < 0 or best[nearest] > longest_m:
            break
        is_done[nearest] = True
        if nearest < places and nearest != source:
            continue
        for point in range(count):
            total = best[nearest] + metres[nearest, point]
            if total < best[point]:
                best[point] = total
                before[point] = nearest
    for point in range(count):
        if not is_done[point]:
            before[point] = -1
    return before
