"""Off the route and off the height, leg by leg, as far as was flown."""

from dataclasses import replace

import pytest

from telemetry.mission_report.fix import Fix, in_order, uav_after_s, uav_span_s
from telemetry.mission_report.flown_route import flown_route, track_of
from tests.telemetry.mission_report.flights import SECOND, flown, flown_twice, place, route, route_of_two_flights


def test_a_flight_along_the_route_is_off_it_nowhere() -> None:
    found = flown_route(route(), flown())
    assert found.across_max_m == pytest.approx(0.0, abs=0.1) and found.height_max_m == pytest.approx(0.0, abs=0.1)
    assert found.flown_m == pytest.approx(990.0, abs=3.0)
    assert [(leg.from_sequence, leg.to_sequence) for leg in found.legs] == [(0, 1), (1, 2), (2, 3)]
    assert all(leg.reports for leg in found.legs)
    assert (found.began_s, found.ended_s) == (1_001.0, 1_120.0)
    assert found.battery_used_percent == pytest.approx(11.9) and found.battery_lowest_percent == pytest.approx(88.0)


def test_a_flight_beside_and_above_it_is_off_by_as_much() -> None:
    first, second, _ = flown_route(route(), flown(aside_m=4.0, higher_m=3.0)).legs
    assert first.across_rms_m == pytest.approx(4.0, abs=0.1) and second.across_max_m == pytest.approx(4.0, abs=0.1)
    assert first.height_max_m == pytest.approx(3.0, abs=0.1)  # about a waypoint the heights of both legs are right


def test_a_flight_that_was_broken_off_tells_nothing_of_the_legs_after_it() -> None:
    fixes = [fix for fix in flown() if fix.waypoint_sequence == 1]
    legs = flown_route(route(), fixes).legs
    assert legs[0].reports and not legs[2].reports
    assert legs[2].across_rms_m is None and legs[2].began_s is None


def test_what_is_said_on_the_ground_and_on_the_way_home_is_not_off_the_route() -> None:
    parked = [Fix(900.0 + second, place(80.0, 80.0), 0.0, 100.0, None, is_in_air=False) for second in range(20)]
    home = [Fix(1_200.0 + second, place(600.0 - 5 * second, 380.0 - 5 * second), 60.0, 80.0, 3, is_in_air=True) for second in range(1, 60)]
    found = flown_route(route(), in_order([*parked, *flown(), *home]))
    assert found.across_max_m == pytest.approx(0.0, abs=0.1)


def test_without_reports_there_are_legs_and_no_figures() -> None:
    found = flown_route(route(), [])
    assert len(found.legs) == 3 and found.across_rms_m is None and found.flown_m == 0.0 and found.began_s is None


def test_a_track_is_broken_where_nothing_was_heard_for_long_and_one_of_a_moment_is_kept() -> None:
    fixes = flown()
    late = [replace(fix, at_s=fix.at_s + 600.0) for fix in fixes[:5]]
    lines = track_of(in_order([*late, *fixes, *fixes]))
    assert [len(line) for line in lines] == [len(fixes), 5]


def test_legs_are_taken_together_by_target() -> None:
    once = route()
    without = replace(
        once, waypoints=tuple(replace(point, target=None if point.sequence == 1 else point.target) for point in once.waypoints)
    )
    found = flown_route(without, flown(aside_m=4.0))
    first, rest = found.stages
    assert (first.flight, first.target, first.whole.from_sequence, first.whole.to_sequence) == (1, 1, 0, 2)
    assert (rest.target, rest.whole.from_sequence, rest.whole.to_sequence) == (None, 2, 3)
    assert first.whole.reports == sum(leg.reports for leg in found.legs[:2]) and first.whole.length_m == pytest.approx(600.0, abs=1.0)
    assert first.whole.across_rms_m == pytest.approx(4.0, abs=0.1)


