"""What is known of a photo from each message that tells of it, and what is not taken for known."""

import math
import random
import struct

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.commands.message_requests import MissingPhotos
from mavlink.decoding.boots import VehicleTime
from mavlink.decoding.captures import AttitudeSource, CaptureDecoder, CaptureMessage, CaptureTimeSource, PositionSource, combined
from mavlink.decoding.gimbal_attitude import YawFrame, attitude_of_quaternion
from tests.mavlink.decoding.photos import (
    BOOTED_S,
    CAMERA,
    EARTH,
    GIMBAL,
    LAT_E7,
    LEVEL,
    LON_E7,
    NAN,
    NOW_S,
    VEHICLE,
    attitude,
    captured,
    decoded,
    feedback,
    gimbal,
    position,
    quaternion,
    sent,
    synchronised,
    trigger,
)  # fmt: skip

PX4, ARDUPILOT = AutopilotType.PX4, AutopilotType.ARDUPILOT


def aim(report: CaptureMessage) -> tuple[float | None, float | None]:
    return report.pitch_deg, report.yaw_deg


def test_photo_of_a_camera_component_has_its_pose_and_its_heights():
    report = decoded(captured(4, url=b"mftp://photo 4.jpg"))
    assert (report.longitude_deg, report.latitude_deg, report.position_source) == (10.0, 55.0, PositionSource.PHOTO)
    assert (report.altitude_amsl_m, report.altitude_relative_m, report.altitude_agl_m) == (130.0, 30.0, None)
    assert aim(report) == (pytest.approx(-30.0, abs=1e-4), pytest.approx(200.0, abs=1e-4))
    assert (report.yaw_frame, report.attitude_source) == (YawFrame.EARTH, AttitudeSource.CAMERA)
    assert (report.image_index, report.camera, report.is_taken, report.file_url) == (4, CAMERA, True, "mftp://photo 4.jpg")
    assert (report.taken_s, report.time_source) == (pytest.approx(NOW_S, abs=0.1), CaptureTimeSource.VEHICLE_CLOCK)
    assert report.position_bound_m == pytest.approx(2.9)


def test_photo_of_px4_itself_has_the_vehicles_attitude_and_a_height_above_the_ground():
    report = decoded(attitude(60.0), gimbal(-40.0, 10.0, LEVEL | VEHICLE), captured(component=1, q=quaternion(2.0, 60.0)), autopilot=PX4)
    assert (report.altitude_amsl_m, report.altitude_relative_m, report.altitude_agl_m) == (130.0, None, 30.0)
    assert aim(report) == (pytest.approx(-40.0, abs=1e-4), pytest.approx(70.0, abs=1e-3))
    assert report.attitude_source is AttitudeSource.GIMBAL
    unknown = decoded(captured(component=1, relative_mm=-1_000), autopilot=PX4)
    assert (unknown.altitude_relative_m, unknown.altitude_agl_m, unknown.attitude_source) == (None, None, AttitudeSource.VEHICLE)


def test_height_of_another_autopilot_whose_reference_nobody_states_is_unknown():
    report = decoded(captured(component=1), autopilot=AutopilotType.OTHER)
    assert (report.altitude_relative_m, report.altitude_agl_m, report.altitude_amsl_m) == (None, None, 130.0)


def test_feedback_of_ardupilot_has_the_vehicles_attitude_and_takes_the_gimbals():
    alone = decoded(feedback())
    assert (alone.attitude_source, aim(alone)) == (AttitudeSource.VEHICLE, (2.0, 60.0))
    with_gimbal = decoded(gimbal(-35.0, -20.0, LEVEL | VEHICLE), feedback())
    assert (with_gimbal.attitude_source, with_gimbal.yaw_frame) == (AttitudeSource.GIMBAL, YawFrame.EARTH)
    assert aim(with_gimbal) == (pytest.approx(-35.0, abs=1e-3), pytest.approx(40.0, abs=1e-3))
    assert (with_gimbal.altitude_amsl_m, with_gimbal.altitude_relative_m, with_gimbal.image_index) == (130.0, 30.0, 1)
    of_camera = decoded(feedback(component=CAMERA))
    assert of_camera.attitude_source is AttitudeSource.CAMERA


