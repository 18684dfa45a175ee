"""What a simulated UAV's camera and gimbal say, with which component and frame, and the commands that they carry out."""

import math
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_plan import MissionItem, MissionType
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.uav import SimulatedUav
from simulation.vehicle_protocol.mission_server import as_kept
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import CAMERA, GIMBAL
from tests.simulation.kinematic_uav import HOME, KinematicUav
from tests.simulation.vehicle_protocol.talk import SYSTEM, Talk, only

NAN = math.nan
START, REQUEST = mavlink.MAV_CMD_IMAGE_START_CAPTURE, mavlink.MAV_CMD_REQUEST_MESSAGE
PITCH_YAW, ROI = mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, mavlink.MAV_CMD_DO_SET_ROI_LOCATION
CAPTURED, INFORMATION = mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED, mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION
ARDUPILOT = SimulatedAutopilot.ARDUPILOT


@pytest.fixture(params=SimulatedAutopilot)
def talk(request) -> Talk:
    return Talk(request.param, SimulatedUav(AIRFRAMES["iris"], HOME, heading_deg=60.0))


def to_camera(number: int, *values: float) -> Any:
    return mavlink.MAVLink_command_long_message(SYSTEM, CAMERA, number, 0, *values, *[NAN] * (7 - len(values)))


def angles_deg(q: list[float]) -> tuple[float, float, float]:
    w, x, y, z = q
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return math.degrees(roll), math.degrees(math.asin(2 * (w * y - z * x))), math.degrees(yaw) % 360.0


def said(talk: Talk, seconds: float) -> list[Any]:
    """By the autopilot, the camera and the gimbal."""
    talk.beside.clear()
    reported = talk.pass_by(seconds)
    return [*reported, *talk.beside]


def test_photo_is_told_by_the_camera_and_on_ardupilot_by_the_autopilot_too(talk):
    assert talk.command(PITCH_YAW, -30.0, 0.0) == mavlink.MAV_RESULT_ACCEPTED
    talk.pass_by(2.0)
    ack = only(talk.send(to_camera(START, 0.0, 0.0, 1.0, 1.0)), "COMMAND_ACK")
    assert (ack.result, ack.get_srcComponent()) == (mavlink.MAV_RESULT_ACCEPTED, CAMERA)
    reported = said(talk, 1.0)
    captured = only(reported, "CAMERA_IMAGE_CAPTURED")
    assert (captured.get_srcComponent(), captured.image_index, captured.capture_result) == (CAMERA, 0, 1)
    assert (captured.lon, captured.lat) == pytest.approx((HOME.lon * 1e7, HOME.lat * 1e7), abs=2)
    assert angles_deg(captured.q) == pytest.approx((0.0, -30.0, 60.0), abs=0.5)
    feedback = [one for one in reported if one.get_type() == "CAMERA_FEEDBACK"]
    assert len(feedback) == (talk.autopilot_type is ARDUPILOT)
    for one in feedback:
        assert (one.get_srcComponent(), one.img_idx) == (1, 1)
        assert (one.pitch, one.yaw) == (pytest.approx(0.0, abs=1.0), pytest.approx(60.0, abs=1.0)), "those of the vehicle"
        assert (one.lng, one.lat) == (captured.lon, captured.lat)


def test_photo_can_be_asked_for_again_and_a_repeated_request_takes_no_second(talk):
    for _ in range(2):
        talk.send(to_camera(START, 0.0, 0.0, 1.0, 5.0))
    (captured,) = [one for one in said(talk, 3.0) if one.get_type() == "CAMERA_IMAGE_CAPTURED"]
    again = only(talk.send(to_camera(REQUEST, CAPTURED, 0.0)), "CAMERA_IMAGE_CAPTURED")
    assert again.to_dict() == captured.to_dict()
    assert only(talk.send(to_camera(REQUEST, CAPTURED, 7.0)), "COMMAND_ACK").result == mavlink.MAV_RESULT_UNSUPPORTED


def test_camera_says_what_it_is(talk):
    information = only(talk.send(to_camera(REQUEST, INFORMATION)), "CAMERA_INFORMATION")
    assert information.get_srcComponent() == CAMERA
    assert (information.focal_length, information.sensor_size_h) == (pytest.approx(8.8), pytest.approx(13.2))
    assert (information.resolution_h, information.resolution_v) == (5472, 3648)
    assert information.flags == mavlink.CAMERA_CAP_FLAGS_CAPTURE_IMAGE
    assert only(talk.send(to_camera(mavlink.MAV_CMD_REQUEST_CAMERA_CAPTURE_STATUS, 1.0)), "CAMERA_CAPTURE_STATUS").image_count == 0
    result = talk.command(REQUEST, INFORMATION)
    assert result == (mavlink.MAV_RESULT_ACCEPTED if talk.autopilot_type is ARDUPILOT else mavlink.MAV_RESULT_UNSUPPORTED)


def test_gimbal_names_the_frame_of_its_yaw(talk):
    flags = mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK | mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME
    assert talk.command(PITCH_YAW, -20.0, 10.0, NAN, NAN, flags) == mavlink.MAV_RESULT_ACCEPTED
    told = [one for one in said(talk, 3.0) if one.get_type() == "GIMBAL_DEVICE_ATTITUDE_STATUS"][-1]
    is_px4 = talk.autopilot_type is SimulatedAutopilot.PX4
    assert told.get_srcComponent() == (GIMBAL if is_px4 else 1)
    earth, vehicle = mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_EARTH_FRAME, mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME
    assert bool(told.flags & earth) == is_px4 and bool(told.flags & vehicle) != is_px4
    assert told.flags & mavlink.GIMBAL_DEVICE_FLAGS_YAW_LOCK
    # The usual gimbal has no yaw: the camera looks where the nose points.
    assert angles_deg(told.q) == pytest.approx((0.0, -20.0, 60.0 if is_px4 else 0.0), abs=0.5)


def test_region_of_interest_has_its_height_above_the_sea_on_px4_and_above_home_on_ardupilot():
    for autopilot_type, frame in ((SimulatedAutopilot.PX4, 0), (ARDUPILOT, 3)):
        talk = Talk(autopilot_type, KinematicUav())
        assert talk.command(ROI, 0.0, 0.0, 0.0, 0.0, HOME.lat, HOME.lon, 12.0) == mavlink.MAV_RESULT_ACCEPTED
        (item,) = talk.uav.operated
        assert (item.frame, item.altitude_m) == (frame, 12.0)
        assert (item.longitude_e7, item.latitude_e7) == pytest.approx((HOME.lon * 1e7, HOME.lat * 1e7), abs=60)  # of 32 bits
        below = mavlink.MAVLink_command_int_message(SYSTEM, 1, 6, ROI, 0, 0, 0, 0, 0, 0, 550_000_000, 100_000_000, 4.0)
        talk.send(below)
        assert (talk.uav.operated[-1].frame, talk.uav.operated[-1].latitude_e7) == (3, 550_000_000)


def test_ardupilot_keeps_whole_degrees_of_a_gimbal_and_its_flags():
    item = MissionItem(PITCH_YAW, 2, (-30.7, 200.9, NAN, NAN), 0, 80, 1.0)
    kept = as_kept(item, MissionType.MISSION, ARDUPILOT)
    assert kept == MissionItem(PITCH_YAW, 0, (-30.0, 200.0, 0.0, 0.0), 0, 80, 1.0)
    assert as_kept(item, MissionType.MISSION, SimulatedAutopilot.PX4) is item
