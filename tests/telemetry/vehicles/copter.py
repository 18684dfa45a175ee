"""The scripted ArduCopter with a body: it flies its list, returns and lands, and reports what it is asked for, in simulated time.

A point mass without inertia in calm air, with the failsafes of battery and GPS as they were observed in the firmware's simulator.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy.wgs84 import short_distance_m
from mavlink.vehicle_plan import MissionItem, MissionType
from tests.telemetry.vehicles.ardupilot import AUTO, GUIDED, LAND, RTL, ArduPilot

STEP_S = 0.05  # of its flight
CLIMB_MPS, SINK_MPS, TOUCH_DOWN_MPS = 2.5, 1.5, 0.5
SLOW_BELOW_M = 10.0  # on the way down
REACHED_M, REACHED_HEIGHT_M = 1.0, 0.2
DEGREES_M = 111_320.0
ESTIMATES_PLACE_AFTER_S = 15.0  # and may be armed in GUIDED
EKF_FAILS_AFTER_S = 5.0  # without GPS
FULL_V = 12.6
NAVIGATION = frozenset({16, 17, 18, 19, 20, 21, 22, 31, 82, 93})  # the other items are done at once
PARAMETERS = {
    "MIS_RESTART": 0.0, "FENCE_ENABLE": 0.0, "RTL_ALT": 1_500.0, "BATT_MONITOR": 0.0, "BATT_ARM_VOLT": 0.0, "BATT_LOW_VOLT": 10.5,
    "BATT_LOW_TIMER": 10.0, "BATT_FS_LOW_ACT": 0.0, "SIM_BATT_VOLTAGE": FULL_V, "SIM_GPS_DISABLE": 0.0, "SIM_WIND_SPD": 0.0,
    "SIM_WIND_DIR": 0.0,
}  # fmt: skip


@dataclass
class FlyingCopter(ArduPilot):
    """`at` is its home, longitude and latitude; `height_m` is above it. Times are simulated seconds since it was switched on."""

    parameters: dict[str, float] = field(default_factory=dict)
    at: tuple[float, float] = (10.0, 55.0)
    home_amsl_m: float = 100.0
    place: tuple[float, float] = field(init=False)
    height_m: float = 0.0
    intervals_s: dict[int, float] = field(default_factory=dict)  # of messages by their ids
    _sent_s: dict[int, float] = field(default_factory=dict)
    _booted_s: float = 0.0
    _epoch_s: float = 1.7e9
    _flown_s: float = 0.0
    _speed_mps: float = 10.0
    _velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # east, north, up [m/s]
    _waits_until_s: float | None = None
    _is_over_home: bool = False
    _low_since_s: float | None = None
    _gps_lost_s: float | None = None
    _has_failsafe: bool = False
    _to_report: list[Any] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.place = self.at
        self.parameters = PARAMETERS | self.parameters
        self.heartbeats = True

    # Its state

    @property
    def since_boot_s(self) -> float:
        return self._now_s - self._booted_s

    @property
    def is_ready(self) -> bool:
        return self.since_boot_s > ESTIMATES_PLACE_AFTER_S

    def reboot(self) -> None:
        """Its power fails for a moment: it stands at its home again, with the lists and parameters it had."""
        self.restart()
        self.place, self.height_m, self.is_armed, self.is_in_air = self.at, 0.0, False, False
        self.custom_mode, self.current_item, self._booted_s, self._velocity = 0, 0, self._now_s, (0.0, 0.0, 0.0)
        self._epoch_s += self.since_boot_s
        self._has_failsafe, self._low_since_s, self._gps_lost_s, self._waits_until_s = False, None, None, None
        self.intervals_s.clear()
        self._to_report.clear()

    # Orders

    def carry_out(self, command: int, values: tuple[float, ...]) -> int:
        if command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            self._set_interval(int(values[0]), values[1] / 1e6)
            return int(mavlink.MAV_RESULT_ACCEPTED)
        if command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM and values[0] == 1 and (refusal := self._arming_refusal()):
            self._report(mavlink.MAV_SEVERITY_CRITICAL, refusal)
            return int(mavlink.MAV_RESULT_FAILED)
        mode_before = self.custom_mode
        result = super().carry_out(command, values)
        if self.custom_mode != mode_before:
            self._enter_mode()
        return result

    def _command(self, message: Any, now_s: float) -> list[Any]:
        """Words before the acknowledgement."""
        answers = super()._command(message, now_s)
        stated, self._to_report = self._to_report, []
        return [*stated, *answers]

    def _version(self, asked_for: int) -> list[Any]:
        return super()._version(asked_for) or self._message(asked_for)

    def _arming_refusal(self) -> str:
        if self.custom_mode == GUIDED and not self.is_ready:
            return "Arm: Need Position Estimate"
        if self.parameters["BATT_MONITOR"] and self.parameters["SIM_BATT_VOLTAGE"] < self.parameters["BATT_ARM_VOLT"]:
            return "Arm: Battery 1 below minimum arming voltage"
        return ""

    def _request_data_stream(self, message: Any, now_s: float) -> list[Any]:
        """All streams at once, as the gateway asks."""
        for number in self._messages():
            self._set_interval(number, 1.0 / message.req_message_rate if message.start_stop and message.req_message_rate else -1.0)
        return []

    def _set_interval(self, number: int, every_s: float) -> None:
        if every_s > 0.0:
            self.intervals_s[number] = every_s
        else:
            self.intervals_s.pop(number, None)

    def _mission_count(self, message: Any, now_s: float) -> list[Any]:
        if self.is_armed and self.custom_mode == AUTO:
            self._report(mavlink.MAV_SEVERITY_INFO, "Auto mission changed, restarted command")
        return super()._mission_count(message, now_s)

    # Flight

    def _due(self, now_s: float) -> list[Any]:
        messages = super()._due(now_s)
        while self._flown_s + STEP_S <= now_s:
            self._flown_s += STEP_S
            self._fly()
            self._watch_failsafes()
        stated, self._to_report = self._to_report, []
        return [*messages, *stated, *self._streamed(now_s)]

    def _fly(self) -> None:
        self._velocity = (0.0, 0.0, 0.0)
        if not self.is_in_air:
            return
        if self.custom_mode == AUTO:
            self._fly_list()
        elif self.custom_mode == RTL:
            self._return()
        elif self.custom_mode == LAND:
            self._sink()

    def _enter_mode(self) -> None:
        self._waits_until_s, self._is_over_home = None, False
        if self.custom_mode == AUTO and self.current_item == 0:
            self.current_item = 1

    def _fly_list(self) -> None:
        items = self.lists[MissionType.MISSION]
        while self.current_item < len(items) and items[self.current_item].command not in NAVIGATION:
            self._do(items[self.current_item])
            self.current_item += 1
        if self.current_item >= len(items):
            self.current_item = max(len(items) - 1, 0)  # it hovers
            return
        item = items[self.current_item]
        if item.command == mavlink.MAV_CMD_NAV_LAND:
            if self._go_to(self._place_of(item), self.height_m):
                self._sink()
        elif item.command == mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
            self._return()
        elif self._reaches(item):
            self._to_report.append(mavlink.MAVLink_mission_item_reached_message(self.current_item))
            self._waits_until_s = None
            if self.current_item < len(items) - 1:
                self.current_item += 1

    def _do(self, item: MissionItem) -> None:
        if item.command == mavlink.MAV_CMD_DO_CHANGE_SPEED and item.parameters[1] > 0.0:
            self._speed_mps = item.parameters[1]

    def _reaches(self, item: MissionItem) -> bool:
        if item.command == mavlink.MAV_CMD_NAV_TAKEOFF:
            return self._go_to(self.place, item.altitude_m)
        if item.command != mavlink.MAV_CMD_NAV_DELAY and not self._go_to(self._place_of(item), item.altitude_m):
            return False
        if self._waits_until_s is None:
            self._waits_until_s = self._flown_s + float(int(item.parameters[0]))
        return self._flown_s >= self._waits_until_s

    def _place_of(self, item: MissionItem) -> tuple[float, float]:
        return (item.longitude_e7 / 1e7, item.latitude_e7 / 1e7) if item.longitude_e7 or item.latitude_e7 else self.place

    def _return(self) -> None:
        height_m = max(self.height_m, self.parameters["RTL_ALT"] / 100.0)
        if self._is_over_home:
            self._sink()
        elif self.height_m < height_m - REACHED_HEIGHT_M:
            self._go_to(self.place, height_m)
        else:
            self._is_over_home = self._go_to(self.at, self.height_m)

    def _go_to(self, place: tuple[float, float], height_m: float) -> bool:
        """One step; whether it is there."""
        away_m, up_m = short_distance_m(*self.place, *place), height_m - self.height_m
        if away_m < REACHED_M and abs(up_m) < REACHED_HEIGHT_M:
            return True
        seconds = max(away_m / self._speed_mps, abs(up_m) / (CLIMB_MPS if up_m > 0.0 else SINK_MPS), STEP_S)
        east, north = place[0] - self.place[0], place[1] - self.place[1]
        lon_m = DEGREES_M * math.cos(math.radians(self.place[1]))
        self._velocity = (east * lon_m / seconds, north * DEGREES_M / seconds, up_m / seconds)
        share = STEP_S / seconds
        self.place = (self.place[0] + east * share, self.place[1] + north * share)
        self.height_m += up_m * share
        return False

    def _sink(self) -> None:
        speed_mps = SINK_MPS if self.height_m > SLOW_BELOW_M else TOUCH_DOWN_MPS
        self.height_m -= speed_mps * STEP_S
        self._velocity = (0.0, 0.0, -speed_mps)
        if self.height_m <= 0.0:
            self.height_m, self._velocity = 0.0, (0.0, 0.0, 0.0)
            self.touch_down()

    # Failsafes

    def _watch_failsafes(self) -> None:
        wanted = self.parameters
        low = wanted["BATT_MONITOR"] > 0.0 and wanted["SIM_BATT_VOLTAGE"] < wanted["BATT_LOW_VOLT"]
        self._low_since_s = (self._low_since_s or self._flown_s) if low else None
        if self._low_since_s is not None and self._flown_s - self._low_since_s >= wanted["BATT_LOW_TIMER"] and not self._has_failsafe:
            self._has_failsafe = True
            self._report(mavlink.MAV_SEVERITY_WARNING, f"Battery 1 is low {wanted['SIM_BATT_VOLTAGE']:.2f}V used 0 mAh")
            self._change_mode_by_itself({1.0: LAND, 2.0: RTL}.get(wanted["BATT_FS_LOW_ACT"]))
        self._gps_lost_s = (self._gps_lost_s or self._flown_s) if wanted["SIM_GPS_DISABLE"] else None
        if self._gps_lost_s is not None and EKF_FAILS_AFTER_S <= self._flown_s - self._gps_lost_s < EKF_FAILS_AFTER_S + STEP_S:
            self._report(mavlink.MAV_SEVERITY_CRITICAL, "EKF Failsafe: changed to LAND Mode")
            self._change_mode_by_itself(LAND)

    def _change_mode_by_itself(self, mode: int | None) -> None:
        if mode is not None and self.is_in_air:
            self.custom_mode = mode
            self._enter_mode()

    def _report(self, severity: int, text: str) -> None:
        self._to_report.append(mavlink.MAVLink_statustext_message(severity, text.encode()))

    # What it reports

    def reports(self) -> list[Any]:
        """Its heartbeat alone: all else is sent to whoever has asked."""
        return super().reports()[:1]

    def _streamed(self, now_s: float) -> Iterator[Any]:
        for number, every_s in list(self.intervals_s.items()):
            if now_s - self._sent_s.get(number, -math.inf) >= every_s:
                self._sent_s[number] = now_s
                yield from self._message(number)

    def _message(self, number: int) -> list[Any]:
        made = self._messages().get(number)
        return [] if made is None else [made()]

    def _messages(self) -> dict[int, Callable[[], Any]]:
        return {
            mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: self._position,
            mavlink.MAVLINK_MSG_ID_ATTITUDE: lambda: mavlink.MAVLink_attitude_message(self._boot_ms, 0, 0, self._heading_rad, 0, 0, 0),
            mavlink.MAVLINK_MSG_ID_VFR_HUD: self._hud,
            mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: self._gps,
            mavlink.MAVLINK_MSG_ID_SYS_STATUS: self._system_status,
            mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: self._battery,
            mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: lambda: super(FlyingCopter, self).reports()[1],
            mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: self._current,
            mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: lambda: mavlink.MAVLink_system_time_message(
                round((self._epoch_s + self.since_boot_s) * 1e6), self._boot_ms
            ),
            mavlink.MAVLINK_MSG_ID_WIND: lambda: super(FlyingCopter, self).reports()[3],
            mavlink.MAVLINK_MSG_ID_HOME_POSITION: self._home,
        }

    @property
    def _boot_ms(self) -> int:
        return round(self.since_boot_s * 1000)

    @property
    def _heading_rad(self) -> float:
        east, north, _up = self._velocity
        return math.atan2(east, north)

    def _position(self) -> Any:
        (lon, lat), (east, north, up) = self.place, self._velocity
        speeds = (round(north * 100), round(east * 100), round(-up * 100))
        amsl_mm, heading_cdeg = (
            round((self.home_amsl_m + self.height_m) * 1000),
            round(math.degrees(self._heading_rad) % 360.0 * 100) % 36_000,
        )
        return mavlink.MAVLink_global_position_int_message(
            self._boot_ms, round(lat * 1e7), round(lon * 1e7), amsl_mm, round(self.height_m * 1000), *speeds, heading_cdeg
        )

    def _hud(self) -> Any:
        east, north, up = self._velocity
        speed_mps = math.hypot(east, north)
        heading_deg = round(math.degrees(self._heading_rad) % 360.0)
        return mavlink.MAVLink_vfr_hud_message(speed_mps, speed_mps, heading_deg, 50, self.home_amsl_m + self.height_m, up)

    def _gps(self) -> Any:
        fix, satellites = (0, 0) if self.parameters["SIM_GPS_DISABLE"] else (6, 10)
        (lon, lat), amsl_mm = self.place, round((self.home_amsl_m + self.height_m) * 1000)
        return mavlink.MAVLink_gps_raw_int_message(
            self._boot_ms * 1000, fix, round(lat * 1e7), round(lon * 1e7), amsl_mm, 121, 200, 0, 0, satellites
        )

    def _system_status(self) -> Any:
        check = mavlink.MAV_SYS_STATUS_PREARM_CHECK
        healthy = 0 if self._arming_refusal() else check
        voltage_mv = round(self.parameters["SIM_BATT_VOLTAGE"] * 1000) if self.parameters["BATT_MONITOR"] else 0xFFFF
        remaining = 98 if self.parameters["BATT_MONITOR"] else -1
        return mavlink.MAVLink_sys_status_message(check, check, healthy, 100, voltage_mv, -1, remaining, 0, 0, 0, 0, 0, 0)

    def _battery(self) -> Any:
        """Its remaining share stays high when its voltage is low."""
        cells = [round(self.parameters["SIM_BATT_VOLTAGE"] * 1000), *[0xFFFF] * 9]
        state = mavlink.MAV_BATTERY_CHARGE_STATE_LOW if self._has_failsafe else mavlink.MAV_BATTERY_CHARGE_STATE_OK
        return mavlink.MAVLink_battery_status_message(0, 0, 0, 32_767, cells, -1, 0, -1, 98, 0, state)

    def _current(self) -> Any:
        return mavlink.MAVLink_mission_current_message(self.current_item, max(len(self.lists[MissionType.MISSION]) - 1, 0), 0)

    def _home(self) -> Any:
        lon, lat = self.at
        return mavlink.MAVLink_home_position_message(
            round(lat * 1e7), round(lon * 1e7), round(self.home_amsl_m * 1000), 0, 0, 0, [1, 0, 0, 0], 0, 0, 0
        )
