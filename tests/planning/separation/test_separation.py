"""UAVs are kept apart in time or height wherever they pass the same place."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from planning.rules import FlightRules, SeparationRules
from planning.separation.report import separation_json
from planning.separation.separation import (
    TimedRoute,
    closest_encounter,
    conflicts,
    keep_apart,
    raised_agl_m,
    timed_route,
)
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from tests.planning.separation.dense_separation import least_seconds_apart, moments_of

RULES = SeparationRules()
DEGREE_M = 111_319.49  # of longitude on the equator, and near enough of latitude for whole numbers of metres
NORTH_M = 110_574.28


def route(uav, *places_m, speed_mps=10.0, start_s=0.0, height_m=100.0, hold_s=(), lands=True, ground_m=None):
    """A route over places (east, north) [m] near the equator, already at its height: it is in the air from its first to its last place."""
    places = np.array(places_m, dtype=float)
    hold = np.zeros(len(places))
    hold[: len(hold_s)] = hold_s
    seconds = np.hypot(*np.diff(places, axis=0).T) / speed_mps
    arrival_s = start_s + np.concatenate([[0.0], np.cumsum(seconds + hold[:-1])])
    heights_m = np.full(len(places), float(height_m))
    position = places / [DEGREE_M, NORTH_M]
    end_s = arrival_s[-1] + hold[-1]
    ground_m = height_m if ground_m is None else ground_m
    return TimedRoute(uav, position, heights_m, arrival_s, hold, start_s, ground_m, end_s if lands else None, ground_m)


ALONG = ((0, 0), (1_000, 0))
ACROSS = ((500, -500), (500, 500))


def test_two_that_cross_at_the_same_moment_meet_where_their_legs_cross():
    [found] = conflicts([route("A", *ALONG), route("B", *ACROSS)], rules=RULES)
    assert (found.uavs, found.legs, found.seconds, found.blocks) == (("A", "B"), (0, 0), 0.0, False)
    assert found.metres == pytest.approx(0.0, abs=0.01)
    assert found.vertical_m == 0.0
    assert found.at_s == pytest.approx((50.0, 50.0), abs=0.01)
    assert found.position == pytest.approx((500 / DEGREE_M, 0.0), abs=1e-7)


def test_at_the_same_time_the_nearest_they_come_is_told():
    """B passes 100 m later than A: at 10 m/s on legs at right angles they come within 100 / sqrt(2) m, which is more than 30 m."""
    [found] = conflicts([route("A", *ALONG), route("B", *ACROSS, start_s=2.0)], rules=RULES)
    assert found.seconds == 0.0
    assert found.metres == pytest.approx(20.0 / math.sqrt(2.0), abs=0.02)


def test_one_behind_the_other_is_apart_by_the_time_less_what_the_limit_of_metres_takes():
    """At 10 m/s the one behind is within 30 m of a place 3 s before it is there: 62 s behind are 59 s apart, 63 s behind are 60."""
    ahead = route("A", *ALONG)
    [found] = conflicts([ahead, route("B", *ALONG, start_s=62.0)], rules=RULES)
    assert found.seconds == pytest.approx(59.0, abs=0.001)
    assert found.metres == pytest.approx(30.0, abs=0.01)
    assert conflicts([ahead, route("B", *ALONG, start_s=63.01)], rules=RULES) == ()
    closest = closest_encounter([ahead, route("B", *ALONG, start_s=63.01)], rules=RULES)
    assert closest is not None
    assert closest.seconds == pytest.approx(60.01, abs=0.001)


def test_head_on_they_are_apart_only_once_one_has_landed():
    """A is within 30 m of where B starts from 97 s to 100 s: B has to start at 160 s, which is the first whole second after."""
    ahead, back = route("A", *ALONG), route("B", *reversed(ALONG))
    separation = keep_apart([ahead, back], rules=RULES)
    assert separation.delays_s == (0.0, 160.0 + 1.0)
    assert separation.unresolved == ()


def test_side_by_side_and_just_as_far_apart_as_asked_they_are_apart():
    ahead = route("A", *ALONG)
    assert conflicts([ahead, route("B", (0, 30.05), (1_000, 30.05))], rules=RULES) == ()
    assert len(conflicts([ahead, route("B", (0, 29.9), (1_000, 29.9))], rules=RULES)) == 1
    assert conflicts([ahead, route("B", *ALONG, height_m=115.0)], rules=RULES) == ()
    assert len(conflicts([ahead, route("B", *ALONG, height_m=114.9)], rules=RULES)) == 1


def test_a_height_that_is_not_known_counts_as_the_same():
    [found] = conflicts([route("A", *ALONG), route("B", *ACROSS, height_m=math.nan)], rules=RULES)
    assert found.vertical_m is None
    assert len(conflicts([route("A", *ALONG, height_m=math.nan), route("B", *ACROSS, height_m=900.0)], rules=RULES)) == 1


def test_a_climb_after_take_off_is_flown_through_every_height():
    high = route("A", (0, 0), (1_000, 0), height_m=100.0)
    below = route("B", (0, 0), (0, 1_000), height_m=200.0, start_s=10.0)
    assert conflicts([high, below], rules=RULES) == ()
    climbing = replace(below, take_off_s=0.0, take_off_m=0.0)
    [found] = conflicts([high, climbing], rules=RULES)
    assert found.legs == (0, 0)


def test_a_hold_keeps_the_place_as_long_as_it_lasts():
    """A holds for 300 s over a place that B passes after 50 s, and leaves at right angles to B's way.

    Over places within 30 m the times s - t are at most 300 - 50 + 3 sqrt(2) = 254.2 s; a minute more makes 315 whole seconds.
    """
    holding = route("A", (500, 0), (500, 900), hold_s=(300.0,))
    separation = keep_apart([holding, route("B", *ALONG)], rules=RULES)
    assert separation.delays_s == (0.0, 315.0)


def test_who_stands_on_the_ground_between_two_flights_is_in_nobodys_way():
    """A lands at its base for 600 s and flies on; B passes low over the base meanwhile."""
    places = np.array([[0.0, 0.0], [500.0, 0.0], [0.0, 0.0]]) / [DEGREE_M, NORTH_M]
    there = TimedRoute(
        "A", places, np.array([40.0, 0.0, 40.0]), np.array([0.0, 70.0, 740.0]), np.array([0.0, 600.0, 0.0]), 0.0, 40.0, 740.0, 40.0
    )
    over = route("B", (500, -500), (500, 500), start_s=300.0, height_m=10.0)
    assert len(conflicts([there, over], rules=RULES)) == 1
    assert conflicts([replace(there, on_ground=np.array([False, True, False])), over], rules=RULES) == ()


def test_from_one_place_the_second_takes_off_later():
    first, second = route("A", (0, 0), (5_000, 0)), route("B", (0, 0), (0, 1_000))
    separation = keep_apart([first, second], rules=RULES)
    assert separation.delays_s[0] == 0.0
    assert 60.0 < separation.delays_s[1] <= 66.0
    assert conflicts(separation.routes, rules=RULES) == ()


def test_who_passes_where_another_will_hover_goes_first():
    """A ends over the middle of B's way and stays; B, although shorter, comes first and A waits until it is through."""
    hovering = route("A", (500, -5_000), (500, 0), lands=False)
    passing = route("B", *ALONG)
    slow = replace(passing, arrival_s=np.array([0.0, 900.0]), lands_s=900.0)
    separation = keep_apart([hovering, slow], rules=RULES)
    assert separation.unresolved == ()
    assert separation.delays_s[1] == 0.0
    assert separation.delays_s[0] > 0.0


