"""What makes a UAV safe, said into the dark: nothing is heard of the vehicle, and it may hear us all the same.

What is known of it is old, so only a mode is asked for that is right in the air and does nothing on the ground: an abort is a return here.
It never disarms, and never lands what was to return: whether a return was refused cannot be heard.
"""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Ends, Message
from mavlink.autopilot_type import Flavour, Mode
from mavlink.commands.actions import Order, mode_numbers

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 15.0  # at first often, for every second counts; then seldom: a pilot may have taken over
MODES = {Order.HOLD: Mode.HOLD, Order.RETURN: Mode.RETURN, Order.ABORT: Mode.RETURN, Order.LAND: Mode.LAND}


def blind_message(order: Order, flavour: Flavour, ends: Ends, sent: int) -> Message:
    """The same again after it was sent so often. `order` is one of MODES, `flavour` one that is commanded."""
    numbers = mode_numbers(flavour, MODES[order])
    return mavlink.MAVLink_command_long_message(ends.system, ends.component, mavlink.MAV_CMD_DO_SET_MODE, min(sent, 255), *numbers)


def pause_s(sent: int) -> float:
    """After so many."""
    return min(FIRST_PAUSE_S * 2.0 ** max(sent - 1, 0), LONGEST_PAUSE_S)
