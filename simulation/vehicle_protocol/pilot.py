"""Converts commands to orders for the UAV, by the rules of each autopilot.

Sources: commands of QGroundControl, MAVSDK and MAVProxy; PX4's Commander; ArduCopter 4.6 in its simulator.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.flight.states import DONE, FlightMode, OrderRefused, Outcome
from simulation.vehicle_protocol.command_endpoint import ReceivedCommand
from simulation.vehicle_protocol.item_rules import begins_with_take_off
from simulation.vehicle_protocol.mode_numbers import (
    COPTER_BY_HAND,
    COPTER_NOT_ARMABLE,
    GUIDED,
    ShownMode,
    SimulatedAutopilot,
    ordered_mode,
    px4_number,
    usual_number,
)
from simulation.vehicle_protocol.vehicle import Vehicle

ACCEPTED, DENIED, FAILED = int(mavlink.MAV_RESULT_ACCEPTED), int(mavlink.MAV_RESULT_DENIED), int(mavlink.MAV_RESULT_FAILED)
UNSUPPORTED, REJECTED = int(mavlink.MAV_RESULT_UNSUPPORTED), int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
FORCE = 21_196  # of COMPONENT_ARM_DISARM
MIN_TAKE_OFF_M = 1.0
AIRSPEED, GROUND_SPEED = 0, 1
PAUSE, GO_ON = 0, 1
E7, MAX_INT = 1e7, 2**31 - 1
GPS_POINT = mavlink.MAV_MOUNT_MODE_GPS_POINT
PLACED = frozenset({mavlink.MAV_CMD_DO_SET_ROI_LOCATION, mavlink.MAV_CMD_DO_SET_ROI})
CAMERA_COMMANDS = frozenset(
    {
        mavlink.MAV_CMD_IMAGE_START_CAPTURE, mavlink.MAV_CMD_IMAGE_STOP_CAPTURE, mavlink.MAV_CMD_DO_DIGICAM_CONTROL,
        mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
    }
)  # fmt: skip


@dataclass
class Pilot:
    """`refusal` is the text of why the last order was refused; the code that sends it clears it."""

    vehicle: Vehicle
    autopilot_type: SimulatedAutopilot
    refusal: str = ""
    shown: ShownMode = field(init=False)

    def __post_init__(self) -> None:
        self.shown = ShownMode.at_start(self.autopilot_type)

    @property
    def custom_mode(self) -> int:
        state = self.vehicle.state
        return self.shown.number(state.mode, is_in_air=state.is_in_air)

    def carry_out(self, command: ReceivedCommand) -> int:
        """Return a MAV_RESULT; UNSUPPORTED for other commands."""
        order = _ORDERS.get(command.number)
        return UNSUPPORTED if order is None else order(self, command)

    def set_mode_number(self, number: int) -> int:
        """Set the mode by its number in heartbeats."""
        mode = ordered_mode(self.autopilot_type, number)
        if mode is None:
            return self._refused("This mode needs a pilot at the sticks, and there is none.", UNSUPPORTED)
        state = self.vehicle.state
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT and number in COPTER_BY_HAND and state.is_armed and state.is_in_air:
            return self._refused("This mode needs a pilot at the sticks, and there is none.")
        is_begun_on_ground = mode is FlightMode.MISSION and state.is_armed and not state.is_in_air
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT and is_begun_on_ground and not begins_with_take_off(self.vehicle.items):
            return self._refused("Auto: Missing Takeoff Cmd")
        is_there = mode is FlightMode.HOLD and state.mode is FlightMode.HOLD
        outcome = DONE if is_there else self.vehicle.set_mode(mode)
        if outcome.is_done:
            self.shown.asked = number
        return self._result(outcome)

    def set_mode(self, mode: FlightMode) -> int:
        return self.set_mode_number(usual_number(self.autopilot_type, mode))

    def set_current(self, number: int) -> int:
        """Set the present item. number: as the autopilot counts; ArduPilot's home selects the first flown item."""
        outcome = self.vehicle.set_current(max(number - self.autopilot_type.first_item, 0))
        return self._result(outcome, DENIED)

    def _arm(self, command: ReceivedCommand) -> int:
        wanted, is_forced = command.whole(1), command.whole(2) == FORCE
        if wanted == 1:
            if (
                self.autopilot_type is SimulatedAutopilot.ARDUPILOT
                and not self.vehicle.state.is_armed
                and self.custom_mode in COPTER_NOT_ARMABLE
            ):
                return self._refused("Arm: this mode is not armable")
            return self._result(self.vehicle.arm())
        if wanted == 0:
            return self._result(self.vehicle.disarm(force=is_forced))
        return DENIED

    def _take_off(self, command: ReceivedCommand) -> int:
        """Take off. PX4 takes it before arming, by altitude AMSL; ArduCopter armed in GUIDED, by height above home."""
        state, height_m = self.vehicle.state, command[7]
        if not command.is_frame_known:
            return DENIED
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT:
            if not state.is_armed or self.custom_mode != GUIDED:
                return self._refused("Take-off needs an armed vehicle in GUIDED")
            if height_m is None or height_m <= 0 or command.is_above_sea:
                return DENIED
            return self._result(self.vehicle.take_off(height_m))
        relative_m = self.vehicle.settings.take_off_height_m
        if height_m is not None:
            wanted_m = height_m if command.is_above_sea is False else height_m - state.home_amsl_m
            relative_m = wanted_m if wanted_m >= MIN_TAKE_OFF_M else relative_m
        outcome = self.vehicle.take_off(relative_m)
        if outcome.is_done:
            self.shown.asked = usual_number(self.autopilot_type, FlightMode.TAKE_OFF)
        return self._result(outcome)

    def _set_mode(self, command: ReceivedCommand) -> int:
        base, main, sub = command.whole(1), command.whole(2), command.whole(3)
        if base is None or not base & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED or main is None:
            return UNSUPPORTED
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT:
            return self.set_mode_number(main)
        if not 0 <= main <= 255 or not 0 <= (sub or 0) <= 255:
            return DENIED
        return self.set_mode_number(px4_number(main, sub or 0))

    def _start(self, command: ReceivedCommand) -> int:
        """Start the mission. PX4 arms by itself; a disarmed ArduCopter accepts and does nothing."""
        first = command.whole(1)
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT:
            return self.set_mode(FlightMode.MISSION) if self.vehicle.state.is_armed else ACCEPTED
        if first is not None and first > 0 and (result := self.set_current(first)) != ACCEPTED:
            return result
        result = self.set_mode(FlightMode.MISSION)
        return self._result(self.vehicle.arm()) if result == ACCEPTED and not self.vehicle.state.is_armed else result

    def _pause(self, command: ReceivedCommand) -> int:
        wanted = command.whole(1)
        if wanted not in (PAUSE, GO_ON):
            return DENIED
        return self.set_mode(FlightMode.HOLD if wanted == PAUSE else FlightMode.MISSION)

    def _go_to(self, command: ReceivedCommand) -> int:
        """Go to a place. Open values stay unchanged; with all open it is a pause."""
        state = self.vehicle.state
        lat, lon, height_m = command[5], command[6], command[7]
        if not state.is_in_air:
            return self._refused("It stands on the ground", REJECTED)
        if all(value is None for value in (lat, lon, height_m, command[4])):
            return self.set_mode(FlightMode.HOLD)
        if height_m is not None and not command.is_frame_known:
            return DENIED
        if (lat is not None and not -90 <= lat <= 90) or (lon is not None and not -180 <= lon <= 180):
            return DENIED
        place = LonLat(state.position.lon if lon is None else lon, state.position.lat if lat is None else lat)
        relative_m = state.altitude_relative_m
        if height_m is not None:
            relative_m = height_m if command.is_above_sea is False else height_m - state.home_amsl_m
        if relative_m <= 0:
            return DENIED
        speed_mps = command[1]
        if speed_mps is not None and speed_mps > 0:
            self.vehicle.change_speed(speed_mps)
        heading_rad = command[4]
        outcome = self.vehicle.go_to(place, relative_m, None if heading_rad is None else math.degrees(heading_rad))
        if outcome.is_done:
            self.shown.asked = usual_number(self.autopilot_type, FlightMode.GO_TO)
        return self._result(outcome)

    def _change_speed(self, command: ReceivedCommand) -> int:
        """Change the speed; -1 is no change, -2 the default speed."""
        if (command[1] or AIRSPEED) not in (AIRSPEED, GROUND_SPEED):
            return UNSUPPORTED
        speed_mps = command[2]
        if speed_mps is None or speed_mps in (-1, -2):
            return ACCEPTED
        return self._result(self.vehicle.change_speed(speed_mps), DENIED) if speed_mps > 0 else DENIED

    def _set_current(self, command: ReceivedCommand) -> int:
        number = command.whole(1)
        return DENIED if number is None or number < 0 else self.set_current(number)

    def operate(self, command: ReceivedCommand) -> int:
        """Carry out a command to gimbal, nose or camera. Without a frame a height is AMSL on PX4, above home on ArduPilot."""
        if not command.is_frame_known:
            return DENIED
        one, two, three, four, five, six, seven = (math.nan if value is None else value for value in command.values)
        is_placed = command.number in PLACED or (command.number == mavlink.MAV_CMD_DO_MOUNT_CONTROL and seven == GPS_POINT)
        scale = E7 if is_placed else 1.0
        x, y = (0 if math.isnan(value) else max(min(round(value * scale), MAX_INT), -MAX_INT) for value in (five, six))
        is_amsl = self.autopilot_type is SimulatedAutopilot.PX4 if command.is_above_sea is None else command.is_above_sea
        frame = mavlink.MAV_FRAME_GLOBAL if is_amsl else mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
        outcome = self.vehicle.operate(MissionItem(command.number, frame, (one, two, three, four), y, x, seven))
        return self._result(outcome, DENIED)

    def _land(self, command: ReceivedCommand) -> int:
        return self.set_mode(FlightMode.LAND)

    def _return(self, command: ReceivedCommand) -> int:
        return self.set_mode(FlightMode.RETURN)

    def _result(self, outcome: Outcome, refused: int = FAILED) -> int:
        return self._refused(str(outcome.words), refused) if isinstance(outcome, OrderRefused) else ACCEPTED

    def _refused(self, words: str, result: int = FAILED) -> int:
        self.refusal = words
        return result


