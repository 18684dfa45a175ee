"""Requests a vehicle's home position, which a boot or arming may have changed since it was reported."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message, Messages
from mavlink.timeouts import TransferRules
from mavlink.vehicle_state import VehicleState


class HomeReading:
    """Requests the home position until it arrives. `outcome` is whether it did. `state` must receive each message first."""

    def __init__(self, state: VehicleState, addressing: Addressing, rules: TransferRules) -> None:
        self.outcome: bool | None = None
        self.wake_at_s: float | None = None
        self._state = state
        self._addressing = addressing
        self._rules = rules
        self._tries = 0
        self._begun_s = 0.0

    def start(self, now_s: float) -> Messages:
        self._begun_s = now_s
        return self._asked(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if self.outcome is None and self._state.home_at_s is not None and self._state.home_at_s >= self._begun_s:
            self.outcome, self.wake_at_s = True, None
        return []

    def tick(self, now_s: float) -> Messages:
        return [] if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s else self._asked(now_s)

    def _asked(self, now_s: float) -> Messages:
        """Send the newer and the older command alternately, as some vehicles support only the older."""
        if self._tries > self._rules.retries:
            self.outcome, self.wake_at_s = False, None
            return []
        self._tries += 1
        self.wake_at_s = now_s + self._rules.timeout_s
        newer = (mavlink.MAV_CMD_REQUEST_MESSAGE, float(mavlink.MAVLINK_MSG_ID_HOME_POSITION))
        command, first = newer if self._tries % 2 else (mavlink.MAV_CMD_GET_HOME_POSITION, 0.0)
        return [
            mavlink.MAVLink_command_long_message(self._addressing.system, self._addressing.component, command, 0, first, 0, 0, 0, 0, 0, 0)
        ]
