"""What an assignment counts of time and battery, against the timing of the routes drawn from it."""

import math
from dataclasses import replace
from itertools import chain, pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame
from inspection.network.build.flyable import node_heights_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.paths.along_paths import BEND, passed_on
from inspection.network.paths.paths import DIRECT
from inspection.network.zones.zone_index import ZoneIndex
from planning.connection_points import AccessRules, TargetPaths, Terminal, paths_between
from planning.energy.assignment_costs import Finish, FlightCosts, FlownVisits, FlyingFleet, flight_costs
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import FlightClass, NodeGround
from planning.energy.performance import Performance
from planning.energy.power import power_w
from planning.problem import End
from planning.rules import FlightRules, Manoeuvres
from planning.task import Task, TaskKind
from planning.trajectory.heights import pass_agl_m
from planning.trajectory.route_points import PassedNodes, TargetPoints, route_points, with_short_legs
from planning.trajectory.timing import Timing, timing
from planning.trajectory.waypoints import Waypoints
from tests.inspection.network.drawn_graphs import drawn_graph

RULES = FlightRules()
AT_ONCE_ROUND_CORNERS = FlightRules(manoeuvres=Manoeuvres(corner_mps2=math.inf))
ACCESS = AccessRules(access_leg_m=10_000, direct_leg_m=300, on_asset_m=300, off_network_factor=2.0, zone_clearance_m=5)
FRAME = LocalFrame.around(9.0, 47.0)
IRIS = FlightClass(Performance(battery_wh=56.6, max_airspeed_mps=14), 10.0)
HEAVY = FlightClass(Performance(battery_wh=600, mass_kg=6, rotor_disk_m2=0.8, climb_speed_mps=4, descent_speed_mps=2), 14.0)
RETURN, LAND, HOVER, BASE = Finish(End.RETURN, True), Finish(End.OPEN, True), Finish(End.OPEN, False), Finish(End.ANY_BASE, True)


def at(east_m: float, north_m: float) -> LonLat:
    return LonLat(*FRAME.to_degrees(np.array([[east_m, north_m]]))[0].tolist())


def line_graph(places: list[LonLat], heights_m: list[float], more: list[tuple[int, int]] = ()) -> InspectionGraph:
    """A line over the places, and edges besides."""
    pairs = [*pairwise(range(len(places))), *more]
    metres = [float(distance_m(np.array(places[a]), np.array(places[b]))[0]) for a, b in pairs]
    drawn = drawn_graph(places, [(a, b, m) for (a, b), m in zip(pairs, metres, strict=True)])
    return replace(drawn, node_height_m=np.array(heights_m, dtype=np.float64))


