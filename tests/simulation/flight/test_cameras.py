"""The gimbal and the camera of a simulated UAV: where they look, how fast they turn, and which photos they take."""

import math
from dataclasses import replace

import pytest
from pymavlink.dialects.v20 import common as mavlink

from mavlink.vehicle_plan import MissionItem
from planning.views.camera import Gimbal
from simulation.flight.airframe import AIRFRAMES, Settings
from simulation.flight.camera import SIMULATED_CAMERA, CameraShutter, Shot, lens_offset_m
from simulation.flight.events import Event, PhotoTaken
from simulation.flight.flown import fly_mission
from simulation.flight.gimbal import RATE_DPS, StabilisedGimbal
from simulation.flight.orders import CENTRE, CannotFly, LookAt, PointCamera, TakePhotos, orders
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import EARTH, HOME, NAN, airborne, at, begin, off_m, place, plain, step, take_off, waypoint, wind

PANS = Gimbal(-90.0, 30.0, -180.0, 180.0)
TARGET_EAST_M, TARGET_NORTH_M, TARGET_UP_M = 40.0, 25.0, 4.0
ROI = at(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, TARGET_EAST_M, TARGET_NORTH_M, TARGET_UP_M)
LOOK_AHEAD = plain(mavlink.MAV_CMD_DO_SET_ROI_NONE)


def photo(number: float = 0.0, count: float = 1.0, interval_s: float = 0.0) -> MissionItem:
    return plain(mavlink.MAV_CMD_IMAGE_START_CAPTURE, 0.0, interval_s, count, number)


def pitch_and_yaw(pitch_deg: float, yaw_deg: float, flags: int = 0) -> MissionItem:
    item = plain(mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, pitch_deg, yaw_deg, NAN, NAN)
    return replace(item, latitude_e7=flags)


def uav_of(gimbal: Gimbal = PANS, **more: object) -> SimulatedUav:
    return SimulatedUav(AIRFRAMES["iris"], HOME, camera=replace(SIMULATED_CAMERA, gimbal=gimbal), **more)  # type: ignore[arg-type]


def photos_of(events: list[Event]) -> list[PhotoTaken]:
    return [event for event in events if isinstance(event, PhotoTaken)]


def off_deg(one: float, other: float) -> float:
    return abs((one - other + 180.0) % 360.0 - 180.0)


def aim(taken: PhotoTaken) -> tuple[float, float]:
    """Pitch and yaw from the lens to the target, by geodesics."""
    pose, target = taken.pose, place(TARGET_EAST_M, TARGET_NORTH_M)
    yaw_deg, _, away_m = EARTH.inv(pose.position.lon, pose.position.lat, target.lon, target.lat)
    return math.degrees(math.atan2(TARGET_UP_M - pose.altitude_relative_m, away_m)), yaw_deg


def turned(gimbal: StabilisedGimbal, seconds: float, heading_deg: float = 0.0) -> tuple[float, float]:
    for _ in range(round(seconds / 0.04)):
        gimbal.step(0.04, (0.0, 0.0, 20.0), heading_deg)
    return gimbal.attitude.pitch_deg, gimbal.attitude.yaw_deg


def test_gimbal_turns_at_its_rate_and_stops_at_its_limits():
    gimbal = StabilisedGimbal(Gimbal(-90.0, 20.0, -60.0, 60.0))
    gimbal.turn(-120.0, 100.0, is_from_north=False)
    pitch_deg, yaw_deg = turned(gimbal, 0.4)
    assert (pitch_deg, yaw_deg) == pytest.approx((-0.4 * RATE_DPS, 0.4 * RATE_DPS))
    assert turned(gimbal, 3.0) == pytest.approx((-90.0, 60.0))
    gimbal.turn(80.0, None, is_from_north=False)
    assert turned(gimbal, 3.0) == pytest.approx((20.0, 60.0))


