"""Parses commands once, so that handlers receive no NaN, infinity or scaled integer positions."""

import math
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.vehicle_protocol.item_rules import ABOVE_SEA, PLACED_FRAMES
from simulation.vehicle_protocol.streams import Outgoing, Station

E7 = 1e7
NO_PLACE_E7 = 2**31 - 1  # in COMMAND_INT: same as NaN in COMMAND_LONG
Seven = tuple[
    float | None, float | None, float | None, float | None, float | None, float | None, float | None
]  # fmt: skip


class NotFinite(ValueError):
    """A parameter is infinite, which is invalid in every command."""


@dataclass(frozen=True)
class ReceivedCommand:
    """A command. `values` are its seven parameters, None for the vehicle's choice; 5 and 6 of a place are latitude and longitude [deg].

    `is_above_sea` is the reference of the seventh, if the message has it; COMMAND_LONG does not. `is_frame_known` is False for other
    references, such as above ground.
    """

    number: int
    values: Seven
    is_above_sea: bool | None = None
    is_frame_known: bool = True

    def __getitem__(self, number: int) -> float | None:
        """Return a parameter, counted from 1."""
        return self.values[number - 1]

    def whole(self, number: int) -> int | None:
        """Return the parameter as an integer; None if it is none or not set."""
        value = self[number]
        return int(value) if value is not None and value == int(value) else None


def command_of(message: Any) -> ReceivedCommand:
    """Parse COMMAND_LONG or COMMAND_INT. Raises NotFinite."""
    first = (message.param1, message.param2, message.param3, message.param4)
    if message.get_type() == "COMMAND_LONG":
        return ReceivedCommand(message.command, _finite(*first, message.param5, message.param6, message.param7))
    place = (math.nan if value == NO_PLACE_E7 else value / E7 for value in (message.x, message.y))
    is_known = message.frame in PLACED_FRAMES
    return ReceivedCommand(message.command, _finite(*first, *place, message.z), message.frame in ABOVE_SEA if is_known else None, is_known)


def acknowledgement(number: int, result: int, station: Station) -> Outgoing:
    return Outgoing(mavlink.MAVLink_command_ack_message(number, int(result), 0, 0, *station.target), station)


def _finite(*values: float) -> Seven:
    if any(math.isinf(value) for value in values):
        raise NotFinite
    one, two, three, four, five, six, seven = (None if math.isnan(value) else float(value) for value in values)
    return (one, two, three, four, five, six, seven)
