"""Issues of supports: vertices and long spans without towers, towers without a line."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import depth_first_order, minimum_spanning_tree
from shapely import LineString, MultiPoint, Point

from inspection.geodesy import distance_m
from inspection.network.build.edges import component_labels
from inspection.network.nearness import nearest_within, pairs_within
from inspection.quality.infrastructure import FoundIssue, asset_key, place_key
from inspection.quality.lines import is_at_terminal
from inspection.quality.network import BoolArray, FloatArray, IntArray, SupportNetwork, metres_by

MIN_LINE_M = 150.0  # shorter lines may span two portals


def missing_supports(network: SupportNetwork) -> list[FoundIssue]:
    """Return one issue per line that has vertices without a support.

    First and last vertices count only where nothing indicates that the line ends in a substation: those are on portals, which are seldom
    mapped. A line without any support is "without towers" if it is longer than a span between two portals.
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
        _issue_of_line(network, line, chosen[first[line] : first[line + 1]], bool(supports[line]), float(without_m[line]))
        for line in np.flatnonzero(count).tolist()
        if supports[line] or network.way_m[line] >= MIN_LINE_M
    ]


def _issue_of_line(network: SupportNetwork, line: int, vertices: IntArray, has_supports: bool, without_m: float) -> FoundIssue:
    ground = network.ground
    kind = "missing_support" if has_supports else "line_without_towers"
    positions = ground.lines.position[vertices]
    middle = positions[len(positions) // 2]
    total = int(ground.lines.first[line + 1] - ground.lines.first[line])
    return FoundIssue(
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


def _is_excused_end(network: SupportNetwork, bare: BoolArray) -> BoolArray:
    """Return first and last vertices without support that are in a substation, or where the line continues underground."""
    lines = network.ground.lines
    count = np.diff(lines.first) > 0
    ends = np.unique(np.concatenate([lines.first[:-1][count], lines.first[1:][count] - 1]))
    ends = ends[bare[ends]]
    ends = ends[network.degree[network.node_of_vertex[ends]] <= 1]
    excused = np.zeros(len(bare), dtype=bool)
    excused[ends[is_at_terminal(network, lines.position[ends], network.way_of_vertex[ends])]] = True
    return excused


def _without_tower_m(network: SupportNetwork, bare: BoolArray) -> FloatArray:
    """Return for each line the metres of its legs that have no tower at one end at least."""
    start = network.leg_start
    is_bare = bare[start] | bare[start + 1]
    return metres_by(network.leg_way[is_bare], network.leg_m[is_bare], len(network.ground.lines))


ROW_M = 550.0  # the widest usual span: nearer towers may form a row
LINE_REACH_M = 500.0  # radius of the search for the nearest line
NAMED = 200  # towers of one row whose keys the details list


def lone_towers(network: SupportNetwork) -> list[FoundIssue]:
    """Return one issue for each tower, or row of towers, that is on no line."""
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
    """Return pairs of towers that may form a row. In dense groups only the nearest four count, so that the number of pairs stays linear."""
    row, other, _ = nearest_within(position, position, ROW_M, count=5)
    pairs = np.sort(np.column_stack([row, other]), axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    if len(position) <= 2_000:
        pairs = np.unique(np.concatenate([pairs, pairs_within(position, ROW_M)]), axis=0)
    return pairs.astype(np.int64)


def course_of_row(position: FloatArray) -> IntArray | None:
    """Return the towers of a row in the order of their line, or None where they branch or are too far apart for one row."""
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
    """Return for each row the metres of its shortest tree, and whether that is a path without a branch."""
    count = int(row.max()) + 1
    tree = _shortest_tree(position, pairs)
    metres = metres_by(row[tree[:, 0]], distance_m(position[tree[:, 0]], position[tree[:, 1]]), count)
    is_path = np.ones(count, dtype=bool)
    is_path[row[np.bincount(tree.ravel(), minlength=len(position)) > 2]] = False
    return metres, is_path


def _shortest_tree(position: FloatArray, pairs: IntArray) -> IntArray:
    """Return the pairs of the shortest trees, one tree for each row."""
    if not len(pairs):
        return np.zeros((0, 2), dtype=np.int64)
    metres = np.maximum(distance_m(position[pairs[:, 0]], position[pairs[:, 1]]), 1e-3)
    tree = minimum_spanning_tree(csr_array((metres, (pairs[:, 0], pairs[:, 1])), shape=(len(position), len(position)))).tocoo()
    return np.column_stack([tree.row, tree.col]).astype(np.int64)


def _sorting_key(network: SupportNetwork, lone: IntArray) -> IntArray:
    """Return a sort key, OSM ids first: a row is named after its first tower."""
    osm_id = network.ground.support_facts.osm_id[lone]
    return np.where(osm_id >= 0, osm_id, np.int64(2) ** 61 + network.ground.supports.asset[lone])


def _gap_of_row(
    network: SupportNetwork, lone: IntArray, members: IntArray, leg: IntArray, metres: FloatArray, length_m: float, is_path: bool
) -> FoundIssue:
    ground = network.ground
    towers = lone[members]
    positions = ground.supports.position[towers]
    first = positions[0]
    leader = int(ground.supports.asset[towers[0]])
    alone = len(members) == 1
    nearest = int(members[np.nanargmin(metres[members])]) if (leg[members] >= 0).any() else -1
    line = int(ground.lines.asset[network.leg_way[leg[nearest]]]) if nearest >= 0 else None
    return FoundIssue(
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


# Volts from which a class begins, the default usual span, and the bound below which a span is no issue, whatever the line's other spans
# are. Usual: wooden and concrete poles are about 80 m apart, towers 300 to 550 m (Darley Power Fight, "dimensions of the towers", 450 to
# 550 m at 220 and 500 kV; in the OSM data of Nepal at 132 kV the median is 0.32 km and 95 % are below 0.64 km). The bound is about twice
# the longest usual span, as single spans cross valleys and rivers.
CLASSES = ((100_000, 320.0, 1_000.0), (50_000, 250.0, 800.0), (1, 100.0, 450.0), (0, 250.0, 800.0))
LONGER_THAN_OTHERS = 3.0
OWN_SPANS = 8  # a line with fewer is compared with all lines of its class, as a median of three spans is unreliable
MAX_IN_THE_WORLD_M = 5_376.0  # Ameralik, Greenland


def voltage_class(voltage_v: FloatArray) -> NDArray[np.int64]:
    """Return the index into CLASSES; 0 V is "not stated"."""
    found = np.full(len(voltage_v), len(CLASSES) - 1, dtype=np.int64)
    for index in range(len(CLASSES) - 2, -1, -1):
        found[voltage_v >= CLASSES[index][0]] = index
    return found


def way_classes(network: SupportNetwork) -> NDArray[np.int64]:
    return voltage_class(np.array([max(volts, default=0) for volts in network.ground.line_facts.voltages_v], dtype=np.float64))


def usual_span_m(network: SupportNetwork) -> FloatArray:
    """Return for each line the median of its own spans, or if it has few, of all spans of its voltage class."""
    classes = way_classes(network)
    usual = np.array([CLASSES[index][1] for index in classes])
    leg_class = classes[network.leg_way]
    for index in range(len(CLASSES)):
        spans = network.leg_m[leg_class == index]
        if len(spans) >= OWN_SPANS:
            usual[classes == index] = np.median(spans)
    order = np.lexsort((network.leg_m, network.leg_way))
    count = np.bincount(network.leg_way, minlength=len(usual))
    first = np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int64)
    own = np.flatnonzero(count >= OWN_SPANS)
    metres = network.leg_m[order]
    usual[own] = (metres[first[own] + (count[own] - 1) // 2] + metres[first[own] + count[own] // 2]) / 2
    return usual


def long_spans(network: SupportNetwork) -> list[FoundIssue]:
    """Return legs longer than both three times the usual span of their line and the bound of its voltage."""
    lines, facts = network.ground.lines, network.ground.line_facts
    usual = usual_span_m(network)[network.leg_way]
    bound = np.array([CLASSES[index][2] for index in way_classes(network)])[network.leg_way]
    found = np.flatnonzero((network.leg_m > LONGER_THAN_OTHERS * usual) & (network.leg_m > bound))
    pair_of_leg = network.pairs[2]
    issues = []
    for leg in found.tolist():
        way, vertex = int(network.leg_way[leg]), int(network.leg_start[leg])
        ends = lines.position[vertex : vertex + 2]
        if abs(ends[0, 0] - ends[1, 0]) > 180.0:
            continue
        span_m = float(network.leg_m[leg])
        beyond_m = float(network.smaller_side_m[pair_of_leg[leg]]) if pair_of_leg[leg] >= 0 else 0.0
        missing = max(round(span_m / float(usual[leg])) - 1, 1)
        issues.append(
            FoundIssue(
                kind="long_span",
                key=f"long_span {asset_key('w', int(facts.osm_id[way]), int(lines.asset[way]))} {place_key(ends[0])} {place_key(ends[1])}",
                asset=int(lines.asset[way]),
                position=_middle(ends),
                geometry=LineString(ends),
                details={
                    "span_m": round(span_m, 1),
                    "usual_span_m": round(float(usual[leg]), 1),
                    "missing_towers": missing,
                    "beyond_m": round(beyond_m, 1),
                    "is_impossible": span_m > MAX_IN_THE_WORLD_M,
                    "start": ends[0].tolist(),
                    "end": ends[1].tolist(),
                },
                cut_off_m=span_m + beyond_m,
            )
        )
    return issues


def _middle(ends: FloatArray) -> tuple[float, float]:
    lon, lat = ends.mean(axis=0)
    return float(lon), float(lat)