def test_two_that_hover_over_one_place_cannot_be_kept_apart_by_waiting():
    one, other = route("A", (0, -900), (0, 0), lands=False), route("B", (900, 0), (0, 0), lands=False)
    separation = keep_apart([one, other], rules=RULES)
    [left] = separation.unresolved
    assert left.blocks
    assert separation_json(separation)["unresolved"][0]["code"] == "hovers_in_the_way"


def test_a_flight_of_another_mission_is_never_moved_and_its_hover_is_told():
    other = replace(route("X", (500, -500), (500, 0), lands=False), mission="other")
    long = route("A", (-2_000, 0), (1_000, 0))
    separation = keep_apart([long], [other], rules=RULES)
    [left] = separation.unresolved
    assert left.missions == (None, "other")
    assert separation.delays_s == (0.0,)
    passing = replace(route("X", *ACROSS), mission="other")
    separation = keep_apart([route("A", *ALONG)], [passing], rules=RULES)
    assert separation.unresolved == ()
    assert separation.delays_s[0] > 60.0


def test_two_flights_of_other_missions_are_not_our_concern():
    others = [replace(route(name, *ALONG), mission="other") for name in "XY"]
    assert conflicts([], others, rules=RULES) == ()
    assert keep_apart([], others, rules=RULES).unresolved == ()


