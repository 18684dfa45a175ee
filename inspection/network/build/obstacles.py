"""What cannot be flown over, and so has to be gone round: towers, wires, bridges too tall for the highest flight, or tall under a zone."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
import shapely
from numpy.typing import NDArray

from inspection.network.build.network import Network
from inspection.network.rules import FlownHeights
from inspection.network.spans import BESIDE_M, NO_NODE, hung_between
from inspection.network.zones.zone_index import ZoneIndex, plane_scale

NO_ZONE = -1  # in place of a zone's primary key
WALL = f"the {BESIDE_M:.0f} m around a mast, wires or a bridge that cannot be flown over"
CORNERS = 4  # of a quarter circle
ROUNDER = 1.02  # makes the chords of such a quarter circle clear the true one

FloatArray = NDArray[np.float64]
Geometries = NDArray[np.object_]

_too_tall: WeakKeyDictionary[Network, tuple[FlownHeights, ZoneIndex]] = WeakKeyDictionary()
_with_obstacles: WeakKeyDictionary[ZoneIndex, WeakKeyDictionary[ZoneIndex, ZoneIndex]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class LowCeilings:
    """Spans that can be flown over, but not where a zone hangs over them: walls, and the nodes at their ends."""

    obstacles: ZoneIndex
    node: NDArray[np.int64]


def too_tall_obstacles(network: Network, heights: FlownHeights) -> ZoneIndex:
    """BESIDE_M around what would have to be passed above the highest flight, at all heights; made once for a network."""
    found = _too_tall.get(network)
    if found is None or found[0] != heights:
        found = _too_tall[network] = heights, obstacle_index_of(_obstacles(network, heights))
    return found[1]


def obstacle_index_of(polygons: Geometries) -> ZoneIndex:
    return ZoneIndex(polygons, np.full(len(polygons), NO_ZONE), [WALL] * len(polygons))


def with_obstacles(zones: ZoneIndex, obstacles: ZoneIndex) -> ZoneIndex:
    """Both, the zones first; made once for the two, with what the index works out as it is asked, and kept for as long as both are."""
    if not len(obstacles):
        return zones
    of_zones = _with_obstacles.setdefault(zones, WeakKeyDictionary())
    both = of_zones.get(obstacles)
    if both is None:
        both = of_zones[obstacles] = ZoneIndex(
            np.concatenate([zones.polygons, obstacles.polygons]),
            np.concatenate([zones.ids, obstacles.ids]),
            [*zones.names, *obstacles.names],
            floor_agl_m=np.concatenate([zones.floor_agl_m, obstacles.floor_agl_m]),
            ceiling_agl_m=np.concatenate([zones.ceiling_agl_m, obstacles.ceiling_agl_m]),
        )
    return both


def at_all_heights(zones: ZoneIndex) -> ZoneIndex:
    """The same zones as if they had no bands."""
    return ZoneIndex(zones.polygons, zones.ids, zones.names)


def obstacles_along(start: FloatArray, end: FloatArray, is_round: NDArray[np.bool_]) -> Geometries:
    """BESIDE_M around lines in lon/lat, (n, 2) each, what touches in one piece; round the ends where that is told, (n, 2)."""
    if not len(start):
        return np.zeros(0, dtype=object)
    scale = plane_scale(np.hstack([np.minimum(start, end), np.maximum(start, end)]))
    start_m, end_m = start * scale, end * scale
    pieces: Geometries = np.asarray(shapely.buffer(shapely.linestrings(np.stack([start_m, end_m], axis=1)), BESIDE_M, cap_style="flat"))
    for place_m, side in ((start_m, 0), (end_m, 1)):
        rounded = is_round[:, side]
        caps = shapely.buffer(shapely.points(place_m[rounded]), BESIDE_M * ROUNDER, quad_segs=CORNERS)
        pieces[rounded] = shapely.union(pieces[rounded], caps)
    vertices, owner = shapely.get_coordinates(pieces, return_index=True)
    obstacles: Geometries = shapely.get_parts(shapely.union_all(shapely.set_coordinates(pieces, vertices / scale[owner])))
    return obstacles


def _obstacles(network: Network, heights: FlownHeights) -> Geometries:
    tallest_m = heights.max_agl_m - heights.clearance_m
    hung = hung_between(network, tallest_m)
    heights_m, start, along = hung.heights_m, hung.line[:, 0], hung.line[:, 1] - hung.line[:, 0]
    begin, until = _above(heights_m[:, 0], heights_m[:, 1], tallest_m)
    is_round = np.column_stack([begin == 0.0, until == 1.0])
    return obstacles_along(start + begin[:, None] * along, start + until[:, None] * along, is_round)


def _above(start_m: FloatArray, end_m: FloatArray, limit_m: float) -> tuple[FloatArray, FloatArray]:
    """From and to which share of spans between two heights, of which one is above a limit, they are above it."""
    rise_m = end_m - start_m
    share = (limit_m - start_m) / np.where(rise_m == 0.0, 1.0, rise_m)
    return np.where(start_m > limit_m, 0.0, share), np.where(end_m > limit_m, 1.0, share)


def low_ceilings(network: Network, zones: ZoneIndex, heights: FlownHeights, clearance_m: float) -> LowCeilings:
    """Where a UAV that flies below all zones at transit height would meet one when it rises over a span."""
    aloft = zones.where(zones.floor_agl_m > heights.transit_agl_m + heights.above_m)
    if not len(aloft):
        return NO_CEILINGS
    hung = hung_between(network, heights.transit_agl_m - heights.clearance_m)
    start, end = hung.line[:, 0], hung.line[:, 1]
    high_m = hung.heights_m.max(axis=1, initial=0.0) + heights.clearance_m + heights.above_m
    low_m, wide_m = np.full(len(start), heights.transit_agl_m - heights.below_m), clearance_m + BESIDE_M * ROUNDER
    met, hangs = np.zeros(len(start), dtype=bool), (start != end).any(axis=1)
    met[hangs] = aloft.meets(start[hangs], end[hangs], wide_m, low_m[hangs], high_m[hangs])
    met[~hangs] = aloft.contains(start[~hangs], wide_m, low_m[~hangs], high_m[~hangs])
    obstacles = obstacles_along(start[met], end[met], np.ones((int(met.sum()), 2), dtype=bool))
    nodes = hung.nodes[met]
    return LowCeilings(obstacle_index_of(obstacles), np.unique(nodes[nodes != NO_NODE]))


NO_CEILINGS = LowCeilings(obstacle_index_of(np.zeros(0, dtype=object)), np.zeros(0, dtype=np.int64))
