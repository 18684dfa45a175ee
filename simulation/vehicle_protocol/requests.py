"""Commands that request messages or set their intervals."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from simulation.vehicle_protocol.camera_endpoint import CameraEndpoint
from simulation.vehicle_protocol.command_endpoint import ReceivedCommand
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.pilot import ACCEPTED, DENIED, UNSUPPORTED
from simulation.vehicle_protocol.reports import REPORTS, SimulatedReport, home
from simulation.vehicle_protocol.streams import Outgoing, Station, Streams

CAPABILITIES = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
)  # fmt: skip
DEVELOPMENT = 0  # firmware type: a development version is not compared with the latest release
VERSIONS = {SimulatedAutopilot.PX4: (1, 15, 0), SimulatedAutopilot.ARDUPILOT: (4, 6, 0)}
VENDOR, PRODUCT = 0x5350, 0x5349
NO_NETWORK = 0
HEADER, PAYLOAD = 12, 251
TERMINATE_SESSION, RESET_SESSIONS = 1, 2
OPENING = frozenset({4, 11})  # for reading, for writing; 6 would create a file
ACK, NAK = 128, 129
UNKNOWN_COMMAND, FILE_NOT_FOUND = 7, 10
_MAX_NS = 2**63 - 1
Answer = tuple[int, list[Message]]  # a MAV_RESULT, and the requested messages


def version(autopilot_type: SimulatedAutopilot, system: int) -> Message:
    """Return AUTOPILOT_VERSION; the unique id is the system id, with a prefix for simulated UAVs."""
    major, minor, patch = VERSIONS[autopilot_type]
    firmware = major << 24 | minor << 16 | patch << 8 | DEVELOPMENT
    nothing = [0] * 8
    unique = int.from_bytes(b"SIMUAV\0\0", "big") | system
    return mavlink.MAVLink_autopilot_version_message(
        CAPABILITIES, firmware, firmware, 0, 0, nothing, nothing, nothing, VENDOR, PRODUCT, unique
    )


def refused(message: Any, station: Station) -> list[Outgoing]:
    """Return the answer to FILE_TRANSFER_PROTOCOL. There are no sessions, so only ending one succeeds."""
    asked = bytes(message.payload[:HEADER])
    if len(asked) < HEADER or asked[3] >= ACK:
        return []
    sequence = (int.from_bytes(asked[:2], "little") + 1) & 0xFFFF
    opcode, session = asked[3], asked[2]
    answer = bytearray(PAYLOAD)
    answer[:2] = sequence.to_bytes(2, "little")
    answer[2], answer[5] = session, opcode
    if opcode in (TERMINATE_SESSION, RESET_SESSIONS):
        answer[3] = ACK
    else:
        answer[3], answer[4] = NAK, 1
        answer[HEADER] = FILE_NOT_FOUND if opcode in OPENING else UNKNOWN_COMMAND
    return [Outgoing(mavlink.MAVLink_file_transfer_protocol_message(NO_NETWORK, *station.target, list(answer)), station)]


def timesync_answer(message: Any, station: Station, now_s: float) -> list[Outgoing]:
    """Return the answer to TIMESYNC. now_s: of a monotonic clock. A message with tc1 set is itself an answer."""
    if message.tc1 != 0:
        return []
    now_ns = min(int(now_s * 1e9), _MAX_NS)
    return [Outgoing(mavlink.MAVLink_timesync_message(now_ns, message.ts1), station)]


def ping_answer(message: Any, station: Station) -> list[Outgoing]:
    """Return the answer to a PING to all; a PING with a target is an answer itself."""
    if (message.target_system, message.target_component) != (0, 0):
        return []
    return [Outgoing(mavlink.MAVLink_ping_message(message.time_usec, message.seq, *station.target), station)]


@dataclass
class Requests:
    """`report` returns the vehicle's present state."""

    autopilot_type: SimulatedAutopilot
    system: int
    streams: Streams
    report: Callable[[], SimulatedReport]
    camera: CameraEndpoint

    def answer(self, command: ReceivedCommand) -> Answer | None:
        """Return the answer; None for a command that requests nothing."""
        asked = _ANSWERS.get(command.number)
        return None if asked is None else asked(self, command)

    def _message(self, command: ReceivedCommand) -> Answer:
        number = command.whole(1)
        if number == mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return ACCEPTED, [version(self.autopilot_type, self.system)]
        if number == mavlink.MAVLINK_MSG_ID_MESSAGE_INTERVAL:
            return self._reported_interval(command.whole(2))
        if number == mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION and self.autopilot_type is SimulatedAutopilot.ARDUPILOT:
            information = self.camera.answer(command, self.report())
            return ACCEPTED, [] if information is None else [information]
        if number is None or number not in REPORTS:
            return UNSUPPORTED, []
        return ACCEPTED, [REPORTS[number](self.report())]

    def _set_interval(self, command: ReceivedCommand) -> Answer:
        """Set an interval; heartbeats always use real time."""
        number = command.whole(1)
        if number is None or number not in REPORTS or number == mavlink.MAVLINK_MSG_ID_HEARTBEAT:
            return UNSUPPORTED, []
        return (ACCEPTED if self.streams.set_interval(number, command[2]) else DENIED), []

    def _interval(self, command: ReceivedCommand) -> Answer:
        return self._reported_interval(command.whole(1))

    def _reported_interval(self, number: int | None) -> Answer:
        if number is None or not 0 <= number <= 0xFFFF:
            return DENIED, []
        return ACCEPTED, [mavlink.MAVLink_message_interval_message(number, self.streams.interval_us(number))]

    def _version(self, command: ReceivedCommand) -> Answer:
        return ACCEPTED, [version(self.autopilot_type, self.system)]

    def _home(self, command: ReceivedCommand) -> Answer:
        return ACCEPTED, [home(self.report())]


_ANSWERS: dict[int, Callable[[Requests, ReceivedCommand], Answer]] = {
    mavlink.MAV_CMD_REQUEST_MESSAGE: Requests._message,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: Requests._set_interval,
    mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: Requests._interval,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: Requests._version,
    mavlink.MAV_CMD_GET_HOME_POSITION: Requests._home,
}