class World:
    """A graph with starts, bases and visits; each visit a course, a height above ground and seconds."""

    def __init__(
        self,
        graph: InspectionGraph,
        starts: list[LonLat],
        visits: list[tuple[list[LonLat], float, float]],
        bases: list[LonLat] = (),
        zones: list[shapely.Polygon] = (),
        most_mps: float = np.inf,
    ) -> None:
        self.most_mps = most_mps
        self.graph, self.starts, self.visits, self.bases = graph, starts, visits, bases
        self.ways: TargetPaths = paths_between(
            graph,
            ZoneIndex(list(zones), list(range(len(zones))), [""] * len(zones)),
            [Terminal(start) for start in starts],
            [Terminal(course[0]) for course, _, _ in visits],
            [Terminal(course[-1]) for course, _, _ in visits],
            ACCESS,
            [Terminal(base) for base in bases],
        )

    def costs(
        self, classes: list[FlightClass], finishes: list[Finish], conditions: Conditions, ground: NodeGround | None = None
    ) -> FlightCosts:
        return flight_costs(
            self.graph,
            self.ways,
            fleet=FlyingFleet(classes, finishes, self.starts),
            bases=self.bases,
            visits=FlownVisits(*([visit[part] for visit in self.visits] for part in range(3)), [self.most_mps] * len(self.visits)),
            conditions=conditions,
            rules=RULES,
            ground=ground,
        )

    def drawn(
        self, uav: int, order: list[int], flying: FlightClass, finish: Finish, conditions: Conditions, *, rules: FlightRules | None = None
    ) -> Timing:
        """Without turns of the course, unless the rules count them."""
        legs = np.array(self.ways.of_route(uav, order, finish.end), dtype=np.int64)
        reported = passed_on(self.ways.travel, legs, self.graph.position)
        agl_m = np.full(len(reported.node), RULES.transit_agl_m)
        nodes = reported.node[reported.node != BEND]
        agl_m[reported.node != BEND] = pass_agl_m(node_heights_m(self.graph, nodes), RULES)
        passed = PassedNodes(reported.position, agl_m, np.full(len(agl_m), -1), reported.first)
        targets = [
            TargetPoints(visit, tuple(course), agl_m, Task(TaskKind.HOLD, hold_s), None)
            for visit, (course, agl_m, hold_s) in ((visit, self.visits[visit]) for visit in order)
        ]
        base = self.bases[self.ways.nearest_base[order[-1]]] if finish.end is End.ANY_BASE else None
        home = self.starts[uav] if finish.end is End.RETURN else base
        points = route_points(start=self.starts[uav], transit_agl_m=RULES.transit_agl_m, targets=targets, ways=passed, home=home)
        points, _ = with_short_legs(points, RULES.longest_leg_m)
        return timing(
            Waypoints(points, None, points.agl_m),
            cruise_speed_mps=flying.cruise_speed_mps,
            performance=flying.performance,
            conditions=conditions,
            lands=finish.lands,
            rules=rules or AT_ONCE_ROUND_CORNERS,
        )


def counted(costs: FlightCosts, uav: int, order: list[int]) -> tuple[float, float]:
    """Seconds and Wh of a route as the assignment adds them up."""
    number = costs.class_of[uav]
    sums = []
    for taken in (costs.seconds, costs.wh):
        total = taken.first[uav, order[0]] + taken.end[order[-1], uav]
        total += sum(taken.onward[number, left, right] for left, right in pairwise(order))
        sums.append(float(total + sum(taken.along[number, visit] + taken.service[number, visit] for visit in order)))
    return sums[0], sums[1]


# Three towers of 45 m 1 km apart to the east, the UAV under the first, and a target of 30 m at the last, inspected at 45 m for 10 s.
TOWERS = line_graph([at(0, 0), at(1000, 0), at(2000, 0)], [45, 45, 45])
EAST = World(TOWERS, [at(0, 0)], [([at(2000, 0)], 45.0, 10.0)])
WEST_WIND = Conditions((WindLayer(10, 5, 270),))
# At 10 m/s and 2 m/s2: 1.5 s until it climbs and 2.5 s until it flies; 2.5 s to a stand, 1.5 s there and 2.5 s away again; to a stand, and
# the last 8 m at 0.7 instead of 2.5 m/s.
TAKING_OFF_S, STOPPING_S, LANDING_S = 4.0, 6.5, 4.0 + 8 / 0.7 - 8 / 2.5


def test_where_no_base_is_free_there_is_no_way_to_land_at_one() -> None:
    costs = EAST.costs([IRIS], [BASE], Conditions())
    assert costs.seconds.end.tolist() == costs.wh.end.tolist() == [[np.inf]]
    assert np.isfinite(costs.seconds.first).all()


def test_in_calm_air_a_route_takes_its_parts() -> None:
    """60 m up at 2.5 m/s, 2 km at 10 m/s, 15 m down, 10 s there, 15 m up, 2 km back and 60 m down; each with its manoeuvres."""
    costs = EAST.costs([IRIS], [RETURN], Conditions())
    assert costs.seconds.first[0, 0] == pytest.approx(24 + TAKING_OFF_S + 200, abs=0.01)
    assert costs.seconds.service[0, 0] == pytest.approx(6 + 10 + STOPPING_S, abs=0.01)
    assert costs.seconds.end[0, 0] == pytest.approx(6 + 200 + 24 + LANDING_S, abs=0.01)
    hover, level, up = (
        power_w(IRIS.performance),
        power_w(IRIS.performance, airspeed_mps=10),
        power_w(IRIS.performance, climb_mps=2.5),
    )
    assert costs.wh.first[0, 0] == pytest.approx((24 * up + TAKING_OFF_S * hover + 200 * level) / 3600, rel=1e-3)
    assert costs.wh.service[0, 0] == pytest.approx((6 + 10 + STOPPING_S) * hover / 3600, rel=1e-3)
    assert costs.wh.end[0, 0] == pytest.approx((6 * up + 200 * level + (24 + LANDING_S) * hover) / 3600, rel=1e-3)


