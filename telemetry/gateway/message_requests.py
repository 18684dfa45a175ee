"""Requests to one vehicle for messages that it does not send, and for data that is needed once."""

import math
from dataclasses import dataclass, field

from django.conf import settings
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.autopilot_type import AutopilotType
from mavlink.frames import Message
from mavlink.mission_sync.limits import PARAMETERS
from mavlink.parameters import BY_NAME
from mavlink.rtl import NAMES as RTL_PARAMETER_NAMES
from mavlink.rtl import PARAMETERS as RTL_PARAMETERS
from mavlink.vehicle_state import VehicleState
from telemetry.gateway import heartbeat

ASK_AGAIN_S = 5.0  # for missing positions; doubled each time for other messages and for data needed once
MISSING_INTERVALS = 3.0  # without a message after which it counts as missing
UNANSWERED_ROUNDS = 2  # of interval requests without a position, before streams are requested
ASK_SELDOM_S = 60.0
LISTENS_S = 10.0  # for another ground station, before streams that it may need are stopped
STATION_GONE_S = 60.0  # after its last heartbeat
LIMIT_REQUESTS = 3  # a vehicle without these parameters does not answer
RTL_REQUEST_INTERVAL_S = 2.0
MAX_RTL_REQUESTS = 5


@dataclass(frozen=True)
class ReportedRtl:
    """RTL parameters as reported. `at_s` is the receipt of the latest, monotonic."""

    autopilot: str
    parameters: dict[str, float]
    at_s: float


@dataclass
class RtlReading:
    """Reads the RTL parameters of a vehicle. Times are monotonic seconds."""

    _wanted_since_s: float = 0.0
    _asked_s: float = -RTL_REQUEST_INTERVAL_S
    _requests_left: int = MAX_RTL_REQUESTS
    _reported_s: float = 0.0

    def ask_anew(self, now_s: float) -> None:
        """Request the parameters again, as they may have changed."""
        self._wanted_since_s, self._requests_left = now_s, MAX_RTL_REQUESTS

    def requests(self, state: VehicleState, now_s: float) -> list[Message]:
        """Return the requests due now, for parameters not reported since they were wanted."""
        groups = RTL_PARAMETERS.get(state.autopilot_type or "", ())
        if not groups or not self._requests_left or now_s - self._asked_s < RTL_REQUEST_INTERVAL_S:
            return []
        missing = [group for group in groups if all(state.parameters_at_s.get(name, -1.0) < self._wanted_since_s for name in group)]
        if not missing:
            return []
        self._asked_s = now_s
        self._requests_left -= 1
        names = [name for group in missing for name in group]
        return [mavlink.MAVLink_param_request_read_message(state.system, AUTOPILOT, name.encode(), BY_NAME) for name in names]

    def news(self, state: VehicleState) -> ReportedRtl | None:
        """Return all known RTL parameters if any was reported since the last `note`, else None."""
        autopilot_type = state.autopilot_type or ""
        last_message_s = {
            name: state.parameters_at_s[name] for name in RTL_PARAMETER_NAMES.get(autopilot_type, ()) if name in state.parameters_at_s
        }
        if not last_message_s or max(last_message_s.values()) <= self._reported_s:
            return None
        return ReportedRtl(str(autopilot_type), {name: state.parameters[name] for name in last_message_s}, max(last_message_s.values()))

    def note(self, reported: ReportedRtl) -> None:
        self._reported_s = max(self._reported_s, reported.at_s)


