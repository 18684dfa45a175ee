"""Frames out of tlog files, as they were logged."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from missions.mavlink.frames import HEADER_V1, HEADER_V2, IS_SIGNED, MARKER_V2, SIGNATURE, frames_of_datagram, message_of


def frames_of_tlog(path: Path) -> list[tuple[float, bytes]]:
    """Each with its time [s since 1970]; those of messages that nobody knows too."""
    data, frames, place = path.read_bytes(), [], 0
    while place + 8 + HEADER_V1 <= len(data):
        at_s = int.from_bytes(data[place : place + 8], "big") / 1e6
        start = place + 8
        is_v2 = data[start] == MARKER_V2
        length = (HEADER_V2 if is_v2 else HEADER_V1) + data[start + 1] + 2 + (SIGNATURE if is_v2 and data[start + 2] & IS_SIGNED else 0)
        frames.append((at_s, data[start : start + length]))
        place = start + length
    return frames


def positions_of(raws: Iterable[bytes]) -> list[Any]:
    found = (frame for raw in raws for frame in frames_of_datagram(raw, Counter()))
    messages = (message_of(frame) for frame in found if frame.message_id == 33)
    return [message for message in messages if message is not None]
