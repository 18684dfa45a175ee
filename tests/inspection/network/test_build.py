"""Linking rules on drawn ground. Assets: supports 100…, lines 200…, railways 300…, bridges 400…; distances in metres."""

from dataclasses import fields, replace

import numpy as np
import pytest

from inspection.geodesy import distance_m
from inspection.network.build.build import build
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.rules import LinkingRules
from tests.inspection.network.drawn_ground import ground, lonlat, places, square, ways, zone

RULES = LinkingRules(zone_clearance_m=5.0)
ROW = [(0, 0), (200, 0), (400, 0)]


def edges(graph: InspectionGraph, *kinds: EdgeKind) -> list[tuple[int, int]]:
    """Edges as pairs of the assets at their ends."""
    chosen = np.isin(graph.edge_kind, kinds or list(EdgeKind))
    return sorted(tuple(sorted(graph.node_asset[pair].tolist())) for pair in graph.edge[chosen])


def built(rules: LinkingRules = RULES, **drawn) -> InspectionGraph:
    return build(ground(**drawn), rules).graph


def test_a_line_connects_its_supports_and_the_vertices_between_them():
    """100 --200-- (vertex) --200-- 102"""
    graph = built(
        supports=places([ROW[0], ROW[2]], first_asset=100, osm=[1, 3], heights=[35.0, 40.0]),
        lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]),
    )
    assert graph.node_kind.tolist() == [NodeKind.SUPPORT, NodeKind.SUPPORT, NodeKind.LINE_VERTEX]
    assert graph.node_asset.tolist() == [100, 101, 200]
    assert graph.node_height_m.tolist()[:2] == [35.0, 40.0]
    assert graph.edge.tolist() == [[0, 2], [1, 2]]
    assert graph.length_m == pytest.approx([200.0, 200.0], abs=0.01)
    assert graph.cost.tolist() == graph.length_m.tolist()
    assert graph.edge_asset.tolist() == [200, 200]


def test_lines_connect_at_the_osm_node_that_they_share():
    r"""100 -- 101 -- 102, and 101 -- 103 northwards"""
    graph = built(
        supports=places([*ROW, (200, 300)], first_asset=100, osm=[1, 2, 3, 4]),
        lines=ways(ROW, [(200, 0), (200, 300)], first_asset=200, osm=[[1, 2, 3], [2, 4]]),
    )
    assert edges(graph, EdgeKind.LINE) == [(100, 101), (101, 102), (101, 103)]


def test_lines_that_only_cross_in_the_picture_are_not_connected():
    graph = built(lines=ways([(-500, 0), (500, 0)], [(0, -500), (0, 500)], first_asset=200, osm=[[1, 2], [3, 4]]))
    assert (
        build(ground(lines=ways([(-500, 0), (500, 0)], [(0, -500), (0, 500)], first_asset=200, osm=[[1, 2], [3, 4]])), RULES).components
        == 2
    )
    assert graph.edge_count == 2


def test_drawn_lines_connect_where_they_touch_within_1_m():
    """A drawn line that ends 0.9 m from a support's OSM node, and another whose end lies 1.2 m from one: joined, not joined."""
    graph = built(
        replace(RULES, crossing_m=0.0),
        supports=places(ROW, first_asset=100, osm=[1, 2, 3]),
        lines=ways(ROW, [(200.9, 0), (200, 300)], [(398.8, 0), (400, 300)], first_asset=200, osm=[[1, 2, 3], [-1, -1], [-1, -1]]),
    )
    assert edges(graph, EdgeKind.LINE) == [(100, 101), (101, 102), (101, 201), (202, 202)]


def test_a_drawn_tower_takes_the_place_of_the_vertex_that_it_stands_on():
    graph = built(
        supports=places([(200.5, 0)], first_asset=100),
        lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]),
    )
    assert graph.node_kind.tolist() == [NodeKind.SUPPORT, NodeKind.LINE_VERTEX, NodeKind.LINE_VERTEX]
    assert edges(graph) == [(100, 200), (100, 200)]


