"""Towers, wires and bridges beside a route: it rises over them, and nothing else changes."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.network.build.decks import decks
from inspection.network.infrastructure import BridgeOutlines
from inspection.network.spans import DECK, Spans, spans_between
from planning.clearance.obstacle_clearance import legs_too_near, spans_too_near
from planning.rules import FlightRules
from planning.task import Task, TaskKind
from planning.trajectory.beside_spans import AT_M
from planning.trajectory.heights import with_heights
from planning.trajectory.obstacles import rising_over, too_low
from planning.trajectory.waypoints import NONE, TARGET, RoutePoint, RoutePoints, WaypointKind, Waypoints
from tests.planning.trajectory.posted_ground import PostedGround, ground_like

HERE = 56.0
METRE_DEG = 1.0 / 111_320.0  # of latitude, about
EAST_DEG = METRE_DEG / math.cos(math.radians(HERE))
RULES = FlightRules()


def at(north_m: float, east_m: float) -> LonLat:
    return LonLat(10.0 + east_m * EAST_DEG, HERE + north_m * METRE_DEG)


def over_flat_ground(*points: RoutePoint) -> Waypoints:
    drawn = RoutePoints.of(points)
    return Waypoints(drawn, None, drawn.agl_m)


def route(*agl_m: float) -> Waypoints:
    """Points 400 m apart to the north."""
    return over_flat_ground(*(RoutePoint(at(400.0 * n, 0.0), WaypointKind.PASS, height) for n, height in enumerate(agl_m)))


def spans(*rows: tuple[float, float, float, float, float, float], asset: int = NONE) -> Spans:
    """Each from north, east, height to north, east, height; all of one line."""
    drawn = np.array(rows).reshape(-1, 6)
    start, end = (np.array([at(north, east) for north, east in drawn[:, side : side + 2]]).reshape(-1, 2) for side in (0, 3))
    return spans_between(start, end, drawn[:, 2], drawn[:, 5], np.full(len(drawn), asset))


def tower(north_m: float, east_m: float, height_m: float) -> tuple[float, float, float, float, float, float]:
    return (north_m, east_m, height_m, north_m, east_m, height_m)


def profile(waypoints: Waypoints) -> list[tuple[int, float]]:
    """Metres north and above ground."""
    return [
        (round((lat - HERE) / METRE_DEG), agl_m) for (_, lat), agl_m in zip(waypoints.points.position, waypoints.points.agl_m, strict=True)
    ]


def test_a_leg_climbs_before_a_tower_beside_it_and_comes_down_behind_it() -> None:
    flown, blocked = rising_over(route(60.0, 60.0), spans(tower(100.0, 15.0, 80.0)), None, RULES)
    assert profile(flown) == [(0, 60.0), (80, 60.0), (80, 95.0), (120, 95.0), (120, 60.0), (400, 60.0)]  # 20² + 15² = 25²
    assert blocked == ()
    assert flown.relative_m is flown.points.agl_m


def test_it_rises_over_a_wire_whose_towers_stand_far_away_as_high_as_that_hangs_there() -> None:
    """From 100 m in the west to 40 m in the east it hangs at 70 m where the leg crosses; it stays so high until it is 25 m away."""
    flown, _ = rising_over(route(60.0, 60.0), spans((200.0, -400.0, 100.0, 200.0, 400.0, 40.0)), None, RULES)
    assert profile(flown) == [(0, 60.0), (175, 60.0), (175, 85.0), (225, 85.0), (225, 60.0), (400, 60.0)]


def test_what_is_high_enough_or_far_enough_away_changes_nothing() -> None:
    points = route(60.0, 100.0, 60.0)
    for other in (tower(400.0, 10.0, 82.0), tower(100.0, 26.0, 80.0), tower(-26.0, 0.0, 80.0), (300.0, -90.0, 45.0, 300.0, 90.0, 45.0)):
        assert rising_over(points, spans(other), None, RULES)[0] is points


def test_it_rises_over_several_each_by_its_own_height() -> None:
    flown, _ = rising_over(route(60.0, 60.0), spans(tower(300.0, 0.0, 65.0), tower(100.0, 0.0, 75.0), tower(130.0, 0.0, 85.0)), None, RULES)
    rises = [(75, 90.0), (105, 90.0), (105, 100.0), (155, 100.0), (155, 60.0), (275, 60.0), (275, 80.0), (325, 80.0)]
    assert profile(flown) == [(0, 60.0), (75, 60.0), *rises, (325, 60.0), (400, 60.0)]


def test_along_its_own_line_nothing_is_put_in_as_each_tower_is_passed_high_enough() -> None:
    points = route(60.0, 95.0, 75.0)
    line = spans((0.0, 0.0, 45.0, 400.0, 0.0, 80.0), (400.0, 0.0, 80.0, 800.0, 0.0, 60.0))
    assert rising_over(points, line, None, RULES)[0] is points


def test_what_would_have_to_be_passed_above_the_limit_blocks_the_route() -> None:
    assert rising_over(route(60.0, 60.0), spans(tower(100.0, 0.0, 106.0)), None, RULES)[1] == (0,)
    assert rising_over(route(60.0, 60.0), spans(tower(100.0, 0.0, 105.0)), None, RULES)[1] == ()


def test_over_a_valley_a_wire_hangs_higher_above_the_ground_than_at_its_towers() -> None:
    """Towers of 20 m on ground at 130 m; the leg crosses half way between them, where the ground lies at 100 m: 50 m and 15 m more."""

    valley = ground_like(lambda position: 100.0 + 0.15 * np.abs(position[:, 0] - 10.0) / EAST_DEG, 9.99, 56.02, 0.03)
    points = route(60.0, 60.0).points
    crossed = spans((200.0, -200.0, 20.0, 200.0, 200.0, 20.0))
    flown, blocked = rising_over(Waypoints(points, points.agl_m + 100.0, points.agl_m), crossed, valley.ground, RULES)
    assert [round(height_m, 3) for height_m in flown.points.agl_m.tolist()] == [60.0, 60.0, 65.0, 65.0, 60.0, 60.0]
    assert flown.amsl_m is not None and flown.amsl_m[2] == pytest.approx(165.0, abs=1e-3)
    assert flown.relative_m[2] == pytest.approx(65.0, abs=1e-3)
    assert blocked == ()
    deep = FlightRules(max_agl_m=64.0)
    assert rising_over(Waypoints(points, points.agl_m + 100.0, points.agl_m), crossed, valley.ground, deep)[1] == (0,)


def test_what_stands_on_ground_that_is_not_known_is_cleared_at_no_height() -> None:
    """One end of the wire stands in a gap of the terrain: the route is not to be flown, and does not rise for it either."""

    ground = ground_like(lambda position: np.where(position[:, 0] - 10.0 > 50.0 * EAST_DEG, np.nan, 100.0), 9.99, 56.02, 0.03).ground
    points = route(60.0, 60.0).points
    over = Waypoints(points, points.agl_m + 100.0, points.agl_m)
    crossed = spans((200.0, -200.0, 10.0, 200.0, 200.0, 10.0), tower(100.0, 0.0, 80.0), tower(300.0, 0.0, 10.0))
    low = too_low(over, crossed, ground, RULES)
    assert low is not None
    assert dict(zip(low.span.tolist(), low.agl_m.tolist(), strict=True)) == {0: np.inf, 1: pytest.approx(95.0)}
    flown, blocked = rising_over(over, crossed, ground, RULES)
    assert blocked == (0,)
    assert flown.points.agl_m.max() == pytest.approx(95.0)
    assert spans_too_near(over, crossed, ground.heights_m, RULES) == {0, 1}
    assert spans_too_near(flown, crossed, ground.heights_m, RULES) == {0}


def inspected(agl_m: float) -> Waypoints:
    """To a pole at 200 m north, down to its inspection and up again."""
    task = Task(TaskKind.PHOTO, 5.0)
    return over_flat_ground(
        RoutePoint(at(0.0, 0.0), WaypointKind.START, 60.0),
        RoutePoint(at(200.0, 0.0), WaypointKind.PASS, 60.0),
        RoutePoint(at(200.0, 0.0), WaypointKind.TARGET, agl_m, 7, 0, task),
        RoutePoint(at(200.0, 0.0), WaypointKind.END, agl_m),
    )


def test_what_is_inspected_is_come_down_to_but_not_under_the_wires_of_another_line() -> None:
    own = (200.0, 0.0, 45.0, 200.0, 90.0, 45.0)
    points = inspected(29.0)
    assert rising_over(points, spans(own), None, RULES)[0] is points
    flown, _ = rising_over(points, spans(own, (220.0, -90.0, 40.0, 220.0, 90.0, 40.0)), None, RULES)
    assert flown.points.agl_m.tolist() == [60.0, 60.0, 55.0, 55.0]


def test_a_pole_right_under_the_wires_of_another_line_is_inspected_from_above_these() -> None:
    """They hang 0.5 m beside its middle: it is not they that are inspected."""
    pole, across = (200.0, 0.0, 14.0, 200.0, 90.0, 14.0), (200.5, -90.0, 45.0, 200.5, 90.0, 45.0)
    points = inspected(29.0)
    flown, _ = rising_over(points, spans(pole, across, asset=5), None, RULES)
    assert flown.points.agl_m.tolist() == [60.0, 60.0, 60.0, 60.0]
    assert spans_too_near(points, spans(pole, across, asset=5), None, RULES) == {1}


def test_a_point_on_a_line_is_come_down_to_between_the_towers_of_that_line() -> None:
    """What hangs there is what is inspected, whatever its wires are taken to be as high as."""
    own = spans((200.0, -90.0, 45.0, 200.0, 90.0, 45.0), asset=7)
    points = inspected(29.0)
    assert rising_over(points, own, None, RULES)[0] is points
    assert spans_too_near(points, own, None, RULES) == set()


LENGTHS = st.floats(-600.0, 1_400.0)
HEIGHTS = st.floats(5.0, 105.0)
SPANS = st.lists(st.tuples(LENGTHS, LENGTHS, HEIGHTS, LENGTHS, LENGTHS, HEIGHTS), min_size=1, max_size=6)
PLACES = st.lists(st.tuples(LENGTHS, LENGTHS, st.floats(60.0, 120.0)), min_size=2, max_size=5)


@settings(max_examples=150)
@given(PLACES, SPANS)
def test_no_leg_is_nearer_than_the_clearance_over_anything(places: list[tuple[float, float, float]], rows: list[tuple[float, ...]]) -> None:
    """Looked at every 2 m, and by the last look; and a route that has risen need not rise again.

    Gentle legs from or to the very place of a tower, over its top, are excused: the last look alone says how far.
    """
    ends = [(north, east) for row in rows for north, east in (row[:2], row[3:5])]
    assume(all(math.hypot(place[0] - north, place[1] - east) > 2.0 * AT_M for place in places for north, east in ends))
    drawn = over_flat_ground(*(RoutePoint(at(north, east), WaypointKind.PASS, agl_m) for north, east, agl_m in places))
    standing = spans(*rows)
    flown, blocked = rising_over(drawn, standing, None, RULES)
    assert blocked == ()
    assert shortest_over(flown.points.position, flown.points.agl_m, rows) >= RULES.clearance_m - 0.5
    assert spans_too_near(flown, standing, None, RULES) == set()
    again = too_low(flown, standing, None, RULES)
    assert again is None or float((again.until - again.begin).max()) < 0.05


@settings(max_examples=150)
@given(PLACES, SPANS, st.integers(0, 2**32 - 1), st.sampled_from([1.0, 8.0, 25.0]))
def test_over_rough_ground_a_risen_route_keeps_the_clearance_and_the_limit(
    places: list[tuple[float, float, float]], rows: list[tuple[float, ...]], seed: int, rough_m: float
) -> None:
    """Looked at every 2 m, with a reader of the ground of its own; blocked are only routes that have to rise above the limit."""
    ends = [(north, east) for row in rows for north, east in (row[:2], row[3:5])]
    assume(all(math.hypot(place[0] - north, place[1] - east) > 2.0 * AT_M for place in places for north, east in ends))
    posts = 700.0 + np.random.default_rng(seed).normal(0.0, rough_m, (60, 60)).cumsum(axis=0)
    ground = PostedGround(posts, 9.98, HERE + 0.02, 0.001)
    drawn = RoutePoints.of([RoutePoint(at(north, east), WaypointKind.PASS, agl_m) for north, east, agl_m in places])
    followed, is_flat = with_heights(drawn, ground.ground, RULES)
    assert not is_flat
    standing = spans(*rows)
    flown, blocked = rising_over(followed, standing, ground.ground, RULES)
    if blocked:
        return
    assert spans_too_near(flown, standing, ground.ground.heights_m, RULES) == set()
    assert flown.amsl_m is not None
    feet_m = [ground.metres([at(*row[:2]), at(*row[3:5])]).tolist() for row in rows]
    tops = [(*row[:2], row[2] + feet[0], *row[3:5], row[5] + feet[1]) for row, feet in zip(rows, feet_m, strict=True)]
    assert shortest_over(flown.points.position, flown.amsl_m, tops) >= RULES.clearance_m - 0.5
    steps = flown.points.position[:-1, None] + np.linspace(0.0, 1.0, 100)[:, None] * np.diff(flown.points.position, axis=0)[:, None]
    levels_m = flown.amsl_m[:-1, None] + np.linspace(0.0, 1.0, 100) * np.diff(flown.amsl_m)[:, None]
    assert (levels_m.ravel() - ground.metres(steps.reshape(-1, 2))).max() <= RULES.max_agl_m + 0.1


BANKS_M = st.floats(100.0, 140.0)
BRIDGES = st.tuples(st.floats(-100.0, 500.0), st.floats(60.0, 300.0), st.floats(4.0, 40.0), st.floats(0.0, math.pi))


@settings(max_examples=100)
@given(PLACES, BRIDGES, BANKS_M, st.sampled_from([math.nan, 35.0, 60.0]))
def test_no_leg_leads_under_a_deck_or_low_over_it(
    places: list[tuple[float, float, float]], drawn_bridge: tuple[float, float, float, float], bank_m: float, tagged_m: float
) -> None:
    """A bridge over a valley at 100 m above the sea between banks of up to 140 m: looked at every 2 m against its deck."""
    north_m, half_m, wide_m, turn = drawn_bridge
    along = np.array([math.sin(turn), math.cos(turn)])  # east, north
    across = along[::-1] * (1.0, -1.0)
    corners = [end * half_m * along + side * wide_m / 2.0 * across for end, side in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    area = shapely.Polygon([(10.0 + x * EAST_DEG, HERE + (north_m + y) * METRE_DEG) for x, y in corners])
    centre = np.array([at(north_m, 0.0)])

    def from_centre_m(position: np.ndarray) -> np.ndarray:
        return np.hypot((position[:, 0] - 10.0) / EAST_DEG, (position[:, 1] - centre[0, 1]) / METRE_DEG)

    ground = ground_like(lambda position: np.where(from_centre_m(position) > 0.8 * half_m, bank_m, 100.0), 9.96, HERE + 0.02, 0.08, 0.0003)
    found = decks(centre, np.array([tagged_m]), BridgeOutlines(np.array([area], dtype=object), np.zeros(1)))
    line, over_m = found.line, np.maximum(found.over_centre_m, found.over_banks_m)[found.bridge]
    deck = spans_between(line[:, 0], line[:, 1], over_m, over_m, np.full(len(line), DECK), found.bridge, found)
    points = RoutePoints.of([RoutePoint(at(north, east), WaypointKind.PASS, agl_m) for north, east, agl_m in places])
    followed, is_flat = with_heights(points, ground.ground, RULES)
    assert not is_flat
    flown, blocked = rising_over(followed, deck, ground.ground, RULES)
    if blocked:
        return
    assert spans_too_near(flown, deck, ground.ground.heights_m, RULES) == set()
    assert flown.amsl_m is not None
    ends = np.array([at(north_m + side * half_m * along[1], side * half_m * along[0]) for side in (-1.0, 1.0)])
    over_banks_m, over_centre_m = (20.0, 30.0) if np.isnan(tagged_m) else (12.0, tagged_m)
    top_m = max(float(ground.metres(ends).max()) + over_banks_m, float(ground.metres(centre)[0]) + over_centre_m)
    steps = flown.points.position[:-1, None] + np.linspace(0.0, 1.0, 400)[:, None] * np.diff(flown.points.position, axis=0)[:, None]
    levels_m = (flown.amsl_m[:-1, None] + np.linspace(0.0, 1.0, 400) * np.diff(flown.amsl_m)[:, None]).ravel()
    metres = (steps.reshape(-1, 2) - (10.0, HERE)) / (EAST_DEG, METRE_DEG)
    on_map = shapely.Polygon([(x, north_m + y) for x, y in corners])
    is_over = shapely.distance(shapely.points(metres), on_map) < 23.0
    assert float((levels_m[is_over] - top_m).min(initial=math.inf)) >= RULES.clearance_m - 1.0


def test_what_is_inspected_on_a_deck_is_come_down_to_from_above_and_nothing_is_inspected_below() -> None:
    """Over the end of a piece of a deck, at 29 m where 45 + 15 are needed: a wire that hangs there would be excused."""
    own = spans((200.0, 0.0, 45.0, 200.0, 90.0, 45.0), asset=DECK)
    assert spans_too_near(inspected(29.0), own, None, RULES) == {0}
    flown, blocked = rising_over(inspected(29.0), own, None, RULES)
    assert blocked == ()
    assert spans_too_near(flown, own, None, RULES) == set()
    assert flown.points.agl_m[flown.points.kind == TARGET].min() >= 60.0 - 0.5


def shortest_over(position: np.ndarray, level_m: np.ndarray, rows: list[tuple[float, ...]]) -> float:
    """The fewest metres over any wire less than 24 m beside."""
    line = np.column_stack([(position - (10.0, HERE)) / (EAST_DEG, METRE_DEG), level_m])
    least_m = math.inf
    for start, end in pairwise(line):
        share = np.linspace(0.0, 1.0, max(int(np.hypot(*(end - start)[:2]) / 2.0), 1) + 1)
        steps = start + share[:, None] * (end - start)
        for row in rows:
            wire, stop = np.array([row[1], row[0], row[2]]), np.array([row[4], row[3], row[5]])
            along = (stop - wire)[:2]
            where = np.clip((steps[:, :2] - wire[:2]) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
            nearest = wire + where[:, None] * (stop - wire)
            is_beside = np.hypot(*(steps - nearest)[:, :2].T) < 24.0
            least_m = min(least_m, float((steps[:, 2] - nearest[:, 2])[is_beside].min(initial=math.inf)))
    return least_m


def test_the_last_look_sees_a_leg_through_wires() -> None:
    assert spans_too_near(route(60.0, 60.0), spans((200.0, -300.0, 80.0, 200.0, 300.0, 80.0)), None, RULES) == {0}
    assert spans_too_near(route(60.0, 60.0), spans((200.0, -300.0, 44.0, 200.0, 300.0, 44.0)), None, RULES) == set()
    assert spans_too_near(inspected(29.0), spans((220.0, -90.0, 40.0, 220.0, 90.0, 40.0)), None, RULES) == {0}
    assert spans_too_near(inspected(29.0), spans((200.0, 0.0, 45.0, 200.0, 90.0, 45.0)), None, RULES) == set()


def test_the_last_look_tells_which_leg_is_too_near() -> None:
    """There at 60 m, back 1 m short of the clearance: that is what rounding and slopes may leave."""
    corners = [(0.0, 0.0, 60.0), (400.0, 0.0, 60.0), (400.0, 0.0, 94.0), (0.0, 0.0, 94.0)]
    points = over_flat_ground(*(RoutePoint(at(north, east), WaypointKind.PASS, agl_m) for north, east, agl_m in corners))
    crossed = spans((200.0, -200.0, 80.0, 200.0, 200.0, 80.0))
    low = too_low(points, crossed, None, RULES)
    assert low is not None
    assert low.place.tolist() == [0, 2]
    assert legs_too_near(points, crossed, None, RULES) == {(0, 0)}
