"""Delivery of one command to one vehicle, and the updates of its row.

Updates are written as they happen. They stop once another gateway delivers the command or a later command replaces it. An upload in
progress is then undone, and the vehicle's lists are still reported.
"""

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from django.conf import settings
from django.utils import timezone

from mavlink.addressing import Addressing
from mavlink.autopilot_type import AutopilotType
from mavlink.commands.actions import Order, pause_s, unacknowledged_message
from mavlink.commands.command import CommandEnd, CommandOutcome
from mavlink.commands.driver import CommandDriver
from mavlink.mission_sync.limits import FIRST_LEG, PARAMETERS, LimitWarning, count_warnings, leg_warnings
from mavlink.mission_sync.outcome import SyncOutcome, SyncState
from mavlink.mission_sync.sync import MissionSync
from mavlink.parameters import ParameterReading, ParameterSetting
from mavlink.reasons import list_reason
from mavlink.rtl import fence_off_by, return_height_parameter
from mavlink.vehicle_plan import FlightLoad, MissionType
from missions.models import CommandKind, UavCommand
from missions.services.commands.commands import (
    is_wanted,
    note_acknowledged,
    note_applied,
    note_failed,
    note_progress,
    note_read_back,
    note_released,
    note_sent,
    note_sent_unacknowledged,
)
from operation.reasons import Reason
from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.gateway.preparation import (
    CannotCarry,
    DeliveryTask,
    as_begun,
    reason_not_to,
    reason_not_to_start,
    return_by_list,
    task_of,
)
from telemetry.gateway.protocol_driver import OTHER_LIST_READ, ProtocolDriver, ask_for_the_present, read_back
from telemetry.gateway.session import RECEIVED_WITHIN_S, Session
from telemetry.services.alerts.command_alerts import raise_mission_mismatch, raise_other_list
from telemetry.services.links.onboard_lists import Carried, LoadedLists, begin_loading, confirm_loaded, end_loading, fail_loading

RETRIES = 2  # a vehicle may not answer for a parameter that it does not have
ADVICE = {
    "far-first-waypoint": Reason("bring_to_start", {"parameter": FIRST_LEG}),
    "long-leg": Reason("approve_with_more_points"),
}
FENCE_PARAMETERS = ("FENCE_ENABLE", "FENCE_AUTOENABLE", "FENCE_TYPE")
POLL_INTERVAL_S = 0.25
logger = logging.getLogger(__name__)
PROGRESS_INTERVAL_S = 0.5
TRY_AGAIN_IN_S = 2.0
UNACKNOWLEDGED = frozenset({"silent", "too-slow", "not-heard"})  # link failures: retried while the command is wanted
NOT_YET = frozenset({"not-held", "not-heard", "left-hold"})  # the mission is cleared as soon as possible
CLEAR_AGAIN_IN_S = 15.0
MAX_ATTEMPTS = 100
UNSETTLED_S = 2.0  # an earlier message may arrive this late
DATABASE_RETRY_S = 0.5


async def reason_not_to_load(load: FlightLoad, session: Session, *, is_wanted: Callable[[], bool]) -> CannotCarry | None:
    """Return a refusal for legs that exceed the vehicle's limits, else None.

    The limits are requested if unknown, and again before a refusal, as they may have changed.
    """
    if session.autopilot_type is AutopilotType.ARDUPILOT and load.fence and FENCE_PARAMETERS[0] not in session.state.parameters:
        await _read(FENCE_PARAMETERS, session, is_wanted)  # for warnings_of
    if session.autopilot_type is not AutopilotType.PX4:
        return None
    if (
        not session.limits
        or session.message_requests.may_ask_limits(session.state)
        or leg_warnings(load, session.limits, session.state.position)
    ):
        session.message_requests.limits_left = 0
        await _read(PARAMETERS, session, is_wanted)
    refused = leg_warnings(load, session.limits, session.state.position)
    return _refusal(refused) if refused else None


async def _read(names: Sequence[str], session: Session, is_wanted: Callable[[], bool]) -> None:
    reading = ParameterReading(names, session.state, Addressing(session.uav.system), replace(settings.TRANSFER_RULES, retries=RETRIES))
    await ProtocolDriver(session, reading, is_wanted).run(on_change=lambda: None)


