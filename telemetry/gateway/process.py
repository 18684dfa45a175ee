"""The gateway process: sockets, sessions, database and timers."""

import asyncio
import hashlib
import logging
import os
import signal
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Collection, Coroutine, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import psycopg
from django.conf import settings
from django.db import connection
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Frame, message_of
from missions.services.commands.commands import CHANNEL
from operation import loop_heartbeats
from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.gateway.dispatcher import Dispatcher
from telemetry.gateway.fleet import KnownUav, known_uavs
from telemetry.gateway.flights import SYNC_INTERVAL_S, Flights
from telemetry.gateway.leasing import Leasing
from telemetry.gateway.options import GatewayOptions
from telemetry.gateway.peers import Listeners, Peer
from telemetry.gateway.reporter import Reporter
from telemetry.gateway.sender_authentication import UnknownSenders
from telemetry.gateway.session import RADIO, Session
from telemetry.gateway.store import Store
from telemetry.services.links.gateway_messages import ReceivedText
from telemetry.services.links.links import LinkState, release_leases

RETRY_DELAY_S = 1.0
PLAIN = frozenset(
    {"application_name", "connect_timeout", "dbname", "host", "password", "port", "sslcert", "sslkey", "sslmode", "sslrootcert", "user"}
)
logger = logging.getLogger(__name__)
FLEET_INTERVAL_S = 1.0
RETRY_S = 0.5
COUNTS_INTERVAL_S = 60.0
DESK_WITHIN_S = 5.0
STOP_WITHIN_S = 4.0
CANCEL_AGAIN_S = 0.5
LOOP, HANGS_AFTER_S = "the gateway", 30.0


async def listen(on_message: Callable[[], None]) -> None:
    """Call `on_message` for each notification until cancelled; reconnects after database outages."""
    parameters = {name: value for name, value in connection.get_connection_params().items() if name in PLAIN}
    while True:
        try:
            async with await psycopg.AsyncConnection.connect(**parameters, autocommit=True) as listening:
                await listening.execute(f"LISTEN {CHANNEL}")
                on_message()
                async for _ in listening.notifies():
                    on_message()
        except psycopg.Error as error:
            logger.debug("no hints: %s", error)
        await asyncio.sleep(RETRY_DELAY_S)


