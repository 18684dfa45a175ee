"""What a vehicle's messages tell of somebody else who changes its lists."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_state import VehicleState
from telemetry.gateway.session import QUIET_S, ListWatch
from telemetry.services.links.onboard_lists import Doubt

LOADED_S, LATER_S = 100.0, 100.0 + QUIET_S + 1.0


@pytest.fixture
def watch() -> ListWatch:
    """We have sent it a list at LOADED_S."""
    found = ListWatch()
    found.note_sent(mavlink.MAVLink_mission_count_message(7, 1, 3, 0), LOADED_S)
    return found


def doubts(watch: ListWatch, message, now_s: float, total: int | None = None) -> list[Doubt]:
    state = VehicleState(7)
    state.mission_total = total
    watch.check(message, state, now_s)
    return [doubt for doubt, _ in watch.found]


def request(system: int, component: int = 190):
    return mavlink.MAVLink_mission_request_int_message(system, component, 0, 0)


def test_what_is_asked_of_another_station_is_somebody_elses_list(watch):
    assert doubts(watch, request(42), LOADED_S) == [Doubt.OTHER_STATION]


def test_a_station_that_calls_itself_like_us_is_known_by_its_time(watch):
    assert doubts(watch, request(255), LOADED_S + 1.0) == []
    assert doubts(watch, request(255), LATER_S) == [Doubt.OTHER_STATION]


def test_who_reads_a_list_changes_none(watch):
    assert doubts(watch, mavlink.MAVLink_mission_count_message(42, 190, 3, 0), LATER_S) == []


def test_another_number_of_items_is_another_list_unless_it_is_ours(watch):
    current = mavlink.MAVLink_mission_current_message(0)
    assert doubts(watch, current, LOADED_S, total=5) == []
    assert doubts(watch, current, LOADED_S + 1.0, total=8) == []
    assert doubts(watch, current, LATER_S, total=8) == []
    assert doubts(watch, current, LATER_S, total=9) == [Doubt.OTHER_LENGTH]


def test_a_boot_is_doubted_and_the_first_one_is_none(watch):
    watch.check_boot("one", 1.0)
    watch.check_boot("one", 2.0)
    assert watch.found == []
    watch.check_boot("two", 3.0)
    assert watch.found == [(Doubt.REBOOTED, 3.0)]
