"""The network cleared of a set of zones: only what meets one is taken, at the heights flown there."""

import math
from dataclasses import fields

import networkx as nx
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry.base import BaseGeometry

from inspection.network.build.build import build
from inspection.network.build.network import Network, network
from inspection.network.build.zone_masking import masked
from inspection.network.inspection_graph import EdgeKind, InspectionGraph
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex
from tests.inspection.network.drawn_ground import ground, places, square, ways, zone

RULES = LinkingRules(detour_m=0.0, zone_clearance_m=5.0)
HEIGHTS = FlownHeights(transit_agl_m=60.0, clearance_m=15.0, tolerance_m=10.0, margin_m=5.0)
STEP_M = 400.0


def index(*polygons: BaseGeometry, floor_m: list[float] | None = None, ceiling_m: list[float] | None = None) -> ZoneIndex:
    names = [f"zone {number}" for number in range(len(polygons))]
    return ZoneIndex(list(polygons), range(len(polygons)), names, floor_agl_m=floor_m, ceiling_agl_m=ceiling_m)


def line_of_four(heights: tuple[float, ...] = ()) -> Network:
    """100 --400-- 101 --400-- 102 --400-- 103"""
    spots = [(number * STEP_M, 0.0) for number in range(4)]
    drawn = ground(supports=places(spots, first_asset=100, heights=heights), lines=ways(spots, first_asset=200))
    return network(drawn, RULES)


def assets(graph: InspectionGraph) -> list[int]:
    return graph.node_asset.tolist()


def pairs(graph: InspectionGraph) -> list[tuple[int, ...]]:
    return sorted(tuple(graph.node_asset[pair].tolist()) for pair in graph.edge)


def test_the_network_knows_no_zones():
    spots = [(0.0, 0.0), (400.0, 0.0)]
    drawn = {"supports": places(spots, first_asset=100), "lines": ways(spots, first_asset=200)}
    with_zone, without = (network(ground(**drawn, zones=zones), RULES) for zones in ([square((0.0, 0.0), 50.0)], []))
    for field in fields(Network):
        assert getattr(with_zone, field.name).tobytes() == getattr(without, field.name).tobytes()


def test_a_zone_between_two_towers_takes_the_edge_and_no_node():
    result = masked(line_of_four(), index(square((600.0, 0.0), 50.0)), RULES, HEIGHTS)
    assert pairs(result.graph) == [(100, 101), (102, 103)]
    assert (result.excluded_nodes, result.excluded_edges, result.components) == (0, 1, 2)


def test_heights_decide():
    """Passed at 60 m (tower of 30 m) and 115 m (tower of 100 m), each up to 15 m lower or 25 m higher.

    100 (30 m) -- 101 (100 m) -- 102 (30 m) -- 103 (30 m), and the zone lies over all of it
    """
    tall_second = line_of_four((30.0, 100.0, 30.0, 30.0))
    over = square((600.0, 0.0), 2_000.0)

    def left(floor_m: float, ceiling_m: float) -> tuple[list[int], int]:
        graph = masked(tall_second, index(over, floor_m=[floor_m], ceiling_m=[ceiling_m]), RULES, HEIGHTS).graph
        return assets(graph), graph.edge_count

    assert left(-np.inf, 44.9) == ([100, 101, 102, 103], 3)
    assert left(-np.inf, 45.0) == ([101], 0)
    assert left(85.1, 99.9) == ([100, 101, 102, 103], 1)  # between both heights: the edges that rise are taken
    assert left(100.0, 120.0) == ([100, 102, 103], 1)
    assert left(140.1, np.inf) == ([100, 101, 102, 103], 3)
    assert left(-np.inf, np.inf) == ([], 0)


def test_a_link_is_flown_between_the_heights_of_its_ends():
    """A bridge (30 m, passed at 60 m) with two towers, 1,000 m west (100 m tall) and 1,500 m east; the zone lies west at 90 m."""
    drawn = ground(
        supports=places([(-1_000.0, 0.0), (1_500.0, 0.0)], first_asset=100, heights=(100.0, 30.0)),
        bridges=places([(0.0, 0.0)], first_asset=400, heights=(30.0,)),
    )
    wall = square((-500.0, 0.0), 50.0)
    for floor_m, ceiling_m, linked, blocked in ((85.0, 90.0, 101, 1), (141.0, 150.0, 100, 0), (0.0, 44.0, 100, 0)):
        result = masked(network(drawn, RULES), index(wall, floor_m=[floor_m], ceiling_m=[ceiling_m]), RULES, HEIGHTS)
        assert (pairs(result.graph), result.excluded_edges) == ([(linked, 400)], blocked)
        assert result.graph.edge_kind.tolist() == [EdgeKind.BRIDGE_TO_TOWER]