@pytest.mark.parametrize(("most_mps", "flown_mps"), [(5.0, 5.0), (9.9, 9.9), (20.0, 10.0)])
def test_a_line_is_inspected_no_faster_than_asked_and_than_the_uav_flies(most_mps: float, flown_mps: float) -> None:
    along = [([at(0, 0), at(1000, 0), at(2000, 0)], 60.0, 0.0)]
    costs = World(TOWERS, [at(0, 0)], along, most_mps=most_mps).costs([IRIS], [RETURN], Conditions())
    assert costs.seconds.along[0, 0] == pytest.approx(2000 / flown_mps, rel=1e-3)
    as_fast = World(TOWERS, [at(0, 0)], along).costs([IRIS], [RETURN], Conditions())
    assert costs.seconds.first[0, 0] == as_fast.seconds.first[0, 0]
    assert costs.wh.along[0, 0] == pytest.approx(2000 / flown_mps * power_w(IRIS.performance, airspeed_mps=flown_mps) / 3600, rel=1e-2)


def test_wind_makes_the_way_there_and_the_way_back_differ() -> None:
    """14 m/s of airspeed hold 10 m/s against no more than 4 m/s: against 5 m/s it is 9 m/s."""
    costs = EAST.costs([IRIS], [RETURN], WEST_WIND)
    assert costs.seconds.first[0, 0] == pytest.approx(24 + TAKING_OFF_S + 200, abs=0.01)
    assert costs.seconds.end[0, 0] == pytest.approx(6 + 2000 / 9 + 24 + LANDING_S, abs=0.01)
    assert costs.wh.end[0, 0] > 1.2 * costs.wh.first[0, 0]


def test_a_tower_that_has_to_be_flown_over_counts() -> None:
    """The tower in the middle is 75 m high: 30 m up and down again, on legs of 1 km that take longer than the 12 s of a climb."""
    tall = World(replace(TOWERS, node_height_m=np.array([45.0, 75.0, 45.0])), EAST.starts, EAST.visits)
    over, level = tall.costs([IRIS], [RETURN], Conditions()), EAST.costs([IRIS], [RETURN], Conditions())
    assert over.seconds.first[0, 0] == pytest.approx(level.seconds.first[0, 0], abs=0.01)
    performance = IRIS.performance
    lifting_wh = 12 * (power_w(performance, airspeed_mps=10, climb_mps=2.5) - power_w(performance, airspeed_mps=10)) / 3600
    assert over.wh.first[0, 0] - level.wh.first[0, 0] == pytest.approx(lifting_wh, rel=1e-2)


def test_a_hill_counts_where_the_ground_is_known() -> None:
    """The last tower stands 300 m higher: 120 s at 2.5 m/s, on a leg of 100 s, and as much down again."""
    ground = NodeGround(np.array([400.0, 400.0, 700.0]), np.array([400.0, 700.0]), np.array([700.0, 400.0]))
    flat, hilly = (EAST.costs([IRIS], [RETURN], Conditions(), one) for one in (None, ground))
    assert hilly.seconds.first - flat.seconds.first == pytest.approx(20, abs=0.1)
    assert hilly.seconds.end - flat.seconds.end == pytest.approx(20, abs=0.1)
    assert hilly.wh.first[0, 0] > flat.wh.first[0, 0]


def test_ground_that_is_not_known_in_one_place_is_flat_there() -> None:
    ground = NodeGround(np.array([400.0, np.nan, 500.0]), np.array([400.0, 500.0]), np.array([500.0, 400.0]))
    flat, known = (EAST.costs([IRIS], [RETURN], Conditions(), one) for one in (None, ground))
    assert known.seconds.first == pytest.approx(flat.seconds.first)


