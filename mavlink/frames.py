"""Converts bytes of MAVLink 1 and 2 to frames and frames to messages. Received bytes cannot make it raise.

Only frames with a correct checksum are returned. The checksum includes a seed of the message, so a message missing from the dialect cannot
be checked and is dropped. After a fault the search goes on at the next byte: garbage, a cut frame or a wrong length loses no later frame.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

Message = Any  # pymavlink creates its message classes at run time

MARKER_V1, MARKER_V2 = 0xFE, 0xFD
HEADER_V1, HEADER_V2 = 6, 10  # bytes, with the marker
CHECKSUM = 2
SIGNATURE = 13  # link id, 6 bytes of time, 6 bytes of hash
IS_SIGNED = 0x01  # incompatibility flag; a frame with any other such flag must be dropped
MAX_FAULTS = 512  # per datagram or piece of a stream; the rest is dropped, which bounds the work
MAX_FRAME_LENGTH = HEADER_V2 + 255 + CHECKSUM + SIGNATURE
_MARKERS = (bytes([MARKER_V1]), bytes([MARKER_V2]))


class Damage(StrEnum):
    """Why bytes were not a frame."""

    NOT_MAVLINK = "not-mavlink"
    CUT = "cut"
    CHECKSUM = "checksum"
    UNKNOWN_MESSAGE = "unknown-message"
    UNKNOWN_FLAGS = "unknown-flags"


@dataclass(frozen=True, slots=True)
class Frame:
    """One intact frame with all its bytes in `raw`. link_id and timestamp [10 us since 2015] are those of its signature, if any."""

    raw: bytes
    version: int
    system: int
    component: int
    sequence: int
    message_id: int
    link_id: int | None = None
    timestamp: int | None = None

    @property
    def is_signed(self) -> bool:
        return self.timestamp is not None


def frames_of_datagram(datagram: bytes, damages: Counter[Damage]) -> list[Frame]:
    """Return the intact frames of one datagram. Frames never span datagrams."""
    frames, _ = _scan(datagram, damages, is_whole=True)
    return frames


@dataclass
class StreamParser:
    """Finds the frames of one connection, however its bytes are split. Holds at most one unfinished frame."""

    damages: Counter[Damage] = field(default_factory=Counter)
    _rest: bytes = b""

    def receive(self, piece: bytes) -> list[Frame]:
        frames, self._rest = _scan(self._rest + piece, self.damages, is_whole=False)
        return frames


_decoder = dialect.MAVLink(None)


def message_of(frame: Frame) -> Message | None:
    """Return the message of a frame; None if the dialect cannot decode it. Signatures are checked in signing.py."""
    try:
        message = _decoder.decode(bytearray(frame.raw))
    except dialect.MAVError:
        return None
    return message


def _scan(data: bytes, damages: Counter[Damage], *, is_whole: bool) -> tuple[list[Frame], bytes]:
    """Return the frames of data, and the rest, which may begin another frame."""
    frames: list[Frame] = []
    place = 0
    faults = 0
    is_lost = False  # within bytes already counted as damage
    for start in _markers(data):
        if start < place:
            continue
        if faults == MAX_FAULTS:
            return frames, b""
        if start > place and not is_lost:
            damages[Damage.NOT_MAVLINK] += 1
        found = _frame_at(data, start)
        if isinstance(found, Frame):
            frames.append(found)
            place, is_lost = start + len(found.raw), False
            continue
        if found is Damage.CUT and not is_whole:
            return frames, data[start:]
        damages[found] += 1
        faults += 1
        place, is_lost = start + 1, True
    if place < len(data) and not is_lost:
        damages[Damage.NOT_MAVLINK] += 1
    return frames, b""


def _markers(data: bytes) -> Iterator[int]:
    """Yield the places in data where a frame may begin, in order."""
    nexts = [data.find(marker) for marker in _MARKERS]
    while max(nexts) >= 0:
        index = min((place, index) for index, place in enumerate(nexts) if place >= 0)[1]
        yield nexts[index]
        nexts[index] = data.find(_MARKERS[index], nexts[index] + 1)


def _frame_at(data: bytes, start: int) -> Frame | Damage:
    is_v2 = data[start] == MARKER_V2
    header = HEADER_V2 if is_v2 else HEADER_V1
    if len(data) < start + header:
        return Damage.CUT
    flags = data[start + 2] if is_v2 else 0
    if flags & ~IS_SIGNED:
        return Damage.UNKNOWN_FLAGS
    message_id = int.from_bytes(data[start + 7 : start + 10], "little") if is_v2 else data[start + 5]
    known = dialect.mavlink_map.get(message_id)
    if known is None:
        return Damage.UNKNOWN_MESSAGE
    payload_end = start + header + data[start + 1]
    end = payload_end + CHECKSUM + (SIGNATURE if flags & IS_SIGNED else 0)
    if len(data) < end:
        return Damage.CUT
    checksum = dialect.x25crc(data[start + 1 : payload_end] + bytes([known.crc_extra])).crc
    if checksum != int.from_bytes(data[payload_end : payload_end + CHECKSUM], "little"):
        return Damage.CHECKSUM
    sequence, system, component = data[start + 4 : start + 7] if is_v2 else data[start + 2 : start + 5]
    if not flags & IS_SIGNED:
        return Frame(data[start:end], 2 if is_v2 else 1, system, component, sequence, message_id)
    timestamp = int.from_bytes(data[end - 12 : end - 6], "little")
    return Frame(data[start:end], 2, system, component, sequence, message_id, data[end - SIGNATURE], timestamp)
