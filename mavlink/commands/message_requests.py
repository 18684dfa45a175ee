"""Requests of messages: of a vehicle's home, which a boot or arming may have changed, and of photos whose message was lost."""

from dataclasses import dataclass, field

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT, Addressing, Message, Messages
from mavlink.timeouts import TransferRules
from mavlink.vehicle_state import VehicleState

MAX_GAP = 100  # indices; a larger step is a camera that counts anew
MAX_MISSING = 200
MAX_REQUESTS = 4  # of one photo
RETRY_DELAY_S = 2.0  # doubled with each request
MAX_AT_ONCE = 5


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


@dataclass
class _Missing:
    due_s: float
    requests: int = 0


@dataclass
class MissingPhotos:
    """The lost photos of one vehicle's cameras. Autopilots keep none of theirs. Times are monotonic seconds.

    A camera sends CAMERA_IMAGE_CAPTURED again for MAV_CMD_REQUEST_MESSAGE with the index as parameter 2 (MAVLink, camera protocol).
    """

    _next: dict[int, int] = field(default_factory=dict)  # index by component
    _missing: dict[tuple[int, int], _Missing] = field(default_factory=dict)

    def receive(self, message: Message, now_s: float) -> None:
        component = message.get_srcComponent()
        if message.get_type() != "CAMERA_IMAGE_CAPTURED" or component == AUTOPILOT or message.image_index < 0:
            return
        index, expected = message.image_index, self._next.get(component)
        if self._missing.pop((component, index), None) is not None:
            return
        self._next[component] = index + 1
        if expected is None:
            return
        if not 0 <= index - expected <= MAX_GAP:  # it counts anew
            self._missing = {which: one for which, one in self._missing.items() if which[0] != component}
            return
        for lost in range(expected, index):
            if len(self._missing) < MAX_MISSING:
                self._missing[component, lost] = _Missing(now_s + RETRY_DELAY_S)  # it may be out of order

    def requests(self, system: int, now_s: float) -> list[Message]:
        """Return the requests that are due."""
        due = [(which, one) for which, one in self._missing.items() if one.due_s <= now_s][:MAX_AT_ONCE]
        for which, one in due:
            one.requests += 1
            one.due_s = now_s + RETRY_DELAY_S * 2.0**one.requests
            if one.requests >= MAX_REQUESTS:
                del self._missing[which]
        captured = float(mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED)
        return [
            mavlink.MAVLink_command_long_message(
                system, component, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, captured, float(index), 0.0, 0.0, 0.0, 0.0, 0.0
            )
            for (component, index), _ in due
        ]