def test_open_angles_are_kept():
    gimbal = StabilisedGimbal(PANS)
    gimbal.turn(-40.0, 30.0, is_from_north=False)
    gimbal.turn(None, 70.0, is_from_north=False)
    assert turned(gimbal, 3.0) == pytest.approx((-40.0, 70.0))
    gimbal.look_at((0.0, 20.0, 20.0))
    assert turned(gimbal, 3.0) == pytest.approx((0.0, 0.0))
    gimbal.turn(-10.0, None, is_from_north=False)
    assert turned(gimbal, 3.0) == pytest.approx((-10.0, 0.0))


def test_yaw_from_north_is_kept_while_the_uav_turns_and_yaw_from_the_nose_turns_with_it():
    gimbal = StabilisedGimbal(PANS)
    gimbal.turn(0.0, 90.0, is_from_north=True)
    assert turned(gimbal, 3.0, heading_deg=30.0)[1] == pytest.approx(60.0)
    assert turned(gimbal, 3.0, heading_deg=200.0)[1] == pytest.approx(-110.0)
    gimbal.turn(0.0, 90.0, is_from_north=False)
    assert turned(gimbal, 4.0, heading_deg=77.0)[1] == pytest.approx(90.0)


def test_gimbal_takes_the_shorter_way_round_where_its_range_allows():
    gimbal = StabilisedGimbal(Gimbal(-90.0, 30.0, -320.0, 320.0))
    gimbal.turn(0.0, 170.0, is_from_north=False)
    turned(gimbal, 4.0)
    gimbal.turn(0.0, -170.0, is_from_north=False)
    assert turned(gimbal, 1.0)[1] == pytest.approx(190.0)


def test_target_straight_below_leaves_the_yaw():
    gimbal = StabilisedGimbal(PANS)
    gimbal.turn(0.0, 50.0, is_from_north=False)
    turned(gimbal, 2.0)
    gimbal.look_at((0.1, 0.1, 0.0))
    pitch_deg, yaw_deg = turned(gimbal, 3.0)
    assert pitch_deg < -89.0 and yaw_deg == pytest.approx(50.0)


@pytest.mark.parametrize("gimbal", [Gimbal(), PANS], ids=["nose", "pan"])
@pytest.mark.parametrize("weather", [None, wind(5.0, gusts_mps=0.8)], ids=["calm", "wind"])
def test_photo_of_a_region_of_interest_is_aimed_at_it(gimbal: Gimbal, weather: object):
    items = [
        take_off(),
        waypoint(5.0, 0.0),
        ROI,
        waypoint(30.0, 5.0, 14.0, 4.0),
        photo(1),
        plain(mavlink.MAV_CMD_NAV_DELAY, 1.0),
        LOOK_AHEAD,
    ]
    uav = uav_of(gimbal, weather=weather)
    assert uav.load([*items, waypoint(60.0, 0.0)]).is_done
    flown = fly_mission(uav)
    (taken,) = flown.photos
    pitch_deg, yaw_deg = aim(taken)
    assert off_m(taken.pose.position, place(30.0, 5.0)) < 0.5
    assert taken.pose.altitude_relative_m == pytest.approx(14.0, abs=0.5)
    assert taken.pose.altitude_amsl_m - taken.pose.altitude_relative_m == pytest.approx(flown.end.home_amsl_m)
    assert taken.pose.pitch_deg == pytest.approx(pitch_deg, abs=1.0)
    assert off_deg(taken.pose.yaw_deg, yaw_deg) < (1.0 if gimbal.yaw_min_deg is not None else 4.0)  # the nose follows gusts
    assert (taken.item, taken.sequence, taken.number) == (4, 1, 1)
    assert flown.end.gimbal.pitch_deg == pytest.approx(0.0), "ahead again"


