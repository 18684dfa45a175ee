"""Leases of vehicles: taken, renewed, and lost to another gateway."""

import asyncio
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from mavlink.frames import Frame
from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.gateway.options import GatewayOptions
from telemetry.gateway.peers import Peer
from telemetry.gateway.session import Session
from telemetry.services.links.links import UNREACHABLE_S, renew_leases, take_leases
from workspace.leases import held_until_s
from workspace.live.timed_waits import wait_for_event

logger = logging.getLogger(__name__)
LEASES_INTERVAL_S = 1.0
RETRY_S = 0.5
GATHERED_S = 0.05  # vehicles first received within this time are leased together
WAITED_TOO_LONG_S = 15.0


def served_until_s(asked_s: float, lease_s: float) -> float:
    """Return the end of a vehicle's lease: another gateway may also take it once its last stored message is old."""
    return held_until_s(asked_s, min(lease_s, UNREACHABLE_S))


@dataclass
class Leasing:
    """Takes and renews leases. `receive` gets the frames that waited for a lease; `end_flight` the lost sessions, with the time."""

    options: GatewayOptions
    database: DatabaseThread
    sessions: Callable[[], list[Session]]
    receive: Callable[[Session, Frame, Peer, float], None]
    end_flight: Callable[[Session, float], None]
    wanted: asyncio.Event = field(default_factory=asyncio.Event)
    answered_s: float = field(default_factory=time.monotonic)  # monotonic time of the last database answer

    async def run(self) -> None:
        while True:
            try:
                await self._hold()
                await self._take()
            except DatabaseUnavailable:
                await asyncio.sleep(RETRY_S)
            self.wanted.clear()
            await asyncio.sleep(GATHERED_S)
            await wait_for_event(self.wanted, LEASES_INTERVAL_S)

    async def _hold(self) -> None:
        now_s, asked_s = time.time(), time.monotonic()
        held = {session.uav.uav_id: session for session in self.sessions() if session.lease is not None}
        still = await self.database.run(renew_leases, uav_ids=list(held), holder=self.options.holder, lease_s=self.options.lease_s)
        self.answered_s = time.monotonic()
        for uav_id in held.keys() - still:
            logger.warning("another gateway serves %s now", held[uav_id].uav.name, extra={"uav": uav_id})
            self.end_flight(held[uav_id], now_s)
            held[uav_id].lose()
        for uav_id in still:
            held[uav_id].held_until_s = served_until_s(asked_s, self.options.lease_s)

    async def _take(self) -> None:
        now_s = time.time()
        wanted = {}
        for session in self.sessions():
            while session.waiting and now_s - session.waiting[0][2] > WAITED_TOO_LONG_S:
                session.waiting.popleft()
            if session.lease is None and session.waiting:
                wanted[session.uav.uav_id] = session
        if not wanted:
            return
        asked_s = time.monotonic()
        leases = await self.database.run(take_leases, uav_ids=list(wanted), holder=self.options.holder, lease_s=self.options.lease_s)
        for lease in leases:
            session = wanted[lease.uav_id]
            logger.info("serves %s", session.uav.name, extra={"uav": session.uav.uav_id})
            for frame, peer, at_s in session.serve(lease, served_until_s(asked_s, self.options.lease_s)):
                self.receive(session, frame, peer, at_s)
