"""Carries out one order to one vehicle and confirms it by what the vehicle reports."""

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
    """Drives an order to its goal.

    `state` must have received each message before the driver does. If the vehicle already is in the goal state, the order ends as applied
    and nothing is sent. That needs a heartbeat after the order, within `fresh_s`, because an earlier one may be older than another sender's
    command. If another command was sent shortly before, the heartbeat must also be after `unsettled_until_s`. A safety order must still
    show its effect then: a start sent before it may arrive after it and undo it.
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
        self.is_acknowledged = False  # the vehicle has accepted a command of this order
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
                yield Pause(self._unsettled_until_s)  # or a late acceptance of an earlier command would count as the answer
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
        """Try the alternatives in order."""
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
            if failure.code == "silent":  # the vehicle may have received it: an alternative could undo it
                break
        return failure

    def _is_already(self, plan: OrderPlan) -> bool:
        if plan.goal is None or not self._state.is_fresh(self._now_s, self._rules.fresh_s):
            return False
        last_message_s = self._state.heartbeat_at_s or 0.0
        return (self._unsettled_until_s is None or last_message_s >= self._unsettled_until_s) and bool(plan.goal(self._state))