@pytest.mark.parametrize("turns_to_target", [False, True], ids=["ArduPilot", "PX4"])
def test_a_gimbal_with_yaw_turns_the_uav_on_px4_alone(turns_to_target: bool):
    uav = uav_of(settings=Settings(turns_to_target=turns_to_target))
    assert uav.load([take_off(), ROI, waypoint(60.0, 0.0, 10.0, 3.0)]).is_done
    begin(uav)
    step(uav, 25.0)
    assert (off_deg(uav.state.heading_deg, 90.0) < 3.0) is not turns_to_target
    assert off_deg(uav.state.heading_deg + uav.state.gimbal.yaw_deg, math.degrees(math.atan2(-20.0, 25.0))) < 2.0


def test_angles_of_items_are_those_of_photos_and_north_is_north():
    earth, vehicle = mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME, mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME
    hold, delay = [4.0], plain(mavlink.MAV_CMD_NAV_DELAY, 2.0)
    items = [
        take_off(), pitch_and_yaw(-30.0, 200.0, earth | mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK), waypoint(20.0, 0.0, 10.0, *hold), photo(1),
        delay, pitch_and_yaw(NAN, 20.0, vehicle), waypoint(20.0, 20.0, 10.0, *hold), photo(2),
        delay, plain(mavlink.MAV_CMD_DO_MOUNT_CONTROL, -75.0, 0.0, -10.0), waypoint(20.0, 40.0, 10.0, *hold),
        photo(3), delay, plain(mavlink.MAV_CMD_CONDITION_YAW, 120.0, 0.0, 1.0, 0.0),
        plain(mavlink.MAV_CMD_NAV_DELAY, 5.0), photo(4), plain(mavlink.MAV_CMD_NAV_DELAY, 1.0),
    ]  # fmt: skip
    uav = uav_of()
    assert uav.load(items).is_done
    photos = fly_mission(uav).photos
    assert [round(one.pose.pitch_deg) for one in photos] == [-30, -30, -75, -75]
    expected = [200.0, 20.0, 350.0, 110.0]  # it flies to the north from the second waypoint on
    assert all(off_deg(one.pose.yaw_deg, yaw_deg) < 3.0 for one, yaw_deg in zip(photos, expected, strict=True))
    assert off_deg(photos[0].pose.yaw_deg, 200.0) < 0.2


def test_mount_control_turns_a_uav_whose_gimbal_has_no_yaw():
    uav = airborne(uav_of(Gimbal()))
    assert uav.operate(plain(mavlink.MAV_CMD_DO_MOUNT_CONTROL, -45.0, 0.0, 250.0)).is_done
    step(uav, 6.0)
    assert off_deg(uav.state.heading_deg, 250.0) < 3.0
    assert uav.state.gimbal.pitch_deg == -45.0


def test_commands_aim_and_trigger_in_the_air_and_on_the_ground():
    uav = uav_of()
    assert uav.operate(photo()).is_done
    (on_ground,) = photos_of(step(uav, 1.0))
    assert (on_ground.item, on_ground.sequence) == (None, None)
    airborne(uav)
    assert uav.operate(ROI).is_done
    step(uav, 3.0)
    assert uav.operate(photo(7)).is_done and uav.operate(photo(7)).is_done
    (taken,) = photos_of(step(uav, 3.0))
    pitch_deg, yaw_deg = aim(taken)
    assert (taken.pose.pitch_deg, taken.sequence) == (pytest.approx(pitch_deg, abs=1.0), 7) and off_deg(taken.pose.yaw_deg, yaw_deg) < 1.0
    assert not uav.operate(waypoint(0.0, 0.0)).is_done, "it is flown in missions alone"
    assert uav.state.photos == 2


def test_aim_survives_a_pause():
    uav = uav_of()
    assert uav.load([take_off(), ROI, pitch_and_yaw(-20.0, NAN), waypoint(30.0, 0.0, 10.0, 60.0)]).is_done
    begin(uav)
    step(uav, 20.0)
    uav.hold()
    step(uav, 2.0)
    uav.set_mode(uav.state.mode.MISSION)
    step(uav, 3.0)
    assert uav.state.gimbal.pitch_deg == -20.0


