"""What is known of a vehicle from its messages."""

from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType, Mode
from mavlink.vehicle_state import VehicleState
from tests.mavlink.mission_sync.test_upload import received


def heartbeat(autopilot: int, custom_mode: int = 0, base_mode: int = 1, status: int = 3, kind: int = 2, **source: int) -> Any:
    return received(mavlink.MAVLink_heartbeat_message(kind, autopilot, base_mode, custom_mode, status, 3), **source)


def state_of(*messages: Any) -> VehicleState:
    state = VehicleState(7)
    for number, message in enumerate(messages):
        state.receive(message, float(number))
    return state


@pytest.mark.parametrize(
    ("autopilot", "custom_mode", "name", "mode"),
    [
        (mavlink.MAV_AUTOPILOT_PX4, 4 << 16 | 4 << 24, "MISSION", Mode.MISSION),
        (mavlink.MAV_AUTOPILOT_PX4, 4 << 16 | 3 << 24, "LOITER", Mode.HOLD),
        (mavlink.MAV_AUTOPILOT_PX4, 4 << 16 | 5 << 24, "RTL", Mode.RETURN),
        (mavlink.MAV_AUTOPILOT_PX4, 3 << 16, "POSCTL", None),
        (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 3, "AUTO", Mode.MISSION),
        (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 4, "GUIDED", Mode.GUIDED),
        (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 17, "BRAKE", Mode.HOLD),
        (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 5, "LOITER", Mode.HOLD),
        (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 21, "SMART_RTL", Mode.RETURN),
        (mavlink.MAV_AUTOPILOT_GENERIC, 3, "MODE 3", None),
    ],
)
def test_mode_has_the_autopilots_name_and_our_meaning(autopilot: int, custom_mode: int, name: str, mode: Mode | None):
    state = state_of(heartbeat(autopilot, custom_mode))
    assert state.mode == name
    assert [known for known in Mode if state.is_in(known)] == ([] if mode is None else [mode])


def test_nothing_is_known_before_a_heartbeat():
    state = VehicleState(7)
    assert (state.autopilot_type, state.mode, state.is_in_air, state.is_held) == (None, "", None, False)
    assert not state.is_fresh(0.0, 3.0)


@pytest.mark.parametrize("message", [
    heartbeat(mavlink.MAV_AUTOPILOT_PX4, system=8),
    heartbeat(mavlink.MAV_AUTOPILOT_INVALID, kind=mavlink.MAV_TYPE_GCS),
    heartbeat(mavlink.MAV_AUTOPILOT_INVALID, component=154),
])  # fmt: skip
def test_heartbeats_of_others_are_not_the_vehicles(message: Any):
    assert state_of(message).autopilot_type is None


def test_flying_is_told_by_the_landed_state_and_else_by_ardupilots_heartbeat():
    flying = heartbeat(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 3, base_mode=129, status=4)
    landed = received(mavlink.MAVLink_extended_sys_state_message(0, mavlink.MAV_LANDED_STATE_ON_GROUND))
    assert state_of(flying).is_in_air is True
    assert state_of(flying, landed).is_in_air is False
    assert state_of(heartbeat(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA)).is_in_air is False
    assert state_of(heartbeat(mavlink.MAV_AUTOPILOT_PX4, base_mode=129, status=4)).is_in_air is None


def test_position_home_mission_version_health_and_texts_are_kept():
    state = state_of(
        heartbeat(mavlink.MAV_AUTOPILOT_PX4),
        received(mavlink.MAVLink_global_position_int_message(1, 554000000, 98000000, 81500, 61500, 0, 0, 0, 0)),
        received(mavlink.MAVLink_home_position_message(554000001, 98000001, 20000, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0)),
        received(mavlink.MAVLink_mission_current_message(3, 6, 3)),
        received(mavlink.MAVLink_mission_item_reached_message(2)),
        received(mavlink.MAVLink_autopilot_version_message(4, 0x010D0300, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)),
        received(mavlink.MAVLink_sys_status_message(1 << 28, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)),
        received(mavlink.MAVLink_param_value_message(b"MIS_DIST_WPS", 900.0, 9, 1, 0)),
        received(mavlink.MAVLink_statustext_message(2, b"Need Position Estimate")),
    )
    assert (state.position, state.altitude_amsl_m, state.altitude_relative_m) == ((9.8, 55.4), 81.5, 61.5)
    assert (state.home, state.home_amsl_m) == ((9.8000001, 55.4000001), 20.0)
    assert (state.mission_item, state.mission_total, state.mission_state, state.reached_item) == (3, 6, 3, 2)
    assert (state.capabilities, state.firmware, state.is_ready_to_arm) == (4, (1, 13, 3), False)
    assert state.parameters == {"MIS_DIST_WPS": 900.0}
    assert state.words_since(8.0) == "Need Position Estimate"
    assert state.words_since(8.5) == ""
    assert (state.received_at_s, state.heartbeat_at_s, state.autopilot_type) == (8.0, 0.0, AutopilotType.PX4)


def test_only_the_newest_texts_are_kept():
    state = state_of(*(received(mavlink.MAVLink_statustext_message(6, f"text {number}".encode())) for number in range(25)))
    assert [text for _, _, text in state.texts] == [f"text {number}" for number in range(15, 25)]


@pytest.mark.parametrize(("custom_mode", "is_held"), [(3, False), (6, False), (17, True), (5, True), (4, True)])
def test_ardupilot_is_held_where_it_flies_no_list(custom_mode: int, is_held: bool):
    assert state_of(heartbeat(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, custom_mode)).is_held is is_held