def warnings_of(load: FlightLoad, session: Session) -> tuple[Reason, ...]:
    """Return warnings for a load that is sent nevertheless; empty if nothing is known."""
    if session.autopilot_type is None:
        return ()
    warnings = [warning.reason for warning in count_warnings(load, session.autopilot_type)]
    if session.autopilot_type is AutopilotType.PX4 and not session.limits:
        warnings.append(Reason("limits_unknown"))
    off_by = fence_off_by(session.autopilot_type, session.state.parameters) if load.fence else ""
    if off_by:
        warnings.append(Reason("fence_does_nothing", {"parameter": off_by}))
    return tuple(warnings)


def _refusal(refused: tuple[LimitWarning, ...]) -> CannotCarry:
    first, others = refused[0], [warning for warning in refused[1:] if warning.code == "long-leg"]
    more = [Reason("more_long_legs", {"count": len(others)}) if len(others) > 1 else Reason("one_more_long_leg")] if others else []
    advice = [ADVICE[code] for code in dict.fromkeys(warning.code for warning in refused)]
    return CannotCarry(first.code, (Reason("would_not_fly"), first.reason, *more, *advice))


async def send_unacknowledged(
    order: Order, session: Session, may_send: Callable[[], bool], is_wanted: Callable[[], Awaitable[bool]]
) -> None:
    """Send a command repeatedly without an acknowledgement. `may_send` is checked before each message, `is_wanted` after it."""
    sent, next_s = 0, time.monotonic()
    while may_send() and session.state.autopilot_type is not None:
        if (now_s := time.monotonic()) >= next_s:
            session.commanded_s = now_s
            session.send([unacknowledged_message(order, session.state.autopilot_type, Addressing(session.uav.system), sent)])
            sent += 1
            next_s = now_s + pause_s(sent)
            if not await is_wanted():
                return
        await asyncio.sleep(POLL_INTERVAL_S)


