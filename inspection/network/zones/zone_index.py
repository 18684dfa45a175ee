"""No-fly zones, indexed to be asked whether legs meet them."""

from collections.abc import Sequence
from functools import cached_property
from hashlib import sha256
from threading import Lock
from weakref import WeakKeyDictionary

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely import STRtree
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import LonLat
from inspection.network.inspection_graph import InspectionGraph

CELLS = 512  # along each side
# The fewest metres in a degree of latitude, and of longitude on the equator (WGS84): a clearance is never narrower than asked.
METRES_PER_DEGREE_LAT = 110_574.0
METRES_PER_DEGREE_LON = 111_319.0
MAX_SHRINKING_LAT_DEG = 89.9  # nearer to a pole a degree of longitude no longer shrinks here
CORNER_SEGMENTS = 8  # per quarter circle of a widened corner
CORNER_EXCESS = 1.005  # makes the chords of such a quarter circle clear the true one: 1 / cos(90 deg / 16) = 1.0048

MANY = 5_000  # legs or positions from which on it is worth a coarse look at where they are

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]


class BoxGrid:
    """Boxes (z, 4), west, south, east, north, marked on a grid over all of them; any rectangle of cells is counted by four look-ups."""

    def __init__(self, boxes: FloatArray) -> None:
        self._low, self._high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        self._step = np.maximum(self._high - self._low, 1e-12) / CELLS
        marked = np.zeros((CELLS, CELLS), dtype=np.int32)
        for west, south, east, north in np.hstack([self._cells(boxes[:, :2]), self._cells(boxes[:, 2:])]).tolist():
            marked[west : east + 1, south : north + 1] = 1
        self._until = np.zeros((CELLS + 1, CELLS + 1), dtype=np.int32)
        self._until[1:, 1:] = marked.cumsum(axis=0).cumsum(axis=1)

    def may_meet(self, low: FloatArray, high: FloatArray) -> BoolArray:
        """Whether a box with these corners, each (n, 2), shares a cell with a marked one, touching included."""
        begin, end = self._cells(low), self._cells(high) + 1
        until = self._until
        count = (
            until[end[:, 0], end[:, 1]] - until[begin[:, 0], end[:, 1]] - until[end[:, 0], begin[:, 1]] + until[begin[:, 0], begin[:, 1]]
        )
        is_beside = ((high < self._low) | (low > self._high)).any(axis=1)
        may_meet: BoolArray = (count > 0) & ~is_beside
        return may_meet

    def _cells(self, position: FloatArray) -> NDArray[np.int64]:
        cells: NDArray[np.int64] = np.clip(np.floor((position - self._low) / self._step), 0, CELLS - 1).astype(np.int64)
        return cells