def test_a_layer_is_flown_where_it_ends_sooner_than_waiting():
    routes = [route("A", *ALONG), route("B", *ACROSS)]

    def raised(number, layer_m):
        return None if layer_m > 15.0 else replace(routes[number], height_m=routes[number].height_m + layer_m)

    separation = keep_apart(routes, rules=RULES, raised=raised)
    assert separation.delays_s == (0.0, 0.0)
    assert separation.layers_m == (0.0, 15.0)
    assert separation.closest is None


def test_what_waits_leaves_no_shorter_wait():
    separation = keep_apart([route("A", *ALONG), route("B", *ACROSS)], rules=RULES)
    first, second = route("A", *ALONG), route("B", *ACROSS)
    wait_s = max(separation.delays_s)
    assert all(conflicts([first, second.delayed(less)], rules=RULES) for less in np.arange(0.0, wait_s))


def test_a_way_that_is_clear_of_all_others_is_not_touched():
    separation = keep_apart([route("A", *ALONG), route("B", (0, 200), (1_000, 200))], rules=RULES)
    assert (separation.delays_s, separation.layers_m, separation.closest) == ((0.0, 0.0), (0.0, 0.0), None)
    reported = separation_json(separation)
    assert (reported["lateral_m"], reported["vertical_m"], reported["time_s"]) == (30.0, 15.0, 60.0)
    assert (reported["delays"], reported["layers"], reported["closest"], reported["unresolved"]) == ([0.0, 0.0], [0.0, 0.0], None, [])


def test_over_the_antimeridian_they_meet_as_anywhere():
    def moved(flown):
        lon = flown.position[:, 0] + 179.9955
        return replace(flown, position=np.column_stack([np.where(lon > 180.0, lon - 360.0, lon), flown.position[:, 1]]))

    pair = [route("A", *ALONG), route("B", *ACROSS, start_s=2.0)]
    [here], [there] = conflicts(pair, rules=RULES), conflicts([moved(flown) for flown in pair], rules=RULES)
    assert there.metres == pytest.approx(here.metres, abs=1e-3)
    assert there.position.lon == pytest.approx(here.position.lon + 179.9955 - 360.0, abs=1e-9)


def test_unused_uavs_are_in_nobodys_way():
    empty = TimedRoute("C", np.empty((0, 2)), np.empty(0), np.empty(0), np.empty(0))
    separation = keep_apart([route("A", *ALONG), empty, route("B", *ACROSS)], rules=RULES)
    assert separation.delays_s[1] == 0.0
    assert separation.unresolved == ()


def test_times_that_run_backwards_are_refused():
    flown = route("A", *ALONG)
    with pytest.raises(ValueError, match="backwards"):
        replace(flown, arrival_s=np.array([10.0, 5.0]))
    with pytest.raises(ValueError, match="backwards"):
        replace(flown, lands_s=50.0)
    with pytest.raises(ValueError, match="one entry"):
        replace(flown, hold_s=np.zeros(1))


def test_a_planned_route_takes_its_holds_and_the_ground_under_its_ends():
    points = RoutePoints.of(
        [
            RoutePoint(LonLat(9.0, 47.0), WaypointKind.START, 60.0),
            RoutePoint(LonLat(9.01, 47.0), WaypointKind.PASS, 60.0),
            RoutePoint(LonLat(9.01, 47.0), WaypointKind.TARGET, 40.0, target=0, task=Task(TaskKind.PHOTO, 10.0)),
            RoutePoint(LonLat(9.0, 47.0), WaypointKind.END, 60.0),
        ]
    )
    waypoints = Waypoints(points, np.array([460.0, 470.0, 450.0, 460.0]), np.array([60.0, 70.0, 50.0, 60.0]))
    timed = timed_route("A", waypoints, np.array([24.0, 90.0, 98.0, 180.0]), lands_s=204.0)
    assert (timed.take_off_m, timed.landing_m, timed.hold_s.tolist()) == (400.0, 400.0, [0.0, 0.0, 10.0, 0.0])
    flat = timed_route("A", Waypoints(points, None, points.agl_m), np.array([24.0, 90.0, 98.0, 180.0]), lands_s=None)
    assert np.isnan(flat.height_m).all()
    raised = raised_agl_m(points, 15.0, lands=True, rules=FlightRules())
    assert raised is not None
    assert raised.tolist() == [75.0, 75.0, 40.0, 75.0]
    assert raised_agl_m(points, 75.0, lands=True, rules=FlightRules()) is None