def test_a_way_against_too_strong_a_wind_is_no_way() -> None:
    storm = Conditions((WindLayer(10, 13.8, 270),))
    costs = EAST.costs([IRIS], [RETURN], storm)
    assert np.isfinite(costs.seconds.first).all()
    assert np.isinf(costs.seconds.end).all()
    assert np.isinf(costs.wh.end).all()


def test_what_cannot_be_held_over_cannot_be_flown_to() -> None:
    """8 m/s up to 52 m, where the way down begins, and 20 m/s where the target is, at 45 m: no way there."""
    low_jet = Conditions((WindLayer(45, 20, 270), WindLayer(46, 8, 270)))
    costs = EAST.costs([IRIS], [RETURN], low_jet)
    assert np.isinf(costs.seconds.first).all()
    assert np.isfinite(costs.seconds.service).all()


def test_uavs_that_fly_alike_share_a_class() -> None:
    world = World(TOWERS, [at(0, 0)] * 3, EAST.visits)
    costs = world.costs([IRIS, HEAVY, IRIS], [RETURN] * 3, Conditions())
    assert costs.class_of == (0, 1, 0)
    assert costs.seconds.onward.shape == (2, 1, 1)
    assert costs.usable_wh.tolist() == pytest.approx([0.8 * 56.6, 480, 0.8 * 56.6])


def test_without_a_battery_nothing_is_counted_of_it() -> None:
    costs = EAST.costs([FlightClass(Performance(), 10.0)], [RETURN], WEST_WIND)
    assert costs.usable_wh.tolist() == [np.inf]
    assert costs.wh.first.tolist() == [[0.0]]


metres = st.integers(-3000, 3000).map(float)
places = st.builds(at, metres, metres)


@st.composite
def worlds(draw: st.DrawFn) -> World:
    nodes = draw(st.lists(places, min_size=2, max_size=8, unique=True))
    heights = draw(st.lists(st.floats(0, 104), min_size=len(nodes), max_size=len(nodes)))
    pairs = sorted({tuple(sorted((draw(st.integers(0, len(nodes) - 1)), draw(st.integers(0, len(nodes) - 1))))) for _ in range(3)})
    graph = line_graph(nodes, heights, [(a, b) for a, b in pairs if b > a + 1])
    others = draw(st.lists(places, min_size=4, max_size=7, unique=True).filter(lambda some: not set(some) & set(nodes)))
    visits = []
    for number, place in enumerate(others[3:]):
        course = [place, at(4000 + 100 * number, draw(metres))] if draw(st.booleans()) else [place]
        visits.append((course, draw(st.sampled_from([20.0, 60.0, 90.0])), draw(st.sampled_from([0.0, 30.0]))))
    return World(graph, others[:2], visits, [others[2]])


@settings(max_examples=60)
@given(worlds(), st.sampled_from([RETURN, LAND, HOVER, BASE]), st.floats(0, 8), st.floats(0, 359), st.data())
def test_the_assignment_counts_what_the_drawn_route_takes(
    world: World, finish: Finish, wind_mps: float, from_deg: float, data: st.DataObject
) -> None:
    conditions = Conditions((WindLayer(10, wind_mps, from_deg),), 5.0)
    classes = [IRIS, HEAVY]
    costs = world.costs(classes, [finish, finish], conditions)
    for uav in range(2):
        order = data.draw(st.permutations(range(len(world.visits))))
        drawn = world.drawn(uav, list(order), classes[uav], finish, conditions)
        seconds, wh = counted(costs, uav, list(order))
        assert seconds == pytest.approx(drawn.total_s, rel=1e-5, abs=0.05)
        assert wh == pytest.approx(drawn.total_wh, rel=1e-4, abs=0.01)
        turning = world.drawn(uav, list(order), classes[uav], finish, conditions, rules=RULES)
        assert turning.total_s >= drawn.total_s
        assert (turning.total_wh or 0.0) >= (drawn.total_wh or 0.0)


def wall(east_m: float, north_m: float) -> shapely.Polygon:
    """A zone of 40 m by 800 m."""
    corners = [(-20, -400), (20, -400), (20, 400), (-20, 400)]
    return shapely.Polygon([at(east_m + east, north_m + north) for east, north in corners])


