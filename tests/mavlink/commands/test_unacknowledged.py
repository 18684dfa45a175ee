"""What is said to a vehicle that is not heard: a mode that is safe in the air and does nothing on the ground."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing
from mavlink.autopilot_type import AutopilotType
from mavlink.commands.actions import Order, pause_s, unacknowledged_message

PX4_MODES = {Order.HOLD: 3, Order.RETURN: 5, Order.ABORT: 5, Order.LAND: 6}
COPTER_MODES = {Order.HOLD: 17, Order.RETURN: 6, Order.ABORT: 6, Order.LAND: 9}


@pytest.mark.parametrize("order", PX4_MODES)
def test_a_mode_is_asked_for_and_nothing_else(order):
    px4 = unacknowledged_message(order, AutopilotType.PX4, Addressing(7), 0)
    copter = unacknowledged_message(order, AutopilotType.ARDUPILOT, Addressing(7), 300)
    assert {px4.command, copter.command} == {mavlink.MAV_CMD_DO_SET_MODE}
    assert {px4.target_system, copter.target_system} == {7}
    assert (px4.param1, px4.param2, px4.param3) == (1.0, 4.0, PX4_MODES[order])
    assert (copter.param1, copter.param2) == (1.0, COPTER_MODES[order])
    assert (px4.confirmation, copter.confirmation) == (0, 255)


def test_it_is_said_often_at_first_and_seldom_then():
    assert [pause_s(sent) for sent in (1, 2, 3, 4, 5, 6, 600)] == [1.0, 2.0, 4.0, 8.0, 15.0, 15.0, 15.0]
