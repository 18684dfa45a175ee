"""Towers that no line passes: one that stands alone, or a row of them whose line is not mapped."""

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import depth_first_order, minimum_spanning_tree
from shapely import MultiPoint, Point

from inspection.geodesy import distance_m
from inspection.network.build.edges import component_labels
from inspection.network.nearness import nearest_within, pairs_within
from inspection.quality.infrastructure import asset_key
from inspection.quality.issue import Gap
from inspection.quality.network import BoolArray, FloatArray, IntArray, Network, metres_by

ROW_M = 550.0  # the widest usual span: towers nearer than that may stand in one row
LINE_REACH_M = 500.0  # how far the nearest line is looked for
NAMED = 200  # towers of one row whose keys are kept in the details


def lone_towers(network: Network) -> list[Gap]:
    """One gap for each tower, or for each row of towers, that no line passes."""
    supports = network.ground.supports
    lone = np.flatnonzero(~network.is_carried)
    if not len(lone):
        return []
    position = supports.position[lone]
    pairs = _nearest_pairs(position)
    _, row = component_labels(len(lone), pairs)
    length, is_path = _trees(position, pairs, row)
    near = network.legs_near(position, LINE_REACH_M)
    place, first = np.unique(near.place, return_index=True)
    leg = np.full(len(lone), -1, dtype=np.int64)
    metres = np.full(len(lone), np.nan)
    leg[place], metres[place] = near.leg[first], near.metres[first]

    order = np.lexsort((_sorting_key(network, lone), row))
    start = np.searchsorted(row[order], np.arange(row.max() + 2))
    return [
        _gap_of_row(network, lone, order[start[index] : start[index + 1]], leg, metres, float(length[index]), bool(is_path[index]))
        for index in range(len(start) - 1)
    ]


def _nearest_pairs(position: FloatArray) -> IntArray:
    """Pairs of towers that stand in a row. A crowd is thinned to its nearest four, so that the number of pairs stays linear."""
    row, other, _ = nearest_within(position, position, ROW_M, count=5)
    pairs = np.sort(np.column_stack([row, other]), axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    if len(position) <= 2_000:
        pairs = np.unique(np.concatenate([pairs, pairs_within(position, ROW_M)]), axis=0)
    return pairs.astype(np.int64)


def course_of_row(position: FloatArray) -> IntArray | None:
    """The towers of a row in the order of their line, or None where they branch or stand too far apart for one row."""
    pairs = pairs_within(position, ROW_M)
    tree = _shortest_tree(position, pairs)
    degree = np.bincount(tree.ravel(), minlength=len(position))
    if len(tree) != len(position) - 1 or degree.max(initial=0) > 2:
        return None
    links = csr_array((np.ones(len(tree)), (tree[:, 0], tree[:, 1])), shape=(len(position), len(position)))
    order: IntArray = depth_first_order(links, int(np.flatnonzero(degree == 1)[0]), directed=False, return_predecessors=False).astype(
        np.int64
    )
    return order


def _trees(position: FloatArray, pairs: IntArray, row: IntArray) -> tuple[FloatArray, BoolArray]:
    """Of each row the metres of the shortest tree through it, and whether that is a path without a branch."""
    count = int(row.max()) + 1
    tree = _shortest_tree(position, pairs)
    metres = metres_by(row[tree[:, 0]], distance_m(position[tree[:, 0]], position[tree[:, 1]]), count)
    is_path = np.ones(count, dtype=bool)
    is_path[row[np.bincount(tree.ravel(), minlength=len(position)) > 2]] = False
    return metres, is_path


def _shortest_tree(position: FloatArray, pairs: IntArray) -> IntArray:
    """The pairs of the shortest trees, one tree for each row."""
    if not len(pairs):
        return np.zeros((0, 2), dtype=np.int64)
    metres = np.maximum(distance_m(position[pairs[:, 0]], position[pairs[:, 1]]), 1e-3)
    tree = minimum_spanning_tree(csr_array((metres, (pairs[:, 0], pairs[:, 1])), shape=(len(position), len(position)))).tocoo()
    return np.column_stack([tree.row, tree.col]).astype(np.int64)


def _sorting_key(network: Network, lone: IntArray) -> IntArray:
    """OSM ids first: the first tower of a row names it."""
    osm_id = network.ground.support_facts.osm_id[lone]
    return np.where(osm_id >= 0, osm_id, np.int64(2) ** 61 + network.ground.supports.asset[lone])


def _gap_of_row(
    network: Network, lone: IntArray, members: IntArray, leg: IntArray, metres: FloatArray, length_m: float, is_path: bool
) -> Gap:
    ground = network.ground
    towers = lone[members]
    positions = ground.supports.position[towers]
    first = positions[0]
    leader = int(ground.supports.asset[towers[0]])
    alone = len(members) == 1
    nearest = int(members[np.nanargmin(metres[members])]) if (leg[members] >= 0).any() else -1
    line = int(ground.lines.asset[network.leg_way[leg[nearest]]]) if nearest >= 0 else None
    return Gap(
        kind="tower_on_no_line",
        key=f"tower_on_no_line {asset_key('n', int(ground.support_facts.osm_id[towers[0]]), leader)}",
        asset=leader,
        other_asset=line,
        position=(float(first[0]), float(first[1])),
        geometry=Point(first) if alone else MultiPoint(positions),
        details={
            "towers": len(members),
            "row_m": round(length_m, 1),
            "is_path": is_path and 2 < len(members) <= NAMED,
            "nearest_line_m": round(float(metres[nearest]), 1) if nearest >= 0 else None,
            "assets": ground.supports.asset[towers[:NAMED]].tolist(),
        },
        cut_off_m=0.0 if alone else length_m,
    )
