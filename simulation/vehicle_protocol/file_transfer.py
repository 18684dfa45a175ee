"""File transfer, which a simulated UAV has not: said at once, so that a station asks by the other ways instead of waiting half a minute.

Source: MAVLink developer guide, "File Transfer Protocol"; payload: sequence (2 bytes), session, opcode, size, opcode asked, burst, padding,
offset (4 bytes), data.
"""

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from simulation.vehicle_protocol.stations import Outgoing, Station

NO_NETWORK = 0
HEADER, PAYLOAD = 12, 251
TERMINATE_SESSION, RESET_SESSIONS = 1, 2
OPENING = frozenset({4, 11})  # for reading, for writing; 6 would create a file
ACK, NAK = 128, 129
UNKNOWN_COMMAND, FILE_NOT_FOUND = 7, 10


def refused(message: Any, station: Station) -> list[Outgoing]:
    """The answer to FILE_TRANSFER_PROTOCOL; there is never a session, so that ending one is easily granted."""
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
    return [Outgoing(mavlink.MAVLink_file_transfer_protocol_message(NO_NETWORK, *station.ends, list(answer)), station)]