@dataclass
class MessageRequests:
    """Requests of one vehicle. Times are monotonic seconds."""

    limits_left: int = LIMIT_REQUESTS
    rtl_reading: RtlReading = field(default_factory=RtlReading)
    _asked_s: float = -math.inf
    _ask_again_s: float = ASK_AGAIN_S
    _rounds: int = 0  # of interval requests since the last position
    _are_intervals_refused: bool = False
    _first_s: float | None = None  # of the first request
    _station_s: float = -math.inf  # last message of another ground station
    _are_streams_settled: bool = False  # stopped, or started for lack of intervals
    _received_s: dict[int, float] = field(default_factory=dict)  # by message id
    _once_requested_s: float = -math.inf
    _request_once_again_s: float = ASK_AGAIN_S

    def receive(self, message: Message, now_s: float) -> None:
        """Record a message of the autopilot."""
        self._received_s[message.get_msgId()] = now_s
        if message.get_type() == "COMMAND_ACK" and message.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            self._are_intervals_refused |= message.result == mavlink.MAV_RESULT_UNSUPPORTED

    def note_station(self, now_s: float) -> None:
        """Record a message of another ground station on the vehicle's channel."""
        self._station_s = now_s

    def due(self, state: VehicleState, now_s: float, *, has_position: bool) -> list[Message]:
        """Return the requests due now, for a vehicle that is received. `has_position`: its position is current."""
        if state.autopilot_type is None:
            return []
        wanted = self._telemetry(state.system, state.autopilot_type, now_s, has_position=has_position)
        wanted += self.rtl_reading.requests(state, now_s)
        once = self._once(state)
        if once and now_s - self._once_requested_s >= self._request_once_again_s:
            self._once_requested_s = now_s
            self._request_once_again_s = min(2 * self._request_once_again_s, ASK_SELDOM_S)
            self.limits_left -= self.may_ask_limits(state)
            wanted += once
        return wanted

    def _telemetry(self, system: int, autopilot_type: AutopilotType, now_s: float, *, has_position: bool) -> list[Message]:
        """Return interval requests for missing messages. Streams, with many unused messages, are a fallback for the position only."""
        if has_position:
            self._rounds = 0
        self._first_s = now_s if self._first_s is None else self._first_s
        if autopilot_type is AutopilotType.ARDUPILOT and has_position and self._may_stop_streams(now_s):
            self._are_streams_settled, self._asked_s = True, now_s
            asked = heartbeat.interval_requests(system, heartbeat.intervals_s(autopilot_type, settings.LINK_BUDGET_BYTES_S))
            return [heartbeat.streams(system, is_on=False), *asked]  # stopping streams ends intervals as well
        if now_s - self._asked_s < (self._ask_again_s if has_position else ASK_AGAIN_S):
            return []
        is_first = self._asked_s == -math.inf
        wanted_s = heartbeat.intervals_s(autopilot_type, settings.LINK_BUDGET_BYTES_S)
        missing_s = {number: every_s for number, every_s in wanted_s.items() if is_first or self._is_missing(number, every_s, now_s)}
        if not missing_s and has_position:
            return []
        self._asked_s = now_s
        self._ask_again_s = min(2 * self._ask_again_s, ASK_SELDOM_S)
        self._rounds += not has_position
        asked = heartbeat.interval_requests(system, missing_s)
        if autopilot_type is AutopilotType.PX4:
            return asked
        needs_streams = not has_position and (self._are_intervals_refused or self._rounds > UNANSWERED_ROUNDS)
        if needs_streams:
            self._are_streams_settled = True
            return [*asked, heartbeat.streams(system, is_on=True)]
        return asked

    def _may_stop_streams(self, now_s: float) -> bool:
        """Return whether no other ground station uses the channel's streams, as far as is known."""
        if self._are_streams_settled or self._are_intervals_refused or self._first_s is None:
            return False
        return now_s - self._first_s >= LISTENS_S and now_s - self._station_s >= STATION_GONE_S

    def _is_missing(self, number: int, every_s: float, now_s: float) -> bool:
        if number in heartbeat.OPTIONAL and number not in self._received_s:
            return False
        return now_s - self._received_s.get(number, -math.inf) > max(MISSING_INTERVALS * every_s, ASK_AGAIN_S)

    def may_ask_limits(self, state: VehicleState) -> bool:
        return (
            state.autopilot_type is AutopilotType.PX4 and self.limits_left > 0 and any(name not in state.parameters for name in PARAMETERS)
        )

    def _once(self, state: VehicleState) -> list[Message]:
        is_reported = state.firmware is not None and state.home is not None
        limits = heartbeat.limit_requests(state.system) if self.may_ask_limits(state) else []
        return [*([] if is_reported else heartbeat.onboard_info_requests(state.system)), *limits]