def test_frame_of_a_gimbals_yaw_is_as_its_sender_means_it():
    def yaw(message, autopilot=ARDUPILOT):
        report = decoded(attitude(60.0), message, trigger(), autopilot=autopilot)
        return report.yaw_deg, report.yaw_frame

    near = pytest.approx
    assert yaw(gimbal(-10.0, 20.0, LEVEL | EARTH, component=GIMBAL)) == (near(20.0, abs=1e-3), YawFrame.EARTH)
    assert yaw(gimbal(-10.0, 20.0, LEVEL | VEHICLE | 16)) == (near(80.0, abs=1e-3), YawFrame.EARTH), "locked, and told from the nose"
    assert yaw(gimbal(-10.0, 20.0, LEVEL | 16, component=GIMBAL)) == (near(20.0, abs=1e-3), YawFrame.EARTH), "the legacy of MAVLink"
    assert yaw(gimbal(-10.0, 20.0, LEVEL)) == (near(80.0, abs=1e-3), YawFrame.EARTH), "ArduPilot before 4.6"
    assert yaw(gimbal(-10.0, 20.0, LEVEL | 16), PX4) == (None, None), "PX4's motors"
    assert yaw(sent(mavlink.MAVLink_mount_orientation_message(0, 0.0, -10.0, 20.0, 300.0))) == (300.0, YawFrame.EARTH)
    assert yaw(sent(mavlink.MAVLink_mount_orientation_message(0, 0.0, -10.0, 20.0))) == (near(80.0, abs=1e-3), YawFrame.EARTH)
    assert yaw(sent(mavlink.MAVLink_mount_status_message(0, 0, -1_000, 0, 2_000))) == (near(80.0, abs=1e-3), YawFrame.EARTH)


def test_yaw_from_the_nose_stays_so_without_a_heading_and_several_gimbals_tell_nothing():
    report = decoded(gimbal(-10.0, 20.0, LEVEL | VEHICLE), trigger())
    assert (report.yaw_deg, report.yaw_frame) == (pytest.approx(20.0, abs=1e-3), YawFrame.VEHICLE)
    two = decoded(attitude(60.0), gimbal(-10.0, 0.0, LEVEL | VEHICLE), gimbal(-80.0, 0.0, LEVEL | VEHICLE, device=2), feedback())
    assert two.attitude_source is AttitudeSource.VEHICLE


def test_photo_without_a_position_is_where_the_vehicle_was_with_a_wider_bound():
    report = decoded(position(vx=1_000), captured(lon_e7=0, lat_e7=0))
    assert (report.longitude_deg, report.position_source) == (10.0, PositionSource.VEHICLE)
    assert report.position_bound_m == pytest.approx(2.9 + 10.0 * (0.2 + 1.0))
    assert (report.altitude_amsl_m, report.altitude_relative_m) == (130.0, 30.0)
    nowhere = decoded(captured(lon_e7=0, lat_e7=0))
    assert (nowhere.longitude_deg, nowhere.position_source, nowhere.position_bound_m, nowhere.altitude_amsl_m) == (None, None, None, None)


def test_times_are_the_vehicles_where_they_can_be_and_say_so_where_not():
    assert decoded(feedback(time_us=(NOW_S - 0.4) * 1e6)).time_source is CaptureTimeSource.VEHICLE_CLOCK
    boot = decoded(feedback(time_us=99.5e6))
    assert (boot.time_source, boot.taken_s) == (CaptureTimeSource.VEHICLE_CLOCK, pytest.approx(NOW_S - 0.5, abs=0.1))
    unsynchronised = decoded(feedback(time_us=(NOW_S - 0.4) * 1e6), clock=VehicleTime())
    assert (unsynchronised.time_source, unsynchronised.taken_s) == (CaptureTimeSource.UTC, pytest.approx(NOW_S - 0.4))
    wrong = decoded(captured(boot_s=4_000.0, utc_s=NOW_S - 3_600.0))
    assert (wrong.time_source, wrong.taken_s, wrong.time_bound_s) == (CaptureTimeSource.RECEIPT, NOW_S, pytest.approx(3_600.0))
    nothing = decoded(captured(boot_s=0.0), clock=VehicleTime())
    assert (nothing.time_source, nothing.taken_s, nothing.time_bound_s) == (CaptureTimeSource.RECEIPT, NOW_S, 5.0)
    future = decoded(captured(boot_s=4_000.0, utc_s=NOW_S + 3_600.0))
    assert (future.time_source, future.taken_s) == (CaptureTimeSource.RECEIPT, NOW_S)


def test_time_of_a_feedback_pin_is_read_beyond_its_32_bits():
    clock = VehicleTime()
    for step in range(5_000, 5_100):
        clock.receive(step * 1_000, NOW_S - 5_100 + step)
    report = decoded(feedback(time_us=(5_099.0 * 1e6) % 2**32), clock=clock)
    assert (report.time_source, report.taken_s) == (CaptureTimeSource.VEHICLE_CLOCK, pytest.approx(NOW_S - 1.0, abs=0.1))


