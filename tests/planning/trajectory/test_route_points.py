"""From ways and targets to the list of points."""

from collections.abc import Iterable

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat, distance_m
from planning.task import Task, TaskKind
from planning.trajectory.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs, without_idle_points
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from tests.planning.plain_route import plain_route

TRANSIT_M = 60.0
Way = list[tuple[float, float]]  # east and height of each node
PHOTO = Task(TaskKind.PHOTO, 10.0)


def at(east: float) -> LonLat:
    """A place on the equator, `east` thousandths of a degree from Greenwich."""
    return LonLat(east / 1_000, 0.0)


def node(east: float, agl_m: float = TRANSIT_M) -> tuple[float, float]:
    return east, agl_m


def passed(ways: list[Way]) -> PassedNodes:
    nodes = [node for way in ways for node in way]
    return PassedNodes(
        np.array([at(east) for east, _ in nodes], dtype=np.float64).reshape(-1, 2),
        np.array([agl_m for _, agl_m in nodes], dtype=np.float64),
        np.array([int(east) for east, _ in nodes], dtype=np.int64),
        np.cumsum([0, *map(len, ways)]),
    )


def target(index: int, *easts: float, agl_m: float = TRANSIT_M) -> TargetPoints:
    return TargetPoints(index, tuple(at(east) for east in easts), agl_m, PHOTO, asset=100 + index)


def draw(points: Iterable[RoutePoint]) -> list[str]:
    """Kind, place and height of each point, and the index of the target it belongs to: "pass 3 @60", "target 4 @30 #0"."""
    return [
        f"{point.kind} {point.position.lon * 1_000:.0f} @{point.agl_m:.0f}" + (f" #{point.target}" if point.target is not None else "")
        for point in points
    ]


def points_of(targets: list[TargetPoints], ways: list[Way], way_home: Way | None) -> RoutePoints:
    home = None if way_home is None else at(0)
    nodes = passed(ways if way_home is None else [*ways, way_home])
    return route_points(start=at(0), transit_agl_m=TRANSIT_M, targets=targets, ways=nodes, home=home)


def route(targets: list[TargetPoints], ways: list[Way], way_home: Way | None = None) -> list[str]:
    return draw(points_of(targets, ways, way_home))


NODES = st.lists(st.tuples(st.integers(0, 4), st.sampled_from([30.0, 60.0, 75.0])), max_size=4)


@given(
    stops=st.lists(
        st.tuples(NODES, st.lists(st.integers(0, 4), min_size=1, max_size=3), st.sampled_from([25.0, 60.0, 90.0])), min_size=1, max_size=3
    ),
    way_home=st.none() | NODES,
)
def test_any_route_is_that_of_the_plain_rules(stops: list[tuple[Way, list[int], float]], way_home: Way | None) -> None:
    """Few places and heights, so that they repeat."""
    targets = [target(number, *easts, agl_m=agl_m) for number, (_, easts, agl_m) in enumerate(stops)]
    ways = [way for way, _, _ in stops]
    plain_ways = [
        [RoutePoint(at(east), WaypointKind.PASS, agl_m, int(east)) for east, agl_m in way]
        for way in [*ways, *([way_home] if way_home else [[]])]
    ]
    home = None if way_home is None else at(0)
    assert list(points_of(targets, ways, way_home)) == plain_route(at(0), TRANSIT_M, targets, plain_ways, home)


def test_an_open_route_ends_hovering_at_its_last_target() -> None:
    assert route([target(0, 3)], [[node(1), node(2), node(3)]]) == [
        "start 0 @60",
        "pass 1 @60",
        "pass 2 @60",
        "target 3 @60 #0",
        "end 3 @60",
    ]


def test_a_route_that_returns_ends_above_its_start() -> None:
    assert route([target(0, 2)], [[node(1), node(2)]], way_home=[node(2), node(1)]) == [
        "start 0 @60",
        "pass 1 @60",
        "target 2 @60 #0",
        "pass 1 @60",
        "end 0 @60",
    ]