def test_two_osm_nodes_are_two_nodes_however_near():
    graph = built(supports=places([(0, 0), (0.5, 0)], first_asset=100, osm=[1, 2]))
    assert graph.node_count == 2
    assert edges(graph, EdgeKind.CROSSING) == [(100, 101)]


def test_a_drawn_line_with_dense_vertices_keeps_its_length():
    """Vertices every 0.4 m over 40 m: those within 1 m of one that leads are joined to it, and groups never grow into chains."""
    graph = built(lines=ways([(0.4 * number, 0) for number in range(101)], first_asset=200))
    assert 20 < graph.node_count < 101
    assert distance_m(graph.position[:1], graph.position[-1:])[0] == pytest.approx(40.0, abs=1.0)
    assert build(ground(lines=ways([(0.4 * number, 0) for number in range(101)], first_asset=200)), RULES).components == 1


def test_things_at_one_position_become_one_node_and_no_edge_is_0_m_long():
    """Two lines that end at one position under different OSM nodes."""
    graph = built(lines=ways([(0, 0), (300, 0)], [(300, 0), (600, 0)], first_asset=200, osm=[[1, 2], [3, 4]]))
    assert graph.node_count == 3
    assert (graph.length_m > 0).all()
    assert graph.edge_count == 2


def test_supports_of_different_lines_link_within_the_radius():
    """Two parallel lines 140 m apart link support to support; at 160 m they do not."""
    for gap_m, linked in ((140, [(100, 102), (101, 103)]), (160, [])):
        graph = built(
            supports=places([(0, 0), (300, 0), (0, gap_m), (300, gap_m)], first_asset=100, osm=[1, 2, 3, 4]),
            lines=ways([(0, 0), (300, 0)], [(0, gap_m), (300, gap_m)], first_asset=200, osm=[[1, 2], [3, 4]]),
        )
        assert edges(graph, EdgeKind.CROSSING) == linked


def test_supports_of_one_line_get_no_crossing_link():
    """A hairpin: the first and the last support stand 50 m apart and belong to the same line."""
    graph = built(
        supports=places([(0, 0), (300, 25), (0, 50)], first_asset=100, osm=[1, 2, 3]),
        lines=ways([(0, 0), (300, 25), (0, 50)], first_asset=200, osm=[[1, 2, 3]]),
    )
    assert edges(graph, EdgeKind.CROSSING) == []


def test_a_lonely_support_links_to_a_line_near_by():
    graph = built(supports=places([(0, 0), (0, 100)], first_asset=100, osm=[1, 2]), lines=ways(ROW, first_asset=200, osm=[[1, 5, 6]]))
    assert edges(graph, EdgeKind.CROSSING) == [(100, 101)]


def test_vertices_that_nobody_tagged_as_supports_link_like_them():
    """Two lines end 100 m apart in a substation, at nodes that carry no tag."""
    graph = built(lines=ways([(-600, 0), (-300, 0), (0, 0)], [(100, 0), (400, 0)], first_asset=200, osm=[[1, 2, 3], [4, 5]]))
    assert edges(graph, EdgeKind.CROSSING) == [(200, 201)]


def test_links_cost_the_off_network_factor_and_keep_their_length():
    graph = built(supports=places([(0, 0), (0, 100)], first_asset=100, osm=[1, 2]))
    assert graph.length_m == pytest.approx([100.0], abs=0.01)
    assert graph.cost == pytest.approx(2 * graph.length_m, rel=1e-12)


def test_a_bridge_links_to_the_nearest_tower_within_3_km():
    graph = built(
        supports=places([(0, 2_900), (0, 2_000), (0, -3_100)], first_asset=100, osm=[1, 2, 3]), bridges=places([(0, 0)], first_asset=400)
    )
    assert edges(graph) == [(101, 400)]
    assert edges(built(supports=places([(0, 3_100)], first_asset=100), bridges=places([(0, 0)], first_asset=400))) == []


