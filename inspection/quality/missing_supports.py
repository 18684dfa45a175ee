"""Line vertices without a tower, one gap for each line; and lines without any."""

import numpy as np
from shapely import MultiPoint

from inspection.quality.infrastructure import asset_key
from inspection.quality.issue import Gap
from inspection.quality.line_ends import is_at_terminal
from inspection.quality.network import BoolArray, FloatArray, IntArray, Network, metres_by

MIN_LINE_M = 150.0  # what is shorter may hang between two portals


def missing_supports(network: Network) -> list[Gap]:
    """One gap per line that has vertices without a support.

    First and last vertices count only where nothing says that the line ends in a substation there: those hang on portals, which are
    seldom mapped. A line without any support is "without towers" if it is longer than what may hang between two portals.
    """
    ground = network.ground
    bare = network.node_of_vertex >= network.support_count
    bare &= ~_is_excused_end(network, bare)
    way = network.way_of_vertex
    count = np.bincount(way[bare], minlength=len(ground.lines))
    supports = np.bincount(way[network.node_of_vertex < network.support_count], minlength=len(ground.lines))
    without_m = _without_tower_m(network, bare)
    chosen = np.flatnonzero(bare)
    first = np.searchsorted(way[chosen], np.arange(len(ground.lines) + 1))
    return [
        _gap_of_line(network, line, chosen[first[line] : first[line + 1]], bool(supports[line]), float(without_m[line]))
        for line in np.flatnonzero(count).tolist()
        if supports[line] or network.way_m[line] >= MIN_LINE_M
    ]


def _gap_of_line(network: Network, line: int, vertices: IntArray, has_supports: bool, without_m: float) -> Gap:
    ground = network.ground
    kind = "missing_support" if has_supports else "line_without_towers"
    positions = ground.lines.position[vertices]
    middle = positions[len(positions) // 2]
    total = int(ground.lines.first[line + 1] - ground.lines.first[line])
    return Gap(
        kind=kind,
        key=f"{kind} {asset_key('w', int(ground.line_facts.osm_id[line]), int(ground.lines.asset[line]))}",
        asset=int(ground.lines.asset[line]),
        position=(float(middle[0]), float(middle[1])),
        geometry=MultiPoint(positions),
        details={
            "missing_towers": len(vertices),
            "vertices": total,
            "line_m": round(float(network.way_m[line]), 1),
            "without_tower_m": round(without_m, 1),
        },
        cut_off_m=0.0 if has_supports else float(network.way_m[line]),
    )


def _is_excused_end(network: Network, bare: BoolArray) -> BoolArray:
    """First and last vertices without support that are known to be in a substation, or where the line goes under ground."""
    lines = network.ground.lines
    count = np.diff(lines.first) > 0
    ends = np.unique(np.concatenate([lines.first[:-1][count], lines.first[1:][count] - 1]))
    ends = ends[bare[ends]]
    ends = ends[network.degree[network.node_of_vertex[ends]] <= 1]
    excused = np.zeros(len(bare), dtype=bool)
    excused[ends[is_at_terminal(network, lines.position[ends], network.way_of_vertex[ends])]] = True
    return excused


def _without_tower_m(network: Network, bare: BoolArray) -> FloatArray:
    """Of each line, the metres of its legs that have no tower at one end at least."""
    start = network.leg_start
    is_bare = bare[start] | bare[start + 1]
    return metres_by(network.leg_way[is_bare], network.leg_m[is_bare], len(network.ground.lines))
