"""Follows one organisation's rows for all its open pages."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Collection
from uuid import UUID

from django.db import Error as DatabaseError

from telemetry.live.messages import changes, everything, message
from telemetry.live.reader import Reader
from telemetry.live.snapshot import LiveSnapshot, changed_between
from telemetry.selectors.live import Key
from workspace.live.timed_waits import wait_for_event

logger = logging.getLogger(__name__)

POLL_INTERVAL_S = 1.0  # poll interval without a notification
POLL_PAUSE_S = 0.1  # between two polls, however many notifications arrive

SnapshotReader = Callable[[int, Collection[UUID], Collection[str], LiveSnapshot], Awaitable[LiveSnapshot]]


class Feed:
    """The feed: `run` until cancelled. Pages `join` and `leave`, all in one event loop."""

    def __init__(self, organisation_id: int, read_snapshot: SnapshotReader) -> None:
        self.organisation_id = organisation_id
        self.readers: set[Reader] = set()
        self._read_snapshot = read_snapshot
        self._snapshot = LiveSnapshot()
        self._waiting: set[Reader] = set()  # for the first poll that begins after they joined
        self._message = asyncio.Event()
        self._bodies: dict[tuple[UUID | None, str, frozenset[Key] | None], str] = {}

    def join(self, reader: Reader) -> None:
        self.readers.add(reader)
        self._waiting.add(reader)
        self._message.set()

    def leave(self, reader: Reader) -> None:
        self.readers.discard(reader)
        self._waiting.discard(reader)

    def wake(self) -> None:
        self._message.set()

    def next_message(self, reader: Reader) -> str:
        """Return the message that is due for a reader. Readers with the same content share it."""
        sequence, keys = reader.take()
        place = (reader.mission, reader.language, keys)
        body = self._bodies.get(place)
        if body is None:
            make = everything(self._snapshot, *place[:2]) if keys is None else changes(self._snapshot, *place[:2], keys)
            body = self._bodies[place] = make
        return message("snapshot" if keys is None else "changes", sequence, body)

    async def run(self) -> None:
        while True:
            self._message.clear()
            await self._poll()
            await asyncio.sleep(POLL_PAUSE_S)
            await wait_for_event(self._message, POLL_INTERVAL_S - POLL_PAUSE_S)

    async def _poll(self) -> None:
        newcomers, self._waiting = self._waiting, set()
        missions = {reader.mission for reader in self.readers if reader.mission is not None}
        languages = {reader.language for reader in self.readers}
        try:
            snapshot = await self._read_snapshot(self.organisation_id, missions, languages, self._snapshot)
        except DatabaseError as error:  # unavailable for now: the next poll retries
            logger.debug("live pages cannot be told: %r", error)
            self._waiting |= newcomers & self.readers
            return
        except Exception:  # one object that cannot be shown must not stop the others
            logger.exception("live pages of organisation %s cannot be told", self.organisation_id)
            self._waiting |= newcomers & self.readers
            return
        before, self._snapshot = self._snapshot, snapshot
        self._bodies.clear()
        self._notify(before, newcomers)

    def _notify(self, before: LiveSnapshot, newcomers: set[Reader]) -> None:
        changed: dict[UUID | None, set[Key]] = {}
        for reader in self.readers:
            if (
                reader.mission is not None
                and reader not in self._waiting
                and not self._snapshot.is_shown(_mission_key(reader), reader.mission)
            ):
                reader.end()
            elif reader in newcomers:
                reader.begin()
            elif reader.is_ready:
                if reader.mission not in changed:
                    changed[reader.mission] = changed_between(before, self._snapshot, reader.mission)
                if changed[reader.mission]:
                    reader.note(changed[reader.mission])


def _mission_key(reader: Reader) -> Key:
    return ("missions", str(reader.mission))