@dataclass
class Gateway:
    """The gateway: `run` until `stop`. `listening` has its addresses once it listens."""

    options: GatewayOptions
    listening: list[str] = field(default_factory=list)
    sessions: dict[int, Session] = field(default_factory=dict)  # by system id
    damages: Counter[str] = field(default_factory=Counter)
    lost_here: Counter[str] = field(default_factory=Counter)
    _uavs: dict[int, KnownUav] | None = None  # by system id; None before they are read
    _is_manned: bool = True
    _early: deque[tuple[Frame, Peer, float]] = field(default_factory=lambda: deque(maxlen=20_000))

    def __post_init__(self) -> None:
        self.database = DatabaseThread("gateway-store")
        self.reporter = Reporter(self._all)
        self.store = Store(self.database, self.options.holder, self.options.most_records, self._link_states, self._mark_unsaved)
        self.unknown = UnknownSenders(self.store.note_sighting)
        self.flights = Flights(self.options)
        self.desk = Dispatcher(self.options.holder, self.options.lease_s, self._all)
        self.leasing = Leasing(self.options, self.database, self._all, self._receive_known, self.flights.end)
        self.listeners = Listeners(self.receive)
        self._stop = asyncio.Event()

    def _all(self) -> list[Session]:
        return list(self.sessions.values())

    def dropped(self) -> dict[str, int]:
        """Return the counts of received data that was not a UAV's frame, by cause."""
        return {**self.damages, **{str(cause): number for cause, number in self.listeners.damages.items()}}

    def not_ready(self) -> list[str]:
        """Return why the gateway is not ready.

        It is ready while it listens and knows its UAVs. A later database outage does not make it unready, so that vehicles keep its
        address.
        """
        if not self.listening:
            return ["it does not listen yet"]
        return [] if self._uavs is not None else ["its UAVs are not known yet"]

    # Frames

    def receive(self, frames: list[Frame], peer: Peer, now_s: float) -> None:
        if self._uavs is None:
            self._early.extend((frame, peer, now_s) for frame in frames)
            return
        for frame in frames:
            if frame.message_id in RADIO and not frame.is_signed:
                self._receive_radio(frame, peer, now_s)
                continue
            uav = self._uavs.get(frame.system)
            if uav is None:
                self.damages["unknown-system"] += 1
                self.unknown.receive(frame, peer, now_s)
                self._note_station(frame, peer)
            else:
                session = self.sessions.get(frame.system) or self._new_session(uav)
                self._receive_known(session, frame, peer, now_s)

    def _receive_known(self, session: Session, frame: Frame, peer: Peer, now_s: float) -> None:
        session.receive(frame, peer, now_s)
        if session.lease is None:
            if session.waiting:
                self.leasing.wanted.set()
            return
        self.flights.watch(session, now_s)

    def _note_station(self, frame: Frame, peer: Peer) -> None:
        message = message_of(frame) if frame.message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT else None
        if message is not None and message.type == mavlink.MAV_TYPE_GCS:
            for session in self.sessions.values():
                session.note_station(peer)

    def _receive_radio(self, frame: Frame, peer: Peer, now_s: float) -> None:
        for session in self.sessions.values():
            if session.peer == peer:
                session.receive_radio(frame, now_s)

    def _new_session(self, uav: KnownUav) -> Session:
        self.unknown.forget(uav.system)
        session = self.sessions[uav.system] = Session(
            uav, self.store.records, captures=self.store.captures, link_id=_link_id(self.options.name), lost_here=self.lost_here
        )
        return session

    # Process

    async def run(self, *, on_listening: Callable[[list[str]], None] | None = None) -> None:
        """Run until stopped. Raises OSError if an address cannot be opened."""
        self.listening = await self.listeners.open(self.options.udp, self.options.tcp)
        logger.info("gateway %s listens on %s", self.options.holder, ", ".join(self.listening))
        if on_listening is not None:
            on_listening(self.listening)
        loops = [asyncio.create_task(loop, name=name) for name, loop in self._loops().items()]
        stopping = asyncio.create_task(self._stop.wait())
        done, _ = await asyncio.wait([*loops, stopping], return_when=asyncio.FIRST_COMPLETED)
        stopping.cancel()
        await self._end(loops)
        for task in done - {stopping}:
            task.result()  # a loop only ends by an error: the process ends and is restarted

    def stop(self) -> None:
        self._stop.set()

    def stop_on_signals(self, *, after_s: float) -> None:
        """Stop on SIGTERM and SIGINT, and exit after `after_s` at the latest, even if the database does not respond."""

        def stop() -> None:
            self.stop()
            last_resort = threading.Timer(after_s, os._exit, [1])
            last_resort.daemon = True
            last_resort.start()

        for number in (signal.SIGTERM, signal.SIGINT):
            asyncio.get_running_loop().add_signal_handler(number, stop)

    def _loops(self) -> dict[str, Coroutine[Any, Any, None]]:
        return {
            "fleet": self._every(FLEET_INTERVAL_S, self._read_fleet),
            "leases": self.leasing.run(),
            "store": self._store_loop(),
            "commands": self.desk.run(),
            "hints": listen(self.desk.wake),
            "vehicles": self._every(1.0, self._tick),
            "logs": self._every(SYNC_INTERVAL_S, self._sync_logs),
            "counts": self._every(COUNTS_INTERVAL_S, self._report_counts),
            **{name: self._every(every_s, notify) for name, (every_s, notify) in self.reporter.loops().items()},
        }

    async def _every(self, interval_s: float, do: Callable[[], Coroutine[Any, Any, None]]) -> None:
        while True:
            try:
                await do()
            except DatabaseUnavailable:
                await asyncio.sleep(RETRY_S)
            await asyncio.sleep(interval_s)

    async def _end(self, loops: list[asyncio.Task[None]]) -> None:
        loop_heartbeats.stop(LOOP)
        await _cancel(loops)
        await self._close_desk()
        self.listeners.close()
        self.flights.end_all(time.time())
        try:
            async with asyncio.timeout(STOP_WITHIN_S):
                while await self.store.flush():
                    pass
                await self.reporter.flown()
                await self.flights.write_rows(self.reporter.database)
                await self.database.run(release_leases, holder=self.options.holder)
        except (DatabaseUnavailable, TimeoutError):
            logger.warning("the database is away: %s records are lost, leases run out by themselves", len(self.store.records))
        self.database.close()
        self.reporter.database.close()

    async def _close_desk(self) -> None:
        try:
            async with asyncio.timeout(DESK_WITHIN_S):
                await self.desk.close()
        except (DatabaseUnavailable, TimeoutError):
            logger.warning("the database is away: commands are taken up again when their leases run out")
        self.desk.database.close()
        self.desk.notes.close()

    # Periodic tasks

    async def _read_fleet(self) -> None:
        self._uavs = await self.database.run(known_uavs)
        for system, session in list(self.sessions.items()):
            uav = self._uavs.get(system)
            if uav is None or uav.uav_id != session.uav.uav_id:
                self.flights.end(session, time.time())
                session.lose()
                del self.sessions[system]
            elif uav != session.uav:
                session.change(uav)
        while self._early:
            frame, peer, now_s = self._early.popleft()
            self.receive([frame], peer, now_s)

    async def _store_loop(self) -> None:
        while True:
            for session in self.sessions.values():
                for text in session.texts:
                    received_at = datetime.fromtimestamp(text.received_s, UTC)
                    self.store.texts.append(ReceivedText(session.uav.uav_id, text.severity, text.text, received_at))
                session.texts.clear()
            if not await self.store.flush():
                await asyncio.sleep(RETRY_S if self.store.is_away else self.options.flush_s)

    def _link_states(self) -> list[LinkState]:
        """Return the states of vehicles received since the last call."""
        unsaved = [
            session for session in self.sessions.values() if session.is_unsaved and session.lease is not None and session.last_message_s
        ]
        for session in unsaved:
            session.is_unsaved = False
        return [session.link_state() for session in unsaved]

    def _mark_unsaved(self, states: Sequence[LinkState]) -> None:
        uav_ids = {state.uav_id for state in states}
        for session in self.sessions.values():
            session.is_unsaved |= session.uav.uav_id in uav_ids

    async def _tick(self) -> None:
        """Tick the sessions. Without its database a gateway cannot deliver commands, so it then stops sending heartbeats."""
        loop_heartbeats.send_heartbeat(LOOP, within_s=HANGS_AFTER_S)
        now_s, is_manned = time.time(), time.monotonic() - self.leasing.answered_s <= settings.GATEWAY_ALONE_S
        if is_manned != self._is_manned:
            self._is_manned = is_manned
            reported = "is back: UAVs get heartbeats" if is_manned else "is away for too long: UAVs get no heartbeats any more"
            logger.warning("the database %s", reported)
        for session in self.sessions.values():
            session.tick(now_s, is_manned=is_manned)

    async def _sync_logs(self) -> None:
        await self.flights.sync(time.time())
        await self.flights.write_rows(self.reporter.database)

    async def _report_counts(self) -> None:
        if counts := self.dropped():
            reported = ", ".join(f"{cause} {number}" for cause, number in sorted(counts.items()))
            logger.info("received since the start and dropped: %s", reported)


async def _cancel(tasks: Collection[asyncio.Task[None]]) -> None:
    """Cancel until all have ended: libraries may drop a cancellation."""
    while pending := [task for task in tasks if not task.done()]:
        for task in pending:
            task.cancel()
        await asyncio.wait(pending, timeout=CANCEL_AGAIN_S)


def _link_id(name: str) -> int:
    """Return this gateway's link id for signatures. Streams of several gateways must not mix, and there are only 256 ids."""
    return hashlib.sha256(name.encode()).digest()[0]