def test_a_cameras_photo_that_was_asked_for_again_has_its_time_once_the_camera_was_on_time():
    for utc_s, source in ((0.0, CaptureTimeSource.VEHICLE_CLOCK), (NOW_S, CaptureTimeSource.UTC)):
        decoder, clock, boot_s = CaptureDecoder(), synchronised(), 100.0 if not utc_s else 9_000.0
        again = captured(3, boot_s=boot_s, utc_s=utc_s)
        unknown = decoder.receive(again, clock, PX4, NOW_S + 20.0)
        assert unknown is not None and (unknown.time_source, unknown.taken_s) == (CaptureTimeSource.RECEIPT, NOW_S + 20.0)
        on_time = captured(4, boot_s=boot_s + 20.0, utc_s=utc_s and utc_s + 20.0)
        assert decoder.receive(on_time, clock, PX4, NOW_S + 20.2).time_source is source
        late = decoder.receive(again, clock, PX4, NOW_S + 30.0)
        assert (late.time_source, late.taken_s) == (source, pytest.approx(NOW_S, abs=0.3))


def test_gaps_of_indices_are_asked_for_and_a_camera_that_counts_anew_is_not():
    missing = MissingPhotos()

    def asked(now_s):
        return [(message.target_component, message.param1, message.param2) for message in missing.requests(7, now_s)]

    for index in (5, 6, 9):
        missing.receive(captured(index), 0.0)
    assert asked(1.0) == [], "they may be out of order"
    assert asked(2.0) == [(CAMERA, 263.0, 7.0), (CAMERA, 263.0, 8.0)]
    missing.receive(captured(7), 3.0)
    assert asked(3.0) == [] and asked(6.0) == [(CAMERA, 263.0, 8.0)]
    missing.receive(captured(10), 7.0)
    assert [bool(asked(float(second))) for second in range(20, 200)].count(True) == 2, "then it is given up"
    missing.receive(captured(0), 300.0)
    missing.receive(captured(2), 301.0)
    assert asked(310.0) == [(CAMERA, 263.0, 1.0)]
    missing.receive(captured(900), 311.0)
    assert asked(320.0) == []
    for index in (1, 5):
        missing.receive(captured(index, component=1), 330.0)
    assert asked(340.0) == [], "an autopilot keeps none"


def test_photos_that_were_held_back_with_all_else_keep_their_time():
    clock = synchronised(epoch=False)
    report = decoded(feedback(time_us=70e6), clock=clock, now_s=NOW_S + 60.0)
    assert (report.time_source, report.taken_s) == (CaptureTimeSource.VEHICLE_CLOCK, pytest.approx(BOOTED_S + 70.0, abs=0.2))


def test_impossible_values_are_unknown():
    report = decoded(captured(-1, q=[NAN, 0.0, 0.0, 0.0], alt_mm=2**31 - 1, relative_mm=-(2**31), lat_e7=910_000_000, result=0))
    assert (report.image_index, report.attitude_source, report.altitude_amsl_m, report.altitude_relative_m) == (None, None, None, None)
    assert (report.longitude_deg, report.is_taken) == (None, False)
    assert decoded(captured(q=[1.0, 0.0, 0.0, 0.0])).attitude_source is None, "what senders without an attitude send"
    assert decoded(captured(q=[0.3, 0.3, 0.3, 0.3])).attitude_source is None
    odd = decoded(feedback(alt_m=NAN, relative_m=math.inf, angles=(NAN, 0.0, 0.0)))
    assert (odd.altitude_amsl_m, odd.altitude_relative_m, odd.attitude_source) == (None, None, None)
    assert decoded(captured(url=b"a\x00b\x07")).file_url == "a"
    assert CaptureDecoder().receive(feedback(flags=mavlink.CAMERA_FEEDBACK_VIDEO), synchronised(), ARDUPILOT, NOW_S) is None


@pytest.mark.parametrize("pitch_deg", [-90.0, -89.95, -45.0, 0.5, 90.0])
@pytest.mark.parametrize("yaw_deg", [0.0, 123.0, 359.0])
def test_quaternion_is_read_back_as_its_angles(pitch_deg: float, yaw_deg: float):
    found = attitude_of_quaternion(quaternion(pitch_deg, yaw_deg), YawFrame.EARTH)
    assert found is not None and found.pitch_deg == pytest.approx(pitch_deg, abs=0.1)
    assert abs((found.yaw_deg - yaw_deg + 180.0) % 360.0 - 180.0) < 0.2