LATTICE_M = 250


@st.composite
def flights(draw, most=4):
    """Flights over a small lattice, so that many share legs; some hover at the end, some heights are unknown."""
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    made = []
    for number in range(draw(st.integers(2, most))):
        count = int(generator.integers(2, 7))
        places = np.cumsum(generator.integers(-1, 2, (count, 2)), axis=0) * LATTICE_M + generator.integers(-20, 21, (count, 2))
        heights_m = generator.choice([100.0, 110.0, 115.0, 130.0], count)
        hold_s = generator.choice([0.0, 0.0, 40.0], count)
        speed_mps = generator.uniform(6.0, 14.0)
        metres = np.hypot(*np.diff(places, axis=0).T) + np.abs(np.diff(heights_m))
        take_off_s = float(generator.choice([0.0, 30.0]))
        arrival_s = take_off_s + 30.0 + np.concatenate([[0.0], np.cumsum(metres / speed_mps + 1.0 + hold_s[:-1])])
        lands = generator.random() < 0.7
        if generator.random() < 0.1:
            heights_m[:] = np.nan
        lands_s = float(arrival_s[-1] + hold_s[-1] + 30.0) if lands else None
        made.append(TimedRoute("ABCD"[number], places / [DEGREE_M, NORTH_M], heights_m, arrival_s, hold_s, take_off_s, 50.0, lands_s, 50.0))
    return made


STEP_S = 0.5
BLUR_M = 1.01 * STEP_S * 14.0  # what two UAVs can come nearer to each other between samples
FRAME = 0.01  # how far the checker's flat world may be out


@pytest.mark.long
@settings(max_examples=30)
@given(flights(most=2))
def test_the_time_between_two_is_what_dense_sampling_finds(pair):
    one, other = (moments_of(flown, STEP_S, hover_s=2_000.0) for flown in pair)
    closest = closest_encounter(pair, rules=RULES)
    exact_s = math.inf if closest is None else closest.seconds
    inside = least_seconds_apart(one, other, RULES.lateral_m * (1.0 - FRAME), RULES.vertical_m - 1e-3)
    around = least_seconds_apart(one, other, RULES.lateral_m * (1.0 + FRAME) + BLUR_M, RULES.vertical_m + BLUR_M)
    assert exact_s <= inside + 1e-3
    assert around <= exact_s + STEP_S
    assert bool(conflicts(pair, rules=RULES)) == (exact_s < RULES.time_s)


@settings(max_examples=8)
@given(flights())
def test_what_is_kept_apart_breaks_the_rule_nowhere_but_where_it_says(routes):
    is_kept_apart(routes)


@pytest.mark.long
@settings(max_examples=200)
@given(flights())
def test_what_is_kept_apart_of_many_breaks_the_rule_nowhere_but_where_it_says(routes):
    is_kept_apart(routes)


def is_kept_apart(routes: list[TimedRoute]) -> None:
    separation = keep_apart(routes, rules=RULES)
    left = {encounter.uavs for encounter in separation.unresolved}
    assert all(delay_s >= 0.0 for delay_s in separation.delays_s)
    assert all(encounter.blocks for encounter in separation.unresolved)
    flown = [moments_of(moved, STEP_S, hover_s=4_000.0) for moved in separation.routes]
    for one, other in combinations(range(len(routes)), 2):
        if (routes[one].uav, routes[other].uav) not in left:
            apart_s = least_seconds_apart(flown[one], flown[other], RULES.lateral_m * (1.0 - FRAME), RULES.vertical_m - 1e-3)
            assert apart_s >= RULES.time_s - 1e-3
    again = keep_apart(routes, rules=RULES)
    assert (again.delays_s, again.layers_m) == (separation.delays_s, separation.layers_m)


@settings(max_examples=40)
@given(flights())
def test_flights_that_land_can_always_be_kept_apart(routes):
    landing = [replace(flown, lands_s=float(flown.arrival_s[-1] + flown.hold_s[-1] + 30.0)) for flown in routes]
    assert keep_apart(landing, rules=RULES).unresolved == ()
