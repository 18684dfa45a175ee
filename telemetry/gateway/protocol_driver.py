"""Runs a protocol state machine with a vehicle's messages and a clock until its outcome."""

import asyncio
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

from django.conf import settings

from mavlink.addressing import Addressing
from mavlink.autopilot_type import RESTARTS, AutopilotType
from mavlink.commands.message_requests import HomeReading
from mavlink.frames import Message
from mavlink.mission_sync.compare import differences
from mavlink.mission_sync.download import Download
from mavlink.mission_sync.upload import TransferState
from mavlink.mission_sync.wire import onboard_list, onboard_sha256
from mavlink.parameters import ParameterReading
from mavlink.reasons import list_reason
from mavlink.vehicle_plan import FlightLoad, MissionType
from operation.reasons import Reason
from telemetry.gateway.session import Session
from workspace.live.timed_waits import wait_for_event

MAX_NAP_S = 0.5
OTHER_LIST_READ = "other-list"  # code: the list was read and is not the approved one
READINGS = 2  # a difference counts after a second reading: the first may be a late answer


class StateMachine(Protocol):
    """A state machine of mavlink. Times are monotonic seconds."""

    @property
    def outcome(self) -> Any: ...

    @property
    def wake_at_s(self) -> float | None: ...

    def start(self, now_s: float) -> list[Message]: ...

    def receive(self, message: Message, now_s: float) -> list[Message]: ...

    def tick(self, now_s: float) -> list[Message]: ...


@dataclass
class ProtocolDriver:
    session: Session
    keeper: StateMachine
    is_wanted: Callable[[], bool]
    _received: asyncio.Event = field(default_factory=asyncio.Event)

    async def run(self, *, on_change: Callable[[], None]) -> Any:
        """Return the outcome; None once it is no longer wanted, which is checked before each send."""
        if not self.is_wanted():
            return None
        self.session.listeners.append(self._receive)
        try:
            self.session.send(self.keeper.start(time.monotonic()))
            while self.keeper.outcome is None:
                await self._wait()
                if not self.is_wanted():
                    return None
                now_s = time.monotonic()
                if self.keeper.outcome is None and self.keeper.wake_at_s is not None and self.keeper.wake_at_s <= now_s:
                    self.session.send(self.keeper.tick(now_s))
                on_change()
            return self.keeper.outcome
        finally:
            self.session.listeners.remove(self._receive)

    def _receive(self, message: Message, now_s: float) -> None:
        if self.keeper.outcome is None and self.is_wanted():
            self.session.send(self.keeper.receive(message, now_s))
        self._received.set()

    async def _wait(self) -> None:
        wake_at_s = self.keeper.wake_at_s
        nap_s = MAX_NAP_S if wake_at_s is None else min(max(wake_at_s - time.monotonic(), 0.0), MAX_NAP_S)
        if await wait_for_event(self._received, nap_s):
            self._received.clear()


@dataclass(frozen=True)
class OnboardReading:
    """Result of a readback. `code` and `why` are the reason if not `is_onboard`."""

    is_onboard: bool
    code: str = ""
    why: tuple[Reason, ...] = ()


def _notify(on_item: Callable[[int], None], before: int, done: int) -> None:
    on_item(before + done)


async def read_back(
    session: Session, load: FlightLoad, beside: Mapping[str, str], is_wanted: Callable[[], bool], on_item: Callable[[int], None]
) -> OnboardReading | None:
    """Read all lists and compare them with a load; None once it is no longer wanted. `on_item` receives the number of items read so far.

    `beside` has the hashes of the vehicle's own lists that were kept when the load was uploaded.
    """
    before = 0
    for kind in MissionType:
        for _ in range(READINGS):
            reading = await _read(session, load, kind, beside, is_wanted, partial(_notify, on_item, before))
            if reading is None or reading.is_onboard:
                break
        if reading is None or not reading.is_onboard:
            return reading
        before += len(load.of(kind))
    return OnboardReading(True)


async def ask_for_the_present(session: Session, is_wanted: Callable[[], bool]) -> None:
    """Request the home position, and for an ArduPilot in the air whether it would restart its mission. Unanswered values keep their age."""
    addressing, rules = Addressing(session.uav.system), settings.TRANSFER_RULES
    asked: list[StateMachine] = [HomeReading(session.state, addressing, rules)]
    if session.autopilot_type is AutopilotType.ARDUPILOT and session.state.is_in_air:
        session.state.parameters.pop(RESTARTS, None)
        asked.append(ParameterReading((RESTARTS,), session.state, addressing, rules))
    for keeper in asked:
        await ProtocolDriver(session, keeper, is_wanted).run(on_change=lambda: None)


async def _read(
    session: Session,
    load: FlightLoad,
    kind: MissionType,
    beside: Mapping[str, str],
    is_wanted: Callable[[], bool],
    on_item: Callable[[int], None],
) -> OnboardReading | None:
    download = Download(kind, Addressing(session.uav.system), settings.TRANSFER_RULES)
    most = len(load.of(kind))
    outcome = await ProtocolDriver(session, download, is_wanted).run(on_change=lambda: on_item(min(download.items_done, most)))
    if outcome is None:
        return None
    name = kind.name.lower()
    if outcome.code == "unsupported" and not load.of(kind):
        return OnboardReading(True)  # the vehicle has no such list
    if outcome.state is not TransferState.DONE:
        return OnboardReading(False, outcome.code, (Reason("list_not_read", {"list": list_reason(name)}),))
    autopilot_type = session.autopilot_type or AutopilotType.OTHER
    held = onboard_list(download.read, kind, autopilot_type)
    found = differences(load.of(kind), held, autopilot_type)
    if not found or (not load.of(kind) and beside.get(name) == onboard_sha256(held)):
        return OnboardReading(True)
    difference = Reason("item_is_otherwise", found[0].params)
    if len(found) > 1:
        difference = Reason("items_are_otherwise", {"first": difference, "more": len(found) - 1})
    return OnboardReading(False, OTHER_LIST_READ, (Reason("list_not_approved", {"list": list_reason(name), "difference": difference}),))
