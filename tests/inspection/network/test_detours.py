"""What zones cut out of lines and railways is gone round; what no straight link reaches is linked round them."""

import networkx as nx
import numpy as np
import pytest

from inspection.network.build.detours import ALL_PAIRS, _pairs
from inspection.network.build.edges import component_labels
from inspection.network.build.network import network
from inspection.network.build.zone_masking import MaskedGraph, masked
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex, zones_of_graph
from tests.inspection.network.drawn_ground import Spot, ground, lonlat, places, square, ways, zone

RULES, HEIGHTS = LinkingRules(zone_clearance_m=5.0), FlownHeights()


def clear_of(*zones, rules: LinkingRules = RULES, **drawn) -> MaskedGraph:
    index = ZoneIndex(list(zones), range(len(zones)), [f"zone {number}" for number in range(len(zones))])
    return masked(network(ground(**drawn), rules), index, rules, HEIGHTS)


def line(*spots: Spot) -> dict[str, object]:
    return {"supports": places(spots, first_asset=100), "lines": ways(spots, first_asset=200)}


def cost(graph: InspectionGraph, start: Spot, end: Spot) -> float:
    copy = nx.Graph()
    copy.add_weighted_edges_from((a, b, cost) for (a, b), cost in zip(graph.edge.tolist(), graph.cost.tolist(), strict=True))
    one, other = (int(np.abs(graph.position - np.array(lonlat(spot))).sum(axis=1).argmin()) for spot in (start, end))
    return float(nx.dijkstra_path_length(copy, one, other))


ROW = [(number * 400.0, 0.0) for number in range(6)]


def test_a_zone_across_a_line_forces_a_detour_not_an_end():
    """A square of 200 m over the tower at 800 m; from 400 m to 1,200 m round its corners, at twice the cost of metres on the line."""
    result = clear_of(square((800.0, 20.0), 100.0), **line(*ROW))
    graph = result.graph
    assert result.components == 1
    bends = graph.node_kind == NodeKind.BEND
    assert (bends.sum(), (graph.edge_kind == EdgeKind.DETOUR).sum()) == (2, 3)
    assert (graph.node_asset[bends].tolist(), graph.node_height_m[bends].tolist()) == ([-1, -1], [0.0, 0.0])
    assert (graph.edge_asset[graph.edge_kind == EdgeKind.DETOUR] == -1).all()
    round_m = 2 * np.hypot(295.0, 85.0) + 210.0
    assert cost(graph, ROW[1], ROW[3]) == pytest.approx(2 * round_m, abs=1.0)
    assert cost(graph, ROW[0], ROW[5]) == pytest.approx(1_200.0 + 2 * round_m, abs=1.0)


def test_a_zone_over_a_line_that_bends_away_is_passed_straight():
    """L-shaped line, its corner in the zone: both stumps see each other."""
    result = clear_of(square((1_000.0, 0.0), 50.0), **line((0.0, 0.0), (500.0, 0.0), (1_000.0, 0.0), (1_000.0, 500.0), (1_000.0, 1_000.0)))
    assert (result.graph.node_kind == NodeKind.BEND).sum() == 0
    detours = np.flatnonzero(result.graph.edge_kind == EdgeKind.DETOUR)
    assert result.graph.length_m[detours] == pytest.approx([500.0 * np.sqrt(2.0)], abs=0.5)
    assert result.components == 1


