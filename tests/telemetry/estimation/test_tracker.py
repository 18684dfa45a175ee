"""One UAV, its reports and what is made of them.

Route: up to 60 m, 600 m east, a hold of 20 s, 600 m north, and straight back to the take-off.

        3
        |
0 ----- 1 (2: the hold)
"""

import math
import random
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import RETURN, FrozenRoute, FrozenWaypoint, TakeOff
from mavlink.decoding.measurement import Measurement
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from telemetry.estimation.estimate import Estimate
from telemetry.estimation.knowledge import Knowledge
from telemetry.estimation.report import Report
from telemetry.estimation.tracker import CONFIDENCE_HORIZON_S, Tracker
from telemetry.estimation.uav_clock import UavClock
from telemetry.services.watches import estimate_to_json

HOME = LonLat(10.0, 56.0)
FRAME = LocalFrame.around(*HOME)
T0 = 1_764_000_000.0
SPEED_MPS = 10.0


def place(east_m: float, north_m: float) -> LonLat:
    lon, lat = FRAME.to_degrees(np.array([[east_m, north_m]]))[0]
    return LonLat(float(lon), float(lat))


def metres(estimate: Estimate) -> tuple[float, float]:
    east_m, north_m = FRAME.to_metres(np.array([estimate.position]))[0]
    return float(east_m), float(north_m)


def waypoint(number: int, east_m: float, north_m: float, kind: WaypointKind = WaypointKind.PASS, **more: Any) -> FrozenWaypoint:
    return FrozenWaypoint(number, place(east_m, north_m), kind, 60.0, 60.0, **more)


@pytest.fixture
def knowledge() -> Knowledge:
    hold = Task(TaskKind.HOLD, 20.0)
    waypoints = (
        waypoint(0, 0, 0, WaypointKind.START),
        waypoint(1, 600, 0),
        waypoint(2, 600, 0, WaypointKind.TARGET, task=hold, target=7),
        waypoint(3, 600, 600, WaypointKind.TARGET, target=4),
        waypoint(4, 0, 0, WaypointKind.END),
    )
    route = FrozenRoute("Tern", TakeOff(HOME, 12.0), SPEED_MPS, RETURN, waypoints)
    return Knowledge(route.flights[0], SPEED_MPS, home=HOME)


def report(
    second: float, east_m: float, north_m: float, *, late_s: float = 0.1, v: tuple[float, float] = (SPEED_MPS, 0.0), **reported: Any
) -> Report:
    values = {"mode": "MISSION", "is_armed": True, "is_in_air": True, "altitude_relative_m": 60.0, "altitude_amsl_m": 72.0} | reported
    lon, lat = place(east_m, north_m)
    east_mps, north_mps = v
    measurement = Measurement(lon, lat, velocity_east_mps=east_mps, velocity_north_mps=north_mps, velocity_down_mps=0.0, **values)
    return Report(T0 + second, T0 + second + late_s, measurement)


def eastwards(seconds: range) -> list[Report]:
    """On the first leg, at 100 m in the first second."""
    return [report(second, 100.0 + SPEED_MPS * second, 0.0, waypoint_sequence=1) for second in seconds]


def tracked(knowledge: Knowledge, reports: list[Report]) -> Tracker:
    tracker = Tracker(knowledge)
    for one in reports:
        tracker.take(one)
    return tracker


def at(tracker: Tracker, second: float) -> Estimate:
    estimate = tracker.estimate(T0 + second)
    assert estimate is not None
    return estimate


def test_nothing_is_estimated_before_the_first_position(knowledge):
    tracker = Tracker(knowledge)
    assert tracker.estimate(T0) is None
    tracker.take(Report(T0, T0, Measurement(mode="MISSION")))
    assert tracker.estimate(T0 + 1) is None