def test_building_is_clearing_of_all_the_grounds_zones():
    spots = [(number * STEP_M, 0.0) for number in range(4)]
    wall = square((600.0, 0.0), 50.0)
    drawn = ground(supports=places(spots, first_asset=100), lines=ways(spots, first_asset=200), zones=[wall])
    built, made = build(drawn, RULES), masked(line_of_four(), index(wall), RULES, FlownHeights())
    assert (built.components, built.excluded_nodes, built.excluded_edges) == (made.components, made.excluded_nodes, made.excluded_edges)
    assert (built.graph.edge.tolist(), built.graph.zone_wkb) == (made.graph.edge.tolist(), made.graph.zone_wkb)


spot = st.tuples(st.integers(-30, 30), st.integers(-30, 30)).map(lambda place: (place[0] * 100.0, place[1] * 100.0))
band = st.sampled_from([(-np.inf, 40.0), (-np.inf, np.inf), (20.0, 44.0), (70.0, 80.0), (90.0, 100.0), (90.0, np.inf)])
small_zone = st.tuples(spot, st.integers(1, 12)).map(lambda drawn: square(drawn[0], drawn[1] * 50.0))


@st.composite
def grounds(draw: st.DrawFn) -> Network:
    """Lines through random places, of which some are towers."""
    courses = draw(st.lists(st.lists(spot, min_size=2, max_size=6, unique=True), min_size=1, max_size=4))
    bridges = draw(st.lists(spot, max_size=3, unique=True))
    towers = sorted({place for course in courses for place in course[::2]})
    drawn = ground(
        supports=places(towers, first_asset=100, heights=[float(10 + 20 * (number % 5)) for number in range(len(towers))]),
        lines=ways(*courses, first_asset=200),
        bridges=places(bridges, first_asset=400),
    )
    return network(drawn, LinkingRules(crossing_m=250.0))


def ways_of(graph: InspectionGraph) -> tuple[nx.Graph, dict[tuple[float, ...], int]]:
    """And the node of each asset and place."""
    copy = nx.Graph()
    copy.add_nodes_from(range(graph.node_count))
    copy.add_weighted_edges_from((a, b, cost) for (a, b), cost in zip(graph.edge.tolist(), graph.cost.tolist(), strict=True))
    places_of_assets = zip(graph.node_asset.tolist(), graph.position.tolist(), strict=True)
    return copy, {(asset, *place): node for node, (asset, place) in enumerate(places_of_assets)}


@given(grounds(), st.lists(st.tuples(small_zone, band), min_size=1, max_size=5), st.data())
@settings(max_examples=60)
def test_fewer_zones_never_lengthen_a_way(whole, drawn, data):
    """Of the links to bridges each set has its own nearest; the others are there whenever no zone is in the way."""
    polygons = [polygon for polygon, _ in drawn]
    zones = index(*polygons, floor_m=[low for _, (low, _) in drawn], ceiling_m=[high for _, (_, high) in drawn])
    mask = np.array(data.draw(st.lists(st.booleans(), min_size=len(drawn), max_size=len(drawn))))
    rules = LinkingRules(detour_m=0.0, bridge_to_tower_m=0.0)
    (more, more_nodes), (fewer, fewer_nodes) = (ways_of(masked(whole, some, rules, HEIGHTS).graph) for some in (zones, zones.where(mask)))
    assert set(more_nodes) <= set(fewer_nodes)
    place_of = {node: place for place, node in more_nodes.items()}
    for source, costs in nx.all_pairs_dijkstra_path_length(more):
        nearer = nx.single_source_dijkstra_path_length(fewer, fewer_nodes[place_of[source]])
        for sink, cost in costs.items():
            assert nearer[fewer_nodes[place_of[sink]]] <= cost + 1e-6


@given(grounds(), st.lists(st.tuples(small_zone, band), max_size=4))
@settings(max_examples=60)
def test_an_edge_is_there_unless_a_zone_is_in_its_way(whole, drawn):
    """Edge by edge, with shapely alone and without an index."""
    zones = index(*[polygon for polygon, _ in drawn], floor_m=[low for _, (low, _) in drawn], ceiling_m=[high for _, (_, high) in drawn])
    graph = masked(whole, zones, LinkingRules(detour_m=0.0, bridge_to_tower_m=0.0, zone_clearance_m=0.0), HEIGHTS).graph
    place = whole.position.tolist()
    height = np.where(np.isnan(whole.node_height_m), np.array([45.0, 45.0, 8.0, 30.0])[whole.node_kind], whole.node_height_m)
    passed = np.maximum(60.0, height + 15.0).tolist()
    here = {frozenset(map(tuple, graph.position[pair].tolist())) for pair in graph.edge}
    near_deg = 50.0 / 70_000.0  # more than 25 m to the side of the leg and of the zone
    for one, other in whole.edge.tolist():
        leg = shapely.LineString([place[one], place[other]])
        low, high = min(passed[one], passed[other]) - 15.0, max(passed[one], passed[other]) + 25.0
        is_free = not any(zone.intersects(leg) and band[0] <= high and band[1] >= low for zone, band in drawn)
        is_here = frozenset([tuple(place[one]), tuple(place[other])]) in here
        assert is_free or not is_here
        if is_free and not is_here:  # it would have to rise into a zone over a taller wire
            wires = [
                (max(passed[start], passed[end]), shapely.LineString([place[start], place[end]]))
                for start, end in whole.edge[whole.edge_kind == EdgeKind.LINE].tolist()
                if {start, end}.isdisjoint({one, other})
            ]
            assert any(
                passed_m > 60.0 and wire.dwithin(leg, near_deg) and zone.dwithin(wire, near_deg) and 85.0 < band[0] <= passed_m + 25.0
                for passed_m, wire in wires
                for zone, band in drawn
            )


