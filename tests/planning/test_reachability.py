"""Which assets can be inspected, by hand and against what the planner itself says of each."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat, distance_m
from inspection.network.build.flyable import flyable_part
from inspection.network.build.network import Network
from inspection.network.build.zone_masking import masked
from inspection.network.inspection_graph import EdgeKind, NodeKind
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex
from planning.connection_points import AccessRules, Terminal, paths_between
from planning.energy.assignment_costs import Finish, FlownVisits, FlyingFleet, flight_costs
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import FlightClass
from planning.energy.performance import Performance
from planning.problem import End
from planning.reachability.reachability import FlownNetwork, PossibleFlight, reach
from planning.reachability.reachable_assets import Reachability
from planning.rules import FlightRules

RULES = AccessRules(access_leg_m=10_000.0, direct_leg_m=5_000.0, on_asset_m=250.0, off_network_factor=2.0, zone_clearance_m=5.0)
LINKING = LinkingRules()
HEIGHTS = FlownHeights(60.0, 15.0, 10.0, 10.0)
SPAN_DEG = 0.01  # of longitude on the equator: 1,113 m
SPAN_M = 1_113.2
LINE = 900  # the first line's key


def network(lines, heights_m=None):
    """Lines of towers on the equator or anywhere: lists of (lon, lat). Towers are assets 1, 2, ...; lines 900, 901, ..."""
    position = np.array([place for line in lines for place in line], dtype=float)
    edge, owner, at = [], [], 0
    for number, line in enumerate(lines):
        edge += [(at + place, at + place + 1) for place in range(len(line) - 1)]
        owner += [LINE + number] * (len(line) - 1)
        at += len(line)
    pairs = np.array(edge, dtype=np.int32).reshape(-1, 2)
    length_m = distance_m(position[pairs[:, 0]], position[pairs[:, 1]])
    return Network(
        position=position,
        node_kind=np.full(at, NodeKind.SUPPORT, dtype=np.uint8),
        node_asset=np.arange(1, at + 1),
        node_height_m=np.full(at, np.nan) if heights_m is None else np.array(heights_m, dtype=float),
        edge=pairs,
        length_m=length_m,
        cost=length_m,
        edge_kind=np.full(len(pairs), EdgeKind.LINE, dtype=np.uint8),
        edge_asset=np.array(owner, dtype=np.int64),
    )


def row(count, *, first=0, lat=0.0):
    return [((first + number) * SPAN_DEG, lat) for number in range(count)]


def zone_index(*boxes):
    return ZoneIndex(
        [shapely.box(*box) for box in boxes], np.arange(len(boxes)) + 1, [f"zone {number + 1}" for number in range(len(boxes))]
    )


def judged(ground, flights, *, zones=None, bases=(), no_landing=None, **more):
    zones = zone_index() if zones is None else zones
    whole = masked(ground, zones, LINKING, HEIGHTS).graph
    flown = FlownNetwork(ground, whole, flyable_part(whole, FlightRules().tallest_m), zones, zones, no_landing)
    return reach(flown, flights, bases, RULES, **more)


def reachabilities(found):
    return dict(zip(found.asset.tolist(), [Reachability(reachability) for reachability in found.state.tolist()], strict=True))


def flight(lon, lat=0.0, end=End.OPEN, limit_m=np.inf):
    return PossibleFlight(LonLat(lon, lat), end, limit_m)


def test_within_range_there_and_beyond_it_with_the_metres_missing():
    """T1 - T2 - T3 - T4, 1,113 m each; the UAV at T1 has 2,500 m: as far as T3, and 840 m too few for T4."""
    found = judged(network([row(4)]), [flight(0.0, limit_m=2_500.0)])
    assert reachabilities(found) == {
        1: Reachability.REACHABLE, 2: Reachability.REACHABLE, 3: Reachability.REACHABLE, 4: Reachability.BEYOND_RANGE,
        LINE: Reachability.PARTLY,
    }  # fmt: skip
    assert found.missing_m.tolist() == pytest.approx([0, 0, 0, 3 * SPAN_M - 2_500.0, 0], abs=1.0)
    assert found.flight.tolist() == [0, 0, 0, -1, -1]


def test_who_comes_back_reaches_half_as_far():
    found = judged(network([row(4)]), [flight(0.0, end=End.RETURN, limit_m=2_500.0)])
    assert [number for number, reachability in reachabilities(found).items() if reachability == Reachability.REACHABLE] == [1, 2]


def test_who_lands_at_the_nearest_base_needs_the_way_to_it():
    """The base is at T4: with 3,400 m, all three spans can be flown; the base away, nothing can."""
    ground = network([row(4)])
    end = row(4)[-1]
    found = judged(ground, [flight(0.0, end=End.ANY_BASE, limit_m=3_400.0)], bases=[LonLat(*end)])
    assert set(reachabilities(found).values()) == {Reachability.REACHABLE}
    found = judged(ground, [flight(0.0, end=End.ANY_BASE, limit_m=3_400.0)])
    assert set(reachabilities(found).values()) == {Reachability.CUT_OFF}


def test_of_those_that_can_the_one_that_flies_least_is_named():
    found = judged(network([row(5)]), [flight(0.0), flight(4 * SPAN_DEG), flight(2 * SPAN_DEG, limit_m=1.0)])
    assert found.flight.tolist() == [0, 0, 2, 1, 1, -1]


def test_a_tower_in_a_zone_and_the_zone_it_is_in():
    """T3 is inside; the network beyond it is reached round the zone by a leg off the line."""
    zones = zone_index((9.0, 9.0, 9.1, 9.1), (0.019, -0.001, 0.021, 0.001))
    found = judged(network([row(5)]), [flight(0.0)], zones=zones)
    assert reachabilities(found)[3] == Reachability.INSIDE_ZONE
    assert found.zone.tolist()[:5] == [-1, -1, 1, -1, -1]
    assert reachabilities(found)[LINE] == Reachability.PARTLY


def test_a_span_that_a_zone_crosses_is_no_more_inspected():
    zones = zone_index((0.004, -0.001, 0.006, 0.001))
    found = judged(network([row(2)]), [flight(0.0), flight(SPAN_DEG)], zones=zones)
    assert reachabilities(found) == {1: Reachability.REACHABLE, 2: Reachability.REACHABLE, LINE: Reachability.INSIDE_ZONE}


def test_a_tower_that_is_too_tall_to_be_flown_over():
    found = judged(network([row(3)], [30.0, 110.0, 30.0]), [flight(0.0)])
    assert reachabilities(found)[2] == Reachability.ABOVE_HEIGHT_LIMIT


@pytest.mark.long
def test_a_line_that_stands_alone_is_reached_over_a_leg_of_its_own_or_not_at_all():
    """A second line 8 km north of the first is reached over a leg from it; one 20 km north is cut off."""
    near, far = row(2, lat=0.072), row(2, lat=0.18)
    found = judged(network([row(2), near, far]), [flight(0.0, lat=-0.05)])
    assert reachabilities(found)[3] == Reachability.REACHABLE
    assert reachabilities(found)[5] == Reachability.CUT_OFF


def test_without_flights_nothing_is_reached():
    assert set(reachabilities(judged(network([row(2)]), [])).values()) == {Reachability.CUT_OFF}


def test_an_asset_knows_where_its_nodes_are():
    found = judged(network([row(3)]), [])
    assert found.box[-1].tolist() == pytest.approx([0.0, 0.0, 2 * SPAN_DEG, 0.0])


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_towers_are_judged_as_a_plan_of_one_target_would_judge_them(seed):
    generator = np.random.default_rng(seed)
    lines = [
        np.cumsum(generator.uniform(-0.012, 0.012, (int(generator.integers(2, 7)), 2)), axis=0) + generator.uniform(-0.06, 0.06, 2)
        for _ in range(int(generator.integers(1, 5)))
    ]
    ground = network([line.tolist() for line in lines])
    boxes = [
        (*corner, *(corner + generator.uniform(0.002, 0.02, 2)))
        for corner in generator.uniform(-0.08, 0.08, (int(generator.integers(0, 4)), 2))
    ]
    zones = zone_index(*boxes)
    ends = [End.OPEN, End.RETURN, End.ANY_BASE]
    places = [LonLat(*place) for place in generator.uniform(-0.08, 0.08, (3, 2)).tolist()]
    flights = [
        PossibleFlight(place, ends[int(generator.integers(3))], float(generator.choice([4_000.0, 9_000.0, np.inf]))) for place in places[:2]
    ]
    graph = masked(ground, zones, LINKING, HEIGHTS).graph

    found = judged(ground, flights, zones=zones, bases=places[2:])

    known = dict(zip(found.asset.tolist(), range(len(found.asset)), strict=True))
    for node in np.flatnonzero(graph.node_asset > 0).tolist():
        target = Terminal(LonLat(*graph.position[node].tolist()), int(graph.node_asset[node]))
        ways = paths_between(graph, zones, [Terminal(one.position) for one in flights], [target], [target], RULES, [Terminal(places[2])])
        needed_m = [
            ways.from_start_m[number, 0] + {End.OPEN: 0.0, End.RETURN: ways.to_start_m[0, number], End.ANY_BASE: ways.to_base_m[0]}[one.end]
            for number, one in enumerate(flights)
        ]
        able = [number for number, one in enumerate(flights) if needed_m[number] <= min(one.limit_m, 1e12)]
        place = known[int(graph.node_asset[node])]
        reachability = Reachability(found.state[place])
        assert (reachability == Reachability.CUT_OFF) == np.isinf(needed_m).all()
        if boxes:  # beside zones the legs from a line that stands alone may be others than a plan's
            continue
        if able:
            assert reachability == Reachability.REACHABLE
            assert needed_m[found.flight[place]] == pytest.approx(min(needed_m[number] for number in able), abs=0.01)
        elif reachability != Reachability.CUT_OFF:
            assert reachability == Reachability.BEYOND_RANGE
            assert found.missing_m[place] == pytest.approx(
                min(m - one.limit_m for m, one in zip(needed_m, flights, strict=True) if m < np.inf), abs=0.01
            )


IRIS = FlightClass(Performance(battery_wh=56.6, max_airspeed_mps=14.0), 10.0)
HEAVY = FlightClass(Performance(battery_wh=300.0, mass_kg=6.0, rotor_disk_m2=0.8, climb_speed_mps=4.0), 12.0)


def needed_wh(graph, zones, one, node, bases, conditions):
    """What an assignment counts for this node as the only target."""
    place = LonLat(*graph.position[node].tolist())
    target = Terminal(place, int(graph.node_asset[node]))
    ways = paths_between(graph, zones, [Terminal(one.position)], [target], [target], RULES, [Terminal(base) for base in bases])
    costs = flight_costs(
        graph, ways, fleet=FlyingFleet([one.flying], [Finish(one.end, one.lands)], [one.position]), bases=bases,
        visits=FlownVisits([[place]], [45.0 + 15.0], [10.0], [math.inf]), conditions=conditions, rules=FlightRules(),
    )  # fmt: skip
    return float(costs.wh.first[0, 0] + costs.wh.service[0, 0] + costs.wh.end[0, 0])


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_the_battery_is_counted_as_an_assignment_counts_it(seed):
    generator = np.random.default_rng(seed)
    lines = [
        np.cumsum(generator.uniform(-0.012, 0.012, (int(generator.integers(2, 7)), 2)), axis=0) + generator.uniform(-0.05, 0.05, 2)
        for _ in range(int(generator.integers(1, 4)))
    ]
    ground, zones = network([line.tolist() for line in lines]), zone_index()
    graph = masked(ground, zones, LINKING, HEIGHTS).graph
    places = [LonLat(*place) for place in generator.uniform(-0.05, 0.05, (2, 2)).tolist()]
    end, lands = [(End.OPEN, False), (End.OPEN, True), (End.RETURN, True), (End.ANY_BASE, True)][int(generator.integers(4))]
    flying = IRIS if generator.random() < 0.5 else HEAVY
    conditions = Conditions((WindLayer(60.0, float(generator.uniform(0.0, 12.0)), float(generator.uniform(0.0, 359.0))),))
    one = PossibleFlight(places[0], end, np.inf, lands, flying)

    found = judged(ground, [one], bases=places[1:], conditions=conditions)

    for place in np.flatnonzero(found.asset < LINE).tolist():
        node = int(np.flatnonzero(graph.node_asset == found.asset[place])[0])
        wanted_wh = needed_wh(graph, zones, one, node, places[1:], conditions)
        reachability = Reachability(found.state[place])
        if wanted_wh <= one.usable_wh:
            assert reachability == Reachability.REACHABLE
        elif np.isfinite(wanted_wh):
            assert reachability == Reachability.BEYOND_ENERGY
            assert found.missing_wh[place] == pytest.approx(wanted_wh - one.usable_wh, rel=1e-3, abs=0.02)
        else:
            assert reachability in {Reachability.WIND, Reachability.CUT_OFF}


def test_against_the_wind_the_battery_does_for_less_and_too_much_of_it_stops_all():
    """Eastward along the line against an east wind; the towers are the same distance away as in calm air."""
    ground, one = network([row(9)]), flight(0.0, end=End.RETURN)
    one = replace(one, lands=True, flying=IRIS)
    calm = judged(ground, [one])
    windy = judged(ground, [one], conditions=Conditions((WindLayer(60.0, 9.0, 90.0),)))
    storm = judged(ground, [one], conditions=Conditions((WindLayer(60.0, 15.0, 90.0),)))
    done = [int((found.state[:9] == Reachability.REACHABLE).sum()) for found in (calm, windy, storm)]
    assert 9 > done[0] > done[1] > done[2] == 0
    assert Reachability(calm.state[8]) == Reachability.BEYOND_ENERGY
    assert set(storm.state[:9].tolist()) == {Reachability.WIND}
