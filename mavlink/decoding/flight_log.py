"""Photos of a tlog file: frames, each after its time as 8 bytes of microseconds since 1970."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

from mavlink.addressing import AUTOPILOT
from mavlink.decoding.boots import VehicleTime
from mavlink.decoding.captures import CaptureDecoder, CaptureMessage
from mavlink.decoding.report import is_vehicle
from mavlink.frames import HEADER_V1, HEADER_V2, IS_SIGNED, MARKER_V1, MARKER_V2, SIGNATURE, Frame, Message, frames_of_datagram, message_of
from mavlink.vehicle_state import VehicleState

TIME_BYTES, CHECKSUM_BYTES = 8, 2
SEND_TIME = frozenset({"GLOBAL_POSITION_INT", "ATTITUDE", "SYSTEM_TIME"})


@dataclass(frozen=True, slots=True)
class LoggedCapture:
    """A report of a photo, when it was received [s since 1970], the run of the vehicle's clock, and the item that its list was at."""

    received_s: float
    stream: str
    report: CaptureMessage
    mission_item: int | None


def frames_of_tlog(file: BinaryIO) -> Iterator[tuple[float, bytes]]:
    """Yield each frame with its time [s since 1970], also those of unknown messages. Ends where the file is cut or is no tlog."""
    while len(head := file.read(TIME_BYTES + 3)) == TIME_BYTES + 3:
        marker, length, flags = head[TIME_BYTES:]
        if marker not in (MARKER_V1, MARKER_V2):
            return
        is_v2 = marker == MARKER_V2
        rest = (HEADER_V2 if is_v2 else HEADER_V1) + length + CHECKSUM_BYTES + (SIGNATURE if is_v2 and flags & IS_SIGNED else 0) - 3
        body = file.read(rest)
        if len(body) < rest:
            return
        yield int.from_bytes(head[:TIME_BYTES], "big") / 1e6, head[TIME_BYTES:] + body


def captures_of_tlog(file: BinaryIO) -> Iterator[LoggedCapture]:
    """Yield the reports of photos by the first vehicle of the log, as a gateway stored them on receipt."""
    state: VehicleState | None = None
    clock, photos = VehicleTime(), CaptureDecoder()
    for at_s, raw in frames_of_tlog(file):
        for frame in frames_of_datagram(raw, Counter()):
            message = message_of(frame)
            if message is None:
                continue
            if state is None and message.get_type() == "HEARTBEAT" and frame.component == AUTOPILOT and is_vehicle(message):
                state = VehicleState(frame.system)
            if state is None or frame.system != state.system:
                continue
            _note_time(clock, frame, message, at_s)
            state.receive(message, at_s)
            report = photos.receive(message, clock, state.autopilot_type, at_s)
            if report is not None:
                yield LoggedCapture(at_s, clock.stream, report, state.mission_item)


def _note_time(clock: VehicleTime, frame: Frame, message: Message, at_s: float) -> None:
    kind = message.get_type()
    if frame.component == AUTOPILOT and kind in SEND_TIME:
        unix_s = message.time_unix_usec / 1e6 if kind == "SYSTEM_TIME" else None
        clock.receive(message.time_boot_ms, at_s, unix_s=unix_s)
