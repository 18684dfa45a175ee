"""Missions as `flight_loads` writes them and as ground stations do, flown item by item."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from pymavlink.dialects.v20 import common as mavlink

from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, LAND, FrozenRoute, FrozenWaypoint, TakeOff
from mavlink.mission_items import flight_loads
from mavlink.vehicle_plan import MissionItem
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.events import Disarmed, ItemReached, LandedAt, MissionEnded, ModeChanged, PhotoTaken, TookOff
from simulation.flight.faults import Faults
from simulation.flight.flown import Ending, fly_mission
from simulation.flight.manoeuvres import around
from simulation.flight.orders import CannotFly, orders
from simulation.flight.states import FlightMode, Landed, MissionItemState
from simulation.flight.uav import SimulatedUav
from tests.simulation.flight.lists import HOME, at, begin, land, off_m, place, plain, reached, speed, step, take_off, waypoint

IRIS = AIRFRAMES["iris"]
FRAME = LocalFrame.around(*HOME)


def uav_with(items: list[MissionItem], **more: object) -> SimulatedUav:
    uav = SimulatedUav(IRIS, HOME, **more)
    assert uav.load(items).is_done
    return uav


def approved(end_action: str) -> FrozenRoute:
    """A photo at one place, a look at another, in between a waypoint flown slower."""

    def point(number: int, east_m: float, task: Task | None = None, speed_mps: float | None = None) -> FrozenWaypoint:
        kind = WaypointKind.TARGET if task else WaypointKind.PASS
        return FrozenWaypoint(
            number, place(east_m, 20.0), kind, 10.0, 10.0, task=task, target=number if task else None, speed_mps=speed_mps
        )

    waypoints = (
        point(0, 0.0),
        point(1, 15.0, Task(TaskKind.PHOTO, 6.0)),
        point(2, 30.0, None, 2.0),
        point(3, 45.0, Task(TaskKind.LOOK, 4.0)),
    )
    return FrozenRoute("", TakeOff(HOME, 0.0), 5.0, end_action, waypoints)


@pytest.mark.parametrize("is_home_first", [False, True], ids=["px4", "ardupilot"])
def test_approved_flight_is_flown_item_by_item_with_its_tasks(is_home_first: bool) -> None:
    mission = list(flight_loads(approved(LAND))[0].mission)
    if is_home_first:
        mission.insert(0, at(mavlink.MAV_CMD_NAV_WAYPOINT, 5_000.0, 5_000.0, 700.0))  # home, as a ground station has it
    uav = SimulatedUav(IRIS, HOME)
    assert uav.load(mission, is_home_first=is_home_first).is_done
    flown = fly_mission(uav)
    assert flown.ending is Ending.LANDED
    assert reached(list(flown.events)) == list(range(is_home_first, len(mission)))
    photos = [event for event in flown.events if isinstance(event, PhotoTaken)]
    assert len(photos) == 2  # 6 s less 2 s of settling, one each 2 s
    assert all(off_m(photo.position, place(15.0, 20.0)) < 0.5 for photo in photos)
    assert off_m(flown.touched_down_at or HOME, place(45.0, 20.0)) < 0.3
    kinds = [type(event) for event in flown.events if isinstance(event, TookOff | LandedAt | MissionEnded | Disarmed)]
    assert kinds == [TookOff, LandedAt, MissionEnded, Disarmed]


def test_flight_that_ends_hovering_hovers() -> None:
    flown = fly_mission(uav_with(list(flight_loads(approved(HOVER))[0].mission)))
    assert flown.ending is Ending.HOVERING
    assert flown.end.mission_state is MissionItemState.COMPLETE
    assert flown.end.is_in_air
    assert flown.end.mode is FlightMode.HOLD
    assert off_m(flown.end.position, place(45.0, 20.0)) < 0.3


@pytest.mark.parametrize(
    ("command", "none"),
    [
        (mavlink.MAV_CMD_DO_SET_ROI_LOCATION, plain(mavlink.MAV_CMD_DO_SET_ROI_NONE)),
        (mavlink.MAV_CMD_DO_SET_ROI, MissionItem(mavlink.MAV_CMD_DO_SET_ROI, 6, (0.0, 0.0, 0.0, 0.0))),
    ],
)
def test_look_turns_the_uav_to_its_target_before_it_holds(command: int, none: MissionItem) -> None:
    """The target is 40 m north of the waypoint; the course leads east."""
    look = at(command, 30.0, 40.0, 0.0)
    uav = uav_with([take_off(), waypoint(5.0, 0.0), look, waypoint(30.0, 0.0, 10.0, 4.0), none, waypoint(50.0, 0.0)])
    begin(uav)
    facing, courses = [], []
    while uav.state.current_item <= 3:
        uav.step()
        state = uav.state
        if state.current_item == 3 and state.ground_speed_mps < 0.1:
            facing.append(state.heading_deg)
        assert uav.now_s < 60.0
    while uav.state.mission_state is not MissionItemState.COMPLETE:
        uav.step()
        courses.append(uav.state.heading_deg)
        assert uav.now_s < 90.0
    assert len(facing) > 50
    assert max(min(value, 360.0 - value) for value in facing) < 3.0
    assert courses[-1] == pytest.approx(90.0, abs=3.0)


def test_speed_item_holds_from_its_place_on() -> None:
    uav = uav_with([take_off(), speed(6.0), waypoint(60.0, 0.0), speed(2.0), waypoint(100.0, 0.0)])
    begin(uav)
    fastest: dict[int, float] = {}
    while uav.state.mission_state is not MissionItemState.COMPLETE:
        uav.step()
        state = uav.state
        fastest[state.current_item] = max(fastest.get(state.current_item, 0.0), state.ground_speed_mps)
        assert uav.now_s < 90.0
    assert uav.state.target_speed_mps == 2.0
    assert fastest[2] == pytest.approx(6.0, abs=0.3)
    assert fastest[4] < 2.5


def test_hold_and_delay_take_as_long_as_they_say() -> None:
    delay = plain(mavlink.MAV_CMD_NAV_DELAY, 4.0, -1.0, -1.0, -1.0)
    uav = uav_with([take_off(), waypoint(3.0, 0.0, 10.0, 2.0), delay, waypoint(6.0, 0.0, 10.0, 0.0)])
    at_s = {event.index: event.at_s for event in fly_mission(uav).events if isinstance(event, ItemReached)}
    assert at_s[2] - at_s[1] == pytest.approx(4.0, abs=0.09)
    assert at_s[1] - at_s[0] > 2.0


def test_jump_is_made_as_often_as_it_says() -> None:
    jump = plain(mavlink.MAV_CMD_DO_JUMP, 1.0, 2.0)
    uav = uav_with([take_off(), waypoint(4.0, 0.0), waypoint(0.0, 0.0), jump, land()])
    flown = fly_mission(uav)
    assert flown.ending is Ending.LANDED
    assert reached(list(flown.events)) == [0, 1, 2, 3, 1, 2, 3, 1, 2, 3, 4]


def test_circle_of_jumps_that_flies_nowhere_harms_nobody() -> None:
    uav = uav_with([take_off(), plain(mavlink.MAV_CMD_DO_JUMP, 2.0, -1.0), plain(mavlink.MAV_CMD_DO_JUMP, 1.0, -1.0)])
    begin(uav)
    step(uav, 10.0)
    assert uav.hold().is_done
    assert uav.state.mode is FlightMode.HOLD


def test_mission_that_begins_with_a_waypoint_takes_off_by_itself() -> None:
    flown = fly_mission(uav_with([waypoint(10.0, 0.0, 8.0), plain(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH)]))
    assert flown.ending is Ending.LANDED
    assert off_m(flown.touched_down_at or place(99.0, 0.0), HOME) < 0.3
    assert reached(list(flown.events)) == [0, 1]


def test_pause_and_resume_miss_nothing() -> None:
    uav = uav_with([take_off(), waypoint(0.0, 0.0), waypoint(40.0, 0.0), waypoint(40.0, 40.0)])
    begin(uav)
    events = step(uav, 12.0)
    assert uav.hold().is_done
    events += step(uav, 8.0)
    state = uav.state
    assert (state.mode, state.mission_state, state.current_item) == (FlightMode.HOLD, MissionItemState.PAUSED, 2)
    assert state.ground_speed_mps < 0.1
    assert uav.set_mode(FlightMode.MISSION).is_done
    events += step(uav, 30.0)
    assert uav.state.mission_state is MissionItemState.COMPLETE
    assert reached(events) == [0, 1, 2, 3]
    assert not uav.set_mode(FlightMode.MISSION).is_done  # complete, and in the air


def test_look_is_kept_over_a_pause() -> None:
    look = at(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, 15.0, 500.0, 0.0)
    uav = uav_with([take_off(), look, waypoint(30.0, 0.0, 10.0, 60.0)])
    begin(uav)
    step(uav, 25.0)
    uav.hold()
    step(uav, 2.0)
    uav.set_mode(FlightMode.MISSION)
    step(uav, 3.0)
    assert off_m(uav.state.position, place(30.0, 0.0)) < 0.5
    assert uav.state.heading_deg > 350.0 or uav.state.heading_deg < 5.0


def test_current_item_can_be_set_in_flight() -> None:
    uav = uav_with([take_off(), waypoint(40.0, 0.0), waypoint(0.0, 30.0), waypoint(0.0, 40.0)])
    begin(uav)
    step(uav, 8.0)
    assert uav.set_current(3).is_done
    assert not uav.set_current(4).is_done
    assert reached(step(uav, 20.0)) == [3]
    assert off_m(uav.state.position, place(0.0, 40.0)) < 0.5


def test_new_mission_in_flight_is_flown_from_there() -> None:
    uav = uav_with([take_off(), waypoint(200.0, 0.0)])
    begin(uav)
    step(uav, 15.0)
    assert uav.load([speed(4.0), waypoint(20.0, 20.0)]).is_done
    assert reached(step(uav, 25.0)) == [0, 1]
    assert off_m(uav.state.position, place(20.0, 20.0)) < 0.5
    assert uav.clear().is_done
    assert uav.state.mission_state is MissionItemState.NONE


def test_mission_cleared_in_flight_leaves_the_uav_hovering() -> None:
    uav = uav_with([take_off(), waypoint(200.0, 0.0)])
    begin(uav)
    step(uav, 15.0)
    assert uav.clear().is_done
    step(uav, 5.0)
    assert (uav.state.mode, uav.state.is_in_air) == (FlightMode.HOLD, True)
    assert uav.state.ground_speed_mps < 0.1


def test_stuck_item_is_never_done_until_it_is_let_go() -> None:
    uav = uav_with([take_off(), waypoint(10.0, 0.0), waypoint(20.0, 0.0), land()], faults=Faults(stuck_item=1))
    begin(uav)
    assert reached(step(uav, 40.0)) == [0]
    assert off_m(uav.state.position, place(10.0, 0.0)) < 0.5
    uav.faults = replace(uav.faults, stuck_item=None)
    assert reached(step(uav, 40.0)) == [1, 2, 3]
    assert uav.state.landed is Landed.ON_GROUND


def test_item_that_gets_stuck_in_flight_holds_the_uav_there() -> None:
    uav = uav_with([take_off(), waypoint(10.0, 0.0), waypoint(30.0, 0.0), waypoint(60.0, 0.0)])
    begin(uav)
    step(uav, 8.0)
    uav.faults = Faults(stuck_item=2)
    assert reached(step(uav, 40.0)) == [1]
    assert off_m(uav.state.position, place(30.0, 0.0)) < 0.5


def test_photos_by_way_are_so_far_apart() -> None:
    items = [take_off(), waypoint(0.0, 0.0), plain(mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST, 10.0), waypoint(45.0, 0.0)]
    photos = [event for event in fly_mission(uav_with(items)).events if isinstance(event, PhotoTaken)]
    apart = [off_m(one.position, other.position) for one, other in pairwise(photos)]
    assert [photo.number for photo in photos] == [1, 2, 3, 4]
    assert apart == pytest.approx([10.0] * 3, abs=0.5)


def test_mode_changes_tell_who_made_them() -> None:
    uav = uav_with([take_off(), land()])
    flown = fly_mission(uav)
    assert [(event.mode, event.is_own) for event in flown.events if isinstance(event, ModeChanged)] == [
        (FlightMode.MISSION, False),
        (FlightMode.HOLD, True),
    ]


def test_waypoint_with_a_heading_is_faced() -> None:
    uav = uav_with([take_off(), waypoint(20.0, 0.0, 10.0, 3.0, 0.0, 0.0, 200.0)])
    flown = fly_mission(uav)
    assert flown.end.heading_deg == pytest.approx(200.0, abs=2.0)


def test_heights_above_sea_and_ground_are_flown_as_they_are_given() -> None:
    class Slope:
        def elevation_m(self, position: object) -> float:
            return 100.0 + 0.2 * max(off_m(HOME, position), 0.0)  # type: ignore[arg-type]

    above_sea = at(mavlink.MAV_CMD_NAV_WAYPOINT, 20.0, 0.0, 130.0, frame=mavlink.MAV_FRAME_GLOBAL_INT)
    above_ground = at(mavlink.MAV_CMD_NAV_WAYPOINT, 50.0, 0.0, 25.0, 1.0, frame=mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT)
    uav = uav_with([take_off(), above_sea, above_ground], ground=Slope())
    begin(uav)
    while uav.state.current_item < 2:
        uav.step()
        assert uav.now_s < 60.0
    assert uav.state.altitude_amsl_m == pytest.approx(130.0, abs=0.5)
    assert uav.state.altitude_relative_m == pytest.approx(30.0, abs=0.5)
    step(uav, 25.0)
    assert uav.state.altitude_agl_m == pytest.approx(25.0, abs=0.5)
    assert uav.state.altitude_amsl_m == pytest.approx(135.0, abs=0.5)
    assert math.isclose(uav.state.home_amsl_m, 100.0)


@pytest.mark.parametrize(("radius_m", "turns", "side"), [(15.0, 2.0, 1.0), (-15.0, 1.0, -1.0)])
def test_a_circle_is_flown_round_its_centre(radius_m: float, turns: float, side: float) -> None:
    """50 m to the east of home. Clockwise the centre lies to the right of its way, and there is no more than a decimetre in it."""
    circle = at(mavlink.MAV_CMD_NAV_LOITER_TURNS, 50.0, 0.0, 10.0, turns, 0.0, radius_m)
    uav = uav_with([take_off(), circle, waypoint(50.0, 40.0), land(50.0, 40.0)])
    begin(uav)
    away, turned_deg, before = [], 0.0, None
    for _ in range(10_000):
        uav.step()
        if uav.state.current_item > 1:
            break
        lon, lat = uav.state.true_position
        x, y = FRAME.to_metres(np.array([[lon, lat]]))[0].tolist()
        off = math.dist((x, y), (50.0, 0.0))
        bearing = math.degrees(math.atan2(x - 50.0, y))
        if off < 15.5 and uav.state.current_item == 1:
            away.append(off)
            turned_deg += 0.0 if before is None else (bearing - before + 180.0) % 360.0 - 180.0
            before = bearing
    assert turned_deg == pytest.approx(side * 360.0 * turns, abs=8.0)
    assert min(away) > 14.4
    assert [index for index in reached(step(uav, 90.0)) if index > 1] == [2, 3]


def test_a_circle_without_a_radius_is_ten_metres_wide_and_one_without_turns_a_place() -> None:
    assert around((0.0, 0.0, 5.0), (30.0, 0.0, 9.0), 0.0, 10.0) == [pytest.approx((10.0, 0.0, 5.0))]
    ends = around((0.0, 0.0, 5.0), (0.0, 30.0, 5.0), 1.5, -20.0)
    assert ends[0] == pytest.approx((0.0, 20.0, 5.0)) and ends[-1] == pytest.approx((0.0, -20.0, 5.0), abs=1e-9)
    (order,) = orders([at(mavlink.MAV_CMD_NAV_LOITER_TURNS, 0.0, 0.0, 10.0, 3.0)], is_home_first=False)
    assert (order.turns, order.radius_m) == (3.0, 10.0)
    with pytest.raises(CannotFly, match="parameter 1"):
        orders([at(mavlink.MAV_CMD_NAV_LOITER_TURNS, 0.0, 0.0, 10.0, 1e6)], is_home_first=False)
