"""What all scripted vehicles have in common: a system id, three lists, modes, arming, and messages that are due at some time."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.mission_sync.wire import OnboardItem, onboard_item
from mavlink.vehicle_plan import MissionItem, MissionType

GROUND = (255, mavlink.MAV_COMP_ID_MISSIONPLANNER)


@dataclass
class Vehicle:
    """Driven like a machine of the ground station: `receive`, `tick`, `wake_at_s`. Answers are messages for `GROUND`."""

    system: int = 7
    wake_at_s: float | None = None
    is_alive: bool = True
    lists: dict[MissionType, list[Any]] = field(default_factory=lambda: {kind: [] for kind in MissionType})
    custom_mode: int = 0
    is_armed: bool = False
    is_in_air: bool = False
    current_item: int = 0  # on ArduPilot item 0 is home
    knows_set_current: bool = True  # the command; else only the older message
    vehicle_type: int = mavlink.MAV_TYPE_QUADROTOR
    firmware: tuple[int, int, int] | None = None  # None: it does not tell its version
    heartbeats: bool = False
    deaf_commands: int = 0  # so many commands are answered by yes, and nothing is done
    is_mute: bool = False  # commands are carried out and never answered
    says: str = ""  # with every refusal
    parameters: dict[str, float] = field(default_factory=lambda: {"MIS_RESTART": 0.0})  # of others it says nothing
    parameters_kept: set[str] = field(default_factory=set)  # that it does not let be set
    denied: dict[int, int] = field(default_factory=dict)  # MAV_CMD: the result that is answered
    taken: list[tuple[int, tuple[float, ...]]] = field(default_factory=list)  # commands that were carried out
    _next_heartbeat_s: float = 0.0

    autopilot = mavlink.MAV_AUTOPILOT_GENERIC

    def receive(self, message: Any, now_s: float) -> list[Any]:
        if not self.is_alive or getattr(message, "target_system", self.system) not in (0, self.system):
            return []
        name = message.get_type()
        if name == "COMMAND_LONG":
            return self._command(message, now_s)
        handler: Callable[[Any, float], list[Any]] | None = getattr(self, f"_{name.lower()}", None)
        return [] if handler is None else handler(message, now_s)

    def tick(self, now_s: float) -> list[Any]:
        if not self.is_alive:
            self.wake_at_s = None
            return []
        messages = []
        if self.heartbeats and now_s >= self._next_heartbeat_s:
            self._next_heartbeat_s = now_s + 1.0
            messages += self.reports()
        messages += self._due(now_s)
        self._plan_wake()
        return messages

    def start(self, now_s: float) -> list[Any]:
        return self.tick(now_s)

    def restart(self) -> None:
        """Its lists are kept, what was under way is forgotten."""
        raise NotImplementedError

    def reports(self) -> list[Any]:
        base_mode = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | (mavlink.MAV_MODE_FLAG_SAFETY_ARMED if self.is_armed else 0)
        status = mavlink.MAV_STATE_ACTIVE if self.is_in_air else mavlink.MAV_STATE_STANDBY
        landed = mavlink.MAV_LANDED_STATE_IN_AIR if self.says_in_air() else mavlink.MAV_LANDED_STATE_ON_GROUND
        return [
            mavlink.MAVLink_heartbeat_message(self.vehicle_type, self.autopilot, base_mode, self.custom_mode, status, 3),
            mavlink.MAVLink_extended_sys_state_message(0, landed),
            mavlink.MAVLink_mission_current_message(self.current_item),
        ]

    def says_in_air(self) -> bool:
        """By EXTENDED_SYS_STATE."""
        return self.is_in_air

    def touch_down(self) -> None:
        """At the end of its mission."""
        self.is_armed = self.is_in_air = False

    def _plan_wake(self) -> None:
        times = [self._next_heartbeat_s] if self.heartbeats else []
        due_s = self._due_s()
        self.wake_at_s = min([*times, *([] if due_s is None else [due_s])], default=None)

    def _due(self, now_s: float) -> list[Any]:
        return []

    def _due_s(self) -> float | None:
        return None

    def _command(self, message: Any, now_s: float) -> list[Any]:
        def ack(result: int) -> Any:
            return mavlink.MAVLink_command_ack_message(message.command, result, 0, 0, *GROUND)

        if message.command == mavlink.MAV_CMD_REQUEST_MESSAGE and self.firmware is not None:
            return [ack(mavlink.MAV_RESULT_ACCEPTED), *self._version(int(message.param1))]
        if message.command in self.denied:
            words = mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_CRITICAL, self.says.encode())
            return [*([words] if self.says else []), ack(self.denied[message.command])]
        if self.deaf_commands:
            self.deaf_commands -= 1
            return [ack(mavlink.MAV_RESULT_ACCEPTED)]
        values = tuple(getattr(message, f"param{number}") for number in range(1, 8))
        if message.command == mavlink.MAV_CMD_DO_SET_MISSION_CURRENT:
            result = self._set_current(int(values[0])) if self.knows_set_current else int(mavlink.MAV_RESULT_UNSUPPORTED)
        else:
            result = self.carry_out(message.command, values)
        if result == mavlink.MAV_RESULT_ACCEPTED:
            self.taken.append((message.command, values))
        return [*([] if self.is_mute else [ack(result)]), *(self.reports() if self.heartbeats else [])]

    def _version(self, asked_for: int) -> list[Any]:
        if asked_for != mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION or self.firmware is None:
            return []
        major, minor, patch = self.firmware
        version = major << 24 | minor << 16 | patch << 8
        return [mavlink.MAVLink_autopilot_version_message(0, version, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)]

    def _mission_set_current(self, message: Any, now_s: float) -> list[Any]:
        self._set_current(message.seq)
        return self.reports()

    def _param_request_read(self, message: Any, now_s: float) -> list[Any]:
        if message.param_id not in self.parameters:
            return []
        value = self.parameters[message.param_id]
        return [mavlink.MAVLink_param_value_message(message.param_id.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32, 2, 0)]

    def _param_set(self, message: Any, now_s: float) -> list[Any]:
        if message.param_id not in self.parameters_kept:
            self.parameters[message.param_id] = message.param_value
        return self._param_request_read(message, now_s)

    def _set_current(self, item: int) -> int:
        if item >= len(self.lists[MissionType.MISSION]):
            return int(mavlink.MAV_RESULT_DENIED)
        self.current_item = item
        return int(mavlink.MAV_RESULT_ACCEPTED)

    def carry_out(self, command: int, values: tuple[float, ...]) -> int:
        return int(mavlink.MAV_RESULT_UNSUPPORTED)

    def held(self, kind: MissionType) -> list[OnboardItem]:
        """As it would be read."""
        return [onboard_item(self._as_read(item, number, kind)) for number, item in enumerate(self.lists[kind])]

    def _as_read(self, item: Any, number: int, kind: MissionType) -> Any:
        raise NotImplementedError

    def _ack(self, result: int, kind: int, to: Any = None) -> Any:
        ends = GROUND if to is None else (to.get_srcSystem(), to.get_srcComponent())
        return mavlink.MAVLink_mission_ack_message(*ends, result, kind)


def item_int(
    number: int, kind: int, item: MissionItem, parameters: tuple[float, ...], frame: int, altitude_m: float, autocontinue: int = 1
) -> Any:
    return mavlink.MAVLink_mission_item_int_message(
        *GROUND, number, frame, item.command, 0, autocontinue, *parameters, item.latitude_e7, item.longitude_e7, altitude_m, kind
    )


def item_of(message: Any) -> MissionItem:
    return onboard_item(message).item