def test_every_branch_that_ends_at_a_zone_is_joined_to_every_other():
    """Four lines meet in a tower within the zone."""
    arms = [[(x * far, y * far) for far in (800.0, 400.0, 0.0)] for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    spots = sorted({spot for arm in arms for spot in arm})
    result = clear_of(square((0.0, 0.0), 100.0), supports=places(spots, first_asset=100), lines=ways(*arms, first_asset=200))
    assert (result.excluded_nodes, result.excluded_edges, result.components) == (1, 4, 1)
    assert cost(result.graph, (400.0, 0.0), (-400.0, 0.0)) == pytest.approx(2 * (2 * np.hypot(295.0, 105.0) + 210.0), abs=1.0)
    assert cost(result.graph, (400.0, 0.0), (0.0, 400.0)) == pytest.approx(2 * 400.0 * np.sqrt(2.0), abs=1.0)


def test_a_railway_is_gone_on_with_behind_a_zone():
    track = [(200.0 * number, 0.0) for number in range(21)]
    result = clear_of(square((2_000.0, 0.0), 150.0), railways=ways(track, first_asset=300))
    assert result.components == 1
    assert (result.graph.edge_kind == EdgeKind.DETOUR).sum() == 3


def test_a_line_whose_end_is_in_a_zone_just_ends():
    result = clear_of(square((2_000.0, 0.0), 100.0), **line(*ROW))
    assert (result.graph.edge_kind == EdgeKind.DETOUR).sum() == 0
    assert result.components == 1


def test_two_lines_through_one_zone_are_not_joined_by_it():
    """They have nothing in common; each gets a way of its own."""
    upper = [(x, 1_000.0) for x, _ in ROW]
    wall = zone((780.0, -50.0), (820.0, -50.0), (820.0, 1_050.0), (780.0, 1_050.0))
    drawn = {"supports": places([*ROW, *upper], first_asset=100), "lines": ways(ROW, upper, first_asset=200)}
    result = clear_of(wall, **drawn)
    assert (clear_of(**drawn).components, result.components) == (2, 2)


def test_a_way_longer_than_the_limit_is_not_made():
    wall = zone((780.0, -6_000.0), (820.0, -6_000.0), (820.0, 6_000.0), (780.0, 6_000.0))
    assert clear_of(wall, **line(*ROW)).components == 2
    assert clear_of(wall, rules=LinkingRules(detour_m=13_000.0), **line(*ROW)).components == 1
    assert clear_of(square((800.0, 0.0), 100.0), rules=LinkingRules(detour_m=0.0), **line(*ROW)).components == 2


def test_a_bridge_that_no_straight_link_reaches_is_linked_round_the_zone():
    """The only tower stands 1,000 m east of the bridge, behind a square."""
    result = clear_of(
        square((500.0, 30.0), 100.0), supports=places([(1_000.0, 0.0)], first_asset=100), bridges=places([(0.0, 0.0)], first_asset=400)
    )
    assert (result.components, result.excluded_edges) == (1, 1)
    assert result.graph.length_m.sum() == pytest.approx(2 * np.hypot(395.0, 75.0) + 210.0, abs=0.6)
    assert set(result.graph.edge_kind.tolist()) == {EdgeKind.DETOUR}


def test_a_railway_that_no_straight_link_reaches_is_linked_round_the_zone_once():
    """The track runs 500 m south of a tower; the zone between them is wider than the track."""
    track = [(200.0 * number, 0.0) for number in range(6)]
    wall = zone((-300.0, 200.0), (1_300.0, 200.0), (1_300.0, 300.0), (-300.0, 300.0))
    result = clear_of(wall, supports=places([(0.0, 500.0)], first_asset=100), railways=ways(track, first_asset=300))
    assert result.components == 1
    assert (result.graph.edge_kind == EdgeKind.DETOUR).sum() == 3


@pytest.mark.parametrize("count", [2, ALL_PAIRS, ALL_PAIRS + 1, 40])
def test_all_stumps_of_a_gap_hang_together_over_few_pairs(count):
    position = np.random.default_rng(count).uniform(-0.01, 0.01, (count, 2)) + np.array([9.0, 47.0])
    pairs = _pairs(position)
    assert component_labels(count, pairs)[0] == 1
    assert len(pairs) <= max(4 * count, count * (count - 1) // 2 if count <= ALL_PAIRS else 0)


def test_no_edge_of_a_cleared_graph_meets_a_zone_at_the_height_flown():
    """Towers of 10 to 110 m, zones in bands; each edge between the pass heights of its ends, judged one by one."""
    rng = np.random.default_rng(3)
    courses = [[tuple(spot) for spot in np.cumsum(rng.uniform(-400, 500, (12, 2)), axis=0).round().tolist()] for _ in range(4)]
    towers = [spot for course in courses for spot in course]
    drawn = ground(
        supports=places(towers, first_asset=100, heights=rng.uniform(10, 104, len(towers)).tolist()), lines=ways(*courses, first_asset=200)
    )
    polygons = [square(tuple(rng.uniform(-1_000, 2_500, 2)), float(rng.uniform(50, 250))) for _ in range(25)]
    floors = rng.choice([0.0, 60.0, 90.0], 25)
    zones = ZoneIndex(polygons, range(25), [""] * 25, floor_agl_m=floors, ceiling_agl_m=floors + rng.choice([20.0, np.inf], 25))
    graph = masked(network(drawn, RULES), zones, RULES, HEIGHTS).graph
    assert (graph.edge_kind == EdgeKind.DETOUR).any()
    height = np.where(graph.node_kind == NodeKind.BEND, 0.0, graph.node_height_m)
    passed = np.maximum(60.0, height + 15.0)[graph.edge]
    give_m = HEIGHTS.tolerance_m + HEIGHTS.margin_m
    start, end = graph.position[graph.edge[:, 0]], graph.position[graph.edge[:, 1]]
    for leg in range(graph.edge_count):
        low_m, high_m = passed[leg].min() - give_m, passed[leg].max() + give_m
        assert not zones.meets(start[[leg]], end[[leg]], 5.0, low_m, high_m).any()
    assert zones_of_graph(graph).ids.tolist() == list(range(25))