def test_the_node_of_a_target_is_not_passed_a_second_time() -> None:
    drawn = route([target(0, 2), target(1, 3)], [[node(2)], [node(2), node(3)]])
    assert drawn == ["start 0 @60", "target 2 @60 #0", "target 3 @60 #1", "end 3 @60"]


def test_a_low_target_is_reached_and_left_vertically() -> None:
    drawn = route([target(0, 2, agl_m=25), target(1, 4)], [[node(1), node(2)], [node(2), node(3), node(4)]])
    assert drawn == [
        "start 0 @60",
        "pass 1 @60",
        "pass 2 @60",
        "target 2 @25 #0",
        "pass 2 @60",
        "pass 3 @60",
        "target 4 @60 #1",
        "end 4 @60",
    ]


def test_a_low_target_off_the_network_is_left_vertically_too() -> None:
    drawn = route([target(0, 5, agl_m=25), target(1, 8, agl_m=25)], [[], []], way_home=[])
    assert drawn == [
        "start 0 @60",
        "pass 5 @60",
        "target 5 @25 #0",
        "pass 5 @60",
        "pass 8 @60",
        "target 8 @25 #1",
        "pass 8 @60",
        "end 0 @60",
    ]


def test_a_hundred_low_targets_off_the_network_are_all_there() -> None:
    """Three points each, without a node between them: no route of as few nodes has more points."""
    targets = [target(index, 2.0 * index + 1.0, agl_m=30.0) for index in range(100)]
    for way_home in (None, []):
        points = points_of(targets, [[] for _ in targets], way_home)
        home = None if way_home is None else at(0)
        assert list(points) == plain_route(at(0), TRANSIT_M, targets, [[] for _ in range(len(targets) + 1)], home)
        assert len(points) == (301 if way_home is None else 302)
        assert points[-1].kind is WaypointKind.END


def test_a_tall_target_is_passed_high_and_inspected_from_there() -> None:
    assert route([target(0, 2, agl_m=90)], [[node(1), node(2, 90)]]) == ["start 0 @60", "pass 1 @60", "target 2 @90 #0", "end 2 @90"]


def test_a_stretch_has_one_target_point_and_its_other_vertices_carry_the_index() -> None:
    drawn = route([target(0, 2, 3, 4), target(1, 6)], [[node(1), node(2)], [node(4), node(5), node(6)]])
    assert drawn == [
        "start 0 @60",
        "pass 1 @60",
        "target 2 @60 #0",
        "pass 3 @60 #0",
        "pass 4 @60 #0",
        "pass 5 @60",
        "target 6 @60 #1",
        "end 6 @60",
    ]


def test_a_low_stretch_is_flown_low_from_end_to_end() -> None:
    assert route([target(0, 2, 3, agl_m=25)], [[node(2)]], way_home=[node(3), node(1)]) == [
        "start 0 @60",
        "pass 2 @60",
        "target 2 @25 #0",
        "pass 3 @25 #0",
        "pass 3 @60",
        "pass 1 @60",
        "end 0 @60",
    ]


def test_a_target_where_the_uav_stands_is_still_a_route() -> None:
    points = points_of([target(0, 0)], [[]], None)
    assert draw(points) == ["start 0 @60", "target 0 @60 #0", "end 0 @60"]
    assert line_of(points).tolist() == [[0.0, 0.0], [0.0, 0.0]]


def test_two_targets_at_one_place_are_two_points() -> None:
    assert route([target(0, 2), target(1, 2)], [[node(2)], [node(2)]]) == ["start 0 @60", "target 2 @60 #0", "target 2 @60 #1", "end 2 @60"]


def test_the_line_on_the_map_has_each_place_once() -> None:
    points = points_of([target(0, 2, agl_m=25)], [[node(1), node(2)]], [node(1)])
    assert np.array_equal(line_of(points)[:, 0] * 1_000, [0, 1, 2, 1, 0])


