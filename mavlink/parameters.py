"""Reads parameters of a vehicle by name, and sets one."""

import math
from collections.abc import Sequence

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message, Messages
from mavlink.commands.command import CommandEnd, CommandOutcome
from mavlink.timeouts import TransferRules
from mavlink.vehicle_state import VehicleState
from operation.reasons import Reason

BY_NAME = -1  # in place of a parameter's number


class ParameterReading:
    """Requests parameters until each has a value or is reported missing. `outcome` has those with a value.

    `state` must receive each message first. Many vehicles do not answer for a parameter that they do not have: it is missing from the
    outcome after the last retry.
    """

    def __init__(self, names: Sequence[str], state: VehicleState, addressing: Addressing, rules: TransferRules) -> None:
        self.outcome: dict[str, float] | None = None
        self.wake_at_s: float | None = None
        self._open = list(dict.fromkeys(names))
        self._state = state
        self._addressing = addressing
        self._rules = rules
        self._tries = 0
        self._read: dict[str, float] = {}

    def start(self, now_s: float) -> Messages:
        return self._asked(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if (
            self.outcome is None
            and message.get_type() == "PARAM_VALUE"
            and self._addressing.has_sent(message)
            and message.param_id in self._open
        ):
            if message.param_id in self._state.parameters:
                self._read[message.param_id] = self._state.parameters[message.param_id]
            self._open.remove(message.param_id)
            if not self._open:
                self._end()
        return []

    def tick(self, now_s: float) -> Messages:
        return [] if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s else self._asked(now_s)

    def _asked(self, now_s: float) -> Messages:
        if not self._open or self._tries > self._rules.retries:
            return self._end()
        self._tries += 1
        self.wake_at_s = now_s + self._rules.timeout_s
        return [
            mavlink.MAVLink_param_request_read_message(self._addressing.system, self._addressing.component, name.encode(), BY_NAME)
            for name in self._open
        ]

    def _end(self) -> Messages:
        self.outcome, self.wake_at_s = self._read, None
        return []


class ParameterSetting:
    """Sets a parameter until the vehicle reports the value, then reads it back. `outcome` is whether the vehicle has it.

    `state` must receive each message first.
    """

    def __init__(self, name: str, value: float, state: VehicleState, addressing: Addressing, rules: TransferRules) -> None:
        self.outcome: CommandOutcome | None = None
        self.wake_at_s: float | None = None
        self._name, self._value = name, value
        self._state = state
        self._addressing = addressing
        self._rules = rules
        self._tries = 0
        self._is_set = False  # the vehicle reported the value: it is read back
        self._other: float | None = None  # the value reported instead

    def start(self, now_s: float) -> Messages:
        return self._asked(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        if self.outcome is not None or message.get_type() != "PARAM_VALUE" or not self._addressing.has_sent(message):
            return []
        if message.param_id != self._name:
            return []
        reported = self._state.parameters.get(self._name)
        if reported is None or not math.isclose(reported, self._value, rel_tol=1e-5, abs_tol=1e-3):
            self._other, self._is_set = reported, False
            return []
        if self._is_set:
            self.outcome, self.wake_at_s = self._outcome(CommandEnd.APPLIED, "", "parameter_read_back", self._value), None
            return []
        self._is_set, self._tries = True, 0
        return self._asked(now_s)

    def tick(self, now_s: float) -> Messages:
        return [] if self.outcome is not None or self.wake_at_s is None or now_s < self.wake_at_s else self._asked(now_s)

    def _asked(self, now_s: float) -> Messages:
        if self._tries > self._rules.retries:
            self.wake_at_s = None
            if self._other is None:
                self.outcome = self._outcome(CommandEnd.FAILED, "silent", "parameter_unanswered")
            else:
                self.outcome = self._outcome(CommandEnd.FAILED, "denied", "parameter_kept", self._other)
            return []
        self._tries += 1
        self.wake_at_s = now_s + self._rules.timeout_s
        system, component, name = self._addressing.system, self._addressing.component, self._name.encode()
        if self._is_set:
            return [mavlink.MAVLink_param_request_read_message(system, component, name, BY_NAME)]
        return [mavlink.MAVLink_param_set_message(system, component, name, self._value, mavlink.MAV_PARAM_TYPE_REAL32)]

    def _outcome(self, state: CommandEnd, code: str, reason: str, value: float | None = None) -> CommandOutcome:
        params = {"parameter": self._name} | ({} if value is None else {"value": value})
        return CommandOutcome(state, code, (Reason(reason, params),))
