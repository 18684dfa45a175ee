"""Whether a UAV was at its targets is told by where it was, however seldom it reports."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from telemetry.mission_report.fix import Fix, in_order
from telemetry.mission_report.visits import visits_of
from tests.telemetry.mission_report.flights import HOLD_S, flown, flown_twice, place, route, route_of_two_flights

MAX_SPEED_MPS = 15.0


@pytest.mark.parametrize("every_s", [1, 5, 10, 30])
def test_a_target_that_was_flown_to_and_held_is_done_however_seldom_it_is_told(every_s: int) -> None:
    first, second = visits_of(route(), flown(every_s=every_s), fastest_mps=MAX_SPEED_MPS)
    assert first.is_done and second.is_done
    assert (first.target, first.waypoint_sequence, second.target) == (0, 1, 1)
    assert first.reached_s == pytest.approx(1_030.0, abs=every_s + 1)


@pytest.mark.parametrize("every_s", [1, 5])
def test_one_that_was_left_out_is_not_done_whatever_the_vehicle_counts(every_s: int) -> None:
    first, second = visits_of(route(), flown(leaves_out=2, every_s=every_s), fastest_mps=MAX_SPEED_MPS)
    assert first.is_done and not second.is_done
    assert second.closest_m is not None and 150.0 < second.closest_m < 250.0


def test_one_that_was_not_held_long_enough_is_not_done() -> None:
    first, second = visits_of(route(), flown(held_s=HOLD_S - 10), fastest_mps=MAX_SPEED_MPS)
    assert first.can_have_reached and not first.is_done
    assert second.is_done


@pytest.mark.parametrize("faster", [2.0, 10.0])
def test_one_that_flies_faster_than_real_time_is_held_to_its_own_clock(faster: float) -> None:
    """A stay of 30 s takes 3 s at ten times real time; one that was too short stays so."""

    def fast(fixes: list[Fix]) -> list[Fix]:
        return [replace(fix, at_s=1_000.0 + (fix.at_s - 1_000.0) / faster, boot=1, clock_s=fix.at_s) for fix in fixes]

    whole, short = (visits_of(route(), fast(flown(held_s=held_s)), fastest_mps=MAX_SPEED_MPS) for held_s in (HOLD_S, HOLD_S - 10))
    assert [visit.is_done for visit in whole] == [True, True]
    assert [visit.is_done for visit in short] == [False, True]
    assert whole[0].reached_s == pytest.approx(1_000.0 + 30.0 / faster, abs=1.0)


def test_without_a_report_nothing_was_reached() -> None:
    assert [(visit.is_done, visit.closest_m, visit.reached_s) for visit in visits_of(route(), [], fastest_mps=MAX_SPEED_MPS)] == [
        (False, None, None)
    ] * 2


def test_a_place_that_is_passed_on_another_leg_does_not_count() -> None:
    fixes = [Fix(fix.at_s, fix.position, fix.altitude_relative_m, None, 3, is_in_air=True) for fix in flown()]
    away = [Fix(fix.at_s - 5.0, flown()[0].position, 30.0, None, 1, is_in_air=True) for fix in fixes[:3]]
    first, _ = visits_of(route(), [*away, *fixes], fastest_mps=MAX_SPEED_MPS)
    assert not first.is_done


@given(st.randoms(use_true_random=False), st.floats(0.0, 1.0))
def test_lost_reports_never_make_a_target_that_was_reached_a_missed_one(chance, kept: float) -> None:
    fixes = [fix for fix in flown() if chance.random() < kept]
    ends = [flown()[0], flown()[-1]]
    for visit in visits_of(route(), in_order([*fixes, *ends]), fastest_mps=MAX_SPEED_MPS):
        assert visit.is_done


def test_targets_of_the_second_flight_are_looked_for_in_the_second_flight() -> None:
    both = visits_of(route_of_two_flights(), flown_twice(), fastest_mps=MAX_SPEED_MPS)
    assert [visit.target for visit in both] == [0, 1, 2, 3] and all(visit.is_done for visit in both)
    assert both[2].reached_s == pytest.approx((both[0].reached_s or 0.0) + 1_800.0, abs=2.0)
    under_way = visits_of(route_of_two_flights(), flown(), fastest_mps=MAX_SPEED_MPS)
    assert [visit.is_done for visit in under_way] == [True, True, False, False]


def test_an_earlier_pass_over_the_same_place_does_not_count() -> None:
    """A route that comes over its target twice before its item, 90 s earlier, and lands there when its list counts from 1 again."""
    fixes = flown(every_s=1)
    early = [Fix(fix.at_s - 90.0, place(300.0, 0.0), 30.0, None, 0, is_in_air=True) for fix in fixes[:25]]
    early.append(Fix(fixes[0].at_s - 1.0, place(0.0, 0.0), 30.0, None, 0, is_in_air=True))
    none = [replace(early[0], at_s=early[0].at_s - 5.0, waypoint_sequence=None)]
    after = [Fix(fixes[-1].at_s + 10.0 + second, place(300.0, 0.0), 0.0, None, 1, is_in_air=False) for second in range(40)]
    first, second = visits_of(route(), [*none, *early, *fixes, *after], fastest_mps=MAX_SPEED_MPS)
    alone, _ = visits_of(route(), fixes, fastest_mps=MAX_SPEED_MPS)
    assert first.reached_s == alone.reached_s == pytest.approx(1_030.0, abs=3.0)
    assert first.held_s == pytest.approx(alone.held_s, abs=1.0) and first.held_s < HOLD_S + 5.0
    assert first.is_done and second.is_done


def test_two_targets_at_one_place_are_held_each_by_itself() -> None:
    way, waypoints = route(), list(route().waypoints)
    waypoints[2] = replace(waypoints[2], position=waypoints[1].position, task=waypoints[1].task)
    fixes = [Fix(1_000.0 + second, place(min(10.0 * second, 300.0), 0.0), 30.0, None, 1, is_in_air=True) for second in range(50)]
    fixes += [replace(fixes[-1], at_s=1_050.0 + second, waypoint_sequence=2) for second in range(10)]
    fixes += [Fix(1_060.0 + second, place(300.0 + 10.0 * second, 0.0), 30.0, None, 3, is_in_air=True) for second in range(1, 30)]
    first, second = visits_of(replace(way, waypoints=tuple(waypoints)), fixes, fastest_mps=MAX_SPEED_MPS)
    assert first.held_s == pytest.approx(21.0, abs=2.5) and first.is_done
    assert second.held_s == pytest.approx(11.0, abs=2.5) and not second.is_done


OUT_AND_BACK_M = ((0.0, 0.0), (900.0, 0.0), (300.0, 0.0), (0.0, 0.0))  # over the second target on the way out to the first


def out_and_back():
    way = route()
    points = [replace(point, position=place(*OUT_AND_BACK_M[point.sequence]), task=None) for point in way.waypoints]
    return replace(way, waypoints=tuple(points))


@pytest.mark.parametrize("tells", [True, False])
def test_a_pass_on_the_way_out_is_neither_a_visit_nor_the_nearest(tells: bool) -> None:
    """It crashes 200 m after it turned back, whether or not it tells its waypoints."""
    out = [(1_000.0 + second, place(10.0 * second, 0.0)) for second in range(91)]
    fixes = [Fix(at_s, here, 30.0, None, 1 if tells else None, is_in_air=True) for at_s, here in out]
    back = [(1_090.0 + second, place(900.0 - 10.0 * second, 0.0)) for second in range(1, 21)]
    fixes += [Fix(at_s, here, 30.0, None, 2 if tells else None, is_in_air=True) for at_s, here in back]
    first, second = visits_of(out_and_back(), fixes, fastest_mps=MAX_SPEED_MPS)
    assert first.is_done and first.is_confirmed
    assert not second.is_done and not second.is_confirmed
    assert second.closest_m == pytest.approx(400.0, abs=5.0)


def test_a_visit_is_confirmed_by_the_track_and_not_by_what_can_have_been() -> None:
    """Reports every 10 s pass it in a straight line; with a gap of 40 s it can have been there, and nobody knows."""
    on_line = flown(every_s=10)
    _, second = visits_of(route(), on_line, fastest_mps=MAX_SPEED_MPS)
    assert second.is_done and second.is_confirmed
    gap = [fix for fix in flown() if not 1_060.0 < fix.at_s < 1_100.0]
    _, second = visits_of(route(), gap, fastest_mps=MAX_SPEED_MPS)
    assert second.is_done and not second.is_confirmed
    assert second.closest_m is not None and second.closest_m > 15.0


def test_a_visit_has_the_height_at_its_nearest_report() -> None:
    first, second = visits_of(route(), flown(), fastest_mps=MAX_SPEED_MPS)
    assert (first.altitude_relative_m, second.altitude_relative_m) == (30.0, pytest.approx(60.0, abs=1.0))
