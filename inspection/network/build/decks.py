"""The areas of bridges as straight pieces that flights pass above: what a node at the centre of a bridge cannot tell.

A deck is level from bank to bank, however deep the valley between. So its height counts from the ground at the centre and from the highest
ground at the corners of its outline; bridges that touch each other, as a viaduct that is mapped in parts does, share their corners.
"""

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from inspection.network.build.edges import component_labels
from inspection.network.infrastructure import BridgeOutlines
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import UNTAGGED_HEIGHT_M
from inspection.network.zones.zone_index import plane_scale

OVER_DECK_M = 12.0  # masts of contact wires, lamp posts, vehicles
OVER_BANKS_M = 20.0  # without a stated height: the same, and a ramp that terrain data lack
MAX_OVER_DECK_M = 300.0  # of pylons of unknown height
RING_M = 8.0  # no place of a deck is farther from a piece
MAX_RINGS = 50
SIMPLER_M, BANK_SIMPLER_M = 0.25, 2.0  # of pieces, and of corners at the banks: a bend loses its smooth corners, not its ends
MAX_CORNERS = 400  # of a bridge; of one with more the convex hull counts
MAX_BANK_CORNERS = 16  # of a bridge
TOUCHING_M, OVERLAP = 2.0, 0.2  # of bridges that continue each other: across the ground, and the share of the smaller that both cover

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Decks(NamedTuple):
    """k pieces of b bridges, whose banks are in groups: a piece of one that is too low counts as high as the banks of its whole group.

    line (k, 2, 2) from lon, lat [deg] to lon, lat; bridge (k,); of bridges centre (b, 2), over_centre_m (b,) from the ground there,
    over_banks_m (b,) from the highest ground at the corners of the group (b,); corner (p, 2) of corner_group (p,), in their order, the
    two that are farthest apart first of each group.
    """

    line: FloatArray
    bridge: IntArray
    centre: FloatArray
    over_centre_m: FloatArray
    over_banks_m: FloatArray
    group: IntArray
    corner: FloatArray
    corner_group: IntArray


NO_DECKS = Decks(
    np.zeros((0, 2, 2)), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64),
    np.zeros((0, 2)), np.zeros(0, dtype=np.int64),
)  # fmt: skip


def bridge_heights_m(tagged_m: FloatArray, outlines: BridgeOutlines) -> FloatArray:
    """Return the heights of bridges (n,), NaN where neither a tag nor a tall structure of unknown height tells."""
    heights_m = tagged_m.copy()
    guessed = np.flatnonzero(np.isnan(tagged_m[: len(outlines.area)]) & (outlines.tall_share > 0.0) & _is_drawn(outlines.area))
    if len(guessed):
        part, owner = shapely.get_parts(_in_metres(outlines.area[guessed])[0], return_index=True)
        length_m = np.zeros(len(guessed))
        np.maximum.at(length_m, owner, _lengths_m(part))
        share_m = np.minimum(outlines.tall_share[guessed] * length_m, MAX_OVER_DECK_M)
        heights_m[guessed] = np.maximum(UNTAGGED_HEIGHT_M[NodeKind.BRIDGE], share_m)
    return heights_m


def decks(centre: FloatArray, tagged_m: FloatArray, outlines: BridgeOutlines) -> Decks:
    """Return the pieces of decks. centre (n, 2) lon, lat [deg]; tagged_m (n,), NaN where not stated."""
    rows = np.flatnonzero(_is_drawn(outlines.area))
    if not len(rows):
        return NO_DECKS
    counted_m, tagged_m = bridge_heights_m(tagged_m, outlines)[rows], tagged_m[rows]
    over_centre_m = np.where(np.isnan(counted_m), UNTAGGED_HEIGHT_M[NodeKind.BRIDGE], counted_m)
    guessed_m = np.fmax(OVER_BANKS_M, np.where(outlines.tall_share[rows] > 0.0, counted_m, np.nan))
    over_banks_m = np.where(np.isnan(tagged_m), guessed_m, np.minimum(over_centre_m, OVER_DECK_M))
    area = _sound(outlines.area[rows])
    areas, scale = _in_metres(area)
    edges, bridge = _edges(areas)
    group = _groups(area)
    corner, owner = _bank_corners(areas)
    corner, corner_group = _by_group(corner / scale[owner], group[owner])
    return Decks(edges / scale[bridge, None], bridge, centre[rows], over_centre_m, over_banks_m, group, corner, corner_group)


def _is_drawn(area: NDArray[np.object_]) -> NDArray[np.bool_]:
    """Whether each has an area or a line at all; a point is its node alone."""
    if not len(area):
        return np.zeros(0, dtype=bool)
    is_finite = np.asarray(np.isfinite(shapely.bounds(area)).all(axis=1), dtype=bool)
    return is_finite & ~shapely.is_empty(area) & (shapely.length(area) > 0.0)


