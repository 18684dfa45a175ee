"""A UAV without physics, for tests of what is said about it: it moves straight at one speed, and stops at once."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from planning.views.camera import Camera
from simulation.flight.airframe import Settings
from simulation.flight.camera import SIMULATED_CAMERA
from simulation.flight.events import Armed, Disarmed, Event, ItemReached, LandedAt, MissionEnded, ModeChanged, TookOff
from simulation.flight.states import DONE, FlightMode, Gps, Landed, MissionItemState, OrderRefused, Outcome, RallyPoint, SimulatedState

STEP_S = 0.04
METRES_PER_DEGREE = 111_195.0
HOME = LonLat(10.0, 55.0)
HOME_AMSL_M = 30.0
GOING = frozenset({FlightMode.MISSION, FlightMode.GO_TO, FlightMode.RETURN, FlightMode.TAKE_OFF, FlightMode.LAND})


def resting(home: LonLat = HOME, home_amsl_m: float = HOME_AMSL_M) -> SimulatedState:
    return SimulatedState(
        at_s=0.0, position=home, true_position=home, altitude_amsl_m=home_amsl_m, altitude_relative_m=0.0, altitude_agl_m=0.0,
        velocity_ned_mps=(0.0, 0.0, 0.0), roll_deg=0.0, pitch_deg=0.0, heading_deg=0.0, roll_rate_dps=0.0, pitch_rate_dps=0.0,
        yaw_rate_dps=0.0, airspeed_mps=0.0, ground_speed_mps=0.0, wind_ned_mps=(0.0, 0.0, 0.0), battery_percent=100.0, battery_used_wh=0.0,
        battery_v=12.6, battery_a=0.5, is_armed=False, is_in_air=False, landed=Landed.ON_GROUND, mode=FlightMode.HOLD, is_crashed=False,
        gps=Gps(3, 14, 0.8), current_item=0, mission_state=MissionItemState.NONE, home=home, home_amsl_m=home_amsl_m, target_speed_mps=5.0,
    )  # fmt: skip


@dataclass
class KinematicUav:
    """Items that are not flown to are done at once. `load` refuses while `refuses_lists`."""

    state: SimulatedState = field(default_factory=resting)
    items: tuple[MissionItem, ...] = ()
    refuses_lists: bool = False
    camera: Camera = SIMULATED_CAMERA
    operated: list[MissionItem] = field(default_factory=list)
    rally_points: tuple[RallyPoint, ...] = ()
    settings: Settings = field(default_factory=Settings)
    _events: list[Event] = field(default_factory=list)
    _goal: tuple[LonLat, float] | None = None

    def step(self) -> None:
        state = replace(self.state, at_s=round(self.state.at_s + STEP_S, 6))
        self.state = state
        if not state.is_armed or state.mode not in GOING:
            return
        if state.mode is FlightMode.MISSION:
            self._fly_item()
        if self._goal is not None and self.state.mode in GOING:
            self._move(*self._goal)

    def take_events(self) -> list[Event]:
        events, self._events = self._events, []
        return events

    def operate(self, item: MissionItem) -> Outcome:
        self.operated.append(item)
        return DONE

    def load(self, items: Sequence[MissionItem]) -> Outcome:
        if self.refuses_lists:
            return OrderRefused("busy", "No list is taken now")
        self.items = tuple(items)
        self.state = replace(self.state, current_item=0, mission_state=MissionItemState.NOT_STARTED if items else MissionItemState.NONE)
        self._goal = None
        return DONE

    def arm(self) -> Outcome:
        if not self.state.is_armed:
            self._events.append(Armed(self.state.at_s))
            self.state = replace(self.state, is_armed=True)
        return DONE

    def disarm(self, *, force: bool = False) -> Outcome:
        if self.state.is_in_air and not force:
            return OrderRefused("in-air", "It flies")
        self._events.append(Disarmed(self.state.at_s))
        self.state = replace(self.state, is_armed=False, mode=FlightMode.HOLD)
        return DONE

    def take_off(self, height_relative_m: float) -> Outcome:
        self._enter(FlightMode.TAKE_OFF)
        self._goal = (self.state.position, height_relative_m)
        return DONE

    def set_mode(self, mode: FlightMode) -> Outcome:
        state = self.state
        if mode is FlightMode.MISSION and not self.items:
            return OrderRefused("no-mission", "There is no mission")
        self._enter(mode)
        self._goal = None
        if mode is FlightMode.MISSION:
            current = 0 if state.mission_state is MissionItemState.COMPLETE else state.current_item
            self.state = replace(self.state, mission_state=MissionItemState.ACTIVE, current_item=current)
        elif state.mission_state is MissionItemState.ACTIVE:
            self.state = replace(self.state, mission_state=MissionItemState.PAUSED)
        if mode is FlightMode.RETURN:
            self._goal = (state.home, 0.0)
        if mode is FlightMode.LAND:
            self._goal = (state.position, 0.0)
        return DONE

    def go_to(self, position: LonLat, altitude_relative_m: float, heading_deg: float | None = None) -> Outcome:
        self._enter(FlightMode.GO_TO)
        self._goal = (position, altitude_relative_m)
        return DONE

    def change_speed(self, speed_mps: float) -> Outcome:
        self.state = replace(self.state, target_speed_mps=speed_mps)
        return DONE

    def set_current(self, index: int) -> Outcome:
        if not 0 <= index < len(self.items):
            return OrderRefused("no-item", "There is no such item")
        self.state = replace(self.state, current_item=index)
        return DONE

    def _enter(self, mode: FlightMode) -> None:
        if mode is not self.state.mode:
            self._events.append(ModeChanged(self.state.at_s, mode, is_own=False))
            self.state = replace(self.state, mode=mode)

    def _fly_item(self) -> None:
        state = self.state
        while self._goal is None and state.current_item < len(self.items):
            item = self.items[state.current_item]
            place = LonLat(item.longitude_e7 / 1e7, item.latitude_e7 / 1e7)
            if item.command in (mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_TAKEOFF):
                self._goal = (place, item.altitude_m)
            elif item.command == mavlink.MAV_CMD_NAV_LAND:
                self._goal = (place, 0.0)
            else:
                state = self._reach()
        if self._goal is None:
            self._events.append(MissionEnded(state.at_s))
            self.state = replace(state, mission_state=MissionItemState.COMPLETE)
            self._enter(FlightMode.HOLD)

    def _reach(self) -> SimulatedState:
        self._events.append(ItemReached(self.state.at_s, self.state.current_item))
        self.state = replace(self.state, current_item=self.state.current_item + 1)
        return self.state

    def _move(self, place: LonLat, height_m: float) -> None:
        state, reach_m = self.state, STEP_S * self.state.target_speed_mps
        per_east_m = METRES_PER_DEGREE * math.cos(math.radians(state.home.lat))
        away = ((place.lon - state.position.lon) * per_east_m, (place.lat - state.position.lat) * METRES_PER_DEGREE,
                height_m - state.altitude_relative_m)  # fmt: skip
        length_m = math.hypot(*away)
        share = 1.0 if length_m <= reach_m else reach_m / length_m
        here = LonLat(state.position.lon + share * away[0] / per_east_m, state.position.lat + share * away[1] / METRES_PER_DEGREE)
        up_m = state.altitude_relative_m + share * away[2]
        is_up = up_m > 0.05
        if is_up and not state.is_in_air:
            self._events.append(TookOff(state.at_s))
        velocity = tuple(part * share / STEP_S for part in (away[1], away[0], -away[2]))
        self.state = replace(
            state, position=here, true_position=here, altitude_relative_m=up_m, altitude_amsl_m=state.home_amsl_m + up_m,
            altitude_agl_m=up_m,
            velocity_ned_mps=velocity, is_in_air=is_up, landed=Landed.IN_AIR if is_up else Landed.ON_GROUND,
        )  # fmt: skip
        if share == 1.0:
            self._arrived(is_up)

    def _arrived(self, is_up: bool) -> None:
        self._goal = None
        self.state = replace(self.state, velocity_ned_mps=(0.0, 0.0, 0.0))
        if not is_up:
            self._events.append(LandedAt(self.state.at_s, self.state.position))
        if self.state.mode is FlightMode.MISSION:
            self._reach()
            if self.state.current_item == len(self.items):
                self._events.append(MissionEnded(self.state.at_s))
                self.state = replace(self.state, mission_state=MissionItemState.COMPLETE)
                self._enter(FlightMode.HOLD)
        elif self.state.mode in (FlightMode.TAKE_OFF, FlightMode.RETURN, FlightMode.LAND):
            self._enter(FlightMode.HOLD)
        if not is_up:
            self.disarm()