@pytest.mark.parametrize("conditions", [Conditions(), WEST_WIND])
def test_legs_round_a_zone_take_what_is_flown(conditions: Conditions) -> None:
    """Both the start and the target lie beside the line, behind a zone."""
    world = World(TOWERS, [at(300, 900)], [([at(1700, -900)], 45.0, 10.0)], zones=[wall(150, 700), wall(1850, -700), wall(1500, -700)])
    assert world.ways.travel.leg_bends
    costs = world.costs([IRIS], [RETURN], conditions)
    drawn = world.drawn(0, [0], IRIS, RETURN, conditions)
    assert counted(costs, 0, [0]) == pytest.approx((drawn.total_s, drawn.total_wh), rel=1e-5)


def test_a_direct_way_round_a_zone_takes_what_is_flown() -> None:
    """Start and target lie 280 m apart and far from the line, a narrow zone between them."""
    post = shapely.Polygon([at(east, north) for east, north in [(130, 2480), (150, 2480), (150, 2520), (130, 2520)]])
    world = World(TOWERS, [at(0, 2500)], [([at(280, 2500)], 45.0, 10.0)], zones=[post])
    assert world.ways.travel.way[0, 0, 0] == DIRECT
    assert world.ways.travel.direct_bends
    costs = world.costs([IRIS], [RETURN], WEST_WIND)
    drawn = world.drawn(0, [0], IRIS, RETURN, WEST_WIND)
    assert counted(costs, 0, [0]) == pytest.approx((drawn.total_s, drawn.total_wh), rel=1e-4)


def test_nothing_is_below_0() -> None:
    world = World(TOWERS, [at(0, 0)], [([at(500, 20)], 20.0, 0.0), ([at(1500, 20)], 90.0, 0.0)])
    costs = world.costs([IRIS], [LAND], WEST_WIND)
    for taken in (costs.seconds, costs.wh):
        assert all((part >= 0).all() for part in vars(taken).values())


def test_all_pairs_have_numbers() -> None:
    world = World(TOWERS, [at(0, 0), at(10, 5)], [([at(500, 20)], 20.0, 0.0), ([at(1500, 20)], 90.0, 0.0)], [at(100, 100)])
    costs = world.costs([IRIS, HEAVY], [BASE, RETURN], WEST_WIND)
    assert all(np.isfinite(part).all() for part in chain(vars(costs.seconds).values(), vars(costs.wh).values()))


@settings(max_examples=60)
@given(worlds(), st.lists(st.tuples(st.floats(0, 16), st.floats(0, 359)), min_size=2, max_size=3), st.data())
def test_what_is_counted_as_open_can_be_flown_when_drawn(world: World, winds: list[tuple[float, float]], data: st.DataObject) -> None:
    """In wind that changes with height, drawing divides legs, and each part has the wind of its own height."""
    layers = tuple(WindLayer(30.0 + 40.0 * number, speed_mps, from_deg) for number, (speed_mps, from_deg) in enumerate(winds))
    costs = world.costs([IRIS, IRIS], [RETURN, RETURN], Conditions(layers))
    order = list(data.draw(st.permutations(range(len(world.visits)))))
    if np.isfinite(counted(costs, 0, order)).all():
        assert world.drawn(0, order, IRIS, RETURN, Conditions(layers)).total_s > 0


def test_a_jet_between_two_heights_closes_the_leg_between_them() -> None:
    """20 m/s at 91 m, and 6 m/s from 6 m below and above it on; the leg leads from 60 to 105 m, its middle is at 82.5 m."""
    jet = Conditions((WindLayer(60, 6, 270), WindLayer(85, 6, 270), WindLayer(91, 20, 270), WindLayer(97, 6, 270)))
    tall = World(replace(TOWERS, node_height_m=np.array([45.0, 90.0, 45.0])), EAST.starts, EAST.visits)
    assert np.isfinite(EAST.costs([IRIS], [RETURN], jet).seconds.first).all()
    assert np.isinf(tall.costs([IRIS], [RETURN], jet).seconds.first).all()
