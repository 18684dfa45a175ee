"""Taking a list off a vehicle."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Ends, Message, Messages
from mavlink.mission_sync.transfer import UNCERTAIN, TransferOutcome, TransferState
from mavlink.mission_sync.wire import result_name
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionType


class Clear:
    """MISSION_CLEAR_ALL of one list. A vehicle that is busy is asked again; read the list back to know."""

    def __init__(self, kind: MissionType, ends: Ends, rules: TransferRules) -> None:
        self.kind = kind
        self.outcome: TransferOutcome | None = None
        self.wake_at_s: float | None = None
        self._ends = ends
        self._rules = rules
        self._begun_s = 0.0
        self._refused: int | None = None

    def start(self, now_s: float) -> Messages:
        self._begun_s = now_s
        return self._asked(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if self.outcome is not None or not self._ends.has_sent(message) or message.get_type() != "MISSION_ACK":
            return []
        if message.mission_type == self.kind:
            if message.type == mavlink.MAV_MISSION_ACCEPTED:
                self._end(TransferState.DONE, "")
            elif message.type in UNCERTAIN:
                self._refused = message.type
            else:
                self._end(TransferState.REFUSED, result_name(message.type))
        return []

    def tick(self, now_s: float) -> Messages:
        if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s:
            return []
        if now_s < self._begun_s + self._rules.silence_s:
            return self._asked(now_s)
        if self._refused is None:
            return self._end(TransferState.SILENT, "silent")
        return self._end(TransferState.REFUSED, result_name(self._refused))

    def _asked(self, now_s: float) -> Messages:
        self.wake_at_s = now_s + self._rules.timeout_s
        return [mavlink.MAVLink_mission_clear_all_message(self._ends.system, self._ends.component, int(self.kind))]

    def _end(self, state: TransferState, code: str) -> Messages:
        self.outcome, self.wake_at_s = TransferOutcome(state, code), None
        return []