def test_repeated_sequence_numbers_take_one_photo_and_photos_are_numbered():
    shutter = CameraShutter(0.5)
    for number in (1, 1, 2, None, None, 2):
        shutter.start(TakePhotos(1, sequence=number), 0.0, 0.0, item=3)
    taken = [shot for step_s in range(300) if (shot := shutter.due(step_s * 0.04, 0.0))]
    assert taken == [Shot(3, 1), Shot(3, 2), Shot(3, None), Shot(3, None)]
    assert shutter.number == 4
    shutter.reset()
    shutter.start(TakePhotos(1, sequence=2), 20.0, 0.0)
    assert shutter.due(20.0, 0.0) == Shot(None, 2), "another flight begins its numbers anew"


def test_photos_within_the_shortest_interval_are_taken_later_and_stopped_ones_never():
    shutter = CameraShutter(2.0)
    for _ in range(3):
        shutter.start(TakePhotos(1), 0.0, 0.0)
    at_s = [step_s * 0.04 for step_s in range(300) if shutter.due(step_s * 0.04, 0.0)]
    assert at_s == pytest.approx([0.0, 2.0, 4.0], abs=0.05)
    shutter.start(TakePhotos(0, interval_s=3.0), 100.0, 0.0)
    assert sum(shutter.due(100.0 + 0.04 * number, 0.0) is not None for number in range(250)) == 4
    shutter.stop()
    assert not any(shutter.due(200.0 + 0.04 * number, 0.0) for number in range(250))


def test_lens_lies_beside_the_antenna_and_turns_with_the_uav():
    assert lens_offset_m((1.0, 0.0, -0.2), 0.0, 0.0, math.radians(90.0)) == pytest.approx((1.0, 0.0, -0.2))
    assert lens_offset_m((0.0, 1.0, 0.0), 0.0, 0.0, math.radians(180.0)) == pytest.approx((-1.0, 0.0, 0.0))
    assert lens_offset_m((1.0, 0.0, 0.0), 0.0, math.radians(90.0), 0.0) == pytest.approx((0.0, 0.0, 1.0))
    assert lens_offset_m((0.0, 1.0, 0.0), math.radians(90.0), 0.0, 0.0) == pytest.approx((0.0, 0.0, -1.0))
    uav = SimulatedUav(AIRFRAMES["iris"], HOME, camera=replace(SIMULATED_CAMERA, offset_m=(0.0, 0.0, -0.5)))
    uav.operate(photo())
    (taken,) = photos_of(step(uav, 0.2))
    assert taken.altitude_amsl_m - taken.pose.altitude_amsl_m == pytest.approx(0.5, abs=0.01)


def test_items_that_cannot_be_are_refused_and_open_ones_are_read():
    earth = mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME
    lock, vehicle = mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK, mavlink.GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME
    read = orders(
        [
            pitch_and_yaw(-10.0, 20.0), pitch_and_yaw(-10.0, 20.0, lock), pitch_and_yaw(-10.0, 20.0, lock | vehicle),
            pitch_and_yaw(NAN, NAN, earth), pitch_and_yaw(0.0, 0.0, mavlink.GIMBAL_MANAGER_FLAGS_NEUTRAL),
        ],
        is_home_first=False,
    )  # fmt: skip
    assert read[:4] == (
        PointCamera(-10.0, 20.0), PointCamera(-10.0, 20.0, is_from_north=True), PointCamera(-10.0, 20.0),
        PointCamera(None, None, is_from_north=True),
    )  # fmt: skip
    assert read[4] == CENTRE
    gps_point = replace(ROI, command=mavlink.MAV_CMD_DO_MOUNT_CONTROL, parameters=(0.0, 0.0, 0.0, 6.0), altitude_m=4.0)
    (target,) = orders([gps_point], is_home_first=False)
    assert isinstance(target, LookAt) and target.place is not None and target.place.height_m == 6.0
    for bad in (pitch_and_yaw(math.inf, 0.0), pitch_and_yaw(0.0, 1e9), photo(1e12)):
        with pytest.raises(CannotFly):
            orders([bad], is_home_first=False)
