"""State of one open page: what was sent and what is due. Slow pages receive only the latest state of each object."""

import asyncio
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from uuid import UUID

from telemetry.selectors.live import Key
from workspace.live.timed_waits import wait_for_event

MAX_UNCONFIRMED = 2  # messages
RETRY_INTERVAL_S = 1.0  # between two snapshots to a page


class SaysNonsense(ValueError):
    """The page acknowledges a message that was never sent."""


@dataclass(eq=False)
class Reader:
    """One open page. `mission` is None for pages of the whole organisation. The feed calls `begin`, `note` and `end`."""

    organisation_id: int
    mission: UUID | None
    language: str
    sequence: int = 0
    confirmed: int = 0
    is_ready: bool = False
    is_ended: bool = False
    dirty: set[Key] = field(default_factory=set)
    wants_all: bool = True
    given_all_s: float = -RETRY_INTERVAL_S
    _changed: asyncio.Event = field(default_factory=asyncio.Event)

    def begin(self) -> None:
        """Mark the page ready: the feed now knows what to send."""
        self.is_ready = True
        self._changed.set()

    def end(self) -> None:
        """Mark the page ended: its mission no longer exists."""
        self.is_ended = True
        self._changed.set()

    def note(self, keys: Iterable[Key]) -> None:
        if self.is_ready and not self.wants_all:
            self.dirty.update(keys)
            self._changed.set()

    def confirm(self, sequence: int) -> None:
        """Record an acknowledgement. Raises SaysNonsense."""
        if sequence > self.sequence:
            raise SaysNonsense
        self.confirmed = max(self.confirmed, sequence)
        self._changed.set()

    def again(self) -> None:
        """Send everything again to a page that missed a number; outstanding acknowledgements are dropped."""
        self.confirmed, self.wants_all = self.sequence, True
        self.dirty.clear()
        self._changed.set()

    @property
    def is_full(self) -> bool:
        """Return whether sending waits for an acknowledgement."""
        return self.sequence - self.confirmed >= MAX_UNCONFIRMED

    @property
    def is_due(self) -> bool:
        has_something = self.is_ready and (self.wants_all or bool(self.dirty))
        return self.is_ended or (has_something and not self.is_full and self.waits_s <= 0)

    @property
    def waits_s(self) -> float:
        """Return the seconds until everything may be sent again."""
        return self.given_all_s + RETRY_INTERVAL_S - time.monotonic() if self.wants_all else 0.0

    async def due(self, within_s: float) -> bool:
        """Return whether something is to be sent within that time."""
        until_s = time.monotonic() + within_s
        while not self.is_due:
            left_s = until_s - time.monotonic()
            if left_s <= 0:
                return False
            self._changed.clear()
            await wait_for_event(self._changed, min(left_s, self.waits_s) if self.waits_s > 0 else left_s)
        return True

    def take(self) -> tuple[int, frozenset[Key] | None]:
        """Return the number of the next message, and its keys; None for everything."""
        self.sequence += 1
        keys = None if self.wants_all else frozenset(self.dirty)
        if self.wants_all:
            self.given_all_s = time.monotonic()
        self.wants_all = False
        self.dirty.clear()
        return self.sequence, keys
