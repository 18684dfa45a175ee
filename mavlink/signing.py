"""MAVLink 2 message signing: reads and checks signatures, and signs frames.

Source: MAVLink developer guide, "Message signing". In addition, a time more than a minute ahead is refused: it would advance the link's
clock and make all later frames too old. Only a valid signature changes any state.
"""

import hashlib
import hmac
from dataclasses import dataclass, field
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.frames import Frame, Message

UNITS_PER_S = 100_000  # 10 us each
EPOCH_UNIX_S = 1_420_070_400  # 2015-01-01
MAX_AGO_S = 60.0
FURTHEST_AHEAD_S = 60.0
MAX_STREAMS = 64  # components and links of one vehicle
TAG = 6
_MAX_TIMESTAMP = 2**48 - 1


class FrameRefusal(StrEnum):
    """Why a frame is not accepted from the UAV whose system id it has."""

    UNSIGNED = "unsigned"
    NO_KEY = "no-key"
    WRONG_SIGNATURE = "wrong-signature"
    REPLAYED = "replayed"
    TOO_OLD = "too-old"
    BEFORE_START = "before-start"
    FROM_THE_FUTURE = "from-the-future"
    TOO_MANY_STREAMS = "too-many-streams"


def timestamp_at(unix_s: float) -> int:
    """Return the signature timestamp: 10 us units since 2015."""
    return min(max(round((unix_s - EPOCH_UNIX_S) * UNITS_PER_S), 0), _MAX_TIMESTAMP)


def unix_s_of(timestamp: int) -> float:
    """Return a signature timestamp as seconds since 1970."""
    return timestamp / UNITS_PER_S + EPOCH_UNIX_S


def stream_of(frame: Frame) -> str:
    """Return component and link as "1:0": timestamps increase within each."""
    return f"{frame.component}:{frame.link_id}"


def tag_of(raw_without_tag: bytes, key: bytes) -> bytes:
    return hashlib.sha256(key + raw_without_tag).digest()[:TAG]


@dataclass
class SignatureCheck:
    """Checks signed frames of one vehicle. `last` is the newest timestamp by component and link, as "1:0".

    Frames from before the timestamp `since` may have been recorded while no gateway received them, and are refused.
    """

    key: bytes = field(repr=False)
    last: dict[str, int] = field(default_factory=dict)
    since: int = 0

    def refusal(self, frame: Frame, now_unix_s: float) -> FrameRefusal | None:
        """Return why a frame is refused; None accepts it and makes its timestamp the newest of its stream."""
        if frame.timestamp is None:
            return FrameRefusal.UNSIGNED
        if not self.is_signed_right(frame):
            return FrameRefusal.WRONG_SIGNATURE
        stream = stream_of(frame)
        before = self.last.get(stream)
        if before is not None and frame.timestamp <= before:
            return FrameRefusal.REPLAYED
        if frame.timestamp < timestamp_at(now_unix_s - MAX_AGO_S):
            return FrameRefusal.TOO_OLD
        if frame.timestamp < self.since:
            return FrameRefusal.BEFORE_START
        if frame.timestamp > timestamp_at(now_unix_s + FURTHEST_AHEAD_S):
            return FrameRefusal.FROM_THE_FUTURE
        if before is None and len(self.last) >= MAX_STREAMS:
            return FrameRefusal.TOO_MANY_STREAMS
        self.last[stream] = frame.timestamp
        return None

    def is_signed_right(self, frame: Frame) -> bool:
        return frame.is_signed and hmac.compare_digest(tag_of(frame.raw[:-TAG], self.key), frame.raw[-TAG:])


@dataclass
class FrameWriter:
    """Converts messages to frames. With a key they are signed, with increasing timestamps even if the clock goes back."""

    system: int
    component: int
    link_id: int = 0
    key: bytes | None = field(default=None, repr=False)
    last_timestamp: int = 0
    _sequence: int = 0

    def frame_of(self, message: Message, now_unix_s: float) -> bytes:
        packer = dialect.MAVLink(None, srcSystem=self.system, srcComponent=self.component)
        packer.seq = self._sequence
        self._sequence = (self._sequence + 1) % 256
        if self.key is not None:
            self.last_timestamp = min(max(timestamp_at(now_unix_s), self.last_timestamp + 1), _MAX_TIMESTAMP)
            packer.signing.secret_key = self.key
            packer.signing.link_id = self.link_id
            packer.signing.timestamp = self.last_timestamp
            packer.signing.sign_outgoing = True
        return bytes(message.pack(packer))