class ZoneIndex:
    """The zones as polygons in the lon/lat plane. A leg is the straight line there; touching a zone is meeting it.

    A zone may have a band of heights above ground: a leg whose heights are told meets only zones that share one of them, else it meets
    all. Threads may share an index. GEOS's prepared polygons are for one thread at a time (two at once crash the process, or get each
    other's answers), so the index asks its own one thread after the other, and hands out none of them.
    """

    def __init__(
        self,
        polygons: Sequence[BaseGeometry] | NDArray[np.object_],
        ids: ArrayLike,
        names: Sequence[str],
        *,
        floor_agl_m: ArrayLike | None = None,
        ceiling_agl_m: ArrayLike | None = None,
    ) -> None:
        """Bands are in metres above the ground under the UAV, shape (z,), both limits included; not given or NaN is without limit."""
        self._polygons: NDArray[np.object_] = np.array(polygons, dtype=object)
        self.ids: NDArray[np.int64] = np.asarray(ids, dtype=np.int64).reshape(-1)
        self.names = tuple(names)
        self.floor_agl_m, self.ceiling_agl_m = _bands(len(self.ids), floor_agl_m, ceiling_agl_m)
        if not len(self._polygons) == len(self.ids) == len(self.names) == len(self.floor_agl_m) == len(self.ceiling_agl_m):
            raise ValueError("polygons, ids, names and bands must be of the same length")
        self._has_bands = bool(np.isfinite(self.floor_agl_m).any() or np.isfinite(self.ceiling_agl_m).any())
        self._parts, self._zone_of_part = shapely.get_parts(self._polygons, return_index=True)
        self._widened: dict[float, tuple[NDArray[np.object_], STRtree]] = {}
        self._grids: dict[float, BoxGrid] = {}
        self._one_thread = Lock()

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def polygons(self) -> NDArray[np.object_]:
        """Copies of the zones: whoever prepares them shares them with no other thread."""
        copies: NDArray[np.object_] = np.asarray(shapely.force_2d(self._polygons), dtype=object)
        return copies

    @property
    def parts(self) -> NDArray[np.object_]:
        """The single polygons of the zones, as `meetings` counts them; copies."""
        copies: NDArray[np.object_] = np.asarray(shapely.force_2d(shapely.get_parts(self._polygons)), dtype=object)
        return copies

    @cached_property
    def wkb(self) -> tuple[bytes, ...]:
        return tuple(shapely.to_wkb(self._polygons).tolist())

    @cached_property
    def digest(self) -> str:
        """Of where the zones are, their bands included: what is cleared of one set is cleared of any with its digest."""
        digest = sha256()
        for floor_m, ceiling_m, wkb in zip(self.floor_agl_m.tolist(), self.ceiling_agl_m.tolist(), self.wkb, strict=True):
            digest.update(f"{floor_m!r} {ceiling_m!r} {len(wkb)} ".encode())
            digest.update(wkb)
        return digest.hexdigest()

    @cached_property
    def identity(self) -> int:
        """Of whose zones they are, and what they are called."""
        return hash((self.ids.tobytes(), self.names))

    def where(self, chosen: ArrayLike) -> "ZoneIndex":
        """The index of some of the zones, chosen by a mask (z,) or by their places, in the order that they have here."""
        chosen = np.asarray(chosen)
        mask = np.zeros(len(self), dtype=bool)
        mask[chosen if chosen.dtype == bool else chosen.astype(np.int64)] = True
        if mask.all():
            return self
        return ZoneIndex(
            self._polygons[mask],
            self.ids[mask],
            [name for name, is_chosen in zip(self.names, mask.tolist(), strict=True) if is_chosen],
            floor_agl_m=self.floor_agl_m[mask],
            ceiling_agl_m=self.ceiling_agl_m[mask],
        )

    def meets(
        self,
        start: ArrayLike,
        end: ArrayLike,
        clearance_m: float = 0.0,
        low_m: ArrayLike | None = None,
        high_m: ArrayLike | None = None,
    ) -> BoolArray:
        """Whether each leg touches a zone or comes nearer to one than the clearance, at a height that the zone's band has.

        start and end have shape (n, 2), columns lon, lat [deg]; one row alone goes with all of the other. Without clearance the answer
        is exact in the plane; with one it errs on the far side by up to 0.5 %, more for a zone that spans many degrees of latitude.
        low_m and high_m, each one number or of shape (n,), are the least and the greatest height above ground of each leg; not given
        or NaN is without limit. A height that only touches a band's limit is in the band.
        """
        start, end = _rows(start), _rows(end)
        met = np.zeros(max(len(start), len(end)) if len(start) and len(end) else 0, dtype=bool)
        if len(self._parts) and len(met) and self._may_meet(start, end, clearance_m):
            leg_index, _ = self._meetings_of_legs(start, end, clearance_m, low_m, high_m)
            met[leg_index] = True
        return met

    def meetings(
        self,
        start: ArrayLike,
        end: ArrayLike,
        clearance_m: float,
        low_m: ArrayLike | None = None,
        high_m: ArrayLike | None = None,
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Which leg meets which of the `parts`, as `meets`: numbers of legs and parts, side by side."""
        start, end = _rows(start), _rows(end)
        if not (len(self._parts) and len(start) and len(end)):
            return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
        return self._meetings_of_legs(start, end, clearance_m, low_m, high_m)

    def contains(
        self, position: ArrayLike, clearance_m: float = 0.0, low_m: ArrayLike | None = None, high_m: ArrayLike | None = None
    ) -> BoolArray:
        """Whether each position, shape (n, 2), lies in a zone, on its border, or nearer to it than the clearance; heights as in `meets`."""
        position = _rows(position)
        inside = np.zeros(len(position), dtype=bool)
        if len(self._parts) and len(position):
            near = self._near(position, position, clearance_m)
            some = slice(None) if near is None else near
            low_m, high_m = _of_some(low_m, some, len(position)), _of_some(high_m, some, len(position))
            point_index, _ = self._meetings(_points(position[some]), clearance_m, low_m, high_m)
            inside[point_index if near is None else near[point_index]] = True
        return inside

    def zone_at(self, position: LonLat, low_m: float | None = None, high_m: float | None = None) -> tuple[int, str] | None:
        """Id and name of the first zone that holds the position, its border included; heights as in `meets`."""
        if not len(self._parts):
            return None
        _, part_index = self._meetings(_points(_rows(position)), 0.0, low_m, high_m)
        return self._describe(self._zone_of_part[part_index].min()) if len(part_index) else None

    def first_met(self, start: LonLat, end: LonLat, low_m: float | None = None, high_m: float | None = None) -> tuple[int, str] | None:
        """Id and name of the zone that the leg meets first on its way; heights as in `meets`."""
        if not len(self._parts):
            return None
        leg = _legs(_rows(start), _rows(end))
        _, part_index = self._meetings(leg, 0.0, low_m, high_m)
        if not len(part_index):
            return None
        shared = shapely.intersection(self._parts[part_index], leg[0])
        way_deg = shapely.distance(shared, _points(_rows(start))[0])
        order = np.lexsort((self._zone_of_part[part_index], way_deg))
        return self._describe(self._zone_of_part[part_index[order[0]]])

    def _describe(self, zone: np.integer) -> tuple[int, str]:
        return int(self.ids[zone]), self.names[int(zone)]

    def _meetings_of_legs(
        self, start: FloatArray, end: FloatArray, clearance_m: float, low_m: ArrayLike | None, high_m: ArrayLike | None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        near = self._near(np.minimum(start, end), np.maximum(start, end), clearance_m)
        if near is None:
            return self._meetings(_legs(start, end), clearance_m, low_m, high_m)
        start, end = np.broadcast_arrays(start, end)
        count = len(start)
        leg_index, part_index = self._meetings(
            _legs(start[near], end[near]), clearance_m, _of_some(low_m, near, count), _of_some(high_m, near, count)
        )
        return near[leg_index], part_index

    def _near(self, low: FloatArray, high: FloatArray, clearance_m: float) -> NDArray[np.intp] | None:
        """Of very many boxes those that a zone may lie in, so that the others need not become shapes; None for few: all may."""
        if len(low) < MANY:
            return None
        with self._one_thread:
            if clearance_m not in self._grids:
                self._grids[clearance_m] = BoxGrid(shapely.bounds(self._widened_by(clearance_m)[0]))
        return np.flatnonzero(self._grids[clearance_m].may_meet(low, high))

    def _meetings(
        self, shapes: NDArray[np.object_], clearance_m: float, low_m: ArrayLike | None, high_m: ArrayLike | None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Pairs (shape, zone part) that touch. Boxes and heights come first; prepared polygons then answer exactly."""
        with self._one_thread:
            parts, tree = self._widened_by(clearance_m)
            shape_index, part_index = tree.query(shapes)
            if self._has_bands:
                is_level = self._are_level(shape_index, self._zone_of_part[part_index], len(shapes), low_m, high_m)
                shape_index, part_index = shape_index[is_level], part_index[is_level]
            touching = shapely.intersects(parts[part_index], shapes[shape_index])
        return shape_index[touching], part_index[touching]

    def _are_level(
        self, shape: NDArray[np.intp], zone: NDArray[np.intp], shapes: int, low_m: ArrayLike | None, high_m: ArrayLike | None
    ) -> BoolArray:
        """Whether shape and zone have a height in common. Said so that NaN, which compares with nothing, has all in common."""
        low = np.broadcast_to(np.asarray(-np.inf if low_m is None else low_m, dtype=np.float64), shapes)[shape]
        high = np.broadcast_to(np.asarray(np.inf if high_m is None else high_m, dtype=np.float64), shapes)[shape]
        are_level: BoolArray = ~((self.floor_agl_m[zone] > high) | (self.ceiling_agl_m[zone] < low))
        return are_level

    def _may_meet(self, start: FloatArray, end: FloatArray, clearance_m: float) -> bool:
        """Whether a zone's box meets that of the legs as a whole: it seldom does."""
        west, south = np.minimum(start.min(axis=0), end.min(axis=0)).tolist()
        east, north = np.maximum(start.max(axis=0), end.max(axis=0)).tolist()
        with self._one_thread:
            _, tree = self._widened_by(clearance_m)
            return bool(len(tree.query(shapely.box(west, south, east, north))))

    def _widened_by(self, clearance_m: float) -> tuple[NDArray[np.object_], STRtree]:
        if clearance_m not in self._widened:
            parts = widen(self._parts, clearance_m) if clearance_m > 0 else self._parts
            shapely.prepare(parts)
            self._widened[clearance_m] = parts, STRtree(parts)
        return self._widened[clearance_m]


def _bands(count: int, floor_agl_m: ArrayLike | None, ceiling_agl_m: ArrayLike | None) -> tuple[FloatArray, FloatArray]:
    """Limits without NaN; a band that is upside down says nothing that could be relied on, and has no limits."""
    floor_m = np.full(count, -np.inf) if floor_agl_m is None else np.array(floor_agl_m, dtype=np.float64).reshape(-1)
    ceiling_m = np.full(count, np.inf) if ceiling_agl_m is None else np.array(ceiling_agl_m, dtype=np.float64).reshape(-1)
    floor_m[np.isnan(floor_m)] = -np.inf
    ceiling_m[np.isnan(ceiling_m)] = np.inf
    if len(floor_m) == len(ceiling_m):
        is_upside_down = floor_m > ceiling_m
        floor_m[is_upside_down], ceiling_m[is_upside_down] = -np.inf, np.inf
    floor_m.setflags(write=False)
    ceiling_m.setflags(write=False)
    return floor_m, ceiling_m


def widen(polygons: NDArray[np.object_], clearance_m: float) -> NDArray[np.object_]:
    """The polygons, wider by at least the clearance on every side, in lon/lat."""
    scale = plane_scale(shapely.bounds(polygons))
    in_metres = _scaled(polygons, scale)
    wider = shapely.buffer(in_metres, clearance_m * CORNER_EXCESS, quad_segs=CORNER_SEGMENTS)
    return _scaled(wider, 1.0 / scale)


def _of_some(limit_m: ArrayLike | None, some: NDArray[np.intp] | slice, count: int) -> FloatArray | None:
    """The limits of some of `count` legs."""
    return None if limit_m is None else np.broadcast_to(np.asarray(limit_m, dtype=np.float64), count)[some]


def plane_scale(bounds: FloatArray) -> FloatArray:
    """The fewest metres in a degree of longitude and of latitude within each box, west, south, east, north: (n, 2)."""
    farthest_lat = np.minimum(np.maximum(np.abs(bounds[:, 1]), np.abs(bounds[:, 3])), MAX_SHRINKING_LAT_DEG)
    return np.column_stack([METRES_PER_DEGREE_LON * np.cos(np.radians(farthest_lat)), np.full(len(bounds), METRES_PER_DEGREE_LAT)])


def _scaled(polygons: NDArray[np.object_], scale: FloatArray) -> NDArray[np.object_]:
    vertices, owner = shapely.get_coordinates(polygons, return_index=True)
    scaled: NDArray[np.object_] = shapely.set_coordinates(polygons.copy(), vertices * scale[owner])
    return scaled


def _rows(positions: ArrayLike) -> FloatArray:
    return np.asarray(positions, dtype=np.float64).reshape(-1, 2)


def _points(positions: FloatArray) -> NDArray[np.object_]:
    return np.asarray(shapely.points(positions), dtype=object)


def _legs(start: FloatArray, end: FloatArray) -> NDArray[np.object_]:
    return np.asarray(shapely.linestrings(np.stack(np.broadcast_arrays(start, end), axis=1)), dtype=object)


_index_of_graph: WeakKeyDictionary[InspectionGraph, ZoneIndex] = WeakKeyDictionary()


def zones_of_graph(graph: InspectionGraph) -> ZoneIndex:
    """The zones that the graph was cleared of; made once per graph."""
    if graph not in _index_of_graph:
        polygons = shapely.from_wkb(np.array(graph.zone_wkb, dtype=object))
        _index_of_graph[graph] = ZoneIndex(polygons, graph.zone_id, graph.zone_name)
    return _index_of_graph[graph]
