"""The flight through photos as waypoints: heights over every ground, and what a route with it is."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.network.spans import Spans, spans_between
from planning.clearance.obstacle_clearance import legs_too_near
from planning.energy.conditions import Conditions
from planning.energy.performance import Performance
from planning.rules import FlightRules
from planning.task import Task, TaskKind, ViewsRequest
from planning.trajectory.photo_flights import GroundNotKnown, clearances_m, photo_legs_of, with_photo_flights
from planning.trajectory.timing import timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from planning.views.limits import DetailRules
from planning.views.photo_flight import MAX_OFF_M, GroundUnknown, PhotoFlight, photo_flight
from planning.views.solids import FloatArray
from planning.views.view_flight import NO_PHOTO
from planning.views.view_plan import ViewPlan, ViewSpeeds, detail_plan
from tests.planning.views.towers import MIN_HEIGHT_M, SPAN_M, TOWERS, ZOOM, standing

TOWER = "lattice, 110 kV, triangle"
FRAME = LocalFrame.around(9.0, 47.0)
BASE_M = 412.0


def level(places: FloatArray) -> FloatArray:
    return np.zeros(len(places))


@cache
def planned(slope: float = 0.0) -> ViewPlan:
    stands = standing(TOWERS[TOWER], ground_m=None if slope == 0.0 else lambda places: slope * places[:, 0])
    return detail_plan(stands.site, ZOOM, DetailRules(0.004), ViewSpeeds())


def flown(slope: float = 0.0) -> PhotoFlight:
    clearance_m = standing(TOWERS[TOWER]).clearance_m
    return photo_flight(planned(slope), FRAME, BASE_M, lambda places: slope * places[:, 0], clearance_m, ZOOM.gimbal)


def test_it_has_every_photo_in_order_and_stops_at_all_but_ground_points() -> None:
    plan, flight = planned(), flown()
    assert len(flight.view) == len(plan.poses) > 0
    assert [view.yaw_deg for _, view in sorted(flight.view.items())] == pytest.approx(plan.poses.yaw_deg % 360.0, abs=0.051)
    assert flight.stops.all(), "over level ground no point is put in"
    assert (flight.position[0] == flight.position[-1]).all()
    assert flight.amsl_m == pytest.approx(BASE_M + flight.agl_m)
    assert flight.agl_m.min() >= MIN_HEIGHT_M - 0.01
    assert all(view.distance_m > 1.0 for view in flight.view.values())


def test_no_photo_looks_straight_down() -> None:
    assert planned().poses.pitch_deg.min() >= -80.0


@pytest.mark.long
@pytest.mark.parametrize("slope", [0.1, -0.3])
def test_over_a_slope_every_place_of_it_is_as_high_as_asked(slope: float) -> None:
    flight = flown(slope)
    assert flight.agl_m.min() >= MIN_HEIGHT_M - 0.01
    assert (flight.amsl_m - BASE_M - flight.agl_m) == pytest.approx(slope * FRAME.to_metres(flight.position)[:, 0], abs=0.02)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.5, 8.0), st.floats(15.0, 80.0), st.floats(0.0, 6.0))
def test_between_its_waypoints_heights_above_ground_are_nearly_straight(rise_m: float, length_m: float, phase: float) -> None:
    def waves(places: FloatArray) -> FloatArray:
        return rise_m * np.sin(places[:, 0] / length_m + phase) * np.cos(places[:, 1] / length_m) - rise_m * np.sin(phase)

    flight = photo_flight(planned(), FRAME, BASE_M, waves, 5.0, ZOOM.gimbal)
    places = np.column_stack([FRAME.to_metres(flight.position), flight.amsl_m - BASE_M])
    for place, (start, end) in enumerate(pairwise(places)):
        shares = np.linspace(0.0, 1.0, 30)[:, None]
        way = start + (end - start) * shares
        straight_m = flight.agl_m[place] + (flight.agl_m[place + 1] - flight.agl_m[place]) * shares[:, 0]
        assert np.abs(way[:, 2] - waves(way[:, :2]) - straight_m).max() < MAX_OFF_M + 0.1
    assert len(flight.view) == len(planned().poses)


def test_ground_that_is_not_known_under_a_part_of_it_is_refused() -> None:
    def gap(places: FloatArray) -> FloatArray:
        return np.where(places[:, 0] > 5.0, np.nan, 0.0)

    with pytest.raises(GroundUnknown):
        photo_flight(planned(), FRAME, BASE_M, gap, 5.0, ZOOM.gimbal)


@pytest.mark.long
def test_it_is_the_same_after_json() -> None:
    flight = flown(0.1)
    again = PhotoFlight.from_json(flight.to_json())
    assert again.view == flight.view
    for name in ("position", "amsl_m", "agl_m", "stops"):
        assert (getattr(again, name) == getattr(flight, name)).all()


# A route over the tower: start, the tower, end.

ASKED = Task(TaskKind.PHOTO, 3.0, views=ViewsRequest(0.004, ZOOM))


def over_the_tower(*, is_flat: bool = False) -> Waypoints:
    away, tower = LonLat(9.01, 47.0), LonLat(*FRAME.origin)
    points = RoutePoints.of([
        RoutePoint(away, WaypointKind.START, 60.0), RoutePoint(tower, WaypointKind.TARGET, 60.0, 7, 4, ASKED),
        RoutePoint(away, WaypointKind.END, 60.0),
    ])  # fmt: skip
    return Waypoints(points, None if is_flat else points.agl_m + BASE_M, points.agl_m)


def test_a_route_gets_it_behind_the_target_and_comes_back_up() -> None:
    flight = flown()
    route = with_photo_flights(over_the_tower(), {4: flight})
    assert len(route) == 3 + len(flight) + 1
    tasks = route.points.task
    assert tasks[1] == Task(TaskKind.HOLD, 1.0), "it stops over the target, and photographs from the poses alone"
    photos = [place for place, task in tasks.items() if task.view is not None]
    assert [tasks[place].view for place in photos] == [flight.view[place] for place in sorted(flight.view)]
    assert {tasks[place].hold_s for place in photos} == {3.0}
    assert (route.points.kind == over_the_tower().points.kind[1]).sum() == 1, "one waypoint of kind target"
    assert route.amsl_m is not None
    assert route.relative_m == pytest.approx(route.amsl_m - BASE_M)
    legs = photo_legs_of(route.points)
    assert legs.tolist() == [False, False, *[True] * (len(flight) + 1), False]
    assert np.isnan(clearances_m(route.points)[~legs]).all()
    assert set(clearances_m(route.points)[legs].tolist()) == {round(flight.clearance_m, 2)}
    assert set(route.points.speed_mps) == set(np.flatnonzero(legs).tolist())


def test_heights_over_unknown_ground_are_refused() -> None:
    with pytest.raises(GroundNotKnown) as error:
        with_photo_flights(over_the_tower(is_flat=True), {4: flown()})
    assert error.value.target == 4
    untouched = over_the_tower(is_flat=True)
    assert with_photo_flights(untouched, {5: flown()}) is untouched


def test_its_time_is_what_the_plan_of_photos_tells() -> None:
    def total_s(route: Waypoints) -> float:
        return timing(
            route, cruise_speed_mps=12.0, performance=Performance(), conditions=Conditions(), lands=True, rules=FlightRules()
        ).total_s

    more_s = total_s(with_photo_flights(over_the_tower(), {4: flown()})) - total_s(over_the_tower())
    assert more_s == pytest.approx(flown().seconds, rel=0.25)


# The last look at wires.


def line_of_the_tower() -> Spans:
    ends = FRAME.to_degrees(np.array([[0.0, 0.0], [0.0, SPAN_M], [0.0, -SPAN_M]]))
    top_m = TOWERS[TOWER].height_m
    return spans_between(ends[[0, 2]], ends[[1, 0]], np.full(2, top_m), np.full(2, top_m), np.array([3, 3]))


def ground(places: FloatArray) -> FloatArray:
    return np.full(len(places), BASE_M)


def test_a_planned_flight_keeps_its_clearance_from_its_own_line_too() -> None:
    route = with_photo_flights(over_the_tower(), {4: flown()})
    assert legs_too_near(route, line_of_the_tower(), ground, FlightRules()) == set()


def test_a_pose_moved_to_the_wires_is_found() -> None:
    flight = flown()
    photo = sorted(flight.view)[0]
    for beside_m, along_m in ((0.0, 40.0), (3.0, -60.0)):
        moved = flight.position.copy()
        moved[photo] = FRAME.to_degrees(np.array([[beside_m, along_m]]))[0]
        amsl_m = flight.amsl_m.copy()
        amsl_m[photo] = BASE_M + 20.0
        bad = PhotoFlight(moved, amsl_m, flight.agl_m, flight.stops, flight.view, flight.clearance_m, flight.length_m, flight.seconds)
        found = legs_too_near(with_photo_flights(over_the_tower(), {4: bad}), line_of_the_tower(), ground, FlightRules())
        assert {leg for leg, _span in found} >= {1 + photo}, "from the waypoint before it"


def test_a_bend_is_not_repeated_where_a_photo_was_taken() -> None:
    assert (planned().flight.photo == NO_PHOTO).sum() > 1
    flight = flown()
    same = (np.diff(flight.position, axis=0) == 0).all(axis=1) & (np.diff(flight.amsl_m) == 0)
    assert not any(same[place - 1] and place not in flight.view for place in range(1, len(flight)))