def test_how_far_apart_reports_come_is_told_by_their_arrivals(knowledge):
    """Ten reports in one parcel each ten seconds; one alone tells nothing."""
    assert at(tracked(knowledge, eastwards(range(1))), 5.0).report_interval_s is None
    assert at(tracked(knowledge, eastwards(range(10))), 10.0).report_interval_s == pytest.approx(1.0)
    parcels = [replace(one, received_s=T0 + 10.0 * (number // 10 + 1)) for number, one in enumerate(eastwards(range(30)))]
    assert at(tracked(knowledge, parcels), 30.0).report_interval_s == 10.0


def test_ten_times_as_fast_as_real_time_it_is_where_it_would_be_by_its_own_clock(knowledge):
    """The same reports within a tenth of the time: the same places, and arrivals a tenth as far away."""
    usual = tracked(knowledge, eastwards(range(10)))
    fast = Tracker(knowledge)
    fast.time.run_at(10.0, T0)
    for one in eastwards(range(10)):
        fast.take(replace(one, measured_s=T0 + (one.measured_s - T0) / 10.0, received_s=T0 + (one.received_s - T0) / 10.0))
    for second in (9.0, 19.0, 40.0):
        ours, theirs = at(fast, second / 10.0), at(usual, second)
        assert metres(ours) == pytest.approx(metres(theirs), abs=0.01)
        assert ours.speed_mps == pytest.approx(theirs.speed_mps)
        assert ours.bound.along_m == pytest.approx(theirs.bound.along_m, rel=1e-3)
        assert [(one.at_s - T0) * 10.0 for one in ours.arrivals] == pytest.approx([one.at_s - T0 for one in theirs.arrivals], abs=0.01)
        assert (ours.ends_at_s - T0) * 10.0 == pytest.approx(theirs.ends_at_s - T0, abs=0.01)
        assert ours.report_s == pytest.approx(T0 + 0.9)
    assert at(fast, 1.5).is_measured
    assert not at(fast, 2.0).is_measured


def test_what_was_measured_before_it_became_faster_stays_where_it_was(knowledge):
    """Ten seconds at 1x, one at 10x, and a report of the first ten that came late."""
    tracker = tracked(knowledge, [one for one in eastwards(range(10)) if one.measured_s != T0 + 5.0])
    tracker.time.run_at(10.0, T0 + 9.0)
    tracker.take(replace(eastwards(range(19, 20))[0], measured_s=T0 + 10.0, received_s=T0 + 10.0))
    tracker.take(replace(eastwards(range(5, 6))[0], received_s=T0 + 10.1))
    assert metres(at(tracker, 10.5))[0] == pytest.approx(340.0, abs=5.0)
    assert metres(at(tracker, 7.5))[0] == pytest.approx(175.0, abs=5.0)
    assert tracker.time.server_s(tracker.time.uav_s(T0 + 4.0)) == T0 + 4.0


@pytest.mark.parametrize("rate", [None, 0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_a_clock_that_cannot_be_is_taken_for_the_servers(rate):
    time = UavClock()
    time.run_at(rate, T0)
    assert time.uav_s(T0 + 3.25) == T0 + 3.25
    assert time.server_s(T0 + 3.25) == T0 + 3.25


def test_between_reports_it_goes_on_along_its_route(knowledge):
    estimate = at(tracked(knowledge, eastwards(range(10))), 19.0)
    east_m, north_m = metres(estimate)
    assert east_m == pytest.approx(290.0, abs=5.0)
    assert north_m == pytest.approx(0.0, abs=1.0)
    assert estimate.speed_mps == pytest.approx(SPEED_MPS, abs=0.5)
    assert estimate.altitude_amsl_m == pytest.approx(72.0, abs=1.0)
    assert (estimate.waypoint_sequence, estimate.is_measured, estimate.is_lost) == (1, False, False)
    assert estimate.along_route_m == pytest.approx(290.0, abs=6.0)
    assert 85.0 <= estimate.bound.bearing_deg <= 95.0
    assert estimate.bound.along_m > estimate.bound.across_m


def test_it_waits_at_a_task_and_turns_at_a_waypoint(knowledge):
    tracker = tracked(knowledge, eastwards(range(45)))  # 540 m
    assert metres(at(tracker, 60.0)) == pytest.approx((600.0, 0.0), abs=6.0)
    assert at(tracker, 60.0).speed_mps < 2.0
    east_m, north_m = metres(at(tracker, 100.0))
    assert east_m == pytest.approx(600.0, abs=5.0)
    assert 150.0 < north_m < 320.0


def test_the_bound_grows_and_says_at_last_that_it_is_lost(knowledge):
    tracker = tracked(knowledge, eastwards(range(10)))
    lengths = [at(tracker, second).bound.along_m for second in (9.0, 12.0, 20.0, 35.0)]
    assert lengths == sorted(lengths)
    assert not at(tracker, 35.0).is_lost
    assert at(tracker, 12.0 + CONFIDENCE_HORIZON_S).is_lost


def test_one_that_may_leave_its_route_without_a_link_is_lost_soon(knowledge):
    tracker = tracked(replace(knowledge, is_to_go_on=False), eastwards(range(10)))
    assert not at(tracker, 30.0).is_lost
    assert at(tracker, 45.0).is_lost


def test_the_order_in_which_reports_come_does_not_matter(knowledge):
    reports = eastwards(range(40))
    expected = at(tracked(knowledge, reports), 45.0)
    mixed = list(reports)
    random.Random(1).shuffle(mixed)
    found = at(tracked(knowledge, [mixed[0], *mixed, *mixed]), 45.0)
    assert metres(found) == pytest.approx(metres(expected), abs=1e-6)
    assert found.bound.along_m == pytest.approx(expected.bound.along_m, abs=1e-6)


def test_a_replayed_log_corrects_the_past_and_the_present(knowledge):
    """It was slower than thought while nothing was heard: only the log tells."""
    reports = eastwards(range(5))
    tracker = tracked(knowledge, reports)
    before = metres(at(tracker, 30.0))[0]
    for second in range(5, 25):
        tracker.take(report(second, 140.0 + 5.0 * (second - 4), 0.0, late_s=25.0 - second, v=(5.0, 0.0), waypoint_sequence=1))
    assert metres(at(tracker, 30.0))[0] < before - 80.0
    assert metres(at(tracker, 20.0))[0] == pytest.approx(220.0, abs=4.0)


def test_what_cannot_be_changes_nothing(knowledge):
    tracker = tracked(knowledge, eastwards(range(10)))
    expected = at(tracker, 15.0)
    nan = math.nan
    tracker.take(Report(nan, T0, Measurement(10.0, 56.0)))
    tracker.take(Report(T0 + 500.0, T0 + 10.0, Measurement(10.0, 56.0)))  # from the future
    tracker.take(Report(T0 - 4_000.0, T0 + 10.0, Measurement(10.0, 56.0)))  # too long ago
    assert at(tracker, 15.0) == expected


def test_values_that_are_no_numbers_leave_no_trace(knowledge):
    tracker = tracked(knowledge, eastwards(range(10)))
    nan = math.nan
    wrong = Measurement(nan, nan, nan, nan, nan, nan, math.inf, nan, heading_deg=nan, mode="MISSION", is_in_air=True, waypoint_sequence=1)
    tracker.take(Report(T0 + 10.0, T0 + 10.1, wrong))
    estimate = at(tracker, 15.0)
    numbers = [*estimate.position, estimate.speed_mps, estimate.bound.along_m, estimate.bound_height_m, estimate.altitude_relative_m]
    assert all(number is not None and math.isfinite(number) for number in numbers)
    assert metres(estimate)[0] == pytest.approx(250.0, abs=5.0)


def test_without_gps_the_waypoint_that_it_flies_to_tells_where_it_is(knowledge):
    """It should still stand at its task; it says that it flies to the next waypoint already, at speed."""
    moving = Measurement(velocity_east_mps=0.0, velocity_north_mps=10.0, mode="MISSION", is_in_air=True, waypoint_sequence=3)
    tracker = tracked(knowledge, eastwards(range(45)))
    before = at(tracker, 73.5)
    tracker.take(Report(T0 + 73.0, T0 + 73.1, moving))
    reported = at(tracker, 73.5)
    assert (before.waypoint_sequence, reported.waypoint_sequence) == (2, 3)
    assert metres(reported)[1] > metres(before)[1] + 5.0
    assert not reported.is_measured


def test_without_gps_a_change_of_mode_is_believed(knowledge):
    reports = [*eastwards(range(30)), Report(T0 + 30.0, T0 + 30.1, Measurement(mode="LOITER", is_in_air=True))]
    assert metres(at(tracked(knowledge, reports), 60.0))[0] == pytest.approx(405.0, abs=15.0)


@pytest.mark.parametrize("mode", ["LOITER", "BRAKE", "POSHOLD"])
def test_one_that_holds_stays(knowledge, mode):
    reports = [*eastwards(range(30)), report(30.0, 400.0, 0.0, v=(0.0, 0.0), mode=mode)]
    estimate = at(tracked(knowledge, reports), 60.0)
    assert metres(estimate) == pytest.approx((400.0, 0.0), abs=3.0)
    assert estimate.speed_mps < 0.5
    assert estimate.arrivals == ()


@pytest.mark.parametrize("mode", ["RTL", "SMART_RTL"])
def test_one_that_returns_flies_home_and_comes_down(knowledge, mode):
    reports = [*eastwards(range(30)), report(30.0, 400.0, 0.0, v=(0.0, 0.0), mode=mode)]
    tracker = tracked(knowledge, reports)
    assert 50.0 < metres(at(tracker, 60.0))[0] < 200.0
    home = at(tracker, 160.0)
    assert metres(home) == pytest.approx((0.0, 0.0), abs=5.0)
    assert home.altitude_relative_m == pytest.approx(0.0, abs=3.0)
    assert home.ends_at_s is not None


def test_one_that_lands_sinks_to_the_ground_and_no_deeper(knowledge):
    tracker = tracked(knowledge, [report(30.0, 400.0, 0.0, v=(0.0, 0.0), mode="LAND")])
    heights = [at(tracker, second).altitude_relative_m for second in (30.0, 50.0, 300.0)]
    assert heights == sorted(heights, reverse=True)
    assert heights[-1] == pytest.approx(0.0, abs=1.0)


def test_one_on_the_ground_stands_there(knowledge):
    reported = report(0.0, 1.0, 2.0, v=(0.0, 0.0), altitude_relative_m=0.0, is_in_air=False, is_armed=False)
    estimate = at(tracked(knowledge, [reported]), 120.0)
    assert metres(estimate) == pytest.approx((1.0, 2.0), abs=0.5)
    assert estimate.bound.along_m < 10.0


def test_one_that_stands_armed_in_its_mission_may_set_out_at_any_moment(knowledge):
    """Until a report says that it has: the bound holds both, the take-off and the way that it would be on by then."""
    ready, flown = tracked(knowledge, [standing(True, "MISSION")]), tracked(knowledge, [report(0, 0, 0, altitude_relative_m=0.0)])
    soon, later = ready.estimate(T0 + 1.0), ready.estimate(T0 + 30.0)
    going = flown.estimate(T0 + 30.0)
    assert soon.bound.along_m < 10.0 and later.bound_height_m > 20.0
    assert 0.0 < metres(later)[0] < metres(going)[0] and metres(later)[0] - later.bound.along_m < 5.0
    for is_armed, mode in ((False, "MISSION"), (True, "LOITER")):
        waits = tracked(knowledge, [standing(is_armed, mode)]).estimate(T0 + 30.0)
        assert waits.bound.along_m < 5.0 and waits.speed_mps == 0.0


def standing(is_armed: bool, mode: str) -> Report:
    return report(0, 0, 0, v=(0.0, 0.0), is_in_air=False, is_armed=is_armed, mode=mode, altitude_relative_m=0.0)


def test_one_that_is_steered_goes_on_and_is_soon_less_sure(knowledge):
    reports = [*eastwards(range(30)), report(30.0, 400.0, 0.0, v=(0.0, 8.0), mode="STABILIZE")]
    tracker = tracked(knowledge, reports)
    assert metres(at(tracker, 32.0)) == pytest.approx((400.0, 14.0), abs=4.0)
    assert at(tracker, 50.0).bound.along_m > 50.0
    assert at(tracker, 50.0).along_route_m is None


def test_one_that_flies_a_mission_elsewhere_is_not_on_this_route(knowledge):
    reports = [report(second, -3_000.0 - 10.0 * second, 2_000.0, v=(-10.0, 0.0)) for second in range(5)]
    estimate = at(tracked(knowledge, reports), 6.0)
    assert estimate.along_route_m is None
    assert metres(estimate) == pytest.approx((-3_060.0, 2_000.0), abs=8.0)


def test_without_a_route_it_goes_straight_on(knowledge):
    estimate = at(tracked(Knowledge(), eastwards(range(3))), 3.0)
    assert metres(estimate)[0] == pytest.approx(130.0, abs=4.0)
    assert estimate.along_route_m is None


def test_arrivals_are_told_for_each_target_that_is_to_come(knowledge):
    tracker = tracked(knowledge, eastwards(range(30)))
    arrivals = at(tracker, 30.0).arrivals
    assert [(arrival.waypoint_sequence, arrival.target) for arrival in arrivals] == [(2, 7), (3, 4)]
    assert all(arrival.earliest_s < arrival.at_s < arrival.latest_s for arrival in arrivals)
    assert arrivals[0].at_s == pytest.approx(T0 + 53.0, abs=5.0)
    assert arrivals[1].at_s == pytest.approx(T0 + 140.0, abs=12.0)
    end_s = at(tracker, 30.0).ends_at_s
    assert end_s is not None
    assert end_s > arrivals[1].latest_s


def test_a_silent_uav_is_expected_back_where_something_was_heard_before(knowledge):
    tracker = tracked(knowledge, eastwards(range(20)))
    assert at(tracker, 22.0).contact_expected_s is None
    end_s = at(tracker, 60.0).ends_at_s
    assert at(tracker, 60.0).contact_expected_s == pytest.approx(end_s, abs=60.0)
    tracker.learn([place(600.0, 400.0)])  # an earlier flight's
    expected_s = at(tracker, 60.0).contact_expected_s
    assert expected_s is not None
    assert expected_s == pytest.approx(T0 + 53 + 22 + 38, abs=15.0)
    assert at(tracker, 145.0).contact_expected_s == expected_s, "past it, and still nothing heard: overdue, not moved on"


def test_what_is_known_can_be_had_again_from_the_newest_reports(knowledge):
    reports = eastwards(range(45))
    whole, again = tracked(knowledge, reports), tracked(knowledge, reports[-20:])
    for second in (45.0, 55.0, 90.0):
        assert metres(at(again, second)) == pytest.approx(metres(at(whole, second)), abs=12.0)


def test_json_names_what_pages_read(knowledge):
    reported = estimate_to_json(at(tracked(knowledge, eastwards(range(30))), 33.0))
    assert reported["at"] == "2025-11-24T16:00:33.000Z"
    assert reported["report_at"] == "2025-11-24T16:00:29.000Z"
    assert set(reported["bound"]) == {"along_m", "across_m", "bearing_deg", "height_m", "speed_mps"}
    assert [arrival["target"] for arrival in reported["arrivals"]] == [7, 4]
    assert reported["is_measured"] is False
