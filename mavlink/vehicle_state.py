"""State of a vehicle as its messages report it."""

import math
import struct
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.addressing import AUTOPILOT, Message
from mavlink.autopilot_type import COMMANDED, COPTER_HOLDING, AutopilotType, Mode, autopilot_type_of, is_in_mode, mode_name
from mavlink.timeouts import CommandRules
from mavlink.vehicle_class import VehicleClass, class_of

TEXTS_KEPT = 10
MAX_PARAMETERS = 4_000  # more than any autopilot has
WHOLE_TYPES = frozenset({
    mavlink.MAV_PARAM_TYPE_INT8, mavlink.MAV_PARAM_TYPE_UINT8, mavlink.MAV_PARAM_TYPE_INT16, mavlink.MAV_PARAM_TYPE_UINT16,
    mavlink.MAV_PARAM_TYPE_INT32, mavlink.MAV_PARAM_TYPE_UINT32,
})  # fmt: skip
BATTERY_STATES = {1: "ok", 2: "low", 3: "critical", 4: "emergency", 5: "failed", 6: "unhealthy", 7: "charging"}  # MAV_BATTERY_CHARGE_STATE
IN_AIR = frozenset({mavlink.MAV_LANDED_STATE_IN_AIR, mavlink.MAV_LANDED_STATE_TAKEOFF, mavlink.MAV_LANDED_STATE_LANDING})


@dataclass
class VehicleState:
    """The state of one system, updated by `receive` with each message. None: not reported. Times are those of `receive`.

    `mission_item` counts as the vehicle does: item 0 is home on ArduPilot. A landed state older than `fresh_s` is unknown, so that a lost
    message at take-off does not keep a UAV on the ground.
    """

    system: int
    fresh_s: float = CommandRules.fresh_s
    autopilot_type: AutopilotType | None = None
    vehicle_type: int | None = None
    custom_mode: int | None = None
    system_status: int | None = None
    battery_state: str = ""
    is_armed: bool | None = None
    landed_state: int | None = None
    position: LonLat | None = None
    position_at_s: float | None = None
    altitude_amsl_m: float | None = None
    altitude_relative_m: float | None = None
    home: LonLat | None = None
    home_amsl_m: float | None = None
    home_at_s: float | None = None
    mission_item: int | None = None
    mission_item_at_s: float | None = None
    mission_total: int | None = None
    mission_state: int | None = None
    reached_item: int | None = None
    capabilities: int | None = None
    firmware: tuple[int, int, int] | None = None
    is_ready_to_arm: bool | None = None
    received_at_s: float | None = None
    heartbeat_at_s: float | None = None
    landed_at_s: float | None = None
    parameters: dict[str, float] = field(default_factory=dict)
    parameters_at_s: dict[str, float] = field(default_factory=dict)
    texts: list[tuple[float, int, str]] = field(default_factory=list)

    def receive(self, message: Message, now_s: float) -> None:
        if message.get_srcSystem() != self.system or message.get_srcComponent() != AUTOPILOT:
            return
        self.received_at_s = now_s
        taken = _TAKES.get(message.get_type())
        if taken is not None:
            taken(self, message, now_s)

    @property
    def mode(self) -> str:
        """Return the autopilot's name of its mode; empty before the first heartbeat."""
        return (
            ""
            if self.autopilot_type is None or self.custom_mode is None
            else mode_name(self.autopilot_type, self.custom_mode, self.vehicle_class)
        )

    @property
    def vehicle_class(self) -> VehicleClass:
        return class_of(self.vehicle_type)

    @property
    def can_be_stopped(self) -> bool:
        """Return whether the modes for hold, return and land are known."""
        if self.autopilot_type is AutopilotType.ARDUPILOT:
            return self.vehicle_class is VehicleClass.COPTER
        return self.autopilot_type in COMMANDED

    def is_in(self, mode: Mode) -> bool:
        if self.autopilot_type is None or self.custom_mode is None:
            return False
        return is_in_mode(self.autopilot_type, self.custom_mode, mode, self.vehicle_class)

    @property
    def is_in_air(self) -> bool | None:
        """Return whether it flies: by its landed state, else, on ArduPilot, by its heartbeat; None if unknown."""
        if self._knows_landed_state:
            return self.landed_state in IN_AIR
        if self.autopilot_type is AutopilotType.ARDUPILOT and self.system_status is not None:
            return bool(self.is_armed) and self.system_status in (mavlink.MAV_STATE_ACTIVE, mavlink.MAV_STATE_CRITICAL)
        return None

    @property
    def _knows_landed_state(self) -> bool:
        if self.landed_at_s is None or self.received_at_s is None or self.landed_state == mavlink.MAV_LANDED_STATE_UNDEFINED:
            return False
        return self.received_at_s - self.landed_at_s <= self.fresh_s

    @property
    def is_held(self) -> bool:
        """Return whether it flies no mission, armed or not, so that new items cannot change its course."""
        if self.autopilot_type is AutopilotType.ARDUPILOT:
            return self.custom_mode in COPTER_HOLDING
        return self.is_in(Mode.HOLD)

    def is_fresh(self, now_s: float, fresh_s: float) -> bool:
        return self.heartbeat_at_s is not None and now_s - self.heartbeat_at_s <= fresh_s

    def words_since(self, since_s: float) -> str:
        """Return the vehicle's status texts from then on, the newest last."""
        return "; ".join(text for at_s, _, text in self.texts if at_s >= since_s)


