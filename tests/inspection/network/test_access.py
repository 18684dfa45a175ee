"""Legs from a position onto the graph."""

import numpy as np
import pytest
from shapely import box

from inspection.geodesy import LonLat, distance_m, path_length_m
from inspection.network.paths.access import MAX_ROUND, LegRules, clear_legs
from inspection.network.rules import FlownHeights
from inspection.network.zones.zone_index import ZoneIndex
from tests.inspection.network.drawn_graphs import drawn_graph

NO_ZONES = ZoneIndex([], [], [])
ROW = [(10.0 + 0.001 * number, 50.0) for number in range(100)]
CHAIN = drawn_graph(ROW, [(number, number + 1, 72.0) for number in range(99)])


def legs(graph=CHAIN, zones=NO_ZONES, position=LonLat(10.0, 50.001), *, radius_m=2_000.0, want=24):  # noqa: B008  # LonLat is immutable
    return clear_legs(graph, zones, position, LegRules(radius_m, 2.0, 5.0), want=want)


def test_the_nearest_nodes_come_first_with_their_geodesic_length():
    found = legs(want=3)
    assert [leg.node for leg in found] == [0, 1, 2]
    expected = distance_m(np.array([(10.0, 50.001)] * 3), CHAIN.position[:3])
    assert [leg.length_m for leg in found] == pytest.approx(expected.tolist(), abs=1e-9)
    assert [leg.cost for leg in found] == pytest.approx((2 * expected).tolist(), abs=1e-9)


def test_at_a_node_the_leg_is_0_m():
    assert legs(position=LonLat(10.005, 50.0), want=1)[0] == (legs(position=LonLat(10.005, 50.0))[0])
    assert legs(position=LonLat(10.005, 50.0), want=1)[0].node == 5
    assert legs(position=LonLat(10.005, 50.0), want=1)[0].length_m == 0.0


def test_no_leg_is_longer_than_the_radius():
    found = legs(radius_m=300.0, want=100)
    assert [leg.node for leg in found] == [0, 1, 2, 3]
    assert max(leg.length_m for leg in found) <= 300.0


def test_the_search_widens_past_nodes_behind_a_zone_and_the_nearest_of_these_are_reached_round_it():
    """The wall stands between the position and the first forty nodes; round its western end it is 1.5 km."""
    wall = ZoneIndex([box(9.99, 50.0004, 10.02, 50.0006)], [7], ["wall"])
    found = legs(zones=wall, want=3, radius_m=10_000)
    straight, bent = list(found)[:-MAX_ROUND], list(found)[-MAX_ROUND:]
    assert len(straight) == 3
    assert straight[0].node > 35
    assert [leg.bends for leg in straight] == [()] * 3
    assert [leg.node for leg in bent] == list(range(MAX_ROUND))
    assert all(len(leg.bends) == 2 for leg in bent)
    for leg in found:
        line = np.array([(10.0, 50.001), *leg.bends, CHAIN.position[leg.node]])
        assert not wall.meets(line[:-1], line[1:], 5.0).any()
        assert (leg.length_m, leg.cost) == pytest.approx((path_length_m(line), 2 * path_length_m(line)), abs=1e-6)


def test_no_way_round_is_longer_than_the_radius():
    wall = ZoneIndex([box(9.99, 50.0004, 10.02, 50.0006)], [7], ["wall"])
    assert not len(legs(zones=wall, radius_m=1_400.0))
    assert len(legs(zones=wall, radius_m=1_600.0))


def test_a_leg_too_near_to_a_zone_goes_round_it():
    """The zone ends 4 m (south) and 6 m (north) short of the leg to node 0; 5 m are kept."""
    four_m, six_m = 4 / 71_687, 6 / 71_687
    near, far = (ZoneIndex([box(9.9, 50.0004, 10.0 - gap, 50.0006)], [1], ["near"]) for gap in (four_m, six_m))
    bends_to_0 = [[leg.bends for leg in legs(zones=zones) if leg.node == 0] for zones in (near, far)]
    assert [len(bends) for bends in bends_to_0[0]] == [2]
    assert bends_to_0[1] == [()]


def test_heights_decide_what_stands_in_the_way():
    """The nodes' towers are taken to be 45 m tall and are passed at 60 m, as is a place without height; 20 m less or 30 m more are met."""
    for floor_m, is_straight in ((90.0, False), (91.0, True)):
        wall = ZoneIndex([box(9.99, 50.0004, 10.02, 50.0006)], [7], ["wall"], floor_agl_m=[floor_m])
        rules = LegRules(2_000.0, 2.0, 5.0, FlownHeights())
        found = clear_legs(CHAIN, wall, LonLat(10.0, 50.001), rules)
        assert (found[0].bends == ()) == is_straight
        assert clear_legs(CHAIN, wall, LonLat(10.0, 50.001), rules, height_m=None)[0].bends != ()


def test_a_component_behind_a_zone_is_reached_round_it():
    """A long row near by, and one tower across the field, joined to nothing, with a zone before it."""
    graph = drawn_graph([*ROW, (10.0, 50.01)], [(number, number + 1, 72.0) for number in range(99)])
    before = ZoneIndex([box(9.999, 50.005, 10.001, 50.006)], [1], ["before"])
    found = legs(graph, before, want=3)
    assert [(leg.node, len(leg.bends)) for leg in found] == [(0, 0), (1, 0), (2, 0), (100, 2)]


def test_a_position_inside_a_zone_has_no_legs():
    assert not len(legs(zones=ZoneIndex([box(9.999, 50.0005, 10.001, 50.0015)], [1], ["around"])))


def test_a_component_beyond_the_nearest_nodes_is_offered_too():
    """A long row near by, and one tower across the field that is joined to nothing."""
    graph = drawn_graph([*ROW, (10.0, 50.01)], [(number, number + 1, 72.0) for number in range(99)])
    found = legs(graph, position=LonLat(10.0, 50.001), want=3)
    assert [leg.node for leg in found] == [0, 1, 2, 100]


def test_no_leg_crosses_the_antimeridian():
    graph = drawn_graph([(179.999, 0.0), (-179.999, 0.0)], [])
    assert [leg.node for leg in legs(graph, position=LonLat(179.998, 0.0))] == [0]


def test_an_empty_graph_offers_nothing():
    assert not len(legs(drawn_graph([], [])))


def test_a_graph_cannot_be_written_to():
    position = np.array([(10.0, 50.0), (10.001, 50.0)])
    graph = drawn_graph(position, [(0, 1, 72.0)])
    position[0] = 9.0  # the drawer's own array
    with pytest.raises(ValueError, match="read-only"):
        graph.position[0] = 9.0
