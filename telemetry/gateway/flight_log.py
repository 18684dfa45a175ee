"""A tlog file: every frame of one flight, in both directions, as the tools of MAVLink read it.

Each frame stands behind the time in microseconds since 1970, in 8 bytes, the first the highest. What carries a key is not written.
"""

import contextlib
import os
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from pymavlink.dialects.v20 import ardupilotmega as mavlink

CARRY_KEYS = frozenset({mavlink.MAVLINK_MSG_ID_SETUP_SIGNING})
BUFFER = 64 * 1024


@dataclass
class FlightRecorder:
    """One open file. A disk that is full, or a log that is too long, ends the writing, nothing else."""

    path: Path
    most_bytes: int
    size_bytes: int = 0
    is_complete: bool = True
    _file: BinaryIO | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True, mode=0o750)
            self._file = self.path.open("xb", buffering=BUFFER)
        except OSError:
            self.is_complete = False

    def write(self, raw: bytes, message_id: int, now_s: float) -> None:
        if self._file is None or message_id in CARRY_KEYS:
            return
        if self.size_bytes + 8 + len(raw) > self.most_bytes:
            self._stop()
            return
        try:
            self._file.write(struct.pack(">Q", int(now_s * 1e6)) + raw)
        except OSError:
            self._stop()
            return
        self.size_bytes += 8 + len(raw)

    def sync(self) -> None:
        """What was written is on the disk afterwards. May take its time: not for the loop."""
        if self._file is None:
            return
        try:
            self._file.flush()
            os.fsync(self._file.fileno())
        except (OSError, ValueError):  # closed meanwhile
            self._stop()

    def close(self) -> None:
        self.sync()
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.close()
            self._file = None

    def _stop(self) -> None:
        self.is_complete = False
        if self._file is not None:
            with contextlib.suppress(OSError, ValueError):
                self._file.close()
            self._file = None
