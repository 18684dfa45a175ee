"""Messages that a vehicle sends by itself, and their intervals by its own clock."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot

# Seconds of simulated time; needed by MAVSDK, MAVProxy and a gateway without a request.
INTERVALS_S = {
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 2.0,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 0.2,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 0.2,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 1.0,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 0.5,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: 0.5,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 0.5,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 1.0,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: 2.0,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS: 0.2,
}
WIND_INTERVAL_S = 2.0
WIND = {SimulatedAutopilot.PX4: mavlink.MAVLINK_MSG_ID_WIND_COV, SimulatedAutopilot.ARDUPILOT: mavlink.MAVLINK_MSG_ID_WIND}
MIN_DURATION_S = 0.04  # a step of the flight
MAX_DURATION_S = 3_600.0
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0  # its multiples are evenly distributed, however many there are


class Streams:
    """Intervals by message. `phase` (any number) spreads messages of one vehicle, and of many, over their intervals."""

    def __init__(self, autopilot_type: SimulatedAutopilot, phase: float = 0.0) -> None:
        self._usual = {**INTERVALS_S, WIND[autopilot_type]: WIND_INTERVAL_S}
        self._intervals_s: dict[int, float] = dict(self._usual)
        self._due_s = {
            message: interval_s * ((phase + place) * GOLDEN % 1.0) for place, (message, interval_s) in enumerate(self._usual.items())
        }
        self._next_s = -math.inf

    @property
    def intervals_s(self) -> Mapping[int, float]:
        return self._intervals_s

    def due(self, at_s: float) -> list[int]:
        """Return the messages to send at this simulated time. Missed ones are not sent later."""
        if at_s < self._next_s:
            return []
        found = [message for message, due_s in self._due_s.items() if due_s <= at_s]
        for message in found:
            following_s = self._due_s[message] + self._intervals_s[message]
            self._due_s[message] = following_s if following_s > at_s else at_s + self._intervals_s[message]
        self._next_s = min(self._due_s.values(), default=math.inf)
        return found

    def send_now(self, message: int) -> None:
        """Send the message at the next opportunity, if it has an interval."""
        if message in self._due_s:
            self._due_s[message] = self._next_s = -math.inf

    def set_interval(self, message: int, interval_us: float | None) -> bool:
        """Set an interval as in SET_MESSAGE_INTERVAL: negative is never, 0 the default. Returns False for None."""
        if interval_us is None:
            return False
        if interval_us < 0:
            self._intervals_s.pop(message, None)
            self._due_s.pop(message, None)
        else:
            interval_s = interval_us / 1e6 if interval_us else self._usual.get(message, 1.0)
            self._intervals_s[message] = min(max(interval_s, MIN_DURATION_S), MAX_DURATION_S)
            self._due_s[message] = -math.inf
        self._next_s = -math.inf
        return True

    def interval_us(self, message: int) -> int:
        """Return the interval as in MESSAGE_INTERVAL."""
        return round(self._intervals_s[message] * 1e6) if message in self._intervals_s else -1


AUTOPILOT, CAMERA, GIMBAL = int(mavlink.MAV_COMP_ID_AUTOPILOT1), int(mavlink.MAV_COMP_ID_CAMERA), int(mavlink.MAV_COMP_ID_GIMBAL)


@dataclass(frozen=True, slots=True)
class Station:
    """A component of another system, and its link: two stations may have the same ids."""

    system: int
    component: int
    link: int = 0

    @property
    def target(self) -> tuple[int, int]:
        """Return its system and component as a message target."""
        return (self.system, self.component)


@dataclass(frozen=True, slots=True)
class Outgoing:
    """A message to send. `to` is None for all stations; `component` sends it."""

    message: Message
    to: Station | None = None
    component: int = AUTOPILOT


def is_for(message: Any, system: int, component: int = AUTOPILOT) -> bool:
    """Return whether a message is for this system id: 0 addresses all, and a message without a target is for all."""
    return getattr(message, "target_system", 0) in (0, system) and getattr(message, "target_component", 0) in (0, component)