def test_bridges_link_to_all_bridges_within_5_km():
    graph = built(bridges=places([(0, 0), (0, 4_900), (4_000, 0), (0, -5_100)], first_asset=400))
    assert edges(graph, EdgeKind.BRIDGE_TO_BRIDGE) == [(400, 401), (400, 402)]


def test_a_railway_is_linked_once_at_its_closest_pair_when_it_is_cut_off():
    """Track at 1 km from the line's east end, 2 km from its west end."""
    graph = built(
        supports=places([(0, 0), (1_000, 0)], first_asset=100, osm=[1, 2]),
        lines=ways([(0, 0), (1_000, 0)], first_asset=200, osm=[[1, 2]]),
        railways=ways([(0, 2_000), (1_000, 1_000)], first_asset=300, osm=[[11, 12]]),
    )
    chosen = np.flatnonzero(graph.edge_kind == EdgeKind.RAILWAY_TO_TOWER)
    assert edges(graph, EdgeKind.RAILWAY_TO_TOWER) == [(101, 300)]
    assert graph.length_m[chosen] == pytest.approx([1_000.0], abs=0.5)


def test_a_support_and_a_bridge_beside_a_railway_link_to_its_nearest_point():
    """300 runs east; tower 100 stands 140 m north of it, tower 101 160 m, bridge 400 stands on it: change-overs for 100 and 400."""
    graph = built(
        supports=places([(0, 140), (1_000, 160)], first_asset=100, osm=[1, 2]),
        railways=ways([(-1_000, 0), (0, 0), (1_000, 0)], first_asset=300, osm=[[11, 12, 13]]),
        bridges=places([(500, 5)], first_asset=400),
    )
    assert edges(graph, EdgeKind.CROSSING) == [(100, 300), (300, 400)]


def test_a_railway_beyond_3_km_stays_alone():
    drawn = ground(supports=places([(0, 0)], first_asset=100), railways=ways([(0, 3_100), (1_000, 3_100)], first_asset=300, osm=[[1, 2]]))
    result = build(drawn, RULES)
    assert edges(result.graph, EdgeKind.RAILWAY_TO_TOWER) == []
    assert result.components == 2


def test_a_railway_cut_in_two_by_a_zone_is_linked_on_both_sides():
    drawn = {
        "supports": places([(0, 500), (4_000, 500)], first_asset=100, osm=[1, 2]),
        "railways": ways([(200 * number, 0) for number in range(21)], first_asset=300, osm=[range(20, 41)]),
    }
    assert len(edges(built(**drawn), EdgeKind.RAILWAY_TO_TOWER)) == 1
    cut = build(ground(**drawn, zones=[square((2_000, 0), 150)]), RULES)
    assert edges(cut.graph, EdgeKind.RAILWAY_TO_TOWER) == [(100, 300), (101, 300)]
    assert cut.excluded_nodes == 1
    assert cut.excluded_edges == 2


def test_the_next_tower_is_taken_when_a_zone_stands_before_the_nearest():
    drawn = {"supports": places([(0, 1_000), (1_500, 0)], first_asset=100, osm=[1, 2]), "bridges": places([(0, 0)], first_asset=400)}
    assert edges(built(**drawn)) == [(100, 400)]
    around = build(ground(**drawn, zones=[square((0, 500), 100)]), RULES)
    assert edges(around.graph) == [(101, 400)]
    assert (around.excluded_nodes, around.excluded_edges) == (0, 1)


def test_a_node_inside_a_zone_is_out_with_its_edges_and_gone_round():
    drawn = ground(
        supports=places(ROW, first_asset=100, osm=[1, 2, 3]),
        lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]),
        zones=[square((200, 0), 20)],
    )
    result = build(drawn, RULES)
    assert result.graph.node_asset.tolist() == [100, 102, -1, -1]
    assert result.graph.node_kind[2:].tolist() == [NodeKind.BEND] * 2
    assert edges(result.graph, EdgeKind.LINE) == []
    assert (result.excluded_nodes, result.excluded_edges, result.components) == (1, 2, 1)


