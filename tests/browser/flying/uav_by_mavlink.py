"""A UAV that a browser test watches: a scripted autopilot that flies what it holds, on a socket to the installation's gateway."""

import math
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_plan import MissionItem, MissionType
from tests.telemetry.gateway.flyer import Flyer
from tests.telemetry.vehicles.px4 import LAND, MISSION, RETURN, Px4

METRES_A_DEGREE = 111_195.0
CLIMB_MPS, SINK_MPS, NEAR_M, REPORT_INTERVAL_S = 12.0, 2.0, 1.0, 1.0
STAYS = (mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_LOITER_TIME)
HOME_AMSL_M = 220.0
BATTERY_PERCENT_S = 0.02


@dataclass
class Autopilot(Flyer):
    """Flies from item to item in mission mode and stays where it is in any other, but for `comes_home`. `at` is where it stands first."""

    vehicle: Px4
    speed_mps: float = 10.0
    relative_m: float = 0.0
    battery_percent: float = 93.0
    _home: tuple[float, float] = (0.0, 0.0)
    _moved_s: float = 0.0
    _reported_s: float = 0.0
    _velocity_mps: tuple[float, float] = (0.0, 0.0)
    _held_s: float = 0.0
    _reached: list[int] = field(default_factory=list)

    def __enter__(self) -> "Autopilot":
        self._home = self.at
        super().__enter__()
        return self

    def comes_home(self) -> None:
        """By itself, as autopilots do when they miss their radio."""
        self.vehicle.custom_mode = 4 << 16 | RETURN << 24

    def _reports(self, now_s: float) -> list[Any]:
        self._fly(min(now_s - self._moved_s, 1.0) if self._moved_s else 0.0)
        self._moved_s = now_s
        self.altitude_amsl_m = HOME_AMSL_M + self.relative_m
        reported, home = super()._reports(now_s)
        east_mps, north_mps = self._velocity_mps
        reported.relative_alt = round(self.relative_m * 1000)
        reported.vx, reported.vy, reported.vz = round(north_mps * 100), round(east_mps * 100), 0
        if east_mps or north_mps:
            reported.hdg = round(math.degrees(math.atan2(east_mps, north_mps)) % 360.0 * 100)
        home.longitude, home.latitude, home.altitude = round(self._home[0] * 1e7), round(self._home[1] * 1e7), round(HOME_AMSL_M * 1000)
        reached = [mavlink.MAVLink_mission_item_reached_message(item) for item in self._reached]
        self._reached.clear()
        if now_s < self._reported_s + REPORT_INTERVAL_S:
            return [reported, home, *reached]
        self._reported_s = now_s
        return [reported, home, *reached, *self._of_the_second(round((now_s - self.booted_s) * 1e6))]

    def _of_the_second(self, boot_us: int) -> list[Any]:
        lat_e7, lon_e7, alt_mm = round(self.at[1] * 1e7), round(self.at[0] * 1e7), round(self.altitude_amsl_m * 1000)
        charge = round(self.battery_percent)
        return [
            mavlink.MAVLink_gps_raw_int_message(boot_us, 3, lat_e7, lon_e7, alt_mm, 80, 90, 0, 0, 14),
            mavlink.MAVLink_sys_status_message(0, 0, 0, 300, 15_200, -1, charge, 0, 0, 0, 0, 0, 0),
        ]

    def _fly(self, for_s: float) -> None:
        self._velocity_mps = (0.0, 0.0)
        if not self.vehicle.is_in_air:
            return
        self.battery_percent -= BATTERY_PERCENT_S * for_s
        if self.vehicle.sub_mode == RETURN:
            self._lands_at(self._home, for_s)
        elif self.vehicle.sub_mode == LAND:
            self._lands_at(self.at, for_s)
        elif self.vehicle.sub_mode == MISSION:
            self._on_mission(for_s)

    def _on_mission(self, for_s: float) -> None:
        items = self.vehicle.lists[MissionType.MISSION]
        item: MissionItem | None = items[self.vehicle.current_item] if self.vehicle.current_item < len(items) else None
        if item is None or item.command == mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
            self._lands_at(self._home, for_s)
            return
        place = (item.longitude_e7 / 1e7, item.latitude_e7 / 1e7)
        if item.command == mavlink.MAV_CMD_NAV_LAND:
            self._lands_at(place, for_s)
        elif item.frame == mavlink.MAV_FRAME_MISSION or (self._goes_to(place, item.altitude_m, for_s) and self._has_stayed(item, for_s)):
            self._held_s = 0.0
            self._reached.append(self.vehicle.current_item)
            self.vehicle.current_item += 1

    def _has_stayed(self, item: MissionItem, for_s: float) -> bool:
        """As long as the item says, for what is done there."""
        self._held_s += for_s
        return item.command not in STAYS or self._held_s >= item.parameters[0]

    def _lands_at(self, place: tuple[float, float], for_s: float) -> None:
        if self._goes_to(place, self.relative_m, for_s) and self._goes_to(place, 0.0, for_s):
            self.vehicle.is_in_air = self.vehicle.is_armed = False

    def _goes_to(self, place: tuple[float, float], relative_m: float, for_s: float) -> bool:
        """Whether it is there."""
        climb_m = max(-SINK_MPS * for_s, min(CLIMB_MPS * for_s, relative_m - self.relative_m))
        self.relative_m += climb_m
        shrink = math.cos(math.radians(self.at[1]))
        east_m, north_m = (place[0] - self.at[0]) * METRES_A_DEGREE * shrink, (place[1] - self.at[1]) * METRES_A_DEGREE
        away_m = math.hypot(east_m, north_m)
        step_m = min(self.speed_mps * for_s, away_m)
        if away_m > NEAR_M and for_s > 0:
            share = step_m / away_m
            self.at = (self.at[0] + (place[0] - self.at[0]) * share, self.at[1] + (place[1] - self.at[1]) * share)
            self._velocity_mps = (self.speed_mps * east_m / away_m, self.speed_mps * north_m / away_m)
        return away_m - step_m <= NEAR_M and abs(relative_m - self.relative_m) < NEAR_M
