"""Runs protocol state machines one after another, written as one generator."""

from collections.abc import Generator
from typing import Any, Generic, Protocol, TypeVar

from mavlink.addressing import Message, Messages
from mavlink.vehicle_state import VehicleState

Result = TypeVar("Result")


class Machine(Protocol):
    """A protocol state machine. Each call returns the messages to send."""

    @property
    def outcome(self) -> Any:
        """The result; None while it runs."""

    @property
    def wake_at_s(self) -> float | None:
        """When `tick` is due; None: not before a message."""

    def start(self, now_s: float) -> Messages: ...

    def receive(self, message: Message, now_s: float) -> Messages: ...

    def tick(self, now_s: float) -> Messages: ...


class Pause:
    """Sends nothing until a time; `outcome` is then True."""

    def __init__(self, until_s: float) -> None:
        self.outcome: bool | None = None
        self.wake_at_s: float | None = until_s

    def start(self, now_s: float) -> Messages:
        return self.tick(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        return self.tick(now_s)

    def tick(self, now_s: float) -> Messages:
        if self.wake_at_s is not None and now_s >= self.wake_at_s:
            self.outcome, self.wake_at_s = True, None
        return []


class NextHeartbeat:
    """Sends nothing until a heartbeat after `since_s` or until `until_s`; `outcome` is then True.

    `state` must receive each message first.
    """

    def __init__(self, state: VehicleState, since_s: float, until_s: float) -> None:
        self.outcome: bool | None = None
        self.wake_at_s: float | None = until_s
        self._state = state
        self._since_s = since_s

    def start(self, now_s: float) -> Messages:
        return self.tick(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        return self.tick(now_s)

    def tick(self, now_s: float) -> Messages:
        last_message_s = self._state.heartbeat_at_s
        if (last_message_s is not None and last_message_s > self._since_s) or (self.wake_at_s is not None and now_s >= self.wake_at_s):
            self.outcome, self.wake_at_s = True, None
        return []


Course = Generator[Machine, None, Result]


class Steps(Generic[Result]):
    """Runs a generator that yields machines, each run to its outcome, and returns the overall outcome."""

    def __init__(self, course: Course[Result]) -> None:
        self.outcome: Result | None = None
        self.step: Machine | None = None
        self._course = course

    @property
    def wake_at_s(self) -> float | None:
        return None if self.step is None else self.step.wake_at_s

    def start(self, now_s: float) -> Messages:
        return self._onward(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        return [] if self.step is None else [*self.step.receive(message, now_s), *self.go_on(now_s)]

    def tick(self, now_s: float) -> Messages:
        return [] if self.step is None else [*self.step.tick(now_s), *self.go_on(now_s)]

    def go_on(self, now_s: float) -> Messages:
        """Start the next step if the current one has ended."""
        return self._onward(now_s) if self.step is not None and self.step.outcome is not None else []

    def _onward(self, now_s: float) -> Messages:
        messages: Messages = []
        while self.step is None or self.step.outcome is not None:
            try:
                self.step = next(self._course)
            except StopIteration as end:
                self.step, self.outcome = None, end.value
                break
            messages += self.step.start(now_s)
        return messages