def test_an_edge_that_crosses_a_zone_is_out_though_its_ends_are_free():
    drawn = ground(lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]), zones=[square((100, 0), 20)])
    result = build(drawn, RULES)
    assert (result.graph.node_kind == NodeKind.LINE_VERTEX).sum() == 3
    assert len(edges(result.graph, EdgeKind.LINE)) == 1
    assert (result.excluded_nodes, result.excluded_edges) == (0, 1)


@pytest.mark.parametrize(("gap_m", "edges_left"), [(-0.01, 1), (0.0, 1), (4.9, 1), (5.1, 2)])
def test_an_edge_is_out_when_a_corner_overlaps_it_touches_it_or_comes_within_5_m(gap_m, edges_left):
    """The corner of a triangle points at the middle of the first span from the south."""
    corner = zone((100, -gap_m), (60, -200), (140, -200))
    assert len(edges(built(lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]), zones=[corner]), EdgeKind.LINE)) == edges_left


def test_an_edge_between_two_zones_stays():
    beside = [square((100, 40), 30), square((100, -40), 30)]
    assert built(lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]), zones=beside).edge_count == 2


def test_without_clearance_only_touching_counts():
    for gap_m, edges_left in ((0.01, 2), (-0.01, 1)):
        corner = zone((100, -gap_m), (60, -200), (140, -200))
        rules = replace(RULES, zone_clearance_m=0.0)
        assert len(edges(built(rules, lines=ways(ROW, first_asset=200, osm=[[1, 2, 3]]), zones=[corner]), EdgeKind.LINE)) == edges_left


def test_legs_across_the_antimeridian_are_not_made():
    drawn = ground(bridges=places([(0, 0), (0, 0)], first_asset=400))
    drawn.bridges.position[:] = [(179.99, 0.0), (-179.99, 0.0)]
    assert build(drawn, RULES).graph.edge_count == 0


def test_of_two_lines_on_the_same_supports_one_edge_is_kept():
    graph = built(
        supports=places(ROW, first_asset=100, osm=[1, 2, 3]),
        lines=ways(ROW, ROW, first_asset=200, osm=[[1, 2, 3], [1, 2, 3]]),
    )
    assert graph.edge_count == 2
    assert graph.edge_asset.tolist() == [200, 200]


def test_the_same_ground_gives_the_same_arrays():
    rng = np.random.default_rng(5)
    spots = [tuple(spot) for spot in rng.uniform(-3_000, 3_000, (60, 2)).tolist()]
    drawn = ground(
        supports=places(spots[:30], first_asset=100, osm=list(range(30))),
        lines=ways(spots[:10], spots[8:20], first_asset=200, osm=[range(10), range(8, 20)]),
        railways=ways(spots[30:50], first_asset=300, osm=[range(100, 120)]),
        bridges=places(spots[50:], first_asset=400),
        zones=[square((0, 0), 300)],
    )
    one, other = build(drawn, RULES).graph, build(drawn, RULES).graph
    for field in fields(InspectionGraph):
        left, right = getattr(one, field.name), getattr(other, field.name)
        assert (
            np.array_equal(left, right, equal_nan=True)
            if isinstance(left, np.ndarray) and left.dtype.kind == "f"
            else np.all(left == right)
        )
    assert (one.edge[:, 0] < one.edge[:, 1]).all()
    assert len(np.unique(one.edge, axis=0)) == one.edge_count


def test_nothing_on_the_ground_makes_an_empty_graph():
    result = build(ground(zones=[square((0, 0), 100)]), RULES)
    assert (result.graph.node_count, result.graph.edge_count, result.components) == (0, 0, 0)


def test_the_origin_of_drawn_ground_is_where_it_says():
    assert distance_m(np.array([lonlat((0, 0))]), np.array([lonlat((300, 400))]))[0] == pytest.approx(500.0, abs=0.05)
