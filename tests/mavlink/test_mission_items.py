"""Approved routes as mission items."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import BASE, HOVER, LAND, RETURN, NotARoute, photo_clearances_m, route_from_json, route_to_json
from mavlink.autopilot_type import AutopilotType
from mavlink.mission_items import CannotBeFlown, aim_point, flight_loads
from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.supported_items import as_known
from mavlink.mission_sync.wire import OnboardItem
from mavlink.vehicle_plan import FlightLoad, MissionItem, load_from_json, load_to_json
from planning.task import Task, TaskKind, View
from planning.trajectory.waypoints import WaypointKind
from tests.mavlink.routes import START, route, start_and_end, waypoint

TAKEOFF, WAYPOINT, SPEED = mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_DO_CHANGE_SPEED
LANDING, DELAY = mavlink.MAV_CMD_NAV_LAND, mavlink.MAV_CMD_NAV_DELAY
PHOTO, LOOK_AT, LOOK_AHEAD = mavlink.MAV_CMD_IMAGE_START_CAPTURE, mavlink.MAV_CMD_DO_SET_ROI_LOCATION, mavlink.MAV_CMD_DO_SET_ROI_NONE


def commands(items: tuple[MissionItem, ...]) -> list[int]:
    return [item.command for item in items]


def with_task(task: Task, **more: object) -> tuple[MissionItem, ...]:
    (load,) = flight_loads(start_and_end(waypoint(1, WaypointKind.TARGET, task=task, target=0, **more)))
    return load.mission


def test_flight_takes_off_sets_its_speed_flies_each_waypoint_and_returns():
    (load,) = flight_loads(start_and_end(waypoint(1, WaypointKind.PASS, relative_m=61.234)))
    assert commands(load.mission) == [TAKEOFF, SPEED, WAYPOINT, WAYPOINT, WAYPOINT, LANDING]
    assert load.mission[1].parameters[:3] == (1.0, 12.0, -1.0)
    passed = load.mission[3]
    assert (passed.longitude_e7, passed.latitude_e7, passed.altitude_m) == (98010000, 554000000, 61.23)
    assert passed.frame == mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    assert [item.waypoint for item in load.mission] == [0, 0, 0, 1, 2, 2]


def test_items_without_a_place_have_the_frame_mission():
    (load,) = flight_loads(start_and_end(waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.PHOTO, 10.0), target=0)))
    placeless = {SPEED, PHOTO, DELAY}
    assert {item.command for item in load.mission if item.frame == mavlink.MAV_FRAME_MISSION} == placeless


def test_speed_changes_only_where_a_leg_is_flown_otherwise():
    (load,) = flight_loads(start_and_end(waypoint(1, WaypointKind.PASS, speed_mps=5.0), waypoint(2, WaypointKind.PASS, speed_mps=5.0)))
    assert commands(load.mission) == [TAKEOFF, SPEED, WAYPOINT, SPEED, WAYPOINT, WAYPOINT, SPEED, WAYPOINT, LANDING]
    assert [item.parameters[1] for item in load.mission if item.command == SPEED] == [12.0, 5.0, 12.0]


def test_hover_lasts_whole_seconds_rounded_up():
    mission = with_task(Task(TaskKind.HOLD, 12.2))
    assert mission[3].command == WAYPOINT and mission[3].parameters[0] == 13.0


def test_photos_are_taken_while_the_uav_stands_still():
    mission = with_task(Task(TaskKind.PHOTO, 9.5))
    assert commands(mission[3:6]) == [WAYPOINT, PHOTO, DELAY]
    assert mission[3].parameters[0] == 2.0
    assert mission[4].parameters == (0.0, 2.0, 4.0, 0.0)
    assert mission[5].parameters == (8.0, -1.0, -1.0, -1.0)


def test_short_photo_is_one_picture_without_a_delay():
    mission = with_task(Task(TaskKind.PHOTO, 1.0))
    assert commands(mission[3:5]) == [WAYPOINT, PHOTO]
    assert mission[4].parameters[1:3] == (0.0, 1)


def test_camera_looks_at_the_ground_under_a_target_on_the_way_there_and_ahead_afterwards():
    mission = with_task(Task(TaskKind.LOOK, 5.0), relative_m=70.0, agl_m=65.0)
    assert commands(mission[3:6]) == [LOOK_AT, WAYPOINT, LOOK_AHEAD]
    assert (mission[3].altitude_m, mission[4].parameters[0]) == (5.0, 5.0)


def test_camera_is_not_turned_back_along_a_stretch():
    stretch = [
        waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.LOOK, 0.0), target=0),
        waypoint(2, WaypointKind.PASS, target=0),
    ]
    (load,) = flight_loads(start_and_end(*stretch))
    assert LOOK_AT not in commands(load.mission)


@pytest.mark.parametrize("end_action", [RETURN, LAND, BASE])
def test_flight_lands_on_the_ground_under_its_last_waypoint(end_action: str):
    (load,) = flight_loads(start_and_end(end_action=end_action))
    last = load.mission[-1]
    assert (last.command, last.altitude_m, last.longitude_e7) == (LANDING, 0.0, 98000000)


def test_hovering_flight_ends_with_its_last_waypoint():
    (load,) = flight_loads(start_and_end(end_action=HOVER))
    assert load.mission[-1].command == WAYPOINT


@pytest.mark.parametrize("end_action", [RETURN, LAND, BASE, HOVER])
def test_flight_before_another_lands_at_the_base_however_the_route_ends(end_action: str):
    kinds = [WaypointKind.START, WaypointKind.END, WaypointKind.BASE, WaypointKind.START, WaypointKind.END]
    points = [waypoint(number, kind, lon=START.lon) for number, kind in enumerate(kinds)]
    points[2] = waypoint(2, WaypointKind.BASE, lon=START.lon, relative_m=4.0, agl_m=0.0)
    first, _ = flight_loads(replace(route(points), end_action=end_action))
    assert (first.mission[-1].command, first.mission[-1].longitude_e7, first.mission[-1].altitude_m) == (LANDING, 98000000, 0.0)


def test_route_over_a_base_is_two_flights_each_from_its_own_take_off():
    kinds = [WaypointKind.START, WaypointKind.END, WaypointKind.BASE, WaypointKind.START, WaypointKind.END]
    points = [waypoint(number, kind, lon=START.lon) for number, kind in enumerate(kinds)]
    points[2] = waypoint(2, WaypointKind.BASE, lon=START.lon, relative_m=4.0, agl_m=0.0)
    whole = route(points)
    first, second = flight_loads(whole)
    assert commands(first.mission) == commands(second.mission) == [TAKEOFF, SPEED, WAYPOINT, WAYPOINT, LANDING]
    assert (first.mission[0].altitude_m, second.mission[0].altitude_m) == (60.0, 56.0)
    assert [flight.take_off.altitude_amsl_m for flight in whole.flights] == [20.0, 24.0]
    assert [item.waypoint for item in second.mission] == [3, 3, 3, 4, 4]


def test_route_without_waypoints_has_no_flight():
    assert flight_loads(route([])) == ()


def test_charging_route_is_refused():
    with pytest.raises(CannotBeFlown, match="charges"):
        flight_loads(route([waypoint(0, WaypointKind.START)], charging_stops=(0,)))


def test_route_that_does_not_rise_is_refused():
    with pytest.raises(CannotBeFlown):
        flight_loads(route([waypoint(0, WaypointKind.START, relative_m=0.0)]))


def test_base_without_a_flight_before_it_is_no_route():
    with pytest.raises(NotARoute):
        flight_loads(route([waypoint(0, WaypointKind.BASE), waypoint(1, WaypointKind.START)]))


def test_route_is_the_same_after_json():
    stored = start_and_end(waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.PHOTO, 10.0), target=3, speed_mps=4.5))
    again = route_from_json(json.loads(json.dumps(route_to_json(stored))))
    assert again == stored
    assert flight_loads(again)[0].content_sha256 == flight_loads(stored)[0].content_sha256


def test_load_is_the_same_after_json_with_nan_left_to_the_autopilot():
    (load,) = flight_loads(start_and_end())
    again = load_from_json(json.loads(json.dumps(load_to_json(load))))
    assert again.content_sha256 == load.content_sha256
    assert math.isnan(again.mission[0].parameters[3])
    assert FlightLoad(load.mission[:-1]).content_sha256 != load.content_sha256


# Photos with a view.


def view(yaw_deg: float = 90.0, pitch_deg: float = -30.0, distance_m: float = 20.0) -> View:
    return View(yaw_deg, pitch_deg, distance_m, 21.0, 8.9)


def photographed(*views: View) -> tuple[MissionItem, ...]:
    photos = [
        waypoint(2 + number, WaypointKind.PASS, task=Task(TaskKind.PHOTO, 3.0, view=own), target=0, speed_mps=4.0, relative_m=40.0)
        for number, own in enumerate(views)
    ]
    over = waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.HOLD, 1.0), target=0)
    back = waypoint(2 + len(views), WaypointKind.PASS, target=0, speed_mps=4.0)
    (load,) = flight_loads(start_and_end(over, *photos, back))
    return load.mission


def test_an_aimed_photo_looks_before_it_flies_and_stands_still_for_the_photo() -> None:
    mission = photographed(view(), view(180.0))
    assert commands(mission[5:13]) == [LOOK_AT, WAYPOINT, PHOTO, DELAY, LOOK_AT, WAYPOINT, PHOTO, DELAY]
    assert mission[13].command == LOOK_AHEAD, "after the last photo of the target"
    assert [item.command for item in mission].count(LOOK_AHEAD) == 1
    photos = [item for item in mission if item.command == PHOTO]
    assert [item.parameters for item in photos] == [(0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 1.0, 2.0)], "numbered: a repeated item takes no second"
    assert [item.parameters[0] for item in mission if item.command == DELAY] == [1.0, 1.0]


def test_the_aim_is_the_place_that_the_photo_shows() -> None:
    (aim,) = [item for item in photographed(view(90.0, -30.0, 20.0)) if item.command == LOOK_AT]
    east_m, north_m = LocalFrame.around(START.lon + 0.002, START.lat).to_metres(
        np.array([[aim.longitude_e7 / 1e7, aim.latitude_e7 / 1e7]])
    )[0]
    assert (east_m, north_m) == pytest.approx((20.0 * math.cos(math.radians(30.0)), 0.0), abs=0.02)
    assert aim.altitude_m == pytest.approx(40.0 - 10.0, abs=0.01)
    (down,) = [item for item in photographed(view(0.0, -80.0, 100.0)) if item.command == LOOK_AT]
    assert down.altitude_m == pytest.approx(40.0 - 98.48, abs=0.01), "below the take-off, where the ground falls away"


@given(st.floats(0.0, 360.0), st.floats(-80.0, 60.0), st.floats(1.0, 80.0))
def test_seen_from_the_waypoint_the_aim_has_the_views_angles(yaw_deg: float, pitch_deg: float, distance_m: float) -> None:
    here = waypoint(1, WaypointKind.PASS, relative_m=40.0)
    place, height_m = aim_point(here, view(yaw_deg, pitch_deg, distance_m))
    east_m, north_m = LocalFrame.around(*here.position).to_metres(np.array([place]))[0]
    up_m = height_m - 40.0
    assert math.hypot(east_m, north_m, up_m) == pytest.approx(distance_m, rel=1e-6)
    assert math.degrees(math.atan2(up_m, math.hypot(east_m, north_m))) == pytest.approx(pitch_deg, abs=1e-6)
    turned_deg = math.degrees(math.atan2(east_m, north_m)) - yaw_deg
    assert (turned_deg + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1e-5)


def test_a_route_with_views_comes_back_from_json_and_one_without_names_none() -> None:
    plain = start_and_end(waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.PHOTO, 3.0), target=0))
    assert set(route_to_json(plain)["waypoints"][1]["task"]) == {"kind", "hold_s"}, "documents and their hashes stay as they were"
    aimed = start_and_end(waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.PHOTO, 3.0, view=view()), target=0))
    assert route_from_json(json.loads(json.dumps(route_to_json(aimed)))) == aimed


def test_the_legs_of_photos_are_those_between_two_waypoints_of_their_target() -> None:
    aimed = waypoint(2, WaypointKind.PASS, task=Task(TaskKind.PHOTO, 3.0, view=view()), target=0)
    other = waypoint(4, WaypointKind.TARGET, task=Task(TaskKind.PHOTO, 3.0), target=1)
    points = [waypoint(1, WaypointKind.TARGET, target=0), aimed, waypoint(3, WaypointKind.PASS, target=0), other]
    assert photo_clearances_m(points) == {2: 8.9, 3: 8.9}


def test_a_gimbal_that_does_not_pan_around_has_the_nose_turned_once_it_stands() -> None:
    turned = replace(view(200.0), heading_deg=200.0)
    waypoints = (waypoint(1, WaypointKind.TARGET, task=Task(TaskKind.PHOTO, 6.0, view=turned), target=0),)
    (load,) = flight_loads(start_and_end(*waypoints))
    mission = load.mission
    assert commands(mission[3:9]) == [LOOK_AT, WAYPOINT, mavlink.MAV_CMD_CONDITION_YAW, DELAY, PHOTO, DELAY]
    assert mission[5].parameters == (200.0, 0.0, 0.0, 0.0), "the shorter way, from north"
    assert [item.parameters[0] for item in (mission[4], mission[6], mission[8])] == [1.0, 4.0, 1.0], "six seconds in all"
    assert commands(as_known(mission, AutopilotType.ARDUPILOT, (4, 7, 0))) == commands(mission)
    on_px4 = as_known(mission, AutopilotType.PX4, None)
    assert mavlink.MAV_CMD_CONDITION_YAW not in commands(on_px4)
    assert len(on_px4) == len(mission)
    assert on_px4[5].parameters[0] == 0.0
    held = tuple(OnboardItem(item, goes_on=True) for item in on_px4)
    assert not differences(mission, held, AutopilotType.PX4), "the readback is that of the approved list"


def test_beside_wires_a_waypoint_counts_as_reached_near_it_alone() -> None:
    """PX4's own radius may be 10 m; ArduPilot keeps none, and is sent none."""
    mission = photographed(view(), view(180.0))
    waypoints = [item for item in mission if item.command == WAYPOINT]
    assert [item.parameters[1] for item in waypoints] == [0.0, 0.0, 0.5, 0.5, 0.5, 0.0]
    assert as_known(mission, AutopilotType.PX4, None) == mission
    on_ardupilot = as_known(mission, AutopilotType.ARDUPILOT, (4, 7, 0))
    assert {item.parameters[1] for item in on_ardupilot if item.command == WAYPOINT} == {0.0}
    kept = (replace(item, parameters=tuple(0.0 if math.isnan(one) else one for one in item.parameters)) for item in on_ardupilot)
    assert not differences(mission, tuple(OnboardItem(item, goes_on=True) for item in kept), AutopilotType.ARDUPILOT)


def test_a_photo_always_stops_the_uav() -> None:
    short = Task(TaskKind.PHOTO, 0.0, view=view())
    mission = with_task(short)
    assert [item.parameters[0] for item in mission if item.command == WAYPOINT][1] >= 1.0


def test_a_view_without_a_target_makes_no_leg_one_beside_wires() -> None:
    free = waypoint(1, WaypointKind.PASS, task=Task(TaskKind.PHOTO, 3.0, view=view()))
    assert photo_clearances_m([waypoint(0, WaypointKind.START), free, waypoint(2, WaypointKind.END)]) == {}
