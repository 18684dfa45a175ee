"""Brings the load of one flight onto one vehicle, completely or not at all."""

from collections.abc import Generator, Sequence
from typing import Any

from mavlink.addressing import Addressing, Message, Messages
from mavlink.autopilot_type import AutopilotType, Mode
from mavlink.mission_sync.compare import ItemDifference, ReadbackMatch, are_identical, differences, found, mix_of
from mavlink.mission_sync.download import Download
from mavlink.mission_sync.limits import too_many
from mavlink.mission_sync.outcome import Mix, SyncOutcome, SyncProgress, SyncState
from mavlink.mission_sync.supported_items import command_words, firmware_words, unknown_items
from mavlink.mission_sync.upload import REQUESTS, Clear, ListUpload, TransferOutcome, TransferState
from mavlink.mission_sync.wire import OnboardList, has_home, onboard_list, onboard_sha256, sent_list
from mavlink.reasons import list_reason
from mavlink.script import Course, Machine, Steps
from mavlink.timeouts import TransferRules
from mavlink.vehicle_class import VehicleClass, refusal_of
from mavlink.vehicle_plan import FlightLoad, MissionItem, MissionType
from mavlink.vehicle_state import VehicleState
from operation.reasons import Reason

ORDER = (MissionType.FENCE, MissionType.MISSION, MissionType.RALLY)  # never a new mission under an old fence
SENDING, READING, CLEARING, RESTORING = "sending", "reading", "clearing", "restoring"


