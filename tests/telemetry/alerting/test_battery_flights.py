"""The battery over whole flights: told in time, hardly ever for nothing."""

import pytest

from tests.telemetry.alerting.battery_flights import battery_flight


def _counts(seeds: range) -> tuple[list[int], list[int], int]:
    late, false, fell = [], [], 0
    for seed in seeds:
        flown = battery_flight(seed)
        fell += flown.below_reserve_s is not None
        late += [seed] if flown.was_warned_late else []
        false += [seed] if flown.was_false_alarm else []
    return late, false, fell


def test_no_uav_of_a_few_is_below_its_reserve_before_its_critical_alert_was_open_for_20_s():
    late, false, fell = _counts(range(15))
    assert late == []
    assert len(false) <= 1, f"critical for nothing: {false}"  # flight 10 lands with 20.02 % of 20; of the 200 they are one in 100
    assert 3 <= fell <= 12, "some flights are short of battery, and some are not"


@pytest.mark.long
def test_no_uav_of_200_is_below_its_reserve_before_its_critical_alert_was_open_for_20_s():
    late, false, fell = _counts(range(1_000, 1_200))
    assert late == []
    assert len(false) <= 2, f"critical for nothing: {false}"
    assert 40 <= fell <= 180
