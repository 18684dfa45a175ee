"""MAVSDK, unchanged and as it is published, flies simulated UAVs of both autopilot types."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.action import Action, ActionError
from mavsdk.plugins.camera import Camera, CaptureInfo, Information
from mavsdk.plugins.info import Info
from mavsdk.plugins.mission import Mission, MissionItem, MissionPlan
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavsdk.plugins.mission_raw import MissionRaw, MissionRawError
from mavsdk.plugins.param import Param, ParamError
from mavsdk.plugins.telemetry import Telemetry

from simulation.flight.plant import FlatGround
from simulation.vehicle_endpoint.fleet import SimulatedFleet
from simulation.vehicle_endpoint.launch import Launch
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import CAMERA
from tests.simulation.fleets import AT, TIMEOUT_S, flying, free_port, wait_for

SPEED = 20.0
GROUND_M = 40.0
NORTH_DEG = 1 / 111_195.0
# Simulated seconds armed on the ground: the machine may be busy.
WAITS = {SimulatedAutopilot.PX4: "COM_DISARM_PRFLT", SimulatedAutopilot.ARDUPILOT: "DISARM_DELAY"}
MISSION, HOLD, RETURN, LAND = "MISSION", "HOLD", "RETURN_TO_LAUNCH", "LAND"


@dataclass
class Station:
    """MAVSDK with the plugins that the tests use."""

    fleet: SimulatedFleet
    autopilot_type: SimulatedAutopilot
    action: Action
    telemetry: Telemetry
    mission: Mission
    raw: MissionRaw
    param: Param
    info: Info
    camera: Camera

    def mode(self) -> str:
        return self.telemetry.flight_mode().name

    def height_m(self) -> float:
        return float(self.telemetry.position().relative_altitude_m)


@pytest.fixture(scope="module", params=list(SimulatedAutopilot))
def station(request) -> Iterator[Station]:
    """One for all tests of an autopilot type, in their order: each leaves the UAV on the ground, disarmed."""
    port = free_port()
    launch = Launch(7, AT, autopilot_type=request.param, ground=FlatGround(GROUND_M), talks_to=[("127.0.0.1", port)])
    with flying([launch], speed=SPEED) as fleet:
        mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
        try:
            mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
            system = mavsdk.first_autopilot(TIMEOUT_S)
            assert system is not None
            plugins = (plugin(system) for plugin in (Action, Telemetry, Mission, MissionRaw, Param, Info, Camera))
            found = Station(fleet, request.param, *plugins)
            found.param.set_param_float(WAITS[request.param], 120.0)
            yield found
        finally:
            mavsdk.destroy()


def landed(station: Station) -> None:
    wait_for(lambda: not station.telemetry.in_air() and not station.telemetry.armed(), "landing")


def raw_items(autopilot_type: SimulatedAutopilot) -> list[RawItem]:
    """Home first for ArduPilot; figures that both autopilot types keep."""
    place = (round(AT.lat * 1e7) + 3_000, round(AT.lon * 1e7))
    home = [(16, 0, 0.0, *place, GROUND_M)] if autopilot_type is SimulatedAutopilot.ARDUPILOT else []
    flown = [(22, 3, 0.0, *place, 15.25), (16, 3, 2.0, place[0] + 123, place[1] - 4_567, 20.5), (21, 3, 0.0, *place, 0.0)]
    return [
        RawItem(seq, frame, command, int(seq == 0), 1, one, 0.0, 0.0, 0.0, lat, lon, height_m, 0)
        for seq, (command, frame, one, lat, lon, height_m) in enumerate(home + flown)
    ]


def figures(items: list[RawItem]) -> list[tuple[float, ...]]:
    return [
        (item.seq, item.frame, item.command, item.param1, item.param2, item.param3, item.param4, item.x, item.y, item.z) for item in items
    ]


def test_it_is_found_healthy_and_where_it_stands(station):
    wait_for(station.telemetry.health_all_ok, "health")
    assert station.telemetry.health().is_armable
    position = wait_for(lambda: (reported := station.telemetry.position()) and math.isfinite(reported.latitude_deg) and reported)
    assert (position.latitude_deg, position.longitude_deg) == pytest.approx((AT.lat, AT.lon), abs=1e-6)
    assert position.absolute_altitude_m == pytest.approx(GROUND_M, abs=0.3)
    assert station.telemetry.home().absolute_altitude_m == pytest.approx(GROUND_M, abs=0.01)
    battery = wait_for(lambda: (reported := station.telemetry.battery()) and reported.voltage_v > 0 and reported)
    assert 10 < battery.voltage_v < 13 and battery.remaining_percent == pytest.approx(100, abs=1)
    wait_for(lambda: station.telemetry.gps_info().num_satellites >= 6, "satellites")
    assert not station.telemetry.armed() and not station.telemetry.in_air()
    assert (
        station.info.get_version().flight_sw_major == {SimulatedAutopilot.PX4: 1, SimulatedAutopilot.ARDUPILOT: 4}[station.autopilot_type]
    )


def test_a_list_is_read_back_as_it_was_sent(station):
    sent = raw_items(station.autopilot_type)
    station.raw.upload_mission(sent)
    read = station.raw.download_mission()
    first = station.autopilot_type.first_item
    assert figures(read)[first:] == figures(sent)[first:]
    if first:
        assert (read[0].x, read[0].y, read[0].z) == (round(AT.lat * 1e7), round(AT.lon * 1e7), GROUND_M), "home is the vehicle's own"


def test_a_list_with_a_bad_item_leaves_the_one_before(station):
    before = raw_items(station.autopilot_type)
    station.raw.upload_mission(before)
    bad = raw_items(station.autopilot_type)
    bad[-2].x = 910_000_000
    with pytest.raises(MissionRawError):
        station.raw.upload_mission(bad)
    first = station.autopilot_type.first_item
    assert figures(station.raw.download_mission())[first:] == figures(before)[first:]
    station.raw.clear_mission()
    assert len(station.raw.download_mission()) == first


def test_fence_and_rally_points_are_read_back_as_they_were_sent(station):
    lat, lon = round(AT.lat * 1e7), round(AT.lon * 1e7)
    corners = [(lat + 9_000, lon + 9_000), (lat + 9_000, lon + 19_000), (lat + 19_000, lon + 9_000)]
    fence = [RawItem(seq, 0, 5002, 0, 1, 3.0, 0.0, 0.0, 0.0, *corner, 0.0, 1) for seq, corner in enumerate(corners)]
    rally = [RawItem(0, 3, 5100, 1, 1, 0.0, 0.0, 0.0, 0.0, lat, lon + 5_000, 40.0, 2)]
    station.raw.upload_geofence(fence)
    station.raw.upload_rally_points(rally)
    assert figures(station.raw.download_geofence()) == figures(fence)
    assert figures(station.raw.download_rallypoints()) == figures(rally)


def test_parameters_are_read_and_set_and_a_missing_one_is_no_wait(station):
    name = {SimulatedAutopilot.PX4: "RTL_RETURN_ALT", SimulatedAutopilot.ARDUPILOT: "RTL_ALT"}[station.autopilot_type]
    per_metre = {SimulatedAutopilot.PX4: 1, SimulatedAutopilot.ARDUPILOT: 100}[station.autopilot_type]
    assert station.param.get_param_float(name) == 30.0 * per_metre
    station.param.set_param_float(name, 25.0 * per_metre)
    assert station.param.get_param_float(name) == 25.0 * per_metre
    with pytest.raises(ParamError):
        station.param.get_param_float("NO_SUCH")


def test_the_camera_is_found_and_its_photos_are_told(station):
    """MAVSDK finds the component by its heartbeat, and asks it for what it is. On ArduPilot the autopilot speaks for the camera too."""

    def component() -> list[Information]:
        return [one for one in station.camera.camera_list().cameras if one.component_id == CAMERA]

    (camera,) = wait_for(component, "the camera")
    assert (camera.vendor_name, camera.model_name) == ("Simulated", "Simulated camera")
    assert (camera.focal_length_mm, camera.horizontal_sensor_size_mm) == (pytest.approx(8.8), pytest.approx(13.2))
    told: list[CaptureInfo] = []
    handle = station.camera.subscribe_capture_info(lambda info, *_: told.append(info))
    try:
        station.camera.take_photo(camera.component_id)
        wait_for(lambda: told, "the photo")
        station.camera.start_photo_interval(camera.component_id, 1.0)
        wait_for(lambda: len(told) >= 3, "photos a second apart")
        station.camera.stop_photo_interval(camera.component_id)
    finally:
        station.camera.unsubscribe_capture_info(handle)
    assert [photo.index for photo in told[:3]] == [0, 1, 2] and all(photo.is_success for photo in told)
    position = told[0].position
    assert (position.latitude_deg, position.longitude_deg) == pytest.approx((AT.lat, AT.lon), abs=1e-6)
    assert position.absolute_altitude_m == pytest.approx(GROUND_M, abs=0.3)
    assert told[0].attitude_euler_angle.pitch_deg == pytest.approx(0.0, abs=0.5)


def test_armed_taken_off_flown_somewhere_and_landed(station):
    station.action.set_takeoff_altitude(12.0)
    station.action.arm()
    wait_for(station.telemetry.armed, "arming")
    station.action.takeoff()
    wait_for(lambda: station.telemetry.in_air() and station.height_m() > 11.5, "the height of take-off")
    with pytest.raises(ActionError):
        station.action.disarm()
    station.action.goto_location(AT.lat + 40 * NORTH_DEG, AT.lon, GROUND_M + 18.0, math.nan)
    wait_for(
        lambda: station.telemetry.position().latitude_deg > AT.lat + 39 * NORTH_DEG and abs(station.height_m() - 18.0) < 0.7, "the place"
    )
    station.action.land()
    wait_for(lambda: station.mode() == LAND, "mode of landing")
    landed(station)


def test_a_mission_is_flown_paused_resumed_and_ends_at_home(station):
    """The return home is told once it hovers at the last place, as an operator does. ArduPilot's list begins with home and a take-off."""
    lat, lon = round(AT.lat * 1e7), round(AT.lon * 1e7)
    before = (
        [(16, 0, 0.0, lat, lon, GROUND_M), (22, 3, 0.0, lat, lon, 20.0)] if station.autopilot_type is SimulatedAutopilot.ARDUPILOT else []
    )
    flown = [(16, 3, 0.0, lat + north_m * 90, lon, height_m) for north_m, height_m in ((60, 20.0), (120, 25.0), (180, 25.0))]
    items = [
        RawItem(seq, frame, command, int(seq == 0), 1, one, 0.0, 0.0, math.nan, *place, height_m, 0)
        for seq, (command, frame, one, *place, height_m) in enumerate(before + flown)
    ]
    station.raw.upload_mission(items)
    station.action.arm()
    station.raw.start_mission()
    wait_for(lambda: station.raw.mission_progress().current >= 1 + len(before), "the first place")
    assert station.telemetry.in_air() and station.mode() == MISSION
    station.raw.pause_mission()
    wait_for(lambda: station.mode() == HOLD, "the pause")
    wait_for(lambda: abs(station.telemetry.velocity_ned().north_m_s) < 0.2, "standing still")
    paused_deg = station.telemetry.position().latitude_deg
    station.raw.start_mission()
    wait_for(lambda: station.telemetry.position().latitude_deg > AT.lat + 178 * 90e-7, "the last place")
    assert station.telemetry.position().latitude_deg > paused_deg
    wait_for(lambda: (reported := station.raw.mission_progress()) and reported.current == reported.total, "the end of the mission")
    station.action.return_to_launch()
    wait_for(lambda: station.mode() == RETURN, "the return")
    landed(station)
    assert station.telemetry.position().latitude_deg == pytest.approx(AT.lat, abs=1.5 * NORTH_DEG)


@pytest.mark.long
@pytest.mark.parametrize("station", [SimulatedAutopilot.PX4], indirect=True)
def test_the_mission_plugin_flies_its_own_items(station):
    """Not on ArduPilot: there the plugin has its first place lost as home, and reads back a frame that it does not know."""
    plan = [MissionItem(AT.lat + north_m * NORTH_DEG, AT.lon, 20.0, 8.0, True, acceptance_radius_m=2.0) for north_m in (30.0, 60.0)]
    station.mission.set_return_to_launch_after_mission(True)
    station.mission.upload_mission(MissionPlan(plan))
    read = station.mission.download_mission().mission_items
    assert [(item.latitude_deg, item.relative_altitude_m) for item in read] == [
        (pytest.approx(item.latitude_deg, abs=1e-7), pytest.approx(item.relative_altitude_m)) for item in plan
    ]
    station.action.arm()
    station.mission.start_mission()
    wait_for(station.mission.is_mission_finished, "the end of the mission")
    landed(station)
    assert station.mission.mission_progress().current == len(plan)
