"""Shortest paths between attached places, by hand and against networkx."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.graph import shortest_paths
from inspection.graph.shortest_paths import Attachment, DirectLeg, NoWay, travel_between
from tests.inspection.graph.drawn_graphs import drawn_graph


def leg(node: int, metres: float, factor: float = 1.0) -> Attachment:
    return Attachment(node, metres, metres * factor)


def test_a_way_is_its_access_leg_the_edges_and_the_last_leg():
    """source --5-- A --100-- B --80-- C --7-- sink"""
    graph = drawn_graph([(0, 0), (1, 0), (2, 0)], [(0, 1, 100.0), (1, 2, 80.0)])
    travel = travel_between(graph, [[leg(0, 5)]], [[leg(2, 7)]])
    assert travel.length_m.tolist() == [[192.0]]
    assert travel.cost.tolist() == [[192.0]]
    assert travel.path(0, 0).tolist() == [0, 1, 2]


def test_the_length_is_what_is_flown_and_the_cost_decides():
    """A --100 (x3)-- B, and A --120-- C --120-- B: the longer way is cheaper."""
    graph = drawn_graph([(0, 0), (1, 0), (0, 1)], [(0, 1, 100.0), (0, 2, 120.0), (1, 2, 120.0)], factor=[3.0, 1.0, 1.0])
    travel = travel_between(graph, [[leg(0, 10, 2.0)]], [[leg(1, 0)]])
    assert travel.path(0, 0).tolist() == [0, 2, 1]
    assert travel.length_m[0, 0] == 250.0
    assert travel.cost[0, 0] == 260.0


def test_source_and_sink_at_one_node_are_0_m_apart():
    graph = drawn_graph([(0, 0), (1, 0)], [(0, 1, 100.0)])
    travel = travel_between(graph, [[leg(0, 0)]], [[leg(0, 0)], [leg(1, 0)]])
    assert travel.length_m.tolist() == [[0.0, 100.0]]
    assert travel.path(0, 0).tolist() == [0]


def test_a_sink_in_another_component_is_out_of_reach():
    """A --100-- B     C --100-- D"""
    graph = drawn_graph([(0, 0), (1, 0), (5, 0), (6, 0)], [(0, 1, 100.0), (2, 3, 100.0)])
    travel = travel_between(graph, [[leg(0, 0)]], [[leg(3, 0)], []])
    assert np.isinf(travel.length_m).all()
    with pytest.raises(NoWay):
        travel.path(0, 0)


def test_a_place_is_never_a_way_through():
    """A   B, joined by nothing but one sink and one source that attach to both."""
    graph = drawn_graph([(0, 0), (1, 0)], [])
    both = [leg(0, 1), leg(1, 1)]
    travel = travel_between(graph, [[leg(0, 1)], both], [both, [leg(1, 1)]])
    assert travel.cost[0, 0] == 2.0
    assert np.isinf(travel.cost[0, 1])


def test_a_direct_leg_wins_when_it_costs_less():
    graph = drawn_graph([(0, 0), (1, 0)], [(0, 1, 100.0)])
    travel = travel_between(
        graph, [[leg(0, 10)]], [[leg(1, 10)], [leg(1, 10)]], [DirectLeg(0, 0, 50.0, 100.0), DirectLeg(0, 1, 90.0, 180.0)]
    )
    assert travel.length_m.tolist() == [[50.0, 120.0]]
    assert travel.path(0, 0).tolist() == []
    assert travel.path(0, 1).tolist() == [0, 1]


def test_of_two_legs_to_one_node_the_cheaper_counts():
    graph = drawn_graph([(0, 0), (1, 0)], [(0, 1, 100.0)])
    travel = travel_between(graph, [[leg(0, 30), leg(0, 10)]], [[leg(1, 5), leg(1, 3)]])
    assert travel.length_m[0, 0] == 113.0


def test_a_graph_without_nodes_reaches_nothing_but_directly():
    travel = travel_between(drawn_graph([], []), [[], []], [[]], [DirectLeg(1, 0, 3.0, 4.0)])
    assert travel.length_m.tolist() == [[np.inf], [3.0]]


def attachments(nodes: int) -> st.SearchStrategy[list[Attachment]]:
    return st.lists(st.builds(leg, st.integers(0, nodes - 1), st.integers(0, 500).map(float), st.sampled_from([1.0, 2.0])), max_size=4)


@st.composite
def plannings(draw: st.DrawFn):
    """Random graphs rich in long chains, cycles and loose ends, with places attached to them."""
    nodes = draw(st.integers(2, 40))
    chain = [(a, a + 1) for a in range(nodes - 1) if draw(st.integers(0, 9))]
    extra = draw(st.lists(st.tuples(st.integers(0, nodes - 1), st.integers(0, nodes - 1)), max_size=nodes // 2))
    renamed = draw(st.permutations(range(nodes)))
    pairs = sorted({(min(renamed[a], renamed[b]), max(renamed[a], renamed[b])) for a, b in chain + extra if a != b})
    edges = [(a, b, draw(st.integers(1, 1000)) / 7) for a, b in pairs]
    factor = [draw(st.sampled_from([1.0, 2.0])) for _ in edges]
    graph = drawn_graph([(float(a), 0.0) for a in range(nodes)], edges, factor=factor)
    return graph, draw(st.lists(attachments(nodes), min_size=1, max_size=4)), draw(st.lists(attachments(nodes), min_size=1, max_size=4))


def networkx_copy(graph, outward, inward) -> nx.DiGraph:
    copy = nx.DiGraph()
    copy.add_nodes_from(range(graph.node_count))
    for (a, b), metres, cost in zip(graph.edge.tolist(), graph.length_m.tolist(), graph.cost.tolist(), strict=True):
        copy.add_edge(a, b, cost=cost, metres=metres)
        copy.add_edge(b, a, cost=cost, metres=metres)
    for name, legs_of in (("source", outward), ("sink", inward)):
        for number, legs in enumerate(legs_of):
            copy.add_node((name, number))
            for one in sorted(legs, key=lambda leg: -leg.cost):
                ends = ((name, number), one.node) if name == "source" else (one.node, (name, number))
                copy.add_edge(*ends, cost=one.cost, metres=one.length_m)
    return copy


@given(plannings())
def test_ways_equal_those_of_networkx(planning):
    graph, outward, inward = planning
    travel = travel_between(graph, outward, inward)
    copy = networkx_copy(graph, outward, inward)
    for source in range(len(outward)):
        known = nx.single_source_dijkstra_path_length(copy, ("source", source), weight="cost")
        for sink in range(len(inward)):
            expected = known.get(("sink", sink), np.inf)
            assert travel.cost[source, sink] == pytest.approx(expected, abs=1e-6)
            if np.isfinite(expected):
                way = [("source", source), *travel.path(source, sink).tolist(), ("sink", sink)]
                assert nx.path_weight(copy, way, "cost") == pytest.approx(expected, abs=1e-6)
                assert nx.path_weight(copy, way, "metres") == pytest.approx(travel.length_m[source, sink], abs=1e-6)


@given(plannings())
def test_costs_are_symmetric_and_obey_the_triangle_inequality(planning):
    graph, outward, _ = planning
    nodes = [[leg(legs[0].node, 0.0)] for legs in outward if legs]
    if not nodes:
        return
    cost = travel_between(graph, nodes, nodes).cost
    reachable = np.where(np.isinf(cost), 1e12, cost)
    assert reachable == pytest.approx(reachable.T, abs=1e-6)
    detour = (reachable[:, :, None] + reachable[None, :, :]).min(axis=1)
    assert (reachable <= detour + 1e-6).all()


def test_a_search_in_blocks_of_sources_finds_the_same(monkeypatch):
    """A --100-- B --80-- C, five sources, two at a time"""
    graph = drawn_graph([(0, 0), (1, 0), (2, 0)], [(0, 1, 100.0), (1, 2, 80.0)])
    outward = [[leg(number % 3, number)] for number in range(5)]
    whole = travel_between(graph, outward, [[leg(2, 0)]])
    monkeypatch.setattr(shortest_paths, "ENTRIES_PER_BLOCK", 6)
    in_blocks = travel_between(graph, outward, [[leg(2, 0)]])
    assert in_blocks.cost.tolist() == whole.cost.tolist()
    assert in_blocks.length_m.tolist() == whole.length_m.tolist() == [[180.0], [81.0], [2.0], [183.0], [84.0]]
    assert [in_blocks.path(source, 0).tolist() for source in range(5)] == [[0, 1, 2], [1, 2], [2], [0, 1, 2], [1, 2]]
