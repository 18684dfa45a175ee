"""Parameters, files, times, texts, streams and reports."""

import math
import struct

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding.report import TextCollector
from mavlink.mission_sync.limits import PARAMETERS as LEG_LIMITS
from mavlink.rtl import rtl_behaviour
from simulation.vehicle_protocol.endpoint import text_messages
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import INTERVALS_S, Streams
from tests.simulation.kinematic_uav import HOME, HOME_AMSL_M
from tests.simulation.vehicle_protocol.talk import SYSTEM, TO, UNIX_S, Talk, kinds, only, over_the_wire

POSITION = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT


def read(talk, name, number=-1):
    return talk.send(mavlink.MAVLink_param_request_read_message(*TO, name, number))


@pytest.fixture(params=list(SimulatedAutopilot))
def talk(request):
    return Talk(request.param)


def test_parameters_are_listed_whole_and_read_by_name_and_number(talk):
    reported = talk.send(mavlink.MAVLink_param_request_list_message(*TO))
    assert [one.param_index for one in reported] == list(range(reported[0].param_count)) and {one.param_type for one in reported} == {9}
    for one in reported:
        assert only(read(talk, one.param_id.encode()), "PARAM_VALUE").param_value == one.param_value
        assert only(read(talk, b"", one.param_index), "PARAM_VALUE").param_id == one.param_id


def test_what_there_is_not_is_told_at_once(talk):
    for name, number in ((b"NO_SUCH", -1), (b"", 999), (b"_HASH_CHECK", -1)):
        assert only(read(talk, name, number), "PARAM_ERROR").error == mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST
    answers = talk.send(mavlink.MAVLink_param_set_message(*TO, b"NO_SUCH", 1.0, 9))
    assert only(answers, "PARAM_ERROR").error == mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST


def test_the_return_is_told_as_the_ground_station_reads_it_and_flown_as_it_is_set(talk):
    def reported():
        return rtl_behaviour(
            talk.autopilot_type.value, {one.param_id: one.param_value for one in talk.send(mavlink.MAVLink_param_request_list_message(*TO))}
        )

    name, per_metre = {SimulatedAutopilot.PX4: (b"RTL_RETURN_ALT", 1), SimulatedAutopilot.ARDUPILOT: (b"RTL_ALT", 100)}[talk.autopilot_type]
    assert (reported().height_m, reported().bends_by, reported().untold, reported().shuns_home) == (30.0, "", "", False)
    assert reported().level_m(5.0, away_m=1.0, goal_m=0.0) == 30.0, "it climbs however near home it is"
    assert talk.uav.settings.return_near_m == 0.0
    talk.send(mavlink.MAVLink_param_set_message(*TO, name, 45.0 * per_metre, 9))
    assert talk.uav.settings.return_height_m == reported().height_m == 45.0
    for value in (math.nan, math.inf, -5.0, 1e9):
        answers = talk.send(mavlink.MAVLink_param_set_message(*TO, name, value, 9))
        assert only(answers, "PARAM_ERROR").error == mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
        assert only(answers, "PARAM_VALUE").param_value == 45.0 * per_metre
    assert talk.uav.settings.return_height_m == 45.0


def test_what_is_fixed_says_so():
    talk = Talk()
    answers = talk.send(mavlink.MAVLink_param_set_message(*TO, b"RTL_TYPE", 1.0, 9))
    assert only(answers, "PARAM_ERROR").error == mavlink.MAV_PARAM_ERROR_READ_ONLY and only(answers, "PARAM_VALUE").param_value == 0
    assert kinds(talk.send(mavlink.MAVLink_param_set_message(*TO, b"RTL_TYPE", 0.0, 9))) == ["PARAM_VALUE"]
    assert {only(read(talk, name.encode()), "PARAM_VALUE").param_value for name in LEG_LIMITS} == {0.0}, "legs are not limited"


@pytest.mark.parametrize(("opcode", "answer", "error"), [(4, 129, 10), (3, 129, 7), (6, 129, 7), (1, 128, None), (2, 128, None)])
def test_files_are_refused_at_once(opcode, answer, error):
    """As MAVSDK would wait for 32 s otherwise."""
    payload = struct.pack("<HBBBBBBI", 65_535, 3, opcode, 4, 0, 0, 0, 0) + b"@PAR"
    asked = mavlink.MAVLink_file_transfer_protocol_message(0, *TO, list(payload.ljust(251, b"\0")))
    reported = bytes(only(Talk().send(asked), "FILE_TRANSFER_PROTOCOL").payload)
    sequence, session, reported_opcode, size, asked_opcode = struct.unpack_from("<HBBBB", reported)
    assert (sequence, session, reported_opcode, asked_opcode) == (0, 3, answer, opcode)
    assert (size, reported[12]) == ((0, 0) if error is None else (1, error))


def test_an_answer_about_files_is_not_answered():
    reported = mavlink.MAVLink_file_transfer_protocol_message(0, *TO, [0, 0, 0, 129, *[0] * 247])
    assert Talk().send(reported) == []


