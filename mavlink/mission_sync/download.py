"""Reads a list of items back from a vehicle."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message, Messages
from mavlink.mission_sync.upload import UNCERTAIN, TransferOutcome, TransferState
from mavlink.mission_sync.wire import OnboardItem, OnboardList, ack_message, onboard_item, result_name
from mavlink.timeouts import TransferRules
from mavlink.vehicle_plan import MissionType


class Download:
    """A list being read from a vehicle; complete in `read` once the outcome is `done`.

    PX4 aborts a transfer when an old request arrives late. The download then restarts, and each request waits for `item_timeout_s`, so that
    late messages arrive first. ArduPilot needs no restart: it answers requests in any order.
    """

    def __init__(self, kind: MissionType, addressing: Addressing, rules: TransferRules) -> None:
        self.kind = kind
        self.outcome: TransferOutcome | None = None
        self.wake_at_s: float | None = None
        self.read: OnboardList = ()
        self._addressing = addressing
        self._rules = rules
        self._count: int | None = None
        self._counted_before: int | None = None
        self._items: list[OnboardItem] = []
        self._is_paced = self._is_pausing = False
        self._refused: tuple[int, float] | None = None
        self._restarts = 0
        self._progress_s = self._asked_anew_s = 0.0

    @property
    def items_done(self) -> int:
        return len(self._items)

    def start(self, now_s: float) -> Messages:
        self._progress_s = now_s
        return self._asked(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if self.outcome is not None or not self._addressing.has_sent(message) or getattr(message, "mission_type", None) != self.kind:
            return []
        name = message.get_type()
        if name == "MISSION_COUNT":
            return self._counted(message.count, now_s)
        if name == "MISSION_ITEM_INT" and self._count is not None and message.seq == len(self._items):
            return self._got(onboard_item(message), now_s)
        if name == "MISSION_ACK" and message.type != mavlink.MAV_MISSION_ACCEPTED:
            return self._note_refusal(message.type, now_s)
        return []

    def tick(self, now_s: float) -> Messages:
        if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s:
            return []
        if self._refused is not None and now_s >= self._refused[1] + self._rules.timeout_s:
            return self._end(TransferState.REFUSED, result_name(self._refused[0]))
        if now_s >= self._progress_s + self._rules.silence_s:
            return self._end(TransferState.SILENT, "silent")
        if self._count is None or now_s >= max(self._progress_s, self._asked_anew_s) + self._rules.restart_s:
            self._count = None
            return self._asked(now_s)
        return self._request(now_s)

    def cancel(self, now_s: float) -> Messages:
        if self.outcome is not None:
            return []
        self._end(TransferState.CANCELLED, "cancelled")
        return [ack_message(mavlink.MAV_MISSION_OPERATION_CANCELLED, self.kind, self._addressing)]

    def _counted(self, count: int, now_s: float) -> Messages:
        if self._count is not None:
            return []
        self._refused = None
        self._count, self._progress_s = count, now_s
        if count != self._counted_before:
            self._items = []
        self._counted_before = count
        return self._next(now_s)

    def _got(self, item: OnboardItem, now_s: float) -> Messages:
        self._refused = None
        self._items.append(item)
        self._progress_s = now_s
        return self._next(now_s)

    def _next(self, now_s: float) -> Messages:
        if len(self._items) == self._count:
            self.read = tuple(self._items)
            self._end(TransferState.DONE, "")
            return [ack_message(mavlink.MAV_MISSION_ACCEPTED, self.kind, self._addressing)]
        if self._is_paced and not self._is_pausing:
            self._is_pausing, self.wake_at_s = True, now_s + self._rules.item_timeout_s
            return []
        return self._request(now_s)

    def _note_refusal(self, result: int, now_s: float) -> Messages:
        if result not in UNCERTAIN:
            self._refused = self._refused or (result, now_s)
            self.wake_at_s = now_s + self._rules.timeout_s
            return []
        if self._count is None:
            return []  # busy: the next tick asks again
        self._restarts += 1
        if self._restarts > self._rules.retries * self._rules.attempts:
            return self._end(TransferState.REFUSED, result_name(result))
        self._count, self._items, self._is_paced, self._progress_s = None, [], True, now_s
        return self._asked(now_s)

    def _asked(self, now_s: float) -> Messages:
        self._asked_anew_s = now_s
        self._is_pausing = False
        self.wake_at_s = now_s + self._rules.timeout_s
        return [mavlink.MAVLink_mission_request_list_message(self._addressing.system, self._addressing.component, int(self.kind))]

    def _request(self, now_s: float) -> Messages:
        self._is_pausing = False
        self.wake_at_s = now_s + self._rules.item_timeout_s
        return [
            mavlink.MAVLink_mission_request_int_message(
                self._addressing.system, self._addressing.component, len(self._items), int(self.kind)
            )
        ]

    def _end(self, state: TransferState, code: str) -> Messages:
        self.outcome, self.wake_at_s = TransferOutcome(state, code, len(self._items)), None
        return []
