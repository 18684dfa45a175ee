"""Aborts: on the ground, in the air, and while the UAV leaves the ground."""

import math
from dataclasses import dataclass
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.commands.actions import Order
from mavlink.commands.command import CommandEnd
from mavlink.commands.driver import CommandDriver
from mavlink.vehicle_state import VehicleState
from tests.mavlink.commands.orders_given import (
    APPLIED,
    ARM,
    MODES,
    RULES,
    SET_MODE,
    mode_of,
    reported,
    vehicle_of,
)
from tests.mavlink.mission_sync.test_upload import received
from tests.telemetry.vehicles.loads import ADDRESSING, AUTOPILOT_TYPES
from tests.telemetry.vehicles.vehicle import GROUND, Vehicle


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_abort_on_the_ground_disarms(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type)
    vehicle.is_armed = True
    assert reported(vehicle, Order.ABORT)[0] == APPLIED
    assert not vehicle.is_armed


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_abort_lands_where_the_return_is_refused(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type, mode="mission", in_air=True)
    carried_out = vehicle.carry_out
    back = float(MODES[autopilot_type]["return"])
    vehicle.carry_out = lambda command, values: 2 if back in values[1:3] else carried_out(command, values)  # type: ignore[method-assign]
    assert reported(vehicle, Order.ABORT)[0] == APPLIED
    assert mode_of(vehicle) == MODES[autopilot_type]["land"]


@dataclass
class LeavesGround:
    """A mission that was started before: the vehicle leaves the ground so many seconds after it was told to disarm, and says no to it."""

    vehicle: Vehicle
    after_s: float
    answers: bool = True

    def __post_init__(self) -> None:
        self.vehicle.is_armed, self._reported_s = True, math.inf
        self._tick, self._receive = self.vehicle.tick, self.vehicle.receive
        self.vehicle.tick, self.vehicle.receive = self.tick, self.receive  # type: ignore[method-assign]

    def receive(self, message: Any, now_s: float) -> list[Any]:
        if message.get_type() == "COMMAND_LONG" and message.command == ARM:
            self._reported_s = min(self._reported_s, now_s)
            return [mavlink.MAVLink_command_ack_message(ARM, mavlink.MAV_RESULT_DENIED, 0, 0, *GROUND)] if self.answers else []
        return self._receive(message, now_s)

    def tick(self, now_s: float) -> list[Any]:
        self.vehicle.is_in_air = self.vehicle.is_in_air or now_s >= self._reported_s + self.after_s
        return self._tick(now_s)


@pytest.mark.parametrize("answers", [True, False])
@pytest.mark.parametrize("after_s", [0.1, 0.9, 2.0])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_abort_during_the_take_off_calls_the_uav_back(autopilot_type: str, after_s: float, answers: bool):
    vehicle = vehicle_of(autopilot_type, mode="mission")
    LeavesGround(vehicle, after_s, answers)
    outcome, channel = reported(vehicle, Order.ABORT)
    assert (outcome.state, mode_of(vehicle)) == (CommandEnd.APPLIED, MODES[autopilot_type]["return"])
    assert channel.now_s < after_s + 3.0


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_abort_with_a_landed_state_that_is_too_old_does_not_disarm(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type, mode="mission")
    state = VehicleState(vehicle.system)
    vehicle.is_armed = True
    for message in vehicle.reports():
        state.receive(received(message), 0.0)
    vehicle.is_in_air = True
    beat = received(vehicle.reports()[0])  # EXTENDED_SYS_STATE is lost from now on
    state.receive(beat, RULES.fresh_s + 0.5)
    keeper = CommandDriver(Order.ABORT, state, ADDRESSING, RULES)
    assert [message.command for message in keeper.start(RULES.fresh_s + 0.6)] == [SET_MODE]


@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_abort_that_is_refused_every_way_is_tried_again(autopilot_type: str):
    vehicle = vehicle_of(autopilot_type, mode="mission", in_air=True)
    carried_out, noes = vehicle.carry_out, iter([2, 2])  # return and land are refused once

    vehicle.carry_out = lambda command, values: next(noes, None) or carried_out(command, values)  # type: ignore[method-assign]
    assert reported(vehicle, Order.ABORT)[0] == APPLIED
    assert mode_of(vehicle) == MODES[autopilot_type]["return"]


@pytest.mark.parametrize("order", [Order.ABORT, Order.LAND, Order.RETURN, Order.HOLD])
@pytest.mark.parametrize("autopilot_type", AUTOPILOT_TYPES)
def test_a_start_that_arrives_after_what_makes_it_safe_does_not_last(autopilot_type: str, order: Order):
    """It was sent before, and a radio held it back."""
    vehicle, state = vehicle_of(autopilot_type, mode="mission", in_air=True), VehicleState(7)
    flying = vehicle.custom_mode
    keeper = CommandDriver(order, state, ADDRESSING, RULES, unsettled_until_s=2.0)
    frames = mavlink.MAVLink(None, srcSystem=vehicle.system, srcComponent=1)
    now_s, sent = 0.0, 0

    def receive_all(messages: list[Any]) -> None:
        for message in messages:
            parsed = mavlink.MAVLink(None).parse_char(message.pack(frames))
            state.receive(parsed, now_s)
            notify(keeper.receive(parsed, now_s) if keeper.wake_at_s is not None else [])

    def notify(messages: list[Any]) -> None:
        nonlocal sent
        for message in messages:
            sent += 1
            receive_all(vehicle.receive(message, now_s))

    receive_all(vehicle.reports())
    notify(keeper.start(now_s))
    for step in range(1, 60):
        now_s = step / 10
        if step == 10:
            assert keeper.outcome is None and vehicle.custom_mode != flying
            vehicle.custom_mode = flying
        receive_all(vehicle.reports() if step % 5 == 0 else [])
        notify(keeper.tick(now_s))
        if keeper.outcome is not None:
            break
    assert (keeper.outcome, sent) == (APPLIED, 2) and now_s >= 2.0
    assert mode_of(vehicle) == MODES[autopilot_type]["return" if order is Order.ABORT else order.value]
