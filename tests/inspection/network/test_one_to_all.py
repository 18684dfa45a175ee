"""Ways from one place to every node: by hand, against a search over the whole graph, and against walking every way."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from inspection.network.legs import NO_LEGS, Attachments
from inspection.network.paths.one_to_all import search_from
from inspection.network.paths.paths import travel_between
from inspection.network.route_index import route_index
from tests.inspection.network import search_oracle
from tests.inspection.network.drawn_graphs import drawn_graph
from tests.inspection.network.test_paths import leg


def test_every_node_has_its_way_and_what_cannot_be_reached_has_none():
    """start --5-- A --100-- B --80-- C     D"""
    graph = drawn_graph([(0, 0), (1, 0), (2, 0), (9, 0)], [(0, 1, 100.0), (1, 2, 80.0)])
    found = search_from(graph, Attachments.of([leg(0, 5, 2.0)]))
    assert found.cost.tolist() == [10.0, 110.0, 190.0, np.inf]
    assert found.length_m.tolist() == [5.0, 105.0, 185.0, np.inf]
    assert found.taken.shape == (4, 2, 0)


def test_from_a_place_that_meets_nothing_there_is_no_way():
    graph = drawn_graph([(0, 0), (1, 0)], [(0, 1, 100.0)])
    assert np.isinf(search_from(graph, NO_LEGS).cost).all()


def test_from_the_middle_of_a_line_both_ways_are_summed_up_in_their_direction():
    """A -- B -- C -- D: a step to the right takes 1, to the left 10; the leg to C takes 100 out and 1,000 back."""
    graph = drawn_graph([(0, 0), (1, 0), (2, 0), (3, 0)], [(0, 1, 50.0), (1, 2, 50.0), (2, 3, 50.0)])
    amount = np.zeros((4, 4))
    amount[[0, 1, 2], [1, 2, 3]], amount[[1, 2, 3], [0, 1, 2]] = 1.0, 10.0
    found = search_from(graph, Attachments.of([leg(2, 7)]), place_sum=_sums(graph, amount), leg_taken=np.array([[[100.0], [1_000.0]]]))
    assert found.taken[:, 0, 0].tolist() == [120.0, 110.0, 100.0, 101.0]
    assert found.taken[:, 1, 0].tolist() == [1_002.0, 1_001.0, 1_000.0, 1_010.0]


def _sums(graph, amount):
    """Sums of amount (n, n) along each chain from its first place, and back to it, as spread takes them."""
    contracted = route_index(graph).contracted
    sums = np.zeros((len(contracted.place_node), 2, 1))
    for first, end in pairwise(contracted.chain_first.tolist()):
        for place in range(first + 1, end):
            before, node = contracted.place_node[place - 1], contracted.place_node[place]
            sums[place, :, 0] = sums[place - 1, :, 0] + (amount[before, node], amount[node, before])
    return sums


@given(st.integers(0, 2**32 - 1), st.integers(2, 24), st.integers(1, 4))
def test_it_is_what_a_search_over_the_whole_graph_finds(seed, count, legs):
    generator = np.random.default_rng(seed)
    pairs = {tuple(sorted(generator.choice(count, 2, replace=False).tolist())) for _ in range(int(generator.integers(1, 2 * count)))}
    edges = [(one, other, float(generator.uniform(10.0, 500.0))) for one, other in sorted(pairs)]
    graph = drawn_graph([(0.001 * node, 0.0) for node in range(count)], edges, factor=generator.choice([1.0, 2.0], len(edges)).tolist())
    start = [leg(int(node), float(generator.uniform(0.0, 300.0)), 2.0) for node in generator.integers(0, count, legs)]
    ends = [[leg(node, 0.0)] for node in range(count)]
    amount = generator.uniform(0.0, 9.0, (count, count))
    leg_taken = generator.uniform(0.0, 9.0, (legs, 2, 1))

    found = search_from(graph, Attachments.of(start), place_sum=_sums(graph, amount), leg_taken=leg_taken)

    truth = search_oracle.travel_between(graph, [start], ends)
    np.testing.assert_allclose(found.cost, truth.cost[0])
    np.testing.assert_allclose(found.length_m, truth.length_m[0])
    travel = travel_between(graph, [start], ends)
    for node in np.flatnonzero(np.isfinite(found.cost)).tolist():
        way = travel.path(0, node).tolist()
        first = min((number for number, one in enumerate(start) if one.node == way[0]), key=lambda number: start[number].cost)
        there = leg_taken[first, 0, 0] + sum(amount[left, right] for left, right in pairwise(way))
        back = leg_taken[first, 1, 0] + sum(amount[right, left] for left, right in pairwise(way))
        np.testing.assert_allclose(found.taken[node, :, 0], [there, back])
