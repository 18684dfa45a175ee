"""One keeper and its vehicle: messages go to and fro, and time goes on, until there is an outcome."""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from mavlink.frames import Message
from telemetry.gateway.session import Session
from workspace.live.timed_waits import wait_for_event

MAX_NAP_S = 0.5


class Keeper(Protocol):
    """A state machine of mavlink. Times are monotonic seconds."""

    @property
    def outcome(self) -> Any: ...

    @property
    def wake_at_s(self) -> float | None: ...

    def start(self, now_s: float) -> list[Message]: ...

    def receive(self, message: Message, now_s: float) -> list[Message]: ...

    def tick(self, now_s: float) -> list[Message]: ...


@dataclass
class Conversation:
    session: Session
    keeper: Keeper
    is_wanted: Callable[[], bool]
    _heard: asyncio.Event = field(default_factory=asyncio.Event)

    async def run(self, *, on_change: Callable[[], None]) -> Any:
        """The outcome; None once it is not wanted any more, which is asked before anything is sent."""
        if not self.is_wanted():
            return None
        self.session.listeners.append(self._hear)
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
            self.session.listeners.remove(self._hear)

    def _hear(self, message: Message, now_s: float) -> None:
        if self.keeper.outcome is None and self.is_wanted():
            self.session.send(self.keeper.receive(message, now_s))
        self._heard.set()

    async def _wait(self) -> None:
        wake_at_s = self.keeper.wake_at_s
        nap_s = MAX_NAP_S if wake_at_s is None else min(max(wake_at_s - time.monotonic(), 0.0), MAX_NAP_S)
        if await wait_for_event(self._heard, nap_s):
            self._heard.clear()