def test_each_flight_of_a_route_is_told_by_itself() -> None:
    found = flown_route(route_of_two_flights(), flown_twice())
    assert [(stage.flight, stage.target) for stage in found.stages] == [(1, 0), (1, 1), (1, None), (2, 2), (2, 3), (2, None)]
    assert {leg.from_sequence for leg in found.legs} == {0, 1, 2, SECOND, SECOND + 1, SECOND + 2}
    assert all(stage.whole.reports for stage in found.stages) and found.across_max_m == pytest.approx(0.0, abs=0.1)
    first, second = found.stages[0].whole, found.stages[3].whole
    assert second.began_s == pytest.approx((first.began_s or 0.0) + 1_800.0, abs=2.0)
    assert found.flown_m == pytest.approx(2 * 990.0, abs=6.0)


def test_of_a_route_under_way_the_first_flight_is_told_and_the_second_is_not() -> None:
    found = flown_route(route_of_two_flights(), flown())
    assert [bool(stage.whole.reports) for stage in found.stages] == [True, True, True, False, False, False]


def test_a_gap_is_told_and_left_out_of_distance_and_errors() -> None:
    """Reports of 80 s are lost; the first ones after it still name the waypoint of before."""
    long_route = replace(route(), waypoints=tuple(replace(point, position=place(*LONG_M[point.sequence])) for point in route().waypoints))
    fixes = [
        Fix(1_000.0 + second, place(*east_north), 30.0 if second < 60 else 60.0, 90.0, sequence, is_in_air=True)
        for second, east_north, sequence in along_with_a_gap()
    ]
    found = flown_route(long_route, fixes)
    (gap,) = found.gaps
    assert (gap.began_s, gap.ended_s) == (1_020.0, 1_100.0)
    assert gap.length_m == pytest.approx(800.0, abs=1.0)
    assert found.flown_m == pytest.approx(1_500.0 - 800.0, abs=2.0)
    assert found.across_max_m == pytest.approx(0.0, abs=0.5)


LONG_M = ((0.0, 0.0), (300.0, 0.0), (600.0, 0.0), (600.0, 900.0))


def along_with_a_gap() -> list[tuple[int, tuple[float, float], int]]:
    """At 10 m/s: the seconds, east and north, and the waypoint that is told."""
    found = []
    for second in [*range(21), *range(100, 151)]:
        along_m = 10.0 * second
        reported = 1 if second <= 110 else 3
        found.append((second, (along_m, 0.0) if along_m <= 600.0 else (600.0, along_m - 600.0), reported))
    return found


def test_battery_and_duration_are_from_take_off_to_landing() -> None:
    """It charged on the ground before, says nothing of the air at first, and is carried to another battery after."""
    silent = [Fix(800.0 + second, place(0.0, 0.0), 0.0, 55.0, None) for second in range(5)]
    before = [Fix(900.0 + second, place(0.0, 0.0), 0.0, 60.0 + second, None, is_in_air=False) for second in range(20)]
    after = [Fix(1_200.0 + second, place(600.0, 400.0), 0.0, 40.0 - second, None, is_in_air=False) for second in range(20)]
    found = flown_route(route(), in_order([*silent, *before, *flown(), *after]))
    assert (found.began_s, found.ended_s, found.duration_s) == (1_001.0, 1_120.0, 119.0)
    assert found.battery_start_percent == pytest.approx(99.9) and found.battery_end_percent == pytest.approx(88.0)
    assert found.battery_lowest_percent == pytest.approx(88.0) and found.battery_used_percent == pytest.approx(11.9)


def test_a_flight_faster_than_real_time_lasts_as_long_as_by_its_own_clock() -> None:
    fast = [replace(fix, at_s=1_000.0 + (fix.at_s - 1_000.0) / 2.0, boot=1, clock_s=fix.at_s) for fix in flown()]
    found = flown_route(route(), fast)
    assert found.duration_s == pytest.approx(119.0) and found.clock_rate == pytest.approx(2.0)
    assert uav_after_s(fast, fast[-1].at_s) == pytest.approx(119.0) and uav_after_s(fast, 1_030.5) == pytest.approx(60.0)
    later = [replace(fix, at_s=fix.at_s + 100.0) for fix in fast]
    assert uav_span_s([fast, later]) == pytest.approx(119.0 + 40.5 + 119.0), "between them nobody was heard"
    assert uav_span_s([fast, [replace(fix, at_s=fix.at_s + 30.0) for fix in fast]]) == pytest.approx(119.0 + 60.0)
