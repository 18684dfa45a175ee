"""A scripted vehicle that behaves as the ArduCopter 4.6.0-dev that was observed in its simulator (and as its sources say).

No upload is atomic: an announcement cuts the list that is there, each item replaces the one in its place at once, and a refused or
abandoned upload leaves what it has.
"""

import math
import struct
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_plan import MissionItem, MissionType
from tests.telemetry.vehicles.vehicle import GROUND, Vehicle, item_int, item_of

REQUEST_S, GIVE_UP_S = 1.0, 8.0
MAX_ITEMS = 650
AUTO, GUIDED, STABILIZE, RTL, LAND, BRAKE = 3, 4, 0, 6, 9, 17
NOT_ARMABLE = frozenset({AUTO, RTL, LAND, BRAKE})
DISARMS_AFTER_S = 10.0
MAX_ALTITUDE_M = 83_000.0
HOME = MissionItem(16, mavlink.MAV_FRAME_GLOBAL, (0.0, 0.0, 0.0, 0.0), 98000100, 554000100, 20.0)
FRAMES = {0: 0, 2: 0, 3: 3, 5: 0, 6: 3, 10: 10, 11: 10}
PLACED = frozenset({16, 17, 18, 19, 21, 22, 31, 82, 195, 201})
KNOWN = PLACED | {20, 93, 112, 114, 115, 177, 178, 181, 183, 197, 203, 206, 2000, 2001}
KNOWN_SINCE = {195: (4, 7, 0), 197: (4, 7, 0), 2000: (4, 4, 0), 2001: (4, 4, 0)}  # as mission items
INTEGERS = {16: 1, 19: 1, 21: 1, 22: 1, 195: 1, 197: 1, 201: 1}  # how many parameters are kept, as whole numbers


def float32(value: float) -> float:
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