def _sound(area: NDArray[np.object_]) -> NDArray[np.object_]:
    """The areas, and the convex hulls of those that are not valid or have very many corners: to mend them may take minutes."""
    is_sound = shapely.is_valid(area) & (shapely.get_num_coordinates(area) <= MAX_CORNERS)
    sound: NDArray[np.object_] = np.where(is_sound, area, shapely.convex_hull(area))
    return sound


def _in_metres(area: NDArray[np.object_]) -> tuple[NDArray[np.object_], FloatArray]:
    """The areas on planes of their own, and the metres in a degree of longitude and of latitude there (n, 2)."""
    area = shapely.force_2d(area)
    scale = plane_scale(shapely.bounds(area))
    corners, owner = shapely.get_coordinates(area, return_index=True)
    scaled: NDArray[np.object_] = shapely.set_coordinates(area.copy(), corners * scale[owner])
    return scaled, scale


def _lengths_m(part: NDArray[np.object_]) -> FloatArray:
    """The longer side of the smallest rectangle around each."""
    found = np.zeros(len(part))
    for row, box in enumerate(shapely.oriented_envelope(part)):
        sides = np.diff(shapely.get_coordinates(box), axis=0)
        found[row] = np.hypot(*sides.T).max(initial=0.0)
    return found


def _edges(area: NDArray[np.object_]) -> tuple[FloatArray, IntArray]:
    """The edges (k, 2, 2) of outlines, of holes in them and of rings inside them, and the area of each (k,)."""
    found, owner = [np.zeros((0, 2, 2))], [np.zeros(0, dtype=np.int64)]
    part, of_part = shapely.get_parts(shapely.simplify(area, SIMPLER_M), return_index=True)
    for _ in range(MAX_RINGS):
        if not len(part):
            break
        is_area = shapely.get_type_id(part) == shapely.GeometryType.POLYGON
        lines, of_line = shapely.get_parts(np.where(is_area, shapely.boundary(part), part), return_index=True)
        corners, line = shapely.get_coordinates(lines, return_index=True)
        follows = np.flatnonzero(line[1:] == line[:-1])
        found.append(np.stack([corners[follows], corners[follows + 1]], axis=1))
        owner.append(of_part[of_line[line[follows]]])
        inner = shapely.simplify(shapely.buffer(part[is_area], -RING_M, quad_segs=2), SIMPLER_M)
        part, of_inner = shapely.get_parts(inner, return_index=True)
        of_part = of_part[is_area][of_inner]
    return np.concatenate(found), np.concatenate(owner)


def _groups(area: NDArray[np.object_]) -> IntArray:
    """The number (n,) of each bridge's group: of those that touch, and do not cross one above the other."""
    scale = plane_scale(shapely.bounds(area))
    lonlat_deg = TOUCHING_M / scale.min(axis=1)
    tree = shapely.STRtree(area)
    pair = tree.query(area, predicate="dwithin", distance=lonlat_deg)
    one, other = pair[:, pair[0] < pair[1]]
    if len(one):
        size = np.maximum(np.minimum(shapely.area(area[one]), shapely.area(area[other])), 1e-18)
        both = shapely.intersection(area[one], area[other])
        joins = shapely.area(both) <= OVERLAP * size
        one, other = one[joins], other[joins]
    _, label = component_labels(len(area), np.column_stack([one, other]).astype(np.int64))
    return np.asarray(label, dtype=np.int64)


def _bank_corners(area: NDArray[np.object_]) -> tuple[FloatArray, IntArray]:
    """Corners (p, 2) of the convex hull of each area, at most MAX_BANK_CORNERS, and the area of each (p,)."""
    corners, owner = shapely.get_coordinates(shapely.simplify(shapely.convex_hull(area), BANK_SIMPLER_M), return_index=True)
    first = np.searchsorted(owner, owner)
    count = np.bincount(owner, minlength=len(area))[owner]
    step = np.maximum(np.ceil(count / MAX_BANK_CORNERS), 1.0)
    kept = (np.arange(len(owner)) - first) % step == 0.0
    return corners[kept], owner[kept].astype(np.int64)


def _by_group(corner: FloatArray, group: IntArray) -> tuple[FloatArray, IntArray]:
    """The corners in the order of their groups, the two that are farthest apart first of each."""
    order = np.argsort(group, kind="stable")
    corner, group = corner[order].copy(), group[order]
    begin = np.flatnonzero(np.r_[True, group[1:] != group[:-1]]).tolist()
    for first, end in zip(begin, [*begin[1:], len(group)], strict=True):
        own = corner[first:end]
        far = int(np.hypot(*(own - own.mean(axis=0)).T).argmax())
        own[[0, far]] = own[[far, 0]]
        if len(own) > 1:
            far = 1 + int(np.hypot(*(own[1:] - own[0]).T).argmax())
            own[[1, far]] = own[[far, 1]]
    return corner, group
