"""Ways between attached places: by hand, against networkx, and against a search over the whole graph."""

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.network.legs import Attachment, DirectLeg, NoPath
from inspection.network.paths.along_paths import BEND, passed_on
from inspection.network.paths.contracted_graph import CORE, contract
from inspection.network.paths.paths import travel_between
from inspection.network.route_index import route_index
from tests.inspection.network import search_oracle
from tests.inspection.network.drawn_graphs import drawn_graph


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
    with pytest.raises(NoPath):
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
    nodes, first = travel.paths(np.array([[0, 0], [0, 1], [0, 0]]))
    assert (nodes.tolist(), first.tolist()) == ([0, 1], [0, 0, 2, 2])


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
    """Random graphs of chains between junctions, rings, islands and lone nodes, with places attached to them.

    Chains may run side by side between two junctions or come back to the one that they left; edges may be 0 m long.
    """
    junctions = draw(st.integers(1, 6))
    nodes, pairs = junctions, []
    for _ in range(draw(st.integers(0, 10))):
        tail, head = draw(st.integers(0, junctions - 1)), draw(st.integers(0, junctions - 1))
        inner = draw(st.integers(2 if tail == head else 0, 6))
        chain = [tail, *range(nodes, nodes + inner), head]
        pairs += list(pairwise(chain))
        nodes += inner
    for _ in range(draw(st.integers(0, 2))):  # rings that meet nothing
        around = draw(st.integers(3, 6))
        pairs += [(nodes + number, nodes + (number + 1) % around) for number in range(around)]
        nodes += around
    nodes += draw(st.integers(0, 2))
    renamed = draw(st.permutations(range(nodes)))
    pairs = sorted({(min(renamed[a], renamed[b]), max(renamed[a], renamed[b])) for a, b in pairs})
    edges = [(a, b, draw(st.integers(0, 1000)) / 7) for a, b in pairs]
    factor = [draw(st.sampled_from([1.0, 2.0])) for _ in edges]
    graph = drawn_graph([(float(a), 0.0) for a in range(nodes)], edges, factor=factor)
    both = draw(st.lists(attachments(nodes), max_size=2))  # places that are source and sink, as the targets of a mission are
    outward = both + draw(st.lists(attachments(nodes), min_size=1, max_size=4))
    return graph, outward, both + draw(st.lists(attachments(nodes), min_size=1, max_size=4))


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


@pytest.mark.long
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


@given(plannings())
def test_ways_equal_those_of_a_search_over_the_whole_graph(planning):
    graph, outward, inward = planning
    direct = [DirectLeg(0, 0, 60.0, 120.0)]
    travel, searched = travel_between(graph, outward, inward, direct), search_oracle.travel_between(graph, outward, inward, direct)
    assert travel.cost == pytest.approx(searched.cost, abs=1e-6)
    assert (np.isinf(travel.length_m) == np.isinf(searched.length_m)).all()


@pytest.mark.long
@given(plannings())
def test_condensing_keeps_every_edge_and_node_once(planning):
    graph, _, _ = planning
    contracted = contract(graph.node_count, graph.edge, graph.cost, graph.length_m)
    degree = np.bincount(graph.edge.ravel(), minlength=graph.node_count)
    within = contracted.node_chain != CORE
    assert (degree[within] == 2).all()
    assert sorted(contracted.core_node.tolist()) == np.flatnonzero(~within).tolist()
    first = contracted.chain_first.tolist()
    walked = []
    for chain, (begin, end) in enumerate(pairwise(first)):
        nodes = contracted.place_node[begin:end].tolist()
        assert (contracted.core_node[[contracted.chain_tail[chain], contracted.chain_head[chain]]] == [nodes[0], nodes[-1]]).all()
        assert (contracted.node_chain[nodes[1:-1]] == chain).all()
        assert (contracted.place_node[contracted.node_place[nodes[1:-1]]] == nodes[1:-1]).all()
        walked += [tuple(sorted(pair)) for pair in pairwise(nodes)]
    assert sorted(walked) == sorted(map(tuple, graph.edge.tolist()))
    assert contracted.chain_m.sum() == pytest.approx(graph.length_m.sum())
    assert contracted.chain_cost.sum() == pytest.approx(graph.cost.sum())


