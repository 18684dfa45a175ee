"""Lists in and out, message by message."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_plan import MissionItem, MissionType
from simulation.vehicle_protocol.mission_server import MAX_REQUESTS, REQUEST_INTERVAL_S
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import Station
from tests.simulation.kinematic_uav import HOME, HOME_AMSL_M
from tests.simulation.vehicle_protocol.talk import TO, Talk, kinds, only
from tests.telemetry.vehicles.loads import mission, polygon, rally, waypoint

MISSION, FENCE, RALLY = MissionType
REQUEST = {SimulatedAutopilot.PX4: "MISSION_REQUEST_INT", SimulatedAutopilot.ARDUPILOT: "MISSION_REQUEST"}
HOME_ITEM = MissionItem(16, 0, (0.0, 0.0, 0.0, 0.0), 1, 2, 3.0)
OTHER = Station(254, 190, 2)


def count(number, kind=MISSION):
    return mavlink.MAVLink_mission_count_message(*TO, number, kind)


def item(number, one, kind=MISSION):
    places = (one.latitude_e7, one.longitude_e7, one.altitude_m)
    return mavlink.MAVLink_mission_item_int_message(*TO, number, one.frame, one.command, 0, 1, *one.parameters, *places, kind)


def upload(talk, items, kind=MISSION):
    """What the last message draws."""
    sent = [HOME_ITEM, *items] if talk.autopilot_type is SimulatedAutopilot.ARDUPILOT and kind is MISSION else items
    answers = talk.send(count(len(sent), kind))
    for number, one in enumerate(sent):
        request = only(answers, REQUEST[talk.autopilot_type])
        assert (request.seq, request.mission_type) == (number, kind)
        answers = talk.send(item(number, one, kind))
    return answers


def accepted(answers):
    return only(answers, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED


def download(talk, kind=MISSION):
    listed = only(talk.send(mavlink.MAVLink_mission_request_list_message(*TO, kind)), "MISSION_COUNT")
    requests = (mavlink.MAVLink_mission_request_int_message(*TO, number, kind) for number in range(listed.count))
    return [only(talk.send(request), "MISSION_ITEM_INT") for request in requests]


def as_read(message):
    parameters = (message.param1, message.param2, message.param3, message.param4)
    return repr((message.seq, message.command, message.frame, parameters, message.y, message.x, message.z))


@pytest.fixture(params=list(SimulatedAutopilot))
def talk(request):
    return Talk(request.param)


def test_what_is_sent_is_given_back_bit_by_bit():
    talk, items = Talk(), mission(30)
    assert accepted(upload(talk, items))
    assert len(talk.uav.items) == 30
    sent = [mavlink.MAVLink(None).parse_char(item(number, one).pack(mavlink.MAVLink(None))) for number, one in enumerate(items)]
    assert [as_read(one) for one in download(talk)] == [as_read(one) for one in sent]


def test_ardupilot_has_home_as_item_0_and_forgets_what_ardupilot_forgets():
    talk = Talk(SimulatedAutopilot.ARDUPILOT)
    place = MissionItem(16, 6, (2.7, 4.0, 5.0, math.nan), 98_000_001, 554_000_002, 30.129)
    speed = MissionItem(178, 2, (1.0, 5.25, -1.0, 0.0), 9, 9, math.nan)
    assert accepted(upload(talk, [place, speed]))
    home, first, second = download(talk)
    assert (home.y, home.x, home.z) == (round(HOME.lon * 1e7), round(HOME.lat * 1e7), HOME_AMSL_M)
    assert (first.frame, first.param1, first.param2, first.param4, first.z) == (3, 2.0, 0.0, 0.0, pytest.approx(30.12, abs=1e-5))
    assert (second.frame, second.param2, second.x, second.z) == (0, 5.25, 0, 0.0)
    assert [one.command for one in talk.uav.items] == [16, 178], "home is not flown"


@pytest.mark.parametrize(("kind", "items"), [(FENCE, polygon(0, 5)), (RALLY, rally(2))])
def test_fence_and_rally_points_are_kept_beside_the_mission(talk, kind, items):
    assert accepted(upload(talk, mission(4)))
    assert accepted(upload(talk, items, kind))
    assert [(one.command, one.param1, one.y, one.x) for one in download(talk, kind)] == [
        (one.command, one.parameters[0], one.longitude_e7, one.latitude_e7) for one in items
    ]
    assert len(talk.uav.items) == 4
    talk.send(mavlink.MAVLink_mission_clear_all_message(*TO, kind))
    assert download(talk, kind) == [] and len(talk.uav.items) == 4
    talk.send(mavlink.MAVLink_mission_clear_all_message(*TO, 255))
    assert talk.uav.items == ()


@pytest.mark.parametrize(
    ("bad", "result"),
    [
        (MissionItem(16, 3, (0.0, 0.0, 0.0, 0.0), 1_900_000_000, 5, 10.0), mavlink.MAV_MISSION_INVALID_PARAM6_Y),
        (MissionItem(16, 3, (0.0, 0.0, 0.0, 0.0), 5, -900_000_001, 10.0), mavlink.MAV_MISSION_INVALID_PARAM5_X),
        (MissionItem(16, 3, (0.0, 0.0, 0.0, 0.0), 5, 5, math.inf), mavlink.MAV_MISSION_INVALID_PARAM7),
        (MissionItem(16, 3, (math.inf, 0.0, 0.0, 0.0), 5, 5, 10.0), mavlink.MAV_MISSION_INVALID_PARAM1),
        (MissionItem(16, 9, (0.0, 0.0, 0.0, 0.0), 5, 5, 10.0), mavlink.MAV_MISSION_UNSUPPORTED_FRAME),
        (MissionItem(12_345, 3, (0.0, 0.0, 0.0, 0.0), 5, 5, 10.0), mavlink.MAV_MISSION_UNSUPPORTED),
        (MissionItem(177, 2, (99.0, 1.0, 0.0, 0.0)), mavlink.MAV_MISSION_INVALID_PARAM1),  # jumps to an item that there is not
    ],
)
def test_a_bad_item_is_named_and_the_list_before_stays_whole(bad, result):
    talk = Talk()
    upload(talk, mission(5))
    before = talk.uav.items
    answers = talk.send(count(3), item(0, waypoint(1)), item(1, bad), item(2, waypoint(2)))
    assert result in [answer.type for answer in answers if answer.get_type() == "MISSION_ACK"]
    assert talk.uav.items is before
    assert accepted(upload(talk, mission(6))), "nothing is left open"


def test_a_list_that_the_vehicle_refuses_leaves_the_one_before(talk):
    upload(talk, mission(5))
    talk.uav.refuses_lists = True
    answers = upload(talk, mission(3))
    assert only(answers, "MISSION_ACK").type == mavlink.MAV_MISSION_DENIED
    assert "STATUSTEXT" in kinds(answers)
    assert len(talk.endpoint.missions.held[MISSION]) == len(talk.uav.items) == 5


def test_a_fence_whose_polygon_is_cut_is_refused():
    talk = Talk()
    upload(talk, polygon(0, 4), FENCE)
    assert not accepted(upload(talk, polygon(0, 5)[:4], FENCE))
    assert len(download(talk, FENCE)) == 4


def test_out_of_turn_draws_the_request_for_the_right_one_and_again_is_taken_for_heard():
    talk = Talk()
    talk.send(count(4), item(0, waypoint(0)))
    assert only(talk.send(item(2, waypoint(2))), "MISSION_REQUEST_INT").seq == 1
    assert talk.send(item(0, waypoint(0))) == []
    assert only(talk.send(item(1, waypoint(1))), "MISSION_REQUEST_INT").seq == 2


def test_the_last_item_sent_again_is_accepted_again(talk):
    upload(talk, mission(3))
    last = len(talk.uav.items) - 1 + talk.autopilot_type.first_item
    assert accepted(talk.send(item(last, waypoint(2))))
    assert only(talk.send(item(0, waypoint(2))), "MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_SEQUENCE
    assert len(talk.uav.items) == 3


def test_a_silent_station_is_asked_again_and_then_told_that_it_is_over():
    talk = Talk()
    upload(talk, mission(3))
    talk.send(count(5), item(0, waypoint(0)))
    reported = [
        one
        for one in talk.pass_by(REQUEST_INTERVAL_S * (MAX_REQUESTS + 4))
        if one.get_type().startswith("MISSION_") and hasattr(one, "mission_type")
    ]
    assert kinds(reported) == ["MISSION_REQUEST_INT"] * (MAX_REQUESTS - 1) + ["MISSION_ACK"]
    assert {one.seq for one in reported[:-1]} == {1} and reported[-1].type == mavlink.MAV_MISSION_OPERATION_CANCELLED
    assert len(talk.uav.items) == 3
    assert only(talk.send(item(1, waypoint(1))), "MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_tries_go_by_the_wall_and_not_by_simulated_time():
    talk = Talk()
    talk.send(count(5))
    reported = talk.pass_by(20.0, wall_s=2 * REQUEST_INTERVAL_S + 0.01)
    assert kinds(reported).count("MISSION_REQUEST_INT") == 2


def test_an_announcement_again_begins_anew_and_another_station_is_denied(talk):
    upload(talk, mission(3))
    talk.send(count(5), item(0, waypoint(0)))
    assert only(talk.send(count(4)), REQUEST[talk.autopilot_type]).seq == 0
    for message in (count(2), item(0, waypoint(9))):
        assert only(talk.send(message, station=OTHER), "MISSION_ACK").type == mavlink.MAV_MISSION_DENIED
    assert only(talk.send(mavlink.MAVLink_mission_clear_all_message(*TO, 0), station=OTHER), "MISSION_ACK").type != 0
    assert len(talk.uav.items) == 3


def test_two_stations_with_the_same_ids_are_told_apart_by_their_links():
    talk = Talk()
    talk.send(count(2))
    twin = Station(talk.station.system, talk.station.component, 99)
    assert only(talk.send(item(0, waypoint(0)), station=twin), "MISSION_ACK").type == mavlink.MAV_MISSION_DENIED


def test_a_station_cancels(talk):
    upload(talk, mission(3))
    talk.send(count(5), mavlink.MAVLink_mission_ack_message(*TO, mavlink.MAV_MISSION_OPERATION_CANCELLED, MISSION))
    assert not talk.endpoint.missions.is_uploading and len(talk.uav.items) == 3


def test_too_long_a_list_is_refused_at_once_and_none_clears(talk):
    upload(talk, mission(3))
    assert only(talk.send(count(2_001)), "MISSION_ACK").type == mavlink.MAV_MISSION_NO_SPACE
    assert len(talk.uav.items) == 3
    assert accepted(talk.send(count(0)))
    assert talk.uav.items == ()


def test_items_of_32_bit_degrees_are_taken_to_a_metre():
    talk, one = Talk(), waypoint(3)
    talk.send(count(1))
    degrees = (one.latitude_e7 / 1e7, one.longitude_e7 / 1e7)
    old = mavlink.MAVLink_mission_item_message(*TO, 0, 3, 16, 0, 1, *one.parameters, *degrees, one.altitude_m, MISSION)
    assert accepted(talk.send(old))
    (held,) = talk.uav.items
    assert (held.longitude_e7, held.latitude_e7) == (pytest.approx(one.longitude_e7, abs=20), pytest.approx(one.latitude_e7, abs=20))


def test_an_old_request_draws_an_old_item_and_one_beyond_the_end_a_no():
    talk = Talk()
    upload(talk, mission(3))
    assert kinds(talk.send(mavlink.MAVLink_mission_request_message(*TO, 1, MISSION))) == ["MISSION_ITEM"]
    answer = only(talk.send(mavlink.MAVLink_mission_request_int_message(*TO, 3, MISSION)), "MISSION_ACK")
    assert answer.type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_lists_that_there_are_not_and_changes_in_part_are_unsupported(talk):
    for message in (
        count(3, 9),
        mavlink.MAVLink_mission_request_list_message(*TO, 9),
        mavlink.MAVLink_mission_clear_all_message(*TO, 9),
        mavlink.MAVLink_mission_write_partial_list_message(*TO, 0, 1, MISSION),
    ):
        assert only(talk.send(message), "MISSION_ACK").type == mavlink.MAV_MISSION_UNSUPPORTED


def test_ardupilot_is_not_cleared_while_it_flies_its_list():
    talk = Talk(SimulatedAutopilot.ARDUPILOT)
    upload(talk, mission(4))
    talk.uav.arm()
    assert talk.command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 3.0) == mavlink.MAV_RESULT_ACCEPTED
    assert not accepted(talk.send(mavlink.MAVLink_mission_clear_all_message(*TO, MISSION)))
    assert len(talk.uav.items) == 4
