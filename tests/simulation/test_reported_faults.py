"""Faults from JSON."""

import pytest

from simulation.flight.faults import Faults, WrongFaults, faults_from

BEFORE = Faults(motor_failed=1, link_lost_until_s=50.0, clock_offset_s=3.0)


def test_what_is_not_told_stays_and_what_lasts_counts_from_now():
    assert faults_from({"gps_lost_for_s": 20})(BEFORE, 100.0) == Faults(
        motor_failed=1, link_lost_until_s=50.0, clock_offset_s=3.0, gps_lost_until_s=120.0
    )


def test_nothing_and_zero_take_faults_away():
    assert faults_from({"motor_failed": None, "link_lost_for_s": 0, "clock_offset_s": None})(BEFORE, 10.0) == Faults(link_lost_until_s=10.0)


@pytest.mark.parametrize(
    "reported",
    [[], {"wings": 1}, {"motor_failed": 4}, {"motor_failed": 1.5}, {"motor_failed": True}, {"battery_wh_left": -1},
     {"link_lost_for_s": "20"}, {"gps_lost_for_s": float("nan")}, {"link_lost_for_s": float("inf")}],
)  # fmt: skip
def test_what_no_uav_can_have_is_refused(reported):
    with pytest.raises(WrongFaults):
        faults_from(reported)
