"""A station that talks to an endpoint by real frames, without a socket."""

from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.vehicle_protocol.endpoint import Endpoint
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.streams import AUTOPILOT, Outgoing, Station
from tests.simulation.kinematic_uav import STEP_S, KinematicUav

SYSTEM = 7
TO = (SYSTEM, 1)
UNIX_S = 1_800_000_000.0
STATION = Station(255, 190, 1)


def over_the_wire(message: Any, system: int, component: int) -> Any:
    """As the other end gets it."""
    return mavlink.MAVLink(None).parse_char(bytes(message.pack(mavlink.MAVLink(None, srcSystem=system, srcComponent=component))))


@dataclass
class Talk:
    """`send` returns what comes back to everybody and to this station, `pass_by` what the autopilot says by itself meanwhile.

    `beside` keeps what the camera and the gimbal have said by themselves.
    """

    autopilot_type: SimulatedAutopilot = SimulatedAutopilot.PX4
    uav: Any = field(default_factory=KinematicUav)
    now_s: float = 0.0
    station: Station = STATION
    beside: list[Any] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.endpoint = Endpoint(self.uav, autopilot_type=self.autopilot_type, system=SYSTEM, unix_at_zero_s=UNIX_S)
        self.endpoint.tick(self.now_s)

    def send(self, *messages: Any, station: Station | None = None) -> list[Any]:
        who = station or self.station
        answers: list[Outgoing] = []
        for message in messages:
            answers += self.endpoint.receive(over_the_wire(message, who.system, who.component), who, self.now_s)
        assert all(answer.to in (None, who) for answer in answers)
        return [over_the_wire(answer.message, SYSTEM, answer.component) for answer in answers]

    def pass_by(self, seconds: float, wall_s: float | None = None) -> list[Any]:
        """So many simulated seconds, in as many of the wall unless told otherwise."""
        steps = round(seconds / STEP_S)
        reported = []
        for _ in range(steps):
            self.uav.step()
            self.now_s += (seconds if wall_s is None else wall_s) / steps
            for one in self.endpoint.tick(self.now_s):
                message = over_the_wire(one.message, SYSTEM, one.component)
                (reported if one.component == AUTOPILOT else self.beside).append(message)
        return reported

    def command(self, number: int, *values: float) -> int:
        """The result of a COMMAND_LONG; what is not given is NaN, as MAVSDK leaves it."""
        parameters = [*values, *[float("nan")] * (7 - len(values))]
        answers = self.send(mavlink.MAVLink_command_long_message(*TO, number, 0, *parameters))
        (result,) = [answer.result for answer in answers if answer.get_type() == "COMMAND_ACK"]
        return int(result)

    @property
    def mode(self) -> tuple[int, int]:
        """PX4's main and sub mode; ArduPilot's number and 0."""
        number = self.endpoint.pilot.custom_mode
        return (number >> 16 & 0xFF, number >> 24) if self.autopilot_type is SimulatedAutopilot.PX4 else (number, 0)


def kinds(messages: list[Any]) -> list[str]:
    return [message.get_type() for message in messages]


def only(messages: list[Any], kind: str) -> Any:
    (found,) = [message for message in messages if message.get_type() == kind]
    return found