def test_times_are_answered_and_answers_are_not():
    talk = Talk(now_s=12.5)
    answer = only(talk.send(mavlink.MAVLink_timesync_message(0, 777)), "TIMESYNC")
    assert (answer.tc1, answer.ts1) == (12_500_000_000, 777)
    assert talk.send(mavlink.MAVLink_timesync_message(5, 777)) == []
    ping = only(talk.send(mavlink.MAVLink_ping_message(123, 4, 0, 0)), "PING")
    assert (ping.time_usec, ping.seq, ping.target_system, ping.target_component) == (123, 4, 255, 190)
    assert talk.send(mavlink.MAVLink_ping_message(123, 4, *TO)) == []


@pytest.mark.parametrize("text", ["short", "x" * 50, "y" * 51, "z" * 100, "several words " * 12])
def test_texts_of_any_length_are_put_together_again(text):
    collector = TextCollector()
    found = [one for message in text_messages(text, 4, 9) for one in collector.receive(over_the_wire(message, SYSTEM, 1), 1.0)]
    found += collector.tick(100.0)
    assert [one.text.rstrip() for one in found] == [text.rstrip()]


def test_streams_keep_their_intervals_of_simulated_time_at_any_pace():
    for wall_s in (20.0, 2.0):
        reported = kinds(Talk().pass_by(20.0, wall_s=wall_s))
        for name, times in (("GLOBAL_POSITION_INT", 100), ("ATTITUDE", 100), ("VFR_HUD", 40), ("SYS_STATUS", 20), ("BATTERY_STATUS", 10)):
            assert reported.count(name) == pytest.approx(times, abs=1)
        assert reported.count("HEARTBEAT") == pytest.approx(wall_s, abs=1)


def test_the_messages_of_many_vehicles_do_not_come_all_at_once():
    steps = [0] * 50
    for system in range(1, 41):
        streams = Streams(SimulatedAutopilot.PX4, float(system))
        for step in range(250):
            steps[step % 50] += len(streams.due(step * 0.04))
    assert max(steps) < 1.25 * sum(steps) / len(steps)


def test_an_interval_is_set_told_stopped_and_put_back():
    talk = Talk()
    usual_us = INTERVALS_S[POSITION] * 1e6
    for asked_us, reported_us, count in ((100_000, 100_000, 100), (-1, -1, 0), (0, usual_us, 50), (1, 40_000, 250)):
        assert talk.command(511, POSITION, asked_us) == mavlink.MAV_RESULT_ACCEPTED
        answers = talk.send(mavlink.MAVLink_command_long_message(*TO, 510, 0, POSITION, 0, 0, 0, 0, 0, 0))
        assert only(answers, "MESSAGE_INTERVAL").interval_us == reported_us
        assert kinds(talk.pass_by(10.0)).count("GLOBAL_POSITION_INT") == pytest.approx(count, abs=1)
    assert talk.command(511, 0, 100_000) == talk.command(511, 31_000, 100_000) == mavlink.MAV_RESULT_UNSUPPORTED
    assert talk.command(511, POSITION) == mavlink.MAV_RESULT_DENIED


def test_reports_tell_what_the_state_says(talk):
    reported = {one.get_type(): one for one in talk.pass_by(4.0)}
    position = reported["GLOBAL_POSITION_INT"]
    assert (position.lon, position.lat, position.alt) == (round(HOME.lon * 1e7), round(HOME.lat * 1e7), HOME_AMSL_M * 1000)
    assert (reported["HOME_POSITION"].longitude, reported["HOME_POSITION"].altitude) == (round(HOME.lon * 1e7), HOME_AMSL_M * 1000)
    assert reported["SYS_STATUS"].voltage_battery == 12_600 and reported["BATTERY_STATUS"].battery_remaining == 100
    assert reported["SYSTEM_TIME"].time_unix_usec == pytest.approx((UNIX_S + talk.now_s) * 1e6, abs=2e6)
    assert reported["EXTENDED_SYS_STATE"].landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND
    assert reported["HEARTBEAT"].autopilot == talk.autopilot_type.autopilot
    assert ("WIND" in reported) == (talk.autopilot_type is SimulatedAutopilot.ARDUPILOT) and ("WIND_COV" in reported) == (
        talk.autopilot_type is SimulatedAutopilot.PX4
    )
    quaternion, attitude = reported["ATTITUDE_QUATERNION"], reported["ATTITUDE"]
    assert math.hypot(quaternion.q1, quaternion.q2, quaternion.q3, quaternion.q4) == pytest.approx(1.0)
    assert 2 * math.atan2(quaternion.q4, quaternion.q1) == pytest.approx(attitude.yaw, abs=1e-6)


def test_messages_for_others_and_its_own_are_not_heard(talk):
    assert talk.send(mavlink.MAVLink_param_request_list_message(8, 1)) == []
    assert talk.send(mavlink.MAVLink_param_request_list_message(7, 100)) == [], "a component that it has not"
    own = type(talk.station)(SYSTEM, 190, 1)
    assert talk.send(mavlink.MAVLink_param_request_list_message(*TO), station=own) == []
