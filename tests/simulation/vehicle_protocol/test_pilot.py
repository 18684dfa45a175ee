"""What the ground stations send, as it is seen on the wire, and what the UAV does then. QGroundControl's rules are those of its source."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionType
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.plant import FlatGround
from simulation.flight.states import FlightMode
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from tests.simulation.kinematic_uav import HOME, HOME_AMSL_M
from tests.simulation.vehicle_protocol.talk import TO, Talk, kinds, only
from tests.telemetry.vehicles.loads import mission

ACCEPTED, DENIED, FAILED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_FAILED
UNSUPPORTED, REJECTED = mavlink.MAV_RESULT_UNSUPPORTED, mavlink.MAV_RESULT_TEMPORARILY_REJECTED
NAN = math.nan
ARM, TAKE_OFF, SET_MODE, GO_TO = 400, 22, 176, 192
PX4_TAKE_OFF, PX4_HOLD, PX4_MISSION, PX4_RETURN, PX4_LAND = ((4, sub) for sub in (2, 3, 4, 5, 6))
AUTO, GUIDED, LOITER, RTL, BRAKE = 3, 4, 5, 6, 17


def flown(autopilot_type=SimulatedAutopilot.PX4):
    """The very UAV that is simulated."""
    return Talk(autopilot_type, SimulatedUav(AIRFRAMES["iris"], HOME, ground=FlatGround(HOME_AMSL_M)))


def in_the_air(autopilot_type=SimulatedAutopilot.PX4, height_m=20.0):
    talk = flown(autopilot_type)
    if autopilot_type is SimulatedAutopilot.ARDUPILOT:
        talk.command(SET_MODE, 1, GUIDED)
        talk.command(ARM, 1)
        talk.command(TAKE_OFF, 0, 0, 0, 0, 0, 0, height_m)
    else:
        talk.command(TAKE_OFF, -1, NAN, NAN, NAN, NAN, NAN, HOME_AMSL_M + height_m)
        talk.command(ARM, 1)
    talk.pass_by(25.0)
    assert talk.uav.state.mode is FlightMode.HOLD and talk.uav.state.altitude_relative_m == pytest.approx(height_m, abs=0.7)
    return talk


def test_qgroundcontrol_tells_px4_to_take_off_before_it_arms_it():
    talk = flown()
    assert talk.command(TAKE_OFF, -1, NAN, NAN, NAN, NAN, NAN, HOME_AMSL_M + 15.0) == ACCEPTED
    assert talk.mode == PX4_TAKE_OFF
    talk.pass_by(2.0)
    assert not talk.uav.state.is_armed and talk.mode == PX4_TAKE_OFF
    assert talk.command(ARM, 1) == ACCEPTED
    talk.pass_by(25.0)
    assert talk.uav.state.altitude_relative_m == pytest.approx(15.0, abs=0.7) and talk.mode == PX4_HOLD


def test_a_take_off_without_a_height_or_below_the_ground_goes_to_the_parameters_height():
    for height_m in (NAN, HOME_AMSL_M - 10):
        talk = flown()
        talk.send(mavlink.MAVLink_param_set_message(*TO, b"MIS_TAKEOFF_ALT", 7.0, 9))
        assert talk.command(TAKE_OFF, NAN, NAN, NAN, NAN, NAN, NAN, height_m) == ACCEPTED
        talk.command(ARM, 1)
        talk.pass_by(15.0)
        assert talk.uav.state.altitude_relative_m == pytest.approx(7.0, abs=0.7)


def test_each_change_of_mode_and_arming_is_in_a_heartbeat_at_once():
    talk = flown()
    talk.pass_by(0.2)
    answers = talk.send(mavlink.MAVLink_command_long_message(*TO, ARM, 0, 1, 0, 0, 0, 0, 0, 0))
    assert only(answers, "HEARTBEAT").base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    answers = talk.send(mavlink.MAVLink_set_mode_message(7, 1, 4 << 16 | 2 << 24))
    assert only(answers, "HEARTBEAT").custom_mode == 4 << 16 | 2 << 24 and only(answers, "COMMAND_ACK").result == ACCEPTED


def test_everything_left_open_is_a_pause_where_it_is():
    talk = in_the_air()
    assert talk.command(GO_TO, -1, 1) == ACCEPTED
    assert talk.uav.state.mode is FlightMode.HOLD and talk.mode == PX4_HOLD


@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_it_goes_to_a_place_and_to_a_height(autopilot_type):
    talk = in_the_air(autopilot_type)
    place = LonLat(HOME.lon, HOME.lat + 30 / 111_195)
    there = (round(place.lat * 1e7), round(place.lon * 1e7))
    message = mavlink.MAVLink_command_int_message(*TO, 0, GO_TO, 0, 0, -1, 1, 0, NAN, *there, HOME_AMSL_M + 26.0)
    assert only(talk.send(message), "COMMAND_ACK").result == ACCEPTED
    assert talk.uav.state.mode is FlightMode.GO_TO
    assert talk.mode == (PX4_HOLD if autopilot_type is SimulatedAutopilot.PX4 else (GUIDED, 0))
    talk.pass_by(20.0)
    assert talk.uav.state.position == pytest.approx(place, abs=5e-6)
    assert talk.uav.state.altitude_relative_m == pytest.approx(26.0, abs=0.5)
    assert talk.command(GO_TO, -1, 1, NAN, NAN, NAN, NAN, HOME_AMSL_M + 22.0) == ACCEPTED
    talk.pass_by(8.0)
    assert talk.uav.state.position == pytest.approx(place, abs=5e-6)
    assert talk.uav.state.altitude_relative_m == pytest.approx(22.0, abs=0.5)


def test_it_goes_nowhere_from_the_ground_nor_into_it_nor_off_the_earth():
    assert flown().command(GO_TO, -1, 1, NAN, NAN, 55.0, 10.0, 100.0) == REJECTED
    talk = in_the_air()
    assert talk.command(GO_TO, -1, 1, NAN, NAN, 95.0, 10.0, 100.0) == DENIED
    assert talk.command(GO_TO, -1, 1, NAN, NAN, NAN, NAN, HOME_AMSL_M - 1) == DENIED
    assert talk.command(GO_TO, -1, 1, NAN, NAN, math.inf, 10.0, 100.0) == DENIED
    assert talk.mode == PX4_HOLD


@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_a_height_above_ground_is_not_taken_for_one_above_the_sea(autopilot_type):
    talk = in_the_air(autopilot_type)
    here = (round(HOME.lat * 1e7), round(HOME.lon * 1e7))
    for number in (GO_TO, TAKE_OFF):
        message = mavlink.MAVLink_command_int_message(*TO, 11, number, 0, 0, -1, 1, 0, NAN, *here, 60.0)
        assert only(talk.send(message), "COMMAND_ACK").result == DENIED
    relative = mavlink.MAVLink_command_int_message(*TO, 3, GO_TO, 0, 0, -1, 1, 0, NAN, *here, 24.0)
    assert only(talk.send(relative), "COMMAND_ACK").result == ACCEPTED
    talk.pass_by(8.0)
    assert talk.uav.state.altitude_relative_m == pytest.approx(24.0, abs=0.5)


def test_px4_is_told_the_mission_and_then_armed():
    talk = flown()
    assert talk.command(SET_MODE, 209, *PX4_MISSION) == FAILED, "there is none"
    talk.endpoint.missions.put(MissionType.MISSION, mission(5))
    assert talk.command(SET_MODE, 209, *PX4_MISSION) == ACCEPTED
    assert talk.command(ARM, 1) == ACCEPTED
    talk.pass_by(10.0)
    assert talk.uav.state.is_in_air and talk.mode == PX4_MISSION
    for number, values, mode in ((193, (0,), PX4_HOLD), (193, (1,), PX4_MISSION), (20, (), PX4_RETURN), (21, (), PX4_LAND)):
        assert talk.command(number, *values) == ACCEPTED
        assert talk.mode == mode


def test_a_px4_mission_is_started_armed_or_not():
    talk = flown()
    talk.endpoint.missions.put(MissionType.MISSION, mission(5))
    assert talk.command(300, 0, 0) == ACCEPTED
    talk.pass_by(10.0)
    assert talk.uav.state.is_in_air and talk.mode == PX4_MISSION


def test_ardupilot_is_armed_in_guided_and_not_in_auto():
    talk = flown(SimulatedAutopilot.ARDUPILOT)
    talk.endpoint.missions.put(MissionType.MISSION, mission(5))
    assert talk.mode == (0, 0)
    assert talk.command(SET_MODE, 1, AUTO) == ACCEPTED
    assert talk.command(ARM, 1) == FAILED
    assert talk.command(300) == ACCEPTED and not talk.uav.state.is_armed, "it agrees, and does nothing"
    assert talk.command(SET_MODE, 1, GUIDED) == ACCEPTED
    assert talk.command(TAKE_OFF, 0, 0, 0, 0, 0, 0, 12) == FAILED, "not armed"
    assert talk.command(ARM, 1) == ACCEPTED
    assert talk.command(TAKE_OFF, 0, 0, 0, 0, 0, 0, -2) == DENIED
    assert talk.command(TAKE_OFF, 0, 0, 0, 0, 0, 0, 12) == ACCEPTED
    assert talk.mode == (GUIDED, 0)
    talk.pass_by(15.0)
    assert talk.uav.state.altitude_relative_m == pytest.approx(12, abs=0.7) and talk.mode == (GUIDED, 0)
    for number in (AUTO, LOITER, BRAKE, RTL):
        assert talk.command(SET_MODE, 1, number) == ACCEPTED
        assert talk.mode == (number, 0)


@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_no_mode_that_needs_a_pilot_is_flown(autopilot_type):
    talk = in_the_air(autopilot_type)
    before = talk.mode
    by_hand = [(209, 1), (209, 2), (209, 6)] if autopilot_type is SimulatedAutopilot.PX4 else [(1, 0), (1, 1), (1, 13)]
    for values in by_hand:
        assert talk.command(SET_MODE, *values) in (UNSUPPORTED, FAILED)
    assert talk.command(SET_MODE, 0, 4, 4) == UNSUPPORTED, "not by the autopilot's own number"
    assert talk.mode == before and talk.uav.state.mode is FlightMode.HOLD


@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_disarming_in_the_air_takes_the_word_for_it(autopilot_type):
    talk = in_the_air(autopilot_type)
    answers = talk.send(mavlink.MAVLink_command_long_message(*TO, ARM, 0, 0, NAN, NAN, NAN, NAN, NAN, NAN))
    assert only(answers, "COMMAND_ACK").result == FAILED and "STATUSTEXT" in kinds(answers)
    assert talk.uav.state.is_armed
    assert talk.command(ARM, 0, 21_196) == ACCEPTED
    assert not talk.uav.state.is_armed


@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_the_current_item_is_set_as_the_flavour_counts(autopilot_type):
    talk = Talk(autopilot_type)
    talk.endpoint.missions.put(MissionType.MISSION, mission(5))
    first = autopilot_type.first_item
    assert talk.command(224, 2 + first) == ACCEPTED and talk.uav.state.current_item == 2
    assert talk.command(224, 5 + first) == DENIED and talk.command(224, -1) == DENIED and talk.command(224) == DENIED
    assert only(talk.send(mavlink.MAVLink_mission_set_current_message(*TO, 3 + first)), "MISSION_CURRENT").seq == 3 + first
    assert talk.command(224, 0) == ACCEPTED and talk.uav.state.current_item == 0


def test_a_speed_is_set_and_what_is_none_is_not():
    talk = in_the_air()
    assert talk.command(178, 1, 3.5, -1) == ACCEPTED and talk.uav.state.target_speed_mps == 3.5
    assert talk.command(178, 1, -1, -1) == ACCEPTED and talk.uav.state.target_speed_mps == 3.5
    assert talk.command(178, 1, 0, -1) == DENIED and talk.command(178, 2, 3) == UNSUPPORTED


def test_unknown_commands_and_messages_are_refused_at_once_and_known_ones_sent():
    talk = Talk()
    assert talk.command(31_010) == UNSUPPORTED
    for number in (397, 395, 435, 300, 99_999, NAN):
        assert talk.command(512, number) == UNSUPPORTED
    answers = talk.send(mavlink.MAVLink_command_long_message(*TO, 512, 0, 148, 0, 0, 0, 0, 0, 0))
    version = only(answers, "AUTOPILOT_VERSION")
    assert version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT and version.flight_sw_version >> 24 >= 1
    assert not version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    for number in mavlink.MAVLINK_MSG_ID_HOME_POSITION, mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN:
        assert talk.command(512, number) == ACCEPTED
    assert talk.command(520, 1) == ACCEPTED and talk.command(410) == ACCEPTED


@pytest.mark.parametrize("autopilot_type", SimulatedAutopilot)
def test_a_return_leads_to_the_rally_point_that_is_nearer_than_home(autopilot_type):
    """A point 60 m to the north, 50 m up; it stands 45 m to the north. PX4 counts the height of returns from that of the point."""
    talk = in_the_air(autopilot_type)
    there = (round((HOME.lat + 60 / 111_195) * 1e7), round(HOME.lon * 1e7))
    point = mavlink.MAVLink_mission_item_int_message(*TO, 0, 3, 5100, 0, 1, 0, 0, 0, 0, *there, 50.0, 2)
    assert only(talk.send(mavlink.MAVLink_mission_count_message(*TO, 1, 2), point)[-1:], "MISSION_ACK").type == 0
    place = (round((HOME.lat + 45 / 111_195) * 1e7), round(HOME.lon * 1e7))
    talk.send(mavlink.MAVLink_command_int_message(*TO, 0, GO_TO, 0, 0, -1, 1, 0, NAN, *place, HOME_AMSL_M + 20.0))
    talk.pass_by(25.0)
    assert talk.command(20) == ACCEPTED
    reported = [one for one in talk.pass_by(160.0) if one.get_type() == "GLOBAL_POSITION_INT"]
    assert max(one.relative_alt for one in reported) / 1_000 == pytest.approx(
        80.0 if autopilot_type is SimulatedAutopilot.PX4 else 50.0, abs=1.0
    )
    assert not talk.uav.state.is_in_air
    assert (talk.uav.state.position.lat - HOME.lat) * 111_195 == pytest.approx(60.0, abs=1.0)


def test_ardupilot_flies_no_list_from_the_ground_that_does_not_begin_with_a_take_off():
    """In the air it does; PX4 takes off by itself."""
    items = mission(5)[1:]
    talk = flown(SimulatedAutopilot.ARDUPILOT)
    talk.endpoint.missions.put(MissionType.MISSION, items)
    talk.command(SET_MODE, 1, GUIDED)
    assert talk.command(ARM, 1) == ACCEPTED
    answers = talk.send(mavlink.MAVLink_command_long_message(*TO, SET_MODE, 0, 1, AUTO, NAN, NAN, NAN, NAN, NAN))
    assert only(answers, "COMMAND_ACK").result == FAILED and "Missing Takeoff" in only(answers, "STATUSTEXT").text
    assert talk.command(300) == FAILED
    assert talk.uav.state.mode is FlightMode.HOLD
    aloft = in_the_air(SimulatedAutopilot.ARDUPILOT)
    aloft.endpoint.missions.put(MissionType.MISSION, items)
    assert aloft.command(SET_MODE, 1, AUTO) == ACCEPTED
    other = flown(SimulatedAutopilot.PX4)
    other.endpoint.missions.put(MissionType.MISSION, items)
    assert other.command(300) == ACCEPTED


def test_the_fence_is_kept_by_holding_or_as_it_is_set():
    """A circle of 30 m about home; it flies north."""
    talk = in_the_air()
    corner = mavlink.MAVLink_mission_item_int_message(
        *TO, 0, 0, 5003, 0, 1, 30.0, 0, 0, 0, round(HOME.lat * 1e7), round(HOME.lon * 1e7), 0, 1
    )
    talk.send(mavlink.MAVLink_mission_count_message(*TO, 1, 1), corner)
    assert talk.command(GO_TO, -1, 1, NAN, NAN, HOME.lat + 200 / 111_195, HOME.lon, NAN) == ACCEPTED
    reported = talk.pass_by(20.0)
    assert any("Fence" in one.text for one in reported if one.get_type() == "STATUSTEXT")
    assert talk.uav.state.mode is FlightMode.HOLD
    assert 30 < (talk.uav.state.position.lat - HOME.lat) * 111_195 < 50
    health = [one for one in reported if one.get_type() == "SYS_STATUS"][-1].onboard_control_sensors_health
    assert not health & mavlink.MAV_SYS_STATUS_GEOFENCE
    assert talk.command(20) == ACCEPTED, "it may go home"
    talk.pass_by(10.0)
    assert talk.uav.state.mode is FlightMode.RETURN


def test_ardupilots_fence_is_switched_off_and_px4_has_no_such_switch():
    assert Talk().command(207, 0) == UNSUPPORTED
    talk = Talk(SimulatedAutopilot.ARDUPILOT)
    for wanted in (0, 1):
        assert talk.command(207, wanted) == ACCEPTED and talk.endpoint.parameters["FENCE_ENABLE"] == wanted
    assert talk.command(207, 7) == DENIED and talk.command(207) == DENIED
