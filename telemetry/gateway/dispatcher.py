"""Dispatcher: delivers commands of the outbox to the vehicles that this gateway serves.

Each vehicle has at most one command in delivery per axis. Uploads take long, so their number is limited, the most urgent first. Commands
that stop or return a UAV wait for nothing, not even for an acknowledgement.
"""

import asyncio
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from uuid import UUID

from django.conf import settings

from missions.command_rules import SETS_IN_MOTION
from missions.models import CommandAxis, LinkKind, UavCommand
from missions.services.commands.commands import claim_commands, expire_overdue, note_released, renew_claims
from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.gateway.delivery import Delivery
from telemetry.gateway.preparation import LOADING
from telemetry.gateway.session import RECEIVED_WITHIN_S, Session
from workspace.leases import held_until_s
from workspace.live.timed_waits import wait_for_event

logger = logging.getLogger(__name__)

POLL_INTERVAL_S = 1.0
MAX_UPLOADS = 8
RETRY_S = 0.5
END_WITHIN_S = 4.0
NOTES_AT_ONCE = 4  # the end of a command may wait for its mission; the start of another must not wait for it


@dataclass
class Dispatcher:
    holder: str
    lease_s: float
    sessions: Callable[[], list[Session]]
    database: DatabaseThread = field(default_factory=lambda: DatabaseThread("gateway-commands"))
    notes: DatabaseThread = field(default_factory=lambda: DatabaseThread("gateway-notes", NOTES_AT_ONCE))  # for updates of deliveries
    _deliveries: dict[UUID, Delivery] = field(default_factory=dict)
    _tasks: dict[UUID, asyncio.Task[None]] = field(default_factory=dict)
    _woken: asyncio.Event = field(default_factory=asyncio.Event)

    def wake(self) -> None:
        self._woken.set()

    async def run(self) -> None:
        while True:
            try:
                await self.poll()
            except DatabaseUnavailable:
                await asyncio.sleep(RETRY_S)
            if await wait_for_event(self._woken, POLL_INTERVAL_S):
                self._woken.clear()

    async def poll(self) -> None:
        """Drop commands that this gateway lost, claim waiting ones, and start those that can start."""
        self._forget_ended()
        if self._deliveries:
            asked_s = time.monotonic()
            held = await self.database.run(renew_claims, holder=self.holder, lease_s=self.lease_s)
            for command_id, delivery in self._deliveries.items():
                if held.get(command_id) != delivery.carried.attempt:
                    delivery.is_dropped = True
                else:
                    delivery.held_until_s = held_until_s(asked_s, self.lease_s)
        now_s = time.time()
        served = {session.uav.uav_id: session for session in self.sessions() if session.is_served(now_s, RECEIVED_WITHIN_S)}
        unacknowledged = {session.uav.uav_id: session for session in self.sessions() if session.may_receive(now_s)}
        unacknowledged = {uav_id: session for uav_id, session in unacknowledged.items() if uav_id not in served}
        await self.database.run(expire_overdue)
        if served:
            await self._claim(served, CommandAxis.FLIGHT, len(served))
            await self._claim(served, CommandAxis.MISSION, MAX_UPLOADS - sum(command.kind in LOADING for command in self._commands()))
            for axis in (CommandAxis.SPEED, CommandAxis.PARAMETER):
                await self._claim(served, axis, settings.GATEWAY_MAX_COMMANDS - len(self._deliveries))
        if unacknowledged:
            await self._claim(unacknowledged, CommandAxis.FLIGHT, len(unacknowledged), is_unacknowledged=True)
        self._begin()

    async def _claim(
        self,
        sessions: dict[int, Session],
        axis: CommandAxis,
        room: int,
        *,
        is_unacknowledged: bool = False,
    ) -> None:
        """Claim at most `room` commands of an axis."""
        if room <= 0:
            return
        asked_s = time.monotonic()
        claimed = await self.database.run(
            claim_commands, uav_ids=list(sessions), holder=self.holder, lease_s=self.lease_s, limit=room, link=LinkKind.MAVLINK,
            axes=[axis], to_unreachable=is_unacknowledged,
        )  # fmt: skip
        for command in claimed:
            session, until_s = sessions[command.uav_id], held_until_s(asked_s, self.lease_s)
            self._deliveries[command.pk] = Delivery(command, session, self.notes, until_s, is_unacknowledged=is_unacknowledged)

    async def close(self) -> None:
        """End the deliveries, and release those that have not ended in time."""
        for delivery in self._deliveries.values():
            delivery.is_dropped = delivery.is_closing = True
        if self._tasks:
            await asyncio.wait(self._tasks.values(), timeout=END_WITHIN_S)
        for command_id, delivery in self._deliveries.items():
            if not delivery.has_ended:
                await self.database.run(note_released, command_id, attempt=delivery.carried.attempt, holder=self.holder)
        for task in self._tasks.values():
            task.cancel()

    def _commands(self) -> list[UavCommand]:
        return [delivery.command for delivery in self._deliveries.values()]

    def _begin(self) -> None:
        waiting = [delivery for command_id, delivery in self._deliveries.items() if command_id not in self._tasks]
        for delivery in sorted(waiting, key=lambda delivery: (delivery.command.priority, delivery.command.created_at)):
            if delivery.is_dropped:
                delivery.has_ended = True
            elif self._may_begin(delivery.command):
                command_id, delivery.has_begun = delivery.command.pk, True
                task = self._tasks[command_id] = asyncio.create_task(delivery.run(), name=f"command {command_id}")
                task.add_done_callback(self._ended)
        self._forget_ended()

    def _may_begin(self, command: UavCommand) -> bool:
        under_way = [self._deliveries[command_id].command for command_id in self._tasks]
        own = [other for other in under_way if other.uav_id == command.uav_id]
        if any(other.axis == command.axis for other in own):
            return False
        if command.kind in SETS_IN_MOTION:
            return not any(other.kind in LOADING for other in own)
        if command.kind in LOADING and any(other.kind in SETS_IN_MOTION for other in own):
            return False
        return command.kind not in LOADING or sum(other.kind in LOADING for other in under_way) < MAX_UPLOADS

    def _ended(self, task: asyncio.Task[None]) -> None:
        if not task.cancelled() and task.exception() is not None:
            logger.error("a command broke down", exc_info=task.exception())
        self.wake()

    def _forget_ended(self) -> None:
        for command_id in [key for key, task in self._tasks.items() if task.done()]:
            del self._tasks[command_id]
            if command_id in self._deliveries and self._deliveries[command_id].has_begun:  # else it was released and claimed again
                del self._deliveries[command_id]
        for command_id in [key for key, delivery in self._deliveries.items() if delivery.has_ended and key not in self._tasks]:
            del self._deliveries[command_id]