def test_a_line_is_not_flown_where_it_would_have_to_rise_over_another_into_a_zone():
    """A low line under a tall one, and a zone from 90 m upwards where they cross; what is too tall for any flight bars it without one."""
    low, tall = [(0.0, 0.0), (400.0, 0.0), (800.0, 0.0)], [(200.0, -300.0), (200.0, 300.0)]

    def crossed(height_m: float) -> Network:
        heights = [20.0, 20.0, 20.0, height_m, height_m]
        return network(
            ground(supports=places([*low, *tall], first_asset=100, heights=heights), lines=ways(low, tall, first_asset=200)), RULES
        )

    over = index(square((200.0, 0.0), 40.0), floor_m=[90.0])
    assert pairs(masked(crossed(40.0), over, RULES, HEIGHTS).graph) == [(100, 101), (101, 102), (103, 104)]
    assert pairs(masked(crossed(80.0), index(), RULES, HEIGHTS).graph) == [(100, 101), (101, 102), (103, 104)]
    assert pairs(masked(crossed(80.0), over, RULES, HEIGHTS).graph) == [(101, 102)]  # nor is the tall one flown into the zone
    assert pairs(masked(crossed(110.0), index(), RULES, HEIGHTS).graph) == [(101, 102)]


def test_a_way_leads_round_wires_that_cannot_be_flown_over():
    low, tall = [(0.0, 0.0), (400.0, 0.0)], [(200.0, -300.0), (200.0, 300.0)]
    drawn = ground(
        supports=places([*low, *tall], first_asset=100, heights=[20.0, 20.0, 110.0, 110.0]), lines=ways(low, tall, first_asset=200)
    )
    graph = masked(network(drawn, RULES), index(), LinkingRules(), HEIGHTS).graph
    copy, node = ways_of(graph)
    ends = (place for place in node if place[0] in {100, 101})
    way_m = nx.dijkstra_path_length(copy, *(node[end] for end in ends)) / 2.0
    assert way_m == pytest.approx(2.0 * math.hypot(170.0, 330.0) + 60.0, abs=25.0)
    for pair in graph.edge.tolist():
        assert shapely.LineString(graph.position[pair]).distance(shapely.LineString(drawn.lines.position[2:])) * 111_320.0 > 20.0


def test_a_network_that_links_its_bridges_itself_keeps_its_links():
    """As one made elsewhere does; a bridge whose link a zone takes is linked anew."""
    drawn = ground(
        supports=places([(-1_000.0, 0.0), (0.0, 1_500.0), (2_000.0, 0.0)], first_asset=100),
        bridges=places([(0.0, 0.0)], first_asset=400),
    )
    linked = network(drawn, RULES)
    own = Network(**{field.name: getattr(linked, field.name) for field in fields(Network)} | link(linked, 2, 3, 2_000.0))
    assert pairs(masked(own, index(), RULES, HEIGHTS).graph) == [(102, 400)]
    assert pairs(masked(own, index(square((1_000.0, 0.0), 50.0)), RULES, HEIGHTS).graph) == [(100, 400)]


def link(graph: Network, one: int, other: int, length_m: float) -> dict[str, np.ndarray]:
    assert graph.edge_count == 0
    return {
        "edge": np.array([[one, other]], dtype=np.int32),
        "length_m": np.array([length_m]),
        "cost": np.array([2 * length_m]),
        "edge_kind": np.array([EdgeKind.BRIDGE_TO_TOWER], dtype=np.uint8),
        "edge_asset": np.array([-1], dtype=np.int64),
    }


def test_a_wall_with_a_gap_leaves_what_passes_the_gap():
    wall = [zone((550.0, north), (650.0, north), (650.0, north + 900.0), (550.0, north + 900.0)) for north in (-910.0, 10.0)]
    graph = masked(line_of_four(), index(*wall), RULES, HEIGHTS).graph
    assert pairs(graph) == [(100, 101), (101, 102), (102, 103)]
    wider = LinkingRules(detour_m=0.0, zone_clearance_m=12.0)
    assert pairs(masked(line_of_four(), index(*wall), wider, HEIGHTS).graph) == [(100, 101), (102, 103)]


def test_heights_are_compared_with_the_least_and_the_greatest_of_a_leg():
    low_m, high_m = HEIGHTS.band_m(np.array([0.0, 45.0, 60.0]))
    assert low_m.tolist() == pytest.approx([45.0, 45.0, 60.0])
    assert high_m.tolist() == pytest.approx([85.0, 85.0, 100.0])
