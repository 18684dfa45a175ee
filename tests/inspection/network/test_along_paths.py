"""Sums along ways: by hand, and against walking every way."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import DirectLeg
from inspection.network.paths.along_paths import leg_of_way, quantities_of_ways, steps_of_graph, sums_along
from inspection.network.paths.paths import DIRECT, Travel, travel_between
from inspection.network.route_index import route_index
from tests.inspection.network.drawn_graphs import drawn_graph
from tests.inspection.network.test_paths import leg, plannings


def taken_by(graph: InspectionGraph, amount: np.ndarray) -> np.ndarray:
    """(p, 2, q): of each chain's steps there and back what amount (n, n, q) has for the way from node to node."""
    contracted = route_index(graph).contracted
    taken = np.zeros((len(contracted.place_node), 2, amount.shape[2]))
    for first, end in pairwise(contracted.chain_first.tolist()):
        for place in range(first + 1, end):
            before, node = contracted.place_node[place - 1], contracted.place_node[place]
            taken[place, 0], taken[place, 1] = amount[before, node], amount[node, before]
    return taken


def walked(travel: Travel, source: int, sink: int, amount: np.ndarray, out: np.ndarray, back: np.ndarray) -> np.ndarray:
    nodes = travel.path(source, sink).tolist()
    start, end = (leg_of_way(way, travel.entry_leg) for way in travel.way[source, sink].tolist())
    assert (travel.leg_node[start], travel.leg_node[end]) == (nodes[0], nodes[-1])
    total = out[start] + back[end]
    for left, right in pairwise(nodes):
        total = total + amount[left, right]
    return total


def test_there_and_back_take_what_each_direction_takes():
    """A -- B -- C, 1 and 2 to the right, 10 and 20 to the left; the legs take 100 out and 1,000 back."""
    graph = drawn_graph([(0, 0), (1, 0), (2, 0)], [(0, 1, 100.0), (1, 2, 80.0)])
    amount = np.zeros((3, 3, 1))
    amount[0, 1], amount[1, 2], amount[1, 0], amount[2, 1] = 1, 2, 10, 20
    places = [leg(0, 5)], [leg(2, 7)]
    travel = travel_between(graph, places, places)
    sums = sums_along(graph, taken_by(graph, amount))
    found = quantities_of_ways(travel, sums, np.full((2, 1), 100.0), np.full((2, 1), 1000.0), np.zeros((2, 2, 1)))
    assert found.tolist() == [[[1100, 1103], [1130, 1100]]]


def test_a_direct_leg_takes_its_own_and_no_way_takes_endlessly():
    graph = drawn_graph([(0, 0), (1, 0)], [])
    travel = travel_between(graph, [[leg(0, 5)]], [[leg(1, 7)], [leg(1, 7)]], [DirectLeg(0, 0, 3.0, 3.0)])
    sums = sums_along(graph, taken_by(graph, np.zeros((2, 2, 2))))
    found = quantities_of_ways(travel, sums, np.zeros((3, 2)), np.zeros((3, 2)), np.full((1, 2, 2), 7.0))
    assert found.tolist() == [[[7.0, np.inf]], [[7.0, np.inf]]]


def test_steps_are_the_edges_with_their_directions():
    """A straight north, then straight east."""
    graph = drawn_graph([(0, 0), (0, 0.01), (0.01, 0.01)], [(0, 1, 100.0), (1, 2, 80.0)])
    steps = steps_of_graph(graph)
    contracted = route_index(graph).contracted
    order = 1 if contracted.place_node[0] == 0 else -1
    assert steps.length_m.tolist()[::1] == ([0, 100, 80] if order == 1 else [0, 80, 100])
    assert steps.north[1 if order == 1 else 2] == pytest.approx(order)
    assert steps.east[2 if order == 1 else 1] == pytest.approx(order)


@given(plannings(), st.integers(0, 2**32 - 1))
def test_sums_agree_with_walking_every_way(planning, seed: int):
    graph, outward, inward = planning
    travel = travel_between(graph, outward, inward, [DirectLeg(0, 0, 50.0, 50.0)])
    draw = np.random.default_rng(seed)
    amount = draw.integers(0, 1000, (graph.node_count, graph.node_count, 2)).astype(float)
    out, back = draw.integers(0, 1000, (2, len(travel.leg_node), 2)).astype(float)
    direct = draw.integers(0, 1000, (len(outward), len(inward), 2)).astype(float)
    found = quantities_of_ways(travel, sums_along(graph, taken_by(graph, amount)), out, back, direct)
    for source in range(len(outward)):
        for sink in range(len(inward)):
            if np.isinf(travel.length_m[source, sink]):
                assert np.isinf(found[:, source, sink]).all()
            elif travel.way[source, sink, 0] == DIRECT:
                assert found[:, source, sink].tolist() == direct[source, sink].tolist()
            else:
                assert found[:, source, sink] == pytest.approx(walked(travel, source, sink, amount, out, back))
