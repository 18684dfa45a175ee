"""A scripted vehicle that keeps lists as PX4's mavlink_mission.cpp does: a new one replaces the old one whole, with its last item."""

import math
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import PX4_AUTO
from mavlink.vehicle_plan import MissionItem, MissionType
from tests.telemetry.vehicles.vehicle import GROUND, Vehicle, item_int, item_of

RETRY_S, GIVE_UP_S = 0.25, 5.0
MAX_ITEMS = {0: 2_000, 1: 64, 2: 32}
PLACED = frozenset({mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_INT,
                    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT})  # fmt: skip
PLACED_COMMANDS = frozenset({16, 17, 19, 21, 22, 31, 195, 5000, 5001, 5002, 5003, 5004, 5100})
PLACELESS_COMMANDS = frozenset({20, 93, 112, 114, 177, 178, 179, 189, 196, 197, 201, 203, 205, 206, 214, 530, 2000, 2001, 2500, 2501})
IDLE, GETTING, SENDING = "idle", "getting", "sending"
MISSION, HOLD, RETURN, LAND, TAKE_OFF = 4, 3, 5, 6, 2


@dataclass
class Px4(Vehicle):
    state: str = IDLE
    refuses: dict[int, int] = field(default_factory=dict)  # number of a mission item: the result it is refused with
    received_items: int = 0
    autopilot = mavlink.MAV_AUTOPILOT_PX4
    _kind: MissionType = MissionType.MISSION
    _at: int = 0
    _count: int = 0
    _new: list[MissionItem] = field(default_factory=list)
    _sent_s: float = 0.0
    _received_s: float = 0.0

    def _mission_count(self, message: Any, now_s: float) -> list[Any]:
        if self.state == SENDING:
            return [self._ack(mavlink.MAV_MISSION_ERROR, message.mission_type)]
        if self.state == GETTING and self._at > 0:
            return [self._ack(mavlink.MAV_MISSION_ERROR, self._kind)]
        if self.state == IDLE:
            if message.count > MAX_ITEMS.get(message.mission_type, 0):
                return [self._ack(mavlink.MAV_MISSION_NO_SPACE, message.mission_type)]
            self._kind = MissionType(message.mission_type)
            self._at, self._count, self._new = 0, message.count, []
            if not message.count:
                self.lists[self._kind] = []
                return [self._ack(mavlink.MAV_MISSION_ACCEPTED, self._kind)]
            self.state = GETTING
        self._received_s = now_s
        return self._request(now_s)

    def _mission_item_int(self, message: Any, now_s: float) -> list[Any]:
        if self.state == GETTING and message.mission_type != self._kind:
            return [self._ack(mavlink.MAV_MISSION_ERROR, self._kind)]
        if self.state == IDLE:
            again = message.mission_type == self._kind and self._at == message.seq + 1
            return [self._ack(mavlink.MAV_MISSION_ACCEPTED if again else mavlink.MAV_MISSION_ERROR, self._kind)]
        if self.state == SENDING:
            return [self._ack(mavlink.MAV_MISSION_ERROR, self._kind)]
        self._received_s = now_s
        if message.seq != self._at:
            return []
        self.received_items += 1
        refusal = self._checked(item_of(message))
        if self._kind is MissionType.MISSION:
            refusal = self.refuses.get(message.seq, refusal)
        if refusal != mavlink.MAV_MISSION_ACCEPTED:
            self.state = IDLE
            return [self._ack(refusal, self._kind)]
        self._new.append(item_of(message))
        self._at += 1
        if self._at < self._count:
            return self._request(now_s)
        self.state = IDLE
        self.lists[self._kind] = self._new
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED, self._kind)]

    def _checked(self, item: MissionItem) -> int:
        if item.frame in PLACED:
            return int(mavlink.MAV_MISSION_ACCEPTED if item.command in PLACED_COMMANDS else mavlink.MAV_MISSION_UNSUPPORTED)
        if item.frame == mavlink.MAV_FRAME_MISSION:
            return int(mavlink.MAV_MISSION_ACCEPTED if item.command in PLACELESS_COMMANDS else mavlink.MAV_MISSION_UNSUPPORTED)
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)

    def _request(self, now_s: float) -> list[Any]:
        self._sent_s = now_s
        return [mavlink.MAVLink_mission_request_int_message(*GROUND, self._at, self._kind)]

    def _mission_request_list(self, message: Any, now_s: float) -> list[Any]:
        if self.state == SENDING and self._at == len(self.lists[self._kind]):
            self.state = IDLE
        if self.state == GETTING or (self.state == SENDING and message.mission_type != self._kind):
            return []
        self.state, self._kind, self._at, self._received_s = SENDING, MissionType(message.mission_type), 0, now_s
        return [mavlink.MAVLink_mission_count_message(*GROUND, len(self.lists[self._kind]), self._kind)]

    def _mission_request_int(self, message: Any, now_s: float) -> list[Any]:
        if self.state != SENDING or message.mission_type != self._kind:
            return []
        self._received_s = now_s
        held = self.lists[self._kind]
        if message.seq == self._at and self._at < len(held):
            self._at += 1
        elif message.seq != self._at - 1:
            self.state = IDLE
            return [self._ack(mavlink.MAV_MISSION_ERROR, self._kind)]
        return [self._as_read(held[message.seq], message.seq, self._kind)]

    def _mission_ack(self, message: Any, now_s: float) -> list[Any]:
        if (self.state == SENDING and message.mission_type == self._kind) or (
            self.state == GETTING and message.type == mavlink.MAV_MISSION_OPERATION_CANCELLED
        ):
            self.state = IDLE
        return []

    def _mission_clear_all(self, message: Any, now_s: float) -> list[Any]:
        if self.state != IDLE:
            return []
        self._kind = MissionType(message.mission_type)
        self.lists[self._kind] = []
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED, self._kind)]

    def _as_read(self, item: MissionItem, number: int, kind: MissionType) -> Any:
        one, two, three, four = item.parameters
        frame = item.frame
        if item.frame != mavlink.MAV_FRAME_MISSION:
            is_relative = frame in (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
            frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT if is_relative else mavlink.MAV_FRAME_GLOBAL_INT
            yaw = four if math.isnan(four) else math.degrees(math.radians(four) % (2 * math.pi))
            if item.command == mavlink.MAV_CMD_NAV_WAYPOINT:
                three, four = 0.0, yaw
            elif item.command == mavlink.MAV_CMD_NAV_LAND:
                one, three, four = 0.0, 0.0, yaw
            elif item.command == mavlink.MAV_CMD_NAV_TAKEOFF:
                one, two, three, four = 0.0, 0.0, 0.0, yaw
            elif item.command in (5001, 5002, 5003, 5004):
                two = three = four = 0.0
            else:
                one = two = three = four = 0.0
        return item_int(number, kind, item, (one, two, three, four), frame, item.altitude_m)

    def _due(self, now_s: float) -> list[Any]:
        if self.state != IDLE and now_s >= self._received_s + GIVE_UP_S:
            self.state = IDLE
        if self.state == GETTING and now_s >= self._sent_s + RETRY_S:
            return self._request(now_s)
        return []

    def _due_s(self) -> float | None:
        if self.state == IDLE:
            return None
        give_up_s = self._received_s + GIVE_UP_S
        return min(give_up_s, self._sent_s + RETRY_S) if self.state == GETTING else give_up_s

    def restart(self) -> None:
        self.is_alive = True
        self.state = IDLE

    def carry_out(self, command: int, values: tuple[float, ...]) -> int:
        if command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
            if values[0] != 1 and self.is_in_air:
                return int(mavlink.MAV_RESULT_FAILED)
            self.is_armed = values[0] == 1
        elif command == mavlink.MAV_CMD_NAV_TAKEOFF:
            self._set(TAKE_OFF)
        elif command == mavlink.MAV_CMD_DO_SET_MODE:
            if values[2] == MISSION and not self.lists[MissionType.MISSION]:
                return int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
            self._set(int(values[2]))
        elif command != mavlink.MAV_CMD_DO_CHANGE_SPEED:
            return int(mavlink.MAV_RESULT_UNSUPPORTED)
        self.is_in_air = self.is_in_air or (self.is_armed and self.sub_mode in (TAKE_OFF, MISSION))
        return int(mavlink.MAV_RESULT_ACCEPTED)

    @property
    def sub_mode(self) -> int:
        return self.custom_mode >> 24

    def _set(self, sub_mode: int) -> None:
        self.custom_mode = PX4_AUTO << 16 | sub_mode << 24