def test_two_places_on_one_ring_are_joined_the_short_way_round():
    """A ring of five that meets nothing, 100 m from node to node."""
    graph = drawn_graph([(float(number), 0.0) for number in range(5)], [(a, (a + 1) % 5, 100.0) for a in range(5)])
    travel = travel_between(graph, [[leg(1, 0)]], [[leg(number, 0)] for number in range(5)])
    assert travel.length_m.tolist() == [[100.0, 0.0, 100.0, 200.0, 200.0]]
    assert travel.path(0, 4).tolist() == [1, 0, 4]
    assert travel.path(0, 3).tolist() == [1, 2, 3]


def test_two_edges_between_two_nodes_count_as_the_cheaper():
    contracted = contract(2, np.array([[0, 1], [0, 1], [1, 1]]), np.array([5.0, 3.0, 1.0]), np.array([5.0, 3.0, 1.0]))
    assert contracted.core_count == 1
    assert contracted.chain_m.tolist() == [8.0]


def test_the_index_is_made_once_even_when_threads_ask_at_the_same_time():
    graph = drawn_graph([(0, 0), (1, 0), (2, 0)], [(0, 1, 100.0), (1, 2, 80.0)])
    with ThreadPoolExecutor(8) as threads:
        made = list(threads.map(lambda _: route_index(graph), range(32)))
    assert all(index is made[0] for index in made)


def test_threads_that_share_an_index_get_their_own_answers():
    random = np.random.default_rng(5)
    count = 400
    edges = {(min(a, b), max(a, b)) for a, b in random.integers(0, count, (600, 2)).tolist() if a != b}
    graph = drawn_graph([(0.0, 0.0)] * count, [(a, b, float(random.integers(1, 900))) for a, b in sorted(edges)])
    asked = [[[leg(int(node), 1.0)] for node in nodes] for nodes in random.integers(0, count, (40, 6))]
    alone = [travel_between(graph, places, places) for places in asked]
    with ThreadPoolExecutor(8) as threads:
        together = list(threads.map(lambda places: travel_between(graph, places, places), asked * 5))
    for number, travel in enumerate(together):
        expected = alone[number % len(asked)]
        assert (travel.cost == expected.cost).all()
        if np.isfinite(travel.cost[0, 1]):
            assert travel.path(0, 1).tolist() == expected.path(0, 1).tolist()


def test_what_a_way_passes_has_the_bends_of_its_legs_in_the_order_flown():
    """x --(a, b)-- 0 --- 1 --- 2 --(c)-- y by the graph; x --(d)-- z straight, without it.

    Whether the way meets in a hub or stays within one chain, the same.
    """
    place = [(9.0, 47.0), (9.001, 47.0), (9.002, 47.0), (9.003, 47.0)]
    a, b, c, d = (8.9, 47.1), (8.95, 47.1), (9.05, 47.2), (8.8, 46.9)
    for edges in ([(0, 1, 76.0), (1, 2, 76.0)], [(0, 1, 76.0), (1, 2, 76.0), (1, 3, 50.0)]):
        graph = drawn_graph(place, edges)
        x, y, z = [Attachment(0, 90.0, 180.0, (a, b))], [Attachment(2, 40.0, 80.0, (c,)), Attachment(1, 900.0, 900.0)], []
        travel = travel_between(graph, [x], [y, z], [DirectLeg(0, 1, 50.0, 100.0, (d,))])
        reported = passed_on(travel, np.array([(0, 0), (0, 1)]), graph.position)
        assert reported.position.tolist() == [list(at) for at in (a, b, *place[:3], c, d)]
        assert (reported.node.tolist(), reported.first.tolist()) == ([BEND, BEND, 0, 1, 2, BEND, BEND], [0, 6, 7])
        assert travel.length_m.tolist() == [[90.0 + 152.0 + 40.0, 50.0]]
        back = travel_between(graph, [y], [x])
        assert passed_on(back, np.array([(0, 0)]), graph.position).position.tolist() == [list(at) for at in (c, *place[2::-1], b, a)]


def test_without_bends_nodes_alone_are_passed():
    graph = drawn_graph([(9.0, 47.0), (9.001, 47.0)], [(0, 1, 76.0)])
    travel = travel_between(graph, [[Attachment(0, 1.0, 1.0)]], [[Attachment(1, 1.0, 1.0)]])
    reported = passed_on(travel, np.array([(0, 0)]), graph.position)
    assert (reported.node.tolist(), reported.position.tolist()) == ([0, 1], graph.position.tolist())