def _heartbeat(state: VehicleState, message: Message, now_s: float) -> None:
    if message.type == mavlink.MAV_TYPE_GCS or message.autopilot == mavlink.MAV_AUTOPILOT_INVALID:
        return
    state.autopilot_type = autopilot_type_of(message.autopilot)
    state.vehicle_type = message.type
    state.custom_mode = message.custom_mode
    state.system_status = message.system_status
    state.is_armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
    state.heartbeat_at_s = now_s


def _landed(state: VehicleState, message: Message, now_s: float) -> None:
    state.landed_state = message.landed_state
    state.landed_at_s = now_s


def _position(state: VehicleState, message: Message, now_s: float) -> None:
    state.position = LonLat(message.lon / 1e7, message.lat / 1e7)
    state.altitude_amsl_m = message.alt / 1000.0
    state.altitude_relative_m = message.relative_alt / 1000.0
    state.position_at_s = now_s


def _home(state: VehicleState, message: Message, now_s: float) -> None:
    state.home = LonLat(message.longitude / 1e7, message.latitude / 1e7)
    state.home_amsl_m = message.altitude / 1000.0
    state.home_at_s = now_s


def _mission_current(state: VehicleState, message: Message, now_s: float) -> None:
    state.mission_item, state.mission_item_at_s = message.seq, now_s
    total, mission_state = getattr(message, "total", 0), getattr(message, "mission_state", 0)
    state.mission_total = None if total in (0, 65535) and mission_state == 0 else total
    state.mission_state = mission_state or None


def _reached(state: VehicleState, message: Message, now_s: float) -> None:
    state.reached_item = message.seq


def _version(state: VehicleState, message: Message, now_s: float) -> None:
    state.capabilities = message.capabilities
    version = message.flight_sw_version
    state.firmware = (version >> 24 & 0xFF, version >> 16 & 0xFF, version >> 8 & 0xFF)


def _health(state: VehicleState, message: Message, now_s: float) -> None:
    check = mavlink.MAV_SYS_STATUS_PREARM_CHECK
    if message.onboard_control_sensors_present & check:
        state.is_ready_to_arm = bool(message.onboard_control_sensors_health & check)


def _battery(state: VehicleState, message: Message, now_s: float) -> None:
    """Store the state of the first battery; empty if not reported."""
    if message.id == 0:
        state.battery_state = BATTERY_STATES.get(getattr(message, "charge_state", 0), "")


def _parameter(state: VehicleState, message: Message, now_s: float) -> None:
    """Store a parameter. PX4 sends the bits of an integer in place of the float (MAVLink's "bytewise" encoding)."""
    value = float(message.param_value)
    if state.autopilot_type is AutopilotType.PX4 and message.param_type in WHOLE_TYPES:
        value = float(struct.unpack("<i", struct.pack("<f", value))[0])
    if math.isfinite(value) and (message.param_id in state.parameters or len(state.parameters) < MAX_PARAMETERS):
        state.parameters[message.param_id] = value
        state.parameters_at_s[message.param_id] = now_s


def _text(state: VehicleState, message: Message, now_s: float) -> None:
    state.texts.append((now_s, message.severity, message.text))
    del state.texts[:-TEXTS_KEPT]


_TAKES = {
    "HEARTBEAT": _heartbeat,
    "EXTENDED_SYS_STATE": _landed,
    "GLOBAL_POSITION_INT": _position,
    "HOME_POSITION": _home,
    "MISSION_CURRENT": _mission_current,
    "MISSION_ITEM_REACHED": _reached,
    "AUTOPILOT_VERSION": _version,
    "SYS_STATUS": _health,
    "BATTERY_STATUS": _battery,
    "PARAM_VALUE": _parameter,
    "STATUSTEXT": _text,
}
