"""Commands that ask for messages, or say how often they are to come."""

from collections.abc import Callable
from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from simulation.vehicle_protocol import identity
from simulation.vehicle_protocol.command_door import Command
from simulation.vehicle_protocol.flavour import Flavour
from simulation.vehicle_protocol.pilot import ACCEPTED, DENIED, UNSUPPORTED
from simulation.vehicle_protocol.reports import REPORTS, Report, home
from simulation.vehicle_protocol.streams import Streams

Answer = tuple[int, list[Message]]  # a MAV_RESULT, and what was asked for


@dataclass
class Requests:
    """`report` is the vehicle's state of this moment."""

    flavour: Flavour
    system: int
    streams: Streams
    report: Callable[[], Report]

    def answer(self, command: Command) -> Answer | None:
        """None for a command that asks for nothing."""
        asked = _ANSWERS.get(command.number)
        return None if asked is None else asked(self, command)

    def _message(self, command: Command) -> Answer:
        number = command.whole(1)
        if number == mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return ACCEPTED, [identity.version(self.flavour, self.system)]
        if number == mavlink.MAVLINK_MSG_ID_MESSAGE_INTERVAL:
            return self._told_interval(command.whole(2))
        if number is None or number not in REPORTS:
            return UNSUPPORTED, []
        return ACCEPTED, [REPORTS[number](self.report())]

    def _set_interval(self, command: Command) -> Answer:
        """Heartbeats go by the wall's clock, whatever anybody wants."""
        number = command.whole(1)
        if number is None or number not in REPORTS or number == mavlink.MAVLINK_MSG_ID_HEARTBEAT:
            return UNSUPPORTED, []
        return (ACCEPTED if self.streams.set_interval(number, command[2]) else DENIED), []

    def _interval(self, command: Command) -> Answer:
        return self._told_interval(command.whole(1))

    def _told_interval(self, number: int | None) -> Answer:
        if number is None or not 0 <= number <= 0xFFFF:
            return DENIED, []
        return ACCEPTED, [mavlink.MAVLink_message_interval_message(number, self.streams.interval_us(number))]

    def _version(self, command: Command) -> Answer:
        return ACCEPTED, [identity.version(self.flavour, self.system)]

    def _home(self, command: Command) -> Answer:
        return ACCEPTED, [home(self.report())]


_ANSWERS: dict[int, Callable[[Requests, Command], Answer]] = {
    mavlink.MAV_CMD_REQUEST_MESSAGE: Requests._message,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: Requests._set_interval,
    mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: Requests._interval,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: Requests._version,
    mavlink.MAV_CMD_GET_HOME_POSITION: Requests._home,
}
