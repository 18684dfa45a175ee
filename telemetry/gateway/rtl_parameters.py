"""The parameters by which a vehicle flies home by itself: asked for when it is first heard and before each flight, and told on."""

from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.frames import Message
from mavlink.parameters import BY_NAME
from mavlink.rtl import NAMES, PARAMETERS
from mavlink.vehicle_state import VehicleState

REQUEST_INTERVAL_S = 2.0
MAX_REQUESTS = 5  # a vehicle that has no such parameters says nothing


@dataclass(frozen=True)
class ReportedRtl:
    """`at_s` is when the last of them was heard, monotonic."""

    autopilot: str
    parameters: dict[str, float]
    at_s: float


@dataclass
class RtlReading:
    """Of one vehicle. Times are monotonic seconds."""

    _wanted_since_s: float = 0.0
    _asked_s: float = -REQUEST_INTERVAL_S
    _requests_left: int = MAX_REQUESTS
    _reported_s: float = 0.0

    def ask_anew(self, now_s: float) -> None:
        """Somebody may have set them since."""
        self._wanted_since_s, self._requests_left = now_s, MAX_REQUESTS

    def requests(self, state: VehicleState, now_s: float) -> list[Message]:
        """What is to be sent now: for what was not told since it was wanted."""
        groups = PARAMETERS.get(state.autopilot_type or "", ())
        if not groups or not self._requests_left or now_s - self._asked_s < REQUEST_INTERVAL_S:
            return []
        untold = [group for group in groups if all(state.parameters_at_s.get(name, -1.0) < self._wanted_since_s for name in group)]
        if not untold:
            return []
        self._asked_s = now_s
        self._requests_left -= 1
        names = [name for group in untold for name in group]
        return [mavlink.MAVLink_param_request_read_message(state.system, AUTOPILOT, name.encode(), BY_NAME) for name in names]

    def news(self, state: VehicleState) -> ReportedRtl | None:
        """What was told since `note` was called last, also without having been asked: all that is known."""
        autopilot_type = state.autopilot_type or ""
        last_message_s = {name: state.parameters_at_s[name] for name in NAMES.get(autopilot_type, ()) if name in state.parameters_at_s}
        if not last_message_s or max(last_message_s.values()) <= self._reported_s:
            return None
        return ReportedRtl(str(autopilot_type), {name: state.parameters[name] for name in last_message_s}, max(last_message_s.values()))

    def note(self, reported: ReportedRtl) -> None:
        self._reported_s = max(self._reported_s, reported.at_s)
