"""The areas of bridges as straight pieces that flights pass above: what a node at the centre of a bridge cannot tell.

A deck is level from bank to bank, however deep the valley between. So its height counts from the ground at both ends and at the centre,
and planners take the highest of the three.
"""

import numpy as np
import shapely
from numpy.typing import NDArray

from inspection.network.infrastructure import BridgeOutlines
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import UNTAGGED_HEIGHT_M
from inspection.network.zones.zone_index import plane_scale

OVER_DECK_M = 12.0  # masts of contact wires, lamp posts, vehicles
PYLON_SHARE = 0.25  # of the length of a bridge: pylons, arches and lifts of which no tag states the height, over the deck
RING_M = 25.0  # no place of a deck is farther from a piece: flights keep clear of what is so far beside them
MAX_RINGS = 8
SIMPLER_M = 0.25

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def bridge_heights_m(tagged_m: FloatArray, outlines: BridgeOutlines) -> FloatArray:
    """Return the heights of bridges (n,), NaN where neither a tag nor a tall structure of unknown height tells."""
    heights_m = tagged_m.copy()
    if not len(outlines.area):
        return heights_m
    guessed = np.flatnonzero(np.isnan(tagged_m) & outlines.has_tall_structure)
    if len(guessed):
        _ends, length_m = _axes(_in_metres(outlines.area[guessed])[0])
        heights_m[guessed] = np.maximum(UNTAGGED_HEIGHT_M[NodeKind.BRIDGE], PYLON_SHARE * length_m)
    return heights_m


def decks(centre: FloatArray, tagged_m: FloatArray, outlines: BridgeOutlines) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the pieces of decks: start and end (k, 2, 2), the place from whose ground the height counts (k, 2), the height [m] (k,).

    centre (n, 2) lon, lat [deg]; tagged_m (n,), NaN where not stated. Each edge of an outline, and of rings inside wide ones, comes three
    times, with its height over the centre and over each end of the bridge.
    """
    if not len(outlines.area):
        return np.zeros((0, 2, 2)), np.zeros((0, 2)), np.zeros(0)
    areas, scale = _in_metres(outlines.area)
    ends, _length_m = _axes(areas)
    counted_m = bridge_heights_m(tagged_m, outlines)
    over_centre_m = np.where(np.isnan(counted_m), UNTAGGED_HEIGHT_M[NodeKind.BRIDGE], counted_m)
    over_ends_m = np.where(np.isnan(tagged_m), over_centre_m, np.minimum(over_centre_m, OVER_DECK_M))
    edges, bridge = _edges(areas)
    line = edges / scale[bridge, None]
    from_ends = ends[bridge] / scale[bridge, None]
    ground = np.concatenate([centre[bridge], from_ends[:, 0], from_ends[:, 1]])
    return np.tile(line, (3, 1, 1)), ground, np.concatenate([over_centre_m[bridge], over_ends_m[bridge], over_ends_m[bridge]])


def _in_metres(area: NDArray[np.object_]) -> tuple[NDArray[np.object_], FloatArray]:
    """The areas on planes of their own, and the metres in a degree of longitude and of latitude there (n, 2)."""
    scale = plane_scale(shapely.bounds(area))
    corners, owner = shapely.get_coordinates(area, return_index=True)
    scaled: NDArray[np.object_] = shapely.set_coordinates(area.copy(), corners * scale[owner])
    return scaled, scale


def _axes(area: NDArray[np.object_]) -> tuple[FloatArray, FloatArray]:
    """The ends of the longer axis of each area (n, 2, 2), and its length [m] (n,)."""
    ends = np.empty((len(area), 2, 2))
    for row, box in enumerate(shapely.oriented_envelope(area)):
        corners = shapely.get_coordinates(box)
        if len(corners) < 5:  # a line or a point
            ends[row] = corners[0], corners[-1]
            continue
        middle = (corners[:4] + corners[1:5]) / 2.0
        is_first = np.hypot(*(middle[0] - middle[2])) >= np.hypot(*(middle[1] - middle[3]))
        ends[row] = middle[[0, 2]] if is_first else middle[[1, 3]]
    return ends, np.hypot(*(ends[:, 1] - ends[:, 0]).T)


def _edges(area: NDArray[np.object_]) -> tuple[FloatArray, IntArray]:
    """The edges (k, 2, 2) of outlines and of rings inside them, and the area of each (k,)."""
    found, owner = [], []
    ring, of_ring = shapely.get_parts(shapely.simplify(area, SIMPLER_M), return_index=True)
    for _ in range(MAX_RINGS):
        if not len(ring):
            break
        is_area = shapely.get_type_id(ring) == shapely.GeometryType.POLYGON
        lines = np.where(is_area, shapely.get_exterior_ring(ring), ring)
        corners, line = shapely.get_coordinates(lines, return_index=True)
        follows = np.flatnonzero(line[1:] == line[:-1])
        found.append(np.stack([corners[follows], corners[follows + 1]], axis=1))
        owner.append(of_ring[line[follows]])
        inner = shapely.buffer(ring[is_area], -RING_M)
        ring, part = shapely.get_parts(shapely.simplify(inner, SIMPLER_M), return_index=True)
        of_ring = of_ring[is_area][part]
    return np.concatenate(found), np.concatenate(owner)