@dataclass
class ArduPilot(Vehicle):
    refuses: dict[int, int] = field(default_factory=dict)  # number of a mission item: the result it is refused with
    has_fence: bool = True  # else fence and rally points are answered by 0 items
    received_items: int = 0
    firmware: tuple[int, int, int] | None = (4, 6, 0)
    parameters: dict[str, float] = field(default_factory=lambda: {"MIS_RESTART": 0.0, "FENCE_ENABLE": 0.0})
    item_after_landing: int = 1  # 0 in other builds
    landed_reported_after_s: float = 1.0  # its messages of the touch-down come at 1 Hz each, in any order
    autopilot = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    upload_kind: MissionType | None = None
    _at: int = 0
    _count: int = 0
    _asked_s: float = 0.0
    _got_s: float = 0.0
    _armed_s: float = 0.0
    _now_s: float = 0.0
    _touched_down_s: float = -math.inf

    def __post_init__(self) -> None:
        self.lists[MissionType.MISSION] = [HOME]

    def receive(self, message: Any, now_s: float) -> list[Any]:
        self._now_s = now_s
        return super().receive(message, now_s)

    def _mission_count(self, message: Any, now_s: float) -> list[Any]:
        kind = MissionType(message.mission_type)
        if not self._has(kind):
            return [self._ack(mavlink.MAV_MISSION_UNSUPPORTED, kind)]
        if message.count > MAX_ITEMS:
            return [self._ack(mavlink.MAV_MISSION_NO_SPACE, kind)]
        del self.lists[kind][max(message.count, 1 if kind is MissionType.MISSION else 0) :]
        if not message.count:
            self.upload_kind = None
            return [self._ack(mavlink.MAV_MISSION_ACCEPTED, kind)]
        self.upload_kind, self._at, self._count, self._got_s = kind, 0, message.count, now_s
        return self._request(now_s)

    def _mission_item_int(self, message: Any, now_s: float) -> list[Any]:
        kind = MissionType(message.mission_type)
        if self.upload_kind is not kind:
            return [self._ack(mavlink.MAV_MISSION_ERROR, kind)]
        if message.seq != self._at:
            return [self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE, kind)]
        self.received_items += 1
        item = item_of(message)
        result = self._checked(item, kind)
        if kind is MissionType.MISSION:
            result = self.refuses.get(message.seq, result)
        if result != mavlink.MAV_MISSION_ACCEPTED:
            self.upload_kind = None
            return [self._ack(result, kind)]
        if not (kind is MissionType.MISSION and message.seq == 0):
            self.lists[kind][message.seq : message.seq + 1] = [item]
        self._at, self._got_s = self._at + 1, now_s
        if self._at < self._count:
            return self._request(now_s)
        self.upload_kind = None
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED, kind)]

    def _checked(self, item: MissionItem, kind: MissionType) -> int:
        if kind is not MissionType.MISSION:
            return int(mavlink.MAV_MISSION_ACCEPTED)
        firmware = self.firmware or (0, 0, 0)
        if item.command not in KNOWN or firmware < KNOWN_SINCE.get(item.command, firmware):
            return int(mavlink.MAV_MISSION_UNSUPPORTED)
        if math.isnan(item.parameters[0]):
            return int(mavlink.MAV_MISSION_INVALID_PARAM1)
        if math.isinf(item.parameters[1]):
            return int(mavlink.MAV_MISSION_INVALID_PARAM2)
        if item.command in PLACED:
            if abs(item.latitude_e7) > 900_000_000:
                return int(mavlink.MAV_MISSION_INVALID_PARAM5_X)
            if abs(item.longitude_e7) > 1_800_000_000:
                return int(mavlink.MAV_MISSION_INVALID_PARAM6_Y)
            if not abs(item.altitude_m) < MAX_ALTITUDE_M:
                return int(mavlink.MAV_MISSION_INVALID_PARAM7)
            if item.frame not in FRAMES:
                return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
        return int(mavlink.MAV_MISSION_ACCEPTED)

    def _request(self, now_s: float) -> list[Any]:
        self._asked_s = now_s
        assert self.upload_kind is not None
        return [mavlink.MAVLink_mission_request_message(*GROUND, self._at, self.upload_kind)]

    def _mission_request_list(self, message: Any, now_s: float) -> list[Any]:
        kind = MissionType(message.mission_type)
        if self.upload_kind is kind:
            return [self._ack(mavlink.MAV_MISSION_DENIED, kind)]
        return [mavlink.MAVLink_mission_count_message(*GROUND, len(self.lists[kind]), kind)]

    def _mission_request_int(self, message: Any, now_s: float) -> list[Any]:
        kind = MissionType(message.mission_type)
        if self.upload_kind is kind:
            return [self._ack(mavlink.MAV_MISSION_DENIED, kind)]
        if message.seq >= len(self.lists[kind]):
            count = mavlink.MAVLink_mission_count_message(*GROUND, len(self.lists[kind]), kind)
            return [count, self._ack(mavlink.MAV_MISSION_ERROR, kind)]
        return [self._as_read(self.lists[kind][message.seq], message.seq, kind)]

    def _mission_clear_all(self, message: Any, now_s: float) -> list[Any]:
        kind = MissionType(message.mission_type)
        if self.upload_kind is not None or (kind is MissionType.MISSION and self.is_armed and self.custom_mode == AUTO):
            return [self._ack(mavlink.MAV_MISSION_ERROR, kind)]
        del self.lists[kind][1 if kind is MissionType.MISSION else 0 :]
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED, kind)]

    def _has(self, kind: MissionType) -> bool:
        return self.has_fence or kind is MissionType.MISSION

    def _as_read(self, item: MissionItem, number: int, kind: MissionType) -> Any:
        one, two, three, four = (0.0 if math.isnan(value) else value for value in item.parameters)
        frame, altitude_m = FRAMES.get(item.frame, 0), 0.0
        if kind is MissionType.FENCE:
            return item_int(number, kind, item, (float(int(one)), 0.0, 0.0, 0.0), 0, 0.0, 0)
        if kind is MissionType.RALLY:
            return item_int(number, kind, item, (0.0, 0.0, 0.0, 0.0), 3, float(int(item.altitude_m)), 0)
        if item.command in PLACED:
            altitude_m = math.trunc(float32(float32(item.altitude_m) * 100.0)) / 100.0
        if item.command in INTEGERS:
            one, two, three, four = float(int(one) & 0xFFFF), 0.0, 0.0, 0.0
        if item.command == mavlink.MAV_CMD_NAV_LAND:
            four = 1.0
        elif item.command == mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
            one = two = three = four = 0.0
        elif item.command == mavlink.MAV_CMD_DO_CHANGE_SPEED:
            four = 0.0
        elif item.command == mavlink.MAV_CMD_IMAGE_START_CAPTURE:
            one, three, four = float(int(one)), float(int(three)), float(int(four))
        elif item.command == mavlink.MAV_CMD_NAV_LOITER_TIME:
            one, two, three, four = float(int(one)), 0.0, math.copysign(1.0, three), 0.0
        return item_int(number, kind, item, (one, two, three, four), frame, altitude_m)

    def _due(self, now_s: float) -> list[Any]:
        self._now_s = now_s
        if self.is_armed and not self.is_in_air and now_s >= self._armed_s + DISARMS_AFTER_S:
            self.is_armed = False
        if self.upload_kind is None:
            return []
        if now_s >= self._got_s + GIVE_UP_S:
            kind, self.upload_kind = self.upload_kind, None
            return [
                mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_WARNING, b"Mission upload timeout"),
                self._ack(mavlink.MAV_MISSION_OPERATION_CANCELLED, kind),
            ]
        return self._request(now_s) if now_s >= self._asked_s + REQUEST_S else []

    def _due_s(self) -> float | None:
        times = [self._armed_s + DISARMS_AFTER_S] if self.is_armed and not self.is_in_air else []
        if self.upload_kind is not None:
            times += [self._got_s + GIVE_UP_S, self._asked_s + REQUEST_S]
        return min(times, default=None)

    def says_in_air(self) -> bool:
        return self.is_in_air or self._now_s < self._touched_down_s + self.landed_reported_after_s

    def touch_down(self) -> None:
        """It disarms by itself, its list is at the beginning again, and no item of LAND is told as reached."""
        super().touch_down()
        self.current_item, self._touched_down_s = self.item_after_landing, self._now_s

    def reports(self) -> list[Any]:
        """Wind, too, which it neither measures nor estimates."""
        return [*super().reports(), mavlink.MAVLink_wind_message(-180.0, 0.0, 0.0)]

    def restart(self) -> None:
        self.is_alive = True
        self.upload_kind = None

    def carry_out(self, command: int, values: tuple[float, ...]) -> int:
        if command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
            if values[0] == 1 and self.custom_mode in NOT_ARMABLE and not self.is_armed:
                return int(mavlink.MAV_RESULT_FAILED)
            if values[0] != 1 and self.is_in_air:
                return int(mavlink.MAV_RESULT_FAILED)
            self.is_armed, self._armed_s = values[0] == 1, self._now_s
        elif command == mavlink.MAV_CMD_DO_SET_MODE:
            self.custom_mode = int(values[1])
        elif command == mavlink.MAV_CMD_MISSION_START:
            self.is_in_air = self.is_in_air or (self.is_armed and self.custom_mode == AUTO)  # yes, disarmed too, and nothing happens
        elif command == mavlink.MAV_CMD_NAV_TAKEOFF:
            if not self.is_armed or self.custom_mode != GUIDED:
                return int(mavlink.MAV_RESULT_FAILED)
            self.is_in_air = True
        elif command != mavlink.MAV_CMD_DO_CHANGE_SPEED:
            return int(mavlink.MAV_RESULT_UNSUPPORTED)
        return int(mavlink.MAV_RESULT_ACCEPTED)
