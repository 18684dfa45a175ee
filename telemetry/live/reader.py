"""One open page: what it has been told, and what it has still to be told. Slow pages are told the latest of each object, and no more."""

import asyncio
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from uuid import UUID

from telemetry.selectors.live import Key
from workspace.live.timed_waits import wait_for_event

MAX_UNCONFIRMED = 2  # messages
RETRY_INTERVAL_S = 1.0  # a page is given everything, at most


class SaysNonsense(ValueError):
    """It confirms what it was never told."""


@dataclass(eq=False)
class Reader:
    """`mission` is None for pages of the whole organisation. Whoever follows the rows calls `begin`, `note` and `end`."""

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
        """What it has to be told is known from now on."""
        self.is_ready = True
        self._changed.set()

    def end(self) -> None:
        """What it shows is not there any more."""
        self.is_ended = True
        self._changed.set()

    def note(self, keys: Iterable[Key]) -> None:
        if self.is_ready and not self.wants_all:
            self.dirty.update(keys)
            self._changed.set()

    def confirm(self, sequence: int) -> None:
        """Raises SaysNonsense."""
        if sequence > self.sequence:
            raise SaysNonsense
        self.confirmed = max(self.confirmed, sequence)
        self._changed.set()

    def again(self) -> None:
        """It has lost count: nothing of what it was told is waited for."""
        self.confirmed, self.wants_all = self.sequence, True
        self.dirty.clear()
        self._changed.set()

    @property
    def is_full(self) -> bool:
        """Nothing more is sent before it has confirmed some."""
        return self.sequence - self.confirmed >= MAX_UNCONFIRMED

    @property
    def is_due(self) -> bool:
        has_something = self.is_ready and (self.wants_all or bool(self.dirty))
        return self.is_ended or (has_something and not self.is_full and self.waits_s <= 0)

    @property
    def waits_s(self) -> float:
        """Until it may be given everything again."""
        return self.given_all_s + RETRY_INTERVAL_S - time.monotonic() if self.wants_all else 0.0

    async def due(self, within_s: float) -> bool:
        """Whether there is something to be told within that time."""
        until_s = time.monotonic() + within_s
        while not self.is_due:
            left_s = until_s - time.monotonic()
            if left_s <= 0:
                return False
            self._changed.clear()
            await wait_for_event(self._changed, min(left_s, self.waits_s) if self.waits_s > 0 else left_s)
        return True

    def take(self) -> tuple[int, frozenset[Key] | None]:
        """The number of the next message, and what is in it; None is everything."""
        self.sequence += 1
        keys = None if self.wants_all else frozenset(self.dirty)
        if self.wants_all:
            self.given_all_s = time.monotonic()
        self.wants_all = False
        self.dirty.clear()
        return self.sequence, keys