def test_key_is_that_of_the_photo_and_not_of_the_message():
    first = decoded(captured(3)).key
    assert decoded(captured(3, boot_s=400.0)).key == first, "told again later, with another time of sending"
    assert len({first, decoded(captured(4)).key, decoded(captured(3, lon_e7=LON_E7 + 1)).key, decoded(captured(3, component=101)).key}) == 4
    assert decoded(captured(3, lat_e7=0, lon_e7=0)).key != decoded(captured(3, lat_e7=0, lon_e7=0, boot_s=99.0)).key
    assert decoded(feedback(3)).key != decoded(feedback(3, time_us=NOW_S * 1e6 - 1)).key


def test_reports_of_one_photo_are_combined_the_same_in_any_order():
    reports = [
        decoded(attitude(60.0), position(), feedback(8, lon_e7=LON_E7 + 1_000)),
        decoded(captured(7, boot_s=4_000.0)),
        decoded(attitude(60.0), position(vx=500), trigger(7)),
    ]
    whole = combined(reports)
    assert all(combined(random.Random(seed).sample(reports, 3)) == whole for seed in range(6))
    assert (whole.image_index, whole.attitude_source, whole.time_source) == (7, AttitudeSource.CAMERA, CaptureTimeSource.VEHICLE_CLOCK)
    assert (whole.longitude_deg, whole.position_source) == (10.0, PositionSource.PHOTO)
    assert whole.position_bound_m == pytest.approx(1e-4 * 111_195 * math.cos(math.radians(LAT_E7 / 1e7)), rel=0.01), (
        "they differ by so much"
    )
    assert combined([reports[0]]) == reports[0]
    assert CaptureMessage.from_json(whole.to_json()) == whole
    failed = decoded(captured(7, result=0))
    assert not combined([reports[0], failed]).is_taken


@pytest.mark.parametrize("seed", range(20))
def test_nothing_that_comes_makes_it_fail_or_gives_impossible_values(seed: int):
    chance = random.Random(seed)

    def number() -> float:
        drawn = struct.unpack("<f", chance.randbytes(4))[0]
        return chance.choice((0.0, NAN, math.inf, -math.inf, 1e30, drawn, chance.uniform(-400.0, 400.0)))

    def whole(bits: int, *, is_signed: bool = True) -> int:
        least = -(2 ** (bits - 1)) if is_signed else 0
        return chance.choice((0, least, 2 ** (bits - is_signed) - 1, chance.randrange(least, 2 ** (bits - is_signed))))

    decoder, clock = CaptureDecoder(), chance.choice((VehicleTime(), synchronised()))
    for _ in range(300):
        message = chance.choice(
            (
                lambda: mavlink.MAVLink_camera_image_captured_message(
                    whole(32, is_signed=False), whole(64, is_signed=False), whole(8, is_signed=False), whole(32), whole(32), whole(32),
                    whole(32), [number() for _ in range(4)], whole(32), whole(8), chance.randbytes(20),
                ),
                lambda: mavlink.MAVLink_camera_feedback_message(
                    whole(64, is_signed=False), 0, whole(8, is_signed=False), whole(16, is_signed=False), whole(32), whole(32),
                    *(number() for _ in range(6)), whole(8, is_signed=False), 0,
                ),
                lambda: mavlink.MAVLink_camera_trigger_message(whole(64, is_signed=False), whole(32, is_signed=False)),
                lambda: mavlink.MAVLink_gimbal_device_attitude_status_message(
                    0, 0, 0, whole(16, is_signed=False), [number() for _ in range(4)], NAN, NAN, NAN, 0, number(), NAN, 1
                ),
                lambda: mavlink.MAVLink_mount_orientation_message(0, number(), number(), number(), number()),
                lambda: mavlink.MAVLink_attitude_message(0, number(), number(), number(), 0, 0, 0),
                lambda: mavlink.MAVLink_gps_raw_int_message(0, 3, 0, 0, 0, 1, 1, 1, 1, 9, 0, whole(32, is_signed=False)),
            )
        )()  # fmt: skip
        report = decoder.receive(sent(message, chance.choice((1, CAMERA))), clock, chance.choice((PX4, ARDUPILOT, None)), NOW_S)
        if report is None:
            continue
        values = [value for value in report.to_json().values() if isinstance(value, float)]
        assert all(map(math.isfinite, values))
        assert report.longitude_deg is None or (abs(report.longitude_deg) <= 180.0 and abs(report.latitude_deg or 0.0) <= 90.0)
        assert report.yaw_deg is None or (0.0 <= report.yaw_deg < 360.0 and report.yaw_frame is not None)
        assert NOW_S - 86_400.0 <= report.taken_s <= NOW_S
        assert CaptureMessage.from_json(report.to_json()) == report
