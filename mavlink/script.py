"""One conversation after another, written as one course of events."""

from collections.abc import Generator
from typing import Any, Generic, Protocol, TypeVar

from mavlink.addressing import Message, Messages
from mavlink.vehicle_state import VehicleState

Result = TypeVar("Result")


class Machine(Protocol):
    """A conversation with a vehicle: every call answers with the messages to be sent."""

    @property
    def outcome(self) -> Any:
        """None while it runs."""

    @property
    def wake_at_s(self) -> float | None:
        """When `tick` is wanted; None: not before a message."""

    def start(self, now_s: float) -> Messages: ...

    def receive(self, message: Message, now_s: float) -> Messages: ...

    def tick(self, now_s: float) -> Messages: ...


class Pause:
    """Nothing is sent until a time; `outcome` is True then."""

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
    """Nothing is sent until the vehicle's state took a heartbeat after `since_s`, or until a time; `outcome` is True then.

    `state` is to have taken a message before this gets it.
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
    """Runs a course: a generator that yields one machine after another, each run to its outcome, and returns the outcome of all."""

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
        """To the next step where the present one has ended."""
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