_ORDERS: dict[int, Callable[[Pilot, ReceivedCommand], int]] = {
    mavlink.MAV_CMD_COMPONENT_ARM_DISARM: Pilot._arm,
    mavlink.MAV_CMD_NAV_TAKEOFF: Pilot._take_off,
    mavlink.MAV_CMD_NAV_LAND: Pilot._land,
    mavlink.MAV_CMD_DO_LAND_START: Pilot._land,  # MAVProxy's "land"
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: Pilot._return,
    mavlink.MAV_CMD_MISSION_START: Pilot._start,
    mavlink.MAV_CMD_DO_SET_MODE: Pilot._set_mode,
    mavlink.MAV_CMD_DO_REPOSITION: Pilot._go_to,
    mavlink.MAV_CMD_DO_PAUSE_CONTINUE: Pilot._pause,
    mavlink.MAV_CMD_DO_CHANGE_SPEED: Pilot._change_speed,
    mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: Pilot._set_current,
    **dict.fromkeys(
        (
            mavlink.MAV_CMD_DO_SET_ROI_LOCATION, mavlink.MAV_CMD_DO_SET_ROI, mavlink.MAV_CMD_DO_SET_ROI_NONE,
            mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, mavlink.MAV_CMD_DO_MOUNT_CONTROL, mavlink.MAV_CMD_CONDITION_YAW,
            *CAMERA_COMMANDS,
        ),
        Pilot.operate,
    ),
}  # fmt: skip
