"""One order to one vehicle, carried out and seen in what the vehicle reports."""

from collections.abc import Mapping

from mavlink.addressing import Addressing, Message, Messages
from mavlink.commands.actions import STOPS, CannotOrder, Order, OrderPlan, plan_of
from mavlink.commands.command import CommandEnd, CommandMachine, CommandOutcome
from mavlink.script import Course, NextHeartbeat, Pause, Steps
from mavlink.timeouts import CommandRules
from mavlink.vehicle_state import VehicleState
from operation.reasons import Reason

UNDONE_ROUNDS = 3


class CommandDriver:
    """Drives an order to its goal. `state` is to have taken each message before the keeper gets it.

    Where the vehicle is already so, it ends as applied, and nothing is sent. That is told by a heartbeat that came after the order was
    given, within `fresh_s`, and, where something else was sent to the vehicle shortly before, after `unsettled_until_s`: one of before the
    order may be of before somebody else told the vehicle otherwise. What makes a UAV
    safe must still show then: a start that was sent before it, and arrives after it, would take it back.
    """

    def __init__(
        self,
        order: Order,
        state: VehicleState,
        addressing: Addressing,
        rules: CommandRules,
        *,
        parameters: Mapping[str, float] | None = None,
        unsettled_until_s: float | None = None,
    ) -> None:
        self.order = order
        self.is_acknowledged = False  # the vehicle said yes to a command of it
        self._state = state
        self._addressing = addressing
        self._rules = rules
        self._parameters = dict(parameters or {})
        self._unsettled_until_s = unsettled_until_s
        self._begun_s = 0.0
        self._now_s = 0.0
        self._steps = Steps(self._course())

    @property
    def outcome(self) -> CommandOutcome | None:
        return self._steps.outcome

    @property
    def wake_at_s(self) -> float | None:
        return self._steps.wake_at_s

    def start(self, now_s: float) -> Messages:
        self._begun_s = self._now_s = now_s
        return self._steps.start(now_s)

    def receive(self, message: Message, now_s: float) -> Messages:
        self._now_s = now_s
        return self._noting(self._steps.receive(message, now_s))

    def tick(self, now_s: float) -> Messages:
        self._now_s = now_s
        return self._noting(self._steps.tick(now_s))

    def _noting(self, messages: Messages) -> Messages:
        step = self._steps.step
        self.is_acknowledged = self.is_acknowledged or (isinstance(step, CommandMachine) and step.is_acknowledged)
        return messages

    def _course(self) -> Course[CommandOutcome]:
        done, has_waited = 0, False
        while True:
            try:
                plan = plan_of(self.order, self._state, self._parameters)
            except CannotOrder as refusal:
                return CommandOutcome(CommandEnd.FAILED, refusal.code, (refusal.reason,))
            if self._is_already(plan) and not has_waited:
                has_waited = True
                yield NextHeartbeat(self._state, self._begun_s, self._begun_s + self._rules.fresh_s)
                continue
            if self._is_already(plan) and (self._state.heartbeat_at_s or 0.0) > self._begun_s:
                return CommandOutcome(CommandEnd.APPLIED, "already", (Reason("done_already"),))
            if plan.goal is None and self._unsettled_until_s is not None:
                yield Pause(self._unsettled_until_s)  # else a late yes to an earlier one would be taken for the answer
            outcome = yield from self._tried(plan)
            done += 1
            if outcome.state is CommandEnd.APPLIED and self.order in STOPS and self._unsettled_until_s is not None:
                yield Pause(self._unsettled_until_s)
                if plan.goal is not None and not plan.goal(self._state):
                    if done < UNDONE_ROUNDS:
                        continue
                    return CommandOutcome(CommandEnd.FAILED, "undone", (Reason("undone"),))
            if outcome.state is CommandEnd.APPLIED or outcome.code == "silent" or done >= plan.rounds:
                return outcome

    def _tried(self, plan: OrderPlan) -> Course[CommandOutcome]:
        """All ways, one after the other."""
        failure = CommandOutcome(CommandEnd.FAILED)
        for way in plan.ways:
            for step in way:
                machine = CommandMachine(step, self._state, self._addressing, self._rules)
                yield machine
                ended = machine.outcome
                if ended is None or ended.state is CommandEnd.FAILED:
                    code, why = ("", ()) if ended is None else (ended.code, ended.why)
                    not_done = Reason("order_not_done", {"order": Reason(f"order_{self.order}"), "step": step.name})
                    failure = CommandOutcome(CommandEnd.FAILED, code, (not_done, *why))
                    break
                self.is_acknowledged = True
            else:
                return CommandOutcome(CommandEnd.APPLIED)
            if failure.code == "silent":  # it may have been heard: another way could undo it
                break
        return failure

    def _is_already(self, plan: OrderPlan) -> bool:
        if plan.goal is None or not self._state.is_fresh(self._now_s, self._rules.fresh_s):
            return False
        last_message_s = self._state.heartbeat_at_s or 0.0
        return (self._unsettled_until_s is None or last_message_s >= self._unsettled_until_s) and bool(plan.goal(self._state))