def test_long_legs_are_divided_evenly_on_the_drawn_line() -> None:
    """0 --- 20, some 2.2 km: three legs of 742 m, heights in between."""
    points = [RoutePoint(at(0), WaypointKind.START, 60.0), RoutePoint(at(20), WaypointKind.TARGET, 90.0, target=0)]
    assert draw(with_short_legs(RoutePoints.of(points), 900.0)[0]) == ["start 0 @60", "pass 7 @70", "pass 13 @80", "target 20 @90 #0"]


def test_points_put_into_a_stretch_belong_to_its_target() -> None:
    points = [RoutePoint(at(0), WaypointKind.TARGET, 60.0, target=3), RoutePoint(at(10), WaypointKind.PASS, 60.0, target=3)]
    assert draw(with_short_legs(RoutePoints.of(points), 900.0)[0])[1] == "pass 5 @60 #3"


def test_no_leg_is_longer_than_the_longest_at_any_latitude() -> None:
    points = [RoutePoint(LonLat(24.0, 70.0), WaypointKind.START, 60.0), RoutePoint(LonLat(24.2, 70.05), WaypointKind.END, 60.0)]
    position = np.array([point.position for point in with_short_legs(RoutePoints.of(points), 900.0)[0]])
    assert len(position) == 12
    assert distance_m(position[:-1], position[1:]).max() <= 900.0


def test_points_that_are_near_enough_stay_as_they_are() -> None:
    points = [
        RoutePoint(at(0), WaypointKind.START, 60.0),
        RoutePoint(at(0), WaypointKind.PASS, 30.0),
        RoutePoint(at(5), WaypointKind.END, 60.0),
    ]
    assert list(with_short_legs(RoutePoints.of(points), 900.0)[0]) == points


def stacked(*heights_m: float, target: int | None = 1) -> Waypoints:
    """A start, points one above another, the one at `target` with a task, and an end."""
    above = [
        RoutePoint(at(1), WaypointKind.TARGET if place == target else WaypointKind.PASS, agl_m, 7, 0 if place == target else None,
                   PHOTO if place == target else None)
        for place, agl_m in enumerate(heights_m)
    ]  # fmt: skip
    points = RoutePoints.of([RoutePoint(at(0), WaypointKind.START, 60.0), *above, RoutePoint(at(2), WaypointKind.END, 60.0)])
    return Waypoints(points, points.agl_m + 100.0, points.agl_m + 1.0)


def heights_of(waypoints: Waypoints) -> list[float]:
    assert waypoints.amsl_m is not None
    assert np.allclose(waypoints.amsl_m, waypoints.points.agl_m + 100.0) and np.allclose(waypoints.relative_m, waypoints.points.agl_m + 1.0)
    return waypoints.points.agl_m[1:-1].tolist()


def test_nothing_is_flown_up_and_down_at_one_place_for_nothing() -> None:
    """As a plan had it: down to the target, and then up and down again."""
    flown = without_idle_points(stacked(69.4, 65.5, 65.5, 69.4, 65.5))
    assert heights_of(flown) == [69.4, 65.5]
    assert flown.points.task == {2: PHOTO} and flown.points[2].kind is WaypointKind.TARGET


def test_a_climb_that_a_leg_needs_stays() -> None:
    assert heights_of(without_idle_points(stacked(69.4, 40.0, 69.4))) == [69.4, 40.0, 69.4]
    assert heights_of(without_idle_points(stacked(60.0, 70.0, 80.0, target=None))) == [60.0, 80.0]
    waypoints = stacked(60.0, 80.0)
    assert without_idle_points(waypoints) is waypoints


@given(st.lists(st.sampled_from([40.0, 65.5, 69.4]), min_size=1, max_size=8), st.integers(0, 7))
def test_what_is_left_comes_to_the_place_and_leaves_it_as_high_as_before(heights_m: list[float], target: int) -> None:
    flown = heights_of(without_idle_points(stacked(*heights_m, target=target)))
    assert (flown[0], flown[-1]) == (heights_m[0], heights_m[-1])
    assert set(flown) <= set(heights_m) and len(flown) <= 3
    assert target >= len(heights_m) or heights_m[target] in flown
