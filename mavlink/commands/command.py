"""One command to a vehicle: sent, acknowledged, and confirmed by the state that the vehicle reports."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message, Messages
from mavlink.timeouts import CommandRules
from mavlink.vehicle_state import VehicleState
from operation.reasons import Reason, text_reason

Effect = Callable[[VehicleState], bool | None]
Seven = tuple[float, float, float, float, float, float, float]


class CommandEnd(StrEnum):
    APPLIED = "applied"
    FAILED = "failed"


@dataclass(frozen=True)
class CommandOutcome:
    """`code` is short and stable, such as already, denied, no-effect or silent."""

    state: CommandEnd
    code: str = ""
    why: tuple[Reason, ...] = ()


@dataclass(frozen=True)
class CommandStep:
    """One MAVLink command and the effect that confirms it.

    `effect` returns whether the vehicle's state shows it. Without an effect the acknowledgement ends the step. A step that `is_slow` is
    sent once and waited for longer. `sent_at_s` returns the time of the message that shows the effect; only messages after the start of the
    step count. `is_too_late` returns whether the step has become pointless. `instead` is sent to a vehicle that does not support the
    command.
    """

    name: Reason
    command: int | None  # MAV_CMD; None: send nothing, wait for the effect
    parameters: Seven = (0.0,) * 7
    effect: Effect | None = None
    is_slow: bool = False
    sent_at_s: Callable[[VehicleState], float | None] = lambda state: state.heartbeat_at_s
    is_too_late: Effect | None = None
    instead: Callable[[Addressing], Message] | None = None


class CommandMachine:
    """Sends a step's command until its effect shows or the vehicle refuses it.

    `state` must have received a message before the machine does. After an acceptance the machine waits for the effect and then sends again.
    An effect without an acknowledgement suffices. A refusal may be the late answer to an earlier command: an acceptance or the effect
    within `refusal_s` overrules it.
    """

    def __init__(self, step: CommandStep, state: VehicleState, addressing: Addressing, rules: CommandRules) -> None:
        self.outcome: CommandOutcome | None = None
        self.wake_at_s: float | None = None
        self.is_acknowledged = False
        self._step = step
        self._state = state
        self._addressing = addressing
        self._rules = rules
        self._begun_s = 0.0
        self._sent = 0
        self._is_unknown = False  # the vehicle does not support the command: `instead` is sent
        self._no: int | None = None

    def start(self, now_s: float) -> Messages:
        self._begun_s = now_s
        if self._step.command is None:
            self.is_acknowledged = True
            self.wake_at_s = now_s + self._effect_s
            return []
        return self._send(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if self.outcome is not None:
            return []
        if message.get_type() == "COMMAND_ACK" and message.command == self._step.command and self._addressing.has_sent(message):
            self._answered(message.result, now_s)
        if self.outcome is None and self._shows_effect():
            self._end(CommandEnd.APPLIED)
        if self.outcome is None and self._step.is_too_late is not None and self._step.is_too_late(self._state):
            self._end(CommandEnd.FAILED, "too-late", Reason("other_state"))
        return []

    def tick(self, now_s: float) -> Messages:
        if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s:
            return []
        is_temporary = self._no == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        if self._no is not None and not (is_temporary and self._sent <= self._rules.retries):
            return self._end(CommandEnd.FAILED, _result_name(self._no), *self._own_words)
        if self.is_acknowledged and (self._step.is_slow or self._step.command is None or self._sent > self._rules.retries):
            return self._end(CommandEnd.FAILED, "no-effect", Reason("no_effect"), *self._own_words)
        if self._sent > self._rules.retries:
            return self._end(CommandEnd.FAILED, "silent", Reason("no_answer"))
        return self._send(now_s)

    @property
    def _own_words(self) -> tuple[Reason, ...]:
        """Return the vehicle's status texts since the start."""
        words = self._state.words_since(self._begun_s)
        return (text_reason(words),) if words else ()

    @property
    def _effect_s(self) -> float:
        return self._rules.lift_off_s if self._step.is_slow else self._rules.effect_s

    def _shows_effect(self) -> bool:
        """Return whether messages received since the start show the effect."""
        last_message_s = self._step.sent_at_s(self._state)
        return (
            self._step.effect is not None
            and last_message_s is not None
            and last_message_s >= self._begun_s
            and bool(self._step.effect(self._state))
        )

    def _answered(self, result: int, now_s: float) -> None:
        if result == mavlink.MAV_RESULT_ACCEPTED:
            self.is_acknowledged, self._no = True, None
            if self._step.effect is None:
                self._end(CommandEnd.APPLIED)
            else:
                self.wake_at_s = now_s + self._effect_s
        elif result == mavlink.MAV_RESULT_IN_PROGRESS:
            self._no = None
            self.wake_at_s = now_s + self._rules.in_progress_s
        elif result == mavlink.MAV_RESULT_UNSUPPORTED and self._step.instead is not None:
            self._is_unknown, self.wake_at_s = True, now_s
        elif not self.is_acknowledged and self._no is None:
            self._no = result
            is_temporary = result == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
            self.wake_at_s = now_s + (self._rules.timeout_s if is_temporary else self._rules.refusal_s)

    def _send(self, now_s: float) -> Messages:
        confirmation = min(self._sent, 255)
        self._sent += 1
        self._no, self.is_acknowledged = None, False
        self.wake_at_s = now_s + self._rules.timeout_s
        if self._is_unknown and self._step.instead is not None:
            return [self._step.instead(self._addressing)]
        return [
            mavlink.MAVLink_command_long_message(
                self._addressing.system, self._addressing.component, self._step.command, confirmation, *self._step.parameters
            )
        ]

    def _end(self, state: CommandEnd, code: str = "", *why: Reason) -> Messages:
        self.outcome, self.wake_at_s = CommandOutcome(state, code, why), None
        return []


def _result_name(result: int) -> str:
    entry = mavlink.enums["MAV_RESULT"].get(result)
    return f"result-{result}" if entry is None else entry.name.removeprefix("MAV_RESULT_").lower().replace("_", "-")