class MissionSync:
    """Reads the vehicle's lists, sends those that differ, reads them back and compares.

    A failed list is restored or cleared, and read again. Ready means that all three lists were read back and match the approved ones. An
    armed vehicle receives lists only while it holds (see `VehicleState.is_held`): ArduPilot flies a new item at once, even from an upload
    that it then refuses, and PX4 flies a new mission from its first item. If the vehicle leaves its hold, `is_endangered` is whether to
    cancel.

    If the load has no fence or no rally points, lists from another sender stay on the vehicle, and those of `known` loads are cleared.

    After a failure, fence and rally points are restored. The mission is kept if it is unchanged and complete; otherwise it is cleared,
    because the vehicle would fly it. `mixes` lists each mixed readback at once, while the sync goes on.

    `known` are other loads approved for this vehicle, so that unknown lists are named from the beginning. Late and duplicate messages are
    harmless: the sync answers requests for a list during its whole lifetime, and a difference counts after a second reading.
    """

    def __init__(
        self, load: FlightLoad, state: VehicleState, addressing: Addressing, rules: TransferRules, *, known: Sequence[FlightLoad] = ()
    ) -> None:
        self.load = load
        self.mixes: list[Mix] = []
        self.before: dict[MissionType, OnboardList] = {}
        self.found_before: dict[MissionType, ReadbackMatch] = {}
        self._state = state
        self._addressing = addressing
        self._rules = rules
        self._known = tuple(known)
        self._now: dict[MissionType, OnboardList | None] = {}  # as last read; None: changed since
        self._sent: dict[MissionType, ListUpload] = {}
        self._touched: list[MissionType] = []
        self._reason = ""
        self._why: tuple[Reason, ...] = ()  # what the vehicle refused, or stores differently
        self._is_cancelled = self._is_restoring = False
        self._kind = MissionType.FENCE
        self._stage = READING
        self._steps = Steps(self._course())

    @property
    def outcome(self) -> SyncOutcome | None:
        return self._steps.outcome

    @property
    def wake_at_s(self) -> float | None:
        return self._steps.wake_at_s

    @property
    def progress(self) -> SyncProgress:
        """Return the progress of the current list."""
        total = len(self.load.of(self._kind))
        step = self._steps.step
        done = min(step.items_done, total) if isinstance(step, ListUpload | Download) else 0
        return SyncProgress(self._kind, RESTORING if self._is_restoring else self._stage, done, total)

    def start(self, now_s: float) -> Messages:
        return self._steps.start(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        answers = self._steps.receive(message, now_s)
        if message.get_type() in REQUESTS and not isinstance(self._steps.step, ListUpload):
            late = self._sent.get(MissionType(message.mission_type)) if message.mission_type in set(MissionType) else None
            answers += [] if late is None else late.receive(message, now_s)
        return answers

    def tick(self, now_s: float) -> Messages:
        return self._steps.tick(now_s)

    @property
    def is_endangered(self) -> bool:
        """Return whether the vehicle has left its hold, so that the sync is to be cancelled.

        A vehicle that flies its mission while it is being replaced receives the rest: half a list would be worse, and ArduPilot refuses to
        clear it then. PX4 keeps the old list until the new one is complete, so there the upload is cancelled.
        """
        state = self._state
        if not state.is_armed or state.is_held:
            return False
        if not state.is_in(Mode.MISSION) or MissionType.MISSION not in self._touched:
            return True
        return state.autopilot_type is AutopilotType.PX4 and isinstance(self._steps.step, ListUpload) and self._kind is MissionType.MISSION

    def cancel(self, now_s: float) -> Messages:
        """Cancel the sync as a failure: changed lists are restored or cleared."""
        if self.outcome is not None or self._is_restoring:
            return []
        self._is_cancelled, self._reason = True, "left-hold" if self.is_endangered else "cancelled"
        self._sent.clear()
        step = self._steps.step
        messages = step.cancel(now_s) if isinstance(step, ListUpload | Download) else []
        return messages + self._steps.go_on(now_s)

    # sequence

    def _course(self) -> Course[SyncOutcome]:
        refused = self._cannot_begin()
        if refused is not None:
            return refused
        for kind in ORDER:
            read = yield from self._read(kind)
            if read is None:
                return SyncOutcome(SyncState.INTACT, self._reason, (Reason("holdings_unreadable"),))
            self.before[kind] = read
            known = [load.of(kind) for load in self._known]
            self.found_before[kind] = found(read, self.load.of(kind), known, self._autopilot_type)
            if self.found_before[kind] is ReadbackMatch.MIXED:
                self._note_mix(kind, read)
        for kind in ORDER:
            if not (yield from self._bring(kind)) and not (yield from self._has_come_unseen(kind)):
                return (yield from self._give_up())
        items = len(self.load.mission)
        held = Reason("holds_approved", {"items": items}) if items else Reason("holds_no_mission")
        lists = {kind: onboard_sha256(self.before[kind]) for kind in ORDER if self._is_left_alone(kind)}
        sha256, mixes = self.load.content_sha256, tuple(self.mixes)
        return SyncOutcome(SyncState.READY, "", (held,), sha256, mixes=mixes, left_alone=self._left_alone(), left_sha256=lists)

    def _cannot_begin(self) -> SyncOutcome | None:
        state = self._state
        code, reason = "", None
        if state.autopilot_type is None:
            code, reason = "not-heard", Reason("vehicle_unknown")
        elif state.autopilot_type is AutopilotType.OTHER:
            code, reason = "autopilot", Reason("missions_to_known_autopilots")
        elif state.vehicle_class is not VehicleClass.COPTER:
            code, reason = "vehicle-class", refusal_of(state.vehicle_class)
        elif state.is_armed and not state.is_held:
            code, reason = "not-held", Reason("armed_not_held", {"mode": state.mode})
        else:
            limit = too_many(self.load, state.autopilot_type)
            unknown = unknown_items(self.load.mission, state.autopilot_type, state.firmware)
            if limit is not None:
                code, reason = limit.code, limit.reason
            elif unknown:
                autopilot, first = firmware_words(state.autopilot_type, state.firmware), unknown[0]
                params = {"autopilot": autopilot, "item": first.place, "command": command_words(first.item.command)}
                code, reason = "unknown-command", Reason("item_unknown", params)
        return None if reason is None else SyncOutcome(SyncState.INTACT, code, (Reason("nothing_sent"), reason))

    @property
    def _autopilot_type(self) -> AutopilotType:
        return self._state.autopilot_type or AutopilotType.OTHER

    def _bring(self, kind: MissionType) -> Generator[Machine, None, bool]:
        """Return whether the vehicle holds the approved list of this kind, after sending it if needed."""
        wanted = self.load.of(kind)
        if self._is_cancelled:
            return False
        if not differences(wanted, self.before[kind], self._autopilot_type) or self._is_left_alone(kind):
            return True
        self._touched.append(kind)
        self._reason = ""
        for _ in range(self._rules.attempts):
            state = yield from self._put(kind, wanted)
            if self._is_cancelled:
                return False
            held = yield from self._read(kind)
            if held is not None and self._differs(kind, held):
                held = yield from self._read(kind)  # the first reading may be a late answer
            if held is not None and not self._differs(kind, held):
                return True
            if held is not None:
                self._note_mix(kind, held)
                self._why = self._why if state is TransferState.REFUSED else self._difference_reasons(kind)
            if self._is_cancelled or state is TransferState.REFUSED:
                return False
            self._reason = self._reason or "differs"
        return False

    def _is_left_alone(self, kind: MissionType) -> bool:
        """Return whether the vehicle keeps an unknown fence or unknown rally points because the load has none."""
        if kind is MissionType.MISSION or self.load.of(kind):
            return False
        return self.found_before[kind] is ReadbackMatch.FOREIGN

    def _left_alone(self) -> tuple[Reason, ...]:
        names = {MissionType.FENCE: Reason("list_fence"), MissionType.RALLY: Reason("rally_points")}
        left = [kind for kind in ORDER if self._is_left_alone(kind)]
        return tuple(Reason("list_left_alone", {"list": names[kind], "count": len(self.before[kind])}) for kind in left)

    def _has_come_unseen(self, kind: MissionType) -> Generator[Machine, None, bool]:
        """Read once more if no reading succeeded after the last upload; return whether the list is there."""
        if self._is_cancelled or self._now.get(kind) is not None:
            return False
        held = yield from self._read(kind)
        return held is not None and not self._differs(kind, held)

    def _put(self, kind: MissionType, items: Sequence[MissionItem]) -> Generator[Machine, None, TransferState]:
        self._now[kind] = None
        self._kind, self._stage = kind, SENDING if items else CLEARING
        step: ListUpload | Clear
        if items:
            step = self._sent[kind] = ListUpload(
                sent_list(items, kind, self._autopilot_type, self._state.firmware), kind, self._addressing, self._rules
            )
        else:
            self._sent.pop(kind, None)
            step = Clear(kind, self._addressing, self._rules)
        yield step
        if isinstance(step, ListUpload) and not self._is_restoring:
            self._why = self._refusal_reasons(step)
        return self._ended(step.outcome)

    def _refusal_reasons(self, upload: ListUpload) -> tuple[Reason, ...]:
        """Return which item and command the firmware refused; empty if none."""
        ended: TransferOutcome | None = upload.outcome
        if ended is None or ended.state is not TransferState.REFUSED or ended.item is None:
            return ()
        params = {
            "autopilot": firmware_words(self._state.autopilot_type, self._state.firmware),
            "item": ended.item - has_home(upload.kind, self._autopilot_type),
            "list": _list(upload.kind),
            "command": command_words(upload.items[ended.item].command),
            "code": ended.code,
        }
        return (Reason("item_refused", params),)

    def _difference_reasons(self, kind: MissionType) -> tuple[Reason, ...]:
        found = self._differences(kind)
        first = [Reason("item_differs", {"list": _list(kind), **difference.params}) for difference in found[:1]]
        more = [Reason("more_differences", {"count": len(found) - 1})] if len(found) > 1 else []
        return (*first, *more)

    def _read(self, kind: MissionType) -> Generator[Machine, None, OnboardList | None]:
        """Read the list, with up to `attempts` attempts. A list that the vehicle does not support counts as empty."""
        self._kind, self._stage = kind, READING
        for _ in range(self._rules.attempts):
            if self._is_cancelled and not self._is_restoring:
                return None
            step = Download(kind, self._addressing, self._rules)
            yield step
            if step.outcome is not None and step.outcome.code == "unsupported":
                self._now[kind] = ()
                return ()
            if self._ended(step.outcome) is TransferState.DONE:
                self._now[kind] = onboard_list(step.read, kind, self._autopilot_type)
                return self._now[kind]
        return None

    def _ended(self, outcome: Any) -> TransferState:
        if outcome.state is not TransferState.DONE and not self._is_restoring and not self._is_cancelled:
            self._reason = outcome.code
        return TransferState(outcome.state)

    # failure

    def _give_up(self) -> Course[SyncOutcome]:
        self._is_restoring = True
        self._sent.clear()
        unread = []
        for kind in self._touched:
            held = yield from self._settle(kind)
            if held is None:
                unread.append(kind)
        return self._verdict(unread)

    def _settle(self, kind: MissionType) -> Generator[Machine, None, OnboardList | None]:
        """Restore a changed list, or clear it if it is the mission. Return what the vehicle holds then; None if unreadable."""
        held = yield from self._read(kind)
        if held is None or are_identical(held, self.before[kind]):
            return held
        self._note_mix(kind, held)
        back = () if kind is MissionType.MISSION else tuple(there.item for there in self.before[kind])
        for _ in range(self._rules.attempts):
            yield from self._put(kind, back)
            held = yield from self._read(kind)
            if held is not None and (not held if kind is MissionType.MISSION else are_identical(held, self.before[kind])):
                break
        return held

    def _verdict(self, unread: Sequence[MissionType]) -> SyncOutcome:
        kept = [kind for kind in self._touched if kind not in unread and are_identical(self._now[kind] or (), self.before[kind])]
        mixed = [
            kind
            for kind in self._touched
            if kind not in unread and kind not in kept and not (kind is MissionType.MISSION and not self._now[kind])
        ]
        reason, mixes = self._reason or "differs", tuple(self.mixes)
        if mixed:
            left = [self._left_reason(kind, self._now[kind] or ()) for kind in mixed]
            lost = [Reason("list_unreadable", {"list": _list(kind)}) for kind in unread]
            shown = self._differences(mixed[0])
            return SyncOutcome(SyncState.MIXED, reason, (*self._why, *left, *lost), "", True, mixes, shown)
        if unread:
            is_critical = self._autopilot_type is AutopilotType.ARDUPILOT
            may = Reason("part_of_each" if is_critical else "one_whole")
            silent = Reason("silent_while_sent", {"list": _list(unread[0]), "what": may})
            return SyncOutcome(SyncState.UNREAD, reason, (*self._why, silent, Reason("read_back_first")), "", is_critical, mixes)
        if MissionType.MISSION in self._touched and MissionType.MISSION not in kept:
            return SyncOutcome(SyncState.CLEARED, reason, (*self._why, Reason("mission_taken_off")), mixes=mixes)
        return SyncOutcome(SyncState.INTACT, reason, (*self._why, Reason("holds_what_before")), mixes=mixes)

    def _differs(self, kind: MissionType, held: OnboardList) -> bool:
        return bool(differences(self.load.of(kind), held, self._autopilot_type))

    def _differences(self, kind: MissionType) -> tuple[ItemDifference, ...]:
        return differences(self.load.of(kind), self._now[kind] or (), self._autopilot_type)

    def _note_mix(self, kind: MissionType, held: OnboardList) -> None:
        """Record a mixed list that was read during the replacement or before it."""
        if not held or not self._differs(kind, held) or (kind in self._touched and are_identical(held, self.before[kind])):
            return
        mix = Mix(kind, self._mix(kind, held))
        if mix not in self.mixes:
            self.mixes.append(mix)

    def _left_reason(self, kind: MissionType, held: OnboardList) -> Reason:
        if not held:
            return Reason("list_not_put_back", {"list": _list(kind)})
        return Reason("list_mixed", {"list": _list(kind), "mix": self._mix(kind, held)})

    def _mix(self, kind: MissionType, held: OnboardList) -> Reason:
        return mix_of(held, self.load.of(kind), self.before.get(kind), self._autopilot_type)


def _list(kind: MissionType) -> Reason:
    return list_reason(kind.name)
