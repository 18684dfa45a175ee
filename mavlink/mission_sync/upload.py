"""Sends a list of items to a vehicle, which requests them one by one."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message, Messages
from mavlink.mission_sync.wire import ack_message, item_message, result_name
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionItem, MissionType

# Acknowledgements that do not decide the transfer: a duplicate message also causes them, or the vehicle is busy.
UNCERTAIN = frozenset({
    mavlink.MAV_MISSION_ERROR,
    mavlink.MAV_MISSION_DENIED,
    mavlink.MAV_MISSION_INVALID_SEQUENCE,
    mavlink.MAV_MISSION_OPERATION_CANCELLED,
})  # fmt: skip
REQUESTS = frozenset({"MISSION_REQUEST", "MISSION_REQUEST_INT"})


class TransferState(StrEnum):
    DONE = "done"
    REFUSED = "refused"  # by the vehicle, with a reason
    UNSURE = "unsure"  # all was sent; the last answer was inconclusive
    SILENT = "silent"
    CANCELLED = "cancelled"


@dataclass(frozen=True)
class TransferOutcome:
    """`code` is short and stable. `item` is the item at which the transfer ended, counted as on the wire."""

    state: TransferState
    code: str = ""
    item: int | None = None


class Clear:
    """Clears one list by MISSION_CLEAR_ALL, and asks a busy vehicle again. Only a readback confirms the result."""

    def __init__(self, kind: MissionType, addressing: Addressing, rules: TransferRules) -> None:
        self.kind = kind
        self.outcome: TransferOutcome | None = None
        self.wake_at_s: float | None = None
        self._addressing = addressing
        self._rules = rules
        self._begun_s = 0.0
        self._refused: int | None = None

    def start(self, now_s: float) -> Messages:
        self._begun_s = now_s
        return self._asked(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if self.outcome is not None or not self._addressing.has_sent(message) or message.get_type() != "MISSION_ACK":
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
        return [mavlink.MAVLink_mission_clear_all_message(self._addressing.system, self._addressing.component, int(self.kind))]

    def _end(self, state: TransferState, code: str) -> Messages:
        self.outcome, self.wake_at_s = TransferOutcome(state, code), None
        return []


class ListUpload:
    """A list being sent to a vehicle; an empty one clears the vehicle's list.

    Each requested item is sent, also repeatedly or out of order. If the vehicle is silent, the item requested last is sent again. After
    INVALID_SEQUENCE (the vehicle has that item, its next request was lost) the following item is sent as well. An acceptance counts only
    after the last item was sent, a definite refusal only without a request within `timeout_s`. ERROR and similar results are ambiguous: PX4
    sends it for a repeated MISSION_COUNT and continues, ArduPilot for an item after the end. The count is therefore sent again if silence
    follows. Even `done` has to be confirmed by a readback.
    """

    def __init__(self, items: Sequence[MissionItem], kind: MissionType, addressing: Addressing, rules: TransferRules) -> None:
        """items: as on the wire (see `sent_list`)."""
        self.items = tuple(items)
        self.kind = kind
        self.outcome: TransferOutcome | None = None
        self.wake_at_s: float | None = None
        self.items_done = 0  # highest number requested
        self._addressing = addressing
        self._rules = rules
        self._at: int | None = None  # the item requested last
        self._may_be_ahead = False
        self._has_sent_last = not self.items
        self._refused: tuple[int, float] | None = None  # result and time of the refusal
        self._restarts = 0
        self._begun_s = self._progress_s = 0.0

    def start(self, now_s: float) -> Messages:
        self._begun_s = self._progress_s = now_s
        return self._announced(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if not self._addressing.has_sent(message) or getattr(message, "mission_type", None) != self.kind:
            return []
        if message.get_type() in REQUESTS:
            return self._requested(message.seq, now_s)
        if self.outcome is None and message.get_type() == "MISSION_ACK":
            self._acknowledged(message.type, now_s)
        return []

    def tick(self, now_s: float) -> Messages:
        if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s:
            return []
        if self._refused is not None and now_s >= self._refused[1] + self._rules.timeout_s:
            return self._after_refusal(self._refused[0], now_s)
        if now_s >= self._progress_s + self._rules.silence_s:
            return self._end(TransferState.SILENT, "silent")
        if self._at is None:
            return self._announced(now_s)
        self._wait(now_s)
        if self._refused is not None and self._refused[0] not in UNCERTAIN:
            return []
        ahead = self._may_be_ahead and self._at + 1 < len(self.items)
        return [self._item(number) for number in ((self._at, self._at + 1) if ahead else (self._at,))]

    def cancel(self, now_s: float) -> Messages:
        """Cancel the upload. PX4 discards the received items; ArduPilot keeps them and waits 8 s for more."""
        if self.outcome is not None:
            return []
        self._end(TransferState.CANCELLED, "cancelled")
        return [ack_message(mavlink.MAV_MISSION_OPERATION_CANCELLED, self.kind, self._addressing)]

    def _requested(self, number: int, now_s: float) -> Messages:
        if number >= len(self.items):
            return []
        if self.outcome is None and now_s >= self._begun_s + self._rules.longest_s(len(self.items)):
            return self._end(TransferState.SILENT, "too-slow")
        if self.outcome is None:
            if number != self._at:
                self._at, self._progress_s, self._may_be_ahead = number, now_s, False
                self.items_done = max(self.items_done, number)
            self._refused = None
            self._wait(now_s)
        return [self._item(number)]

    def _acknowledged(self, result: int, now_s: float) -> None:
        if result == mavlink.MAV_MISSION_ACCEPTED:
            if self._has_sent_last:
                self.items_done = len(self.items)
                self._end(TransferState.DONE, "")
            elif self._at is not None and self._refused is None:  # it mistook a repeated, shorter count for this one
                self._refused = (mavlink.MAV_MISSION_ERROR, now_s)
        elif result == mavlink.MAV_MISSION_INVALID_SEQUENCE:
            self._may_be_ahead = True
        elif self._refused is None or self._refused[0] in UNCERTAIN:
            self._refused = (result, now_s)

    def _after_refusal(self, result: int, now_s: float) -> Messages:
        """Handle a refusal that no request followed."""
        if result not in UNCERTAIN:
            return self._end(TransferState.REFUSED, result_name(result))
        if self._at is not None and self._has_sent_last:
            return self._end(TransferState.UNSURE, result_name(result))
        self._restarts += 1
        if self._restarts > self._rules.retries:
            return self._end(TransferState.REFUSED, result_name(result))
        self._refused, self._at, self._may_be_ahead = None, None, False
        self._has_sent_last = not self.items
        self._progress_s = now_s
        return self._announced(now_s)

    def _announced(self, now_s: float) -> Messages:
        self._wait(now_s)
        return [mavlink.MAVLink_mission_count_message(self._addressing.system, self._addressing.component, len(self.items), int(self.kind))]

    def _item(self, number: int) -> Message:
        self._has_sent_last = self._has_sent_last or number == len(self.items) - 1
        return item_message(self.items[number], number, self.kind, self._addressing)

    def _wait(self, now_s: float) -> None:
        self.wake_at_s = now_s + (self._rules.timeout_s if self._at is None else self._rules.item_timeout_s)

    def _end(self, state: TransferState, code: str) -> Messages:
        self.outcome, self.wake_at_s = TransferOutcome(state, code, self._at), None
        return []
