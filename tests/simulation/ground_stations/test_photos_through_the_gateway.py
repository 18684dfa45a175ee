"""Aimed photos of a simulated UAV arrive through the gateway with the pose that they were commanded to have."""

import math
from dataclasses import replace

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from planning.views.camera import Gimbal
from simulation.flight.camera import SIMULATED_CAMERA
from simulation.flight.plant import FlatGround
from simulation.flight.states import FlightMode
from simulation.vehicle_endpoint.fleet import SimulatedFleet
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from telemetry.models import Capture, CaptureReport
from tests.accounts.users import a_user
from tests.simulation.fleets import flying, free_port
from tests.simulation.flight.lists import EARTH, HOME, at, off_m, place, plain, take_off, waypoint
from tests.telemetry.gateway.program import gateway_program
from tests.telemetry.gateway.station import signed_uav, wait_for

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
GROUND_M, SYSTEM, SPEED = 100.0, 7, 10.0
TARGET, TARGET_UP_M = (40.0, 30.0), 8.0
STANDS = [(20.0, 0.0, 12.0), (60.0, 10.0, 16.0), (60.0, 50.0, 20.0), (30.0, 60.0, 6.0)]  # east, north, up [m]


def items() -> list[MissionItem]:
    """A photo from each stand: there the UAV holds until the camera is at rest."""
    delay = plain(mavlink.MAV_CMD_NAV_DELAY, 2.0)
    flown = [take_off(12.0), at(mavlink.MAV_CMD_DO_SET_ROI, *TARGET, TARGET_UP_M)]
    for number, stand in enumerate(STANDS, 1):
        flown += [waypoint(*stand, 4.0), plain(mavlink.MAV_CMD_IMAGE_START_CAPTURE, 0.0, 0.0, 1.0, float(number)), delay]
    return [*flown, plain(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH)]


def begin(fleet: SimulatedFleet) -> None:
    uav = fleet.uavs[0].uav
    for outcome in (uav.load(items()), uav.set_mode(FlightMode.MISSION), uav.arm()):
        assert outcome.is_done, outcome


def off_deg(one: float, other: float) -> float:
    return abs((one - other + 180.0) % 360.0 - 180.0)


@pytest.mark.parametrize("autopilot_type", list(SimulatedAutopilot))
@pytest.mark.parametrize("gimbal", [Gimbal(-90.0, 30.0), Gimbal(-90.0, 30.0, -180.0, 180.0)], ids=["nose", "pan"])
def test_photos_arrive_within_half_a_metre_and_one_degree(autopilot_type, gimbal, tmp_path, settings):
    settings.FLIGHT_LOG_DIR = tmp_path
    uav, key = signed_uav(SYSTEM, a_user())
    port = free_port()
    launch = Launch(
        SYSTEM, HOME, airframe="inspector", autopilot_type=autopilot_type, key=key, ground=FlatGround(GROUND_M),
        talks_to=[("127.0.0.1", port)], camera=replace(SIMULATED_CAMERA, gimbal=gimbal),
    )  # fmt: skip
    with gateway_program(port, tmp_path), flying([launch], speed=SPEED) as fleet:
        wait_for(lambda: fleet.uavs[0].received_count, "the gateway")
        begin(fleet)
        wait_for(lambda: Capture.objects.filter(uav=uav).count() >= len(STANDS), "the photos", patience_s=60.0)
        wait_for(lambda: not fleet.uavs[0].uav.is_armed, "the landing", patience_s=60.0)
    photos = list(Capture.objects.filter(uav=uav).order_by("taken_at"))
    assert [photo.image_index for photo in photos] == [0, 1, 2, 3]
    kinds = 2 if autopilot_type is SimulatedAutopilot.ARDUPILOT else 1
    assert CaptureReport.objects.count() == kinds * len(STANDS)
    goal = place(*TARGET)
    for photo, (east_m, north_m, up_m) in zip(photos, STANDS, strict=True):
        lens = LonLat(photo.position.x, photo.position.y)
        assert off_m(lens, place(east_m, north_m)) < 0.5
        assert photo.altitude_relative_m == pytest.approx(up_m, abs=0.5)
        assert photo.altitude_amsl_m == pytest.approx(GROUND_M + photo.altitude_relative_m, abs=0.01)
        yaw_deg, _, away_m = EARTH.inv(lens.lon, lens.lat, goal.lon, goal.lat)
        assert off_deg(photo.yaw_deg, yaw_deg) < 1.0
        assert photo.pitch_deg == pytest.approx(math.degrees(math.atan2(TARGET_UP_M - photo.altitude_relative_m, away_m)), abs=1.0)
        assert (photo.attitude_source, photo.yaw_frame, photo.position_source, photo.is_taken) == ("camera", "earth", "photo", True)
        assert photo.time_source in ("vehicle-clock", "utc") and photo.camera == 100
        assert abs((photo.taken_at - photo.received_at).total_seconds()) < 2.0


def test_photo_whose_message_is_lost_is_asked_for_again(tmp_path, settings):
    settings.FLIGHT_LOG_DIR = tmp_path
    uav, key = signed_uav(SYSTEM, a_user())
    port = free_port()
    launch = Launch(SYSTEM, HOME, airframe="inspector", key=key, ground=FlatGround(GROUND_M), talks_to=[("127.0.0.1", port)])
    with gateway_program(port, tmp_path), flying([launch], speed=SPEED) as fleet:
        camera = fleet.uavs[0].endpoint.camera
        tell = camera.photo
        camera.photo = lambda event, report: [] if event.number == 2 and tell(event, report) else tell(event, report)  # type: ignore[method-assign]
        wait_for(lambda: fleet.uavs[0].received_count, "the gateway")
        begin(fleet)
        wait_for(lambda: Capture.objects.filter(uav=uav).count() >= len(STANDS), "the photos", patience_s=60.0)
    photos = list(Capture.objects.filter(uav=uav).order_by("taken_at"))
    assert [photo.image_index for photo in photos] == [0, 1, 2, 3], "also in the order in which they were taken"
    again = photos[1]
    assert off_m(LonLat(again.position.x, again.position.y), place(*STANDS[1][:2])) < 0.5
    assert (again.received_at - again.taken_at).total_seconds() > 1.0 and again.time_source != "receipt"