@dataclass
class Delivery:
    """The delivery of one command.

    `is_dropped`: the row belongs to another gateway, or is to be released. `is_closing`: it is released because the process stops.
    `is_unacknowledged`: nothing is received from the vehicle.
    """

    command: UavCommand
    session: Session
    database: DatabaseThread
    held_until_s: float = 0.0  # monotonic; after it another gateway may deliver the command
    is_unacknowledged: bool = False
    is_dropped: bool = False
    is_closing: bool = False
    has_begun: bool = False
    has_ended: bool = False
    _notes: set[asyncio.Task[Any]] = field(default_factory=set)

    @property
    def carried(self) -> Carried:
        return Carried.of(self.command)

    @property
    def is_ours(self) -> bool:
        """Return whether this gateway surely holds the command, also during a database outage."""
        return not self.is_dropped and self.session.is_held and time.monotonic() < self.held_until_s

    async def run(self) -> None:
        try:
            if self.is_unacknowledged:
                await self._send_unacknowledged()
                return
            task = await self._surely(task_of, self.command)
            if isinstance(task, DeliveryTask):
                if task.take_off is not None:
                    self.session.message_requests.rtl_reading.ask_anew(time.monotonic())
                task = await self._reason_against(task) or await self._beyond_limits(task) or task
            if isinstance(task, DeliveryTask):
                task = as_begun(task, self.session.state)
            if isinstance(task, CannotCarry):
                await self._refuse(task)
            elif task.load is not None:
                await self._load(task)
            elif task.return_height_m is not None:
                await self._set_return_height(task.return_height_m)
            else:
                await self._order(task)
        except Exception:
            logger.exception(
                "the command %s of %s broke down", self.command.kind, self.session.uav.name, extra={"uav": self.session.uav.uav_id}
            )
            await self._end(note_failed, "internal", (Reason("gateway_failed"),))
        finally:
            await asyncio.gather(*self._notes, return_exceptions=True)

    async def _send_unacknowledged(self) -> None:
        """Send until the vehicle is received again, then release the command: its effect is then confirmed as for any command."""
        if await self._surely(note_sent_unacknowledged, self.command.pk, **self._fence):
            await send_unacknowledged(
                Order(self.command.kind),
                self.session,
                may_send=lambda: self.is_ours and not self.session.is_served(time.time(), RECEIVED_WITHIN_S),
                is_wanted=lambda: self._surely(is_wanted, self.command.pk, **self._fence),
            )
        await self._end(note_released)

    async def _refuse(self, reason: CannotCarry) -> None:
        if reason.is_for_good or self.command.attempts >= MAX_ATTEMPTS:
            await self._end(note_failed, reason.code, reason.why)
        else:
            await self._end(note_released, retry_in_s=TRY_AGAIN_IN_S, note=reason.why, code=reason.code)

    async def _reason_against(self, task: DeliveryTask) -> CannotCarry | None:
        if task.onboard is not None:
            await ask_for_the_present(self.session, lambda: self.is_ours)
        return reason_not_to(task, self.session.state, time.monotonic())

    async def _beyond_limits(self, task: DeliveryTask) -> CannotCarry | None:
        if task.load is None or not task.load.mission:
            return None
        return await reason_not_to_load(task.load, self.session, is_wanted=lambda: self.is_ours)

    async def _order(self, task: DeliveryTask) -> None:
        assert task.order is not None  # noqa: S101 - exactly one of the two is None
        order, parameters = task.order, task.parameters
        if task.onboard is not None and not await self._is_onboard(task.onboard, task.before):
            return
        too_near = await self._surely(reason_not_to_start, self.command) if self.command.kind == CommandKind.START else None
        if too_near is not None:  # another UAV has taken off during the readback
            await self._refuse(too_near)
            return
        if task.along is not None:
            found = await self._surely(return_by_list, task.along, self.session.state, time.monotonic(), timezone.now())
            if isinstance(found, CannotCarry):
                await self._refuse(found)
                return
            parameters = found
        if not await self._surely(note_sent, self.command.pk, **self._fence):
            await self._end(note_released)
            return
        keeper = CommandDriver(
            order, self.session.state, Addressing(self.session.uav.system), settings.VEHICLE_COMMAND_RULES,
            parameters=parameters, unsettled_until_s=self.session.unsettled_until_s(UNSETTLED_S),
        )  # fmt: skip
        reported = False

        def change() -> None:
            nonlocal reported
            self.session.commanded_s = time.monotonic()
            if keeper.is_acknowledged and not reported:
                reported = True
                self._note(note_acknowledged, self.command.pk, **self._fence)

        self.session.commanded_s = time.monotonic()
        outcome = await ProtocolDriver(self.session, keeper, lambda: self.is_ours).run(on_change=change)
        if isinstance(outcome, CommandOutcome):
            await self._send_order(outcome)
        else:
            await self._end(note_released)

    async def _set_return_height(self, height_m: float) -> None:
        """Set the vehicle's parameter for the return height, and read it back."""
        wanted = return_height_parameter(self.session.autopilot_type, self.session.state.parameters, height_m)
        if wanted is None:
            await self._refuse(CannotCarry("not-read", (Reason("return_height_unknown"),), is_for_good=False))
            return
        if not await self._surely(note_sent, self.command.pk, **self._fence):
            await self._end(note_released)
            return
        setting = ParameterSetting(*wanted, self.session.state, Addressing(self.session.uav.system), settings.TRANSFER_RULES)
        outcome = await ProtocolDriver(self.session, setting, lambda: self.is_ours).run(on_change=lambda: None)
        if isinstance(outcome, CommandOutcome):
            await self._send_order(outcome)
        else:
            await self._end(note_released)

    async def _is_onboard(self, load: FlightLoad, before: LoadedLists | None) -> bool:
        """Read back the mission to be flown; return whether the vehicle holds it. Otherwise end the command.

        The command's time-out runs from the end of the readback and does not expire during it.
        """
        total, read, noted_s = sum(len(load.of(kind)) for kind in MissionType), 0, time.monotonic()

        def advance(done: int) -> None:
            nonlocal read, noted_s
            if done > read and time.monotonic() - noted_s >= PROGRESS_INTERVAL_S:
                read, noted_s = done, time.monotonic()
                self._note(note_read_back, self.command.pk, done=done, total=total, **self._fence)

        reading = await read_back(self.session, load, before.beside if before else {}, lambda: self.is_ours, advance)
        await asyncio.gather(*self._notes, return_exceptions=True)
        if reading is None:
            await self._end(note_released)
        elif reading.is_onboard:
            await self._surely(raise_other_list, self.command)
            if before is not None:
                await self._surely(confirm_loaded, self.carried, before)
            if await self._surely(note_read_back, self.command.pk, done=total, total=total, **self._fence):
                return True
            await self._end(note_released)
        elif reading.code in UNACKNOWLEDGED:
            await self._end(note_released, retry_in_s=TRY_AGAIN_IN_S, note=reading.why, code=reading.code)
        else:
            if reading.code == OTHER_LIST_READ:
                await self._surely(raise_other_list, self.command, reading.why)
            await self._end_with(fail_loading, None, reading.code, reading.why)
        return False

    async def _send_order(self, outcome: CommandOutcome) -> None:
        await asyncio.gather(*self._notes, return_exceptions=True)
        if outcome.state is CommandEnd.APPLIED:
            await self._end(note_applied, note=outcome.why)
        elif outcome.code in UNACKNOWLEDGED:
            await self._end(note_released, retry_in_s=TRY_AGAIN_IN_S, note=outcome.why)
        else:
            await self._end(note_failed, outcome.code or "failed", outcome.why or (Reason("not_done"),))

    async def _load(self, task: DeliveryTask) -> None:
        assert task.load is not None  # noqa: S101 - checked by the caller
        if not await self._surely(begin_loading, self.carried):
            await self._end(note_released)
            return
        keeper = MissionSync(task.load, self.session.state, Addressing(self.session.uav.system), settings.TRANSFER_RULES, known=task.known)
        noted_s, mixes = 0.0, 0

        def change() -> None:
            nonlocal noted_s, mixes
            if self.is_dropped or keeper.is_endangered:
                self.session.send(keeper.cancel(time.monotonic()))
            if len(keeper.mixes) > mixes:
                mixes = len(keeper.mixes)
                why = [Reason("list_mixed", {"list": list_reason(mix.kind.name), "mix": mix.what}) for mix in keeper.mixes]
                self._note(raise_mission_mismatch, self.command, is_mixed=True, why=why)
            if time.monotonic() - noted_s >= PROGRESS_INTERVAL_S:
                noted_s = time.monotonic()
                progress = keeper.progress
                self._note(note_progress, self.command.pk, done=progress.done, total=progress.total, **self._fence)

        outcome = await ProtocolDriver(self.session, keeper, lambda: self.session.is_held).run(on_change=change)
        await asyncio.gather(*self._notes, return_exceptions=True)
        if outcome is None:
            await self._end(note_released)
        else:
            await self._report_load(task, outcome)

    async def _report_load(self, task: DeliveryTask, outcome: SyncOutcome) -> None:
        """Report the vehicle's lists first, as a mix is critical regardless of who holds the command; then end the command."""
        still_mixed = outcome.state is SyncState.MIXED or (outcome.state is SyncState.UNREAD and outcome.is_critical)
        await self._surely(raise_mission_mismatch, self.command, is_mixed=still_mixed, why=outcome.why)
        before = task.before if outcome.state is SyncState.INTACT else None
        if outcome.state is SyncState.READY:
            await self._surely(raise_other_list, self.command)
            warnings = warnings_of(task.load, self.session) if task.load is not None and task.load.mission else ()
            beside = {kind.name.lower(): sha256 for kind, sha256 in outcome.left_sha256.items()}
            wanted = None if task.wanted is None else replace(task.wanted, beside=beside)
            self.session.forget_flown()
            self.session.message_requests.rtl_reading.ask_anew(time.monotonic())  # also how many rally points it holds now
            await self._end_with(end_loading, wanted, note=outcome.why, warnings=(*outcome.left_alone, *warnings))
        elif self.command.kind == CommandKind.CLEAR_MISSION and outcome.code in NOT_YET:
            await self._end(note_released, retry_in_s=CLEAR_AGAIN_IN_S, note=outcome.why)
        elif self.is_closing or (outcome.code in UNACKNOWLEDGED and not outcome.is_critical):
            await self._end(note_released, retry_in_s=0.0 if self.is_closing else TRY_AGAIN_IN_S, note=outcome.why)
        else:
            await self._end_with(fail_loading, before, outcome.code or outcome.state.value, outcome.why)

    @property
    def _fence(self) -> dict[str, Any]:
        return {"attempt": self.carried.attempt, "holder": self.carried.holder}

    async def _end(self, note: Callable[..., bool], /, *values: Any, **named: Any) -> None:
        self.has_ended = True
        await self._surely(note, self.command.pk, *values, **named, **self._fence)

    async def _end_with(self, note: Callable[..., bool], /, *values: Any, **named: Any) -> None:
        self.has_ended = True
        await self._surely(note, self.carried, *values, **named)

    async def _surely(self, do: Callable[..., Any], /, *values: Any, **named: Any) -> Any:
        """Return the result of a database call, retrying while the database is unavailable."""
        while True:
            try:
                return await self.database.run(do, *values, **named)
            except DatabaseUnavailable:
                await asyncio.sleep(DATABASE_RETRY_S)

    def _note(self, do: Callable[..., Any], /, *values: Any, **named: Any) -> None:
        """Write an optional update in the background."""

        async def inside() -> None:
            try:
                await self.database.run(do, *values, **named)
            except DatabaseUnavailable:
                logger.debug("not noted: %s", do)

        task = asyncio.create_task(inside())
        self._notes.add(task)
        task.add_done_callback(self._notes.discard)
