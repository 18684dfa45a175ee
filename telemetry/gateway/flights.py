"""Flight logs: a log begins when a vehicle arms and ends some seconds after it disarms.

A vehicle that arms and disarms in quick succession keeps one file. The event loop never waits for the disk.
"""

import asyncio
import contextlib
import logging
import os
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

from django.conf import settings
from django.db import transaction
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.models import Uav
from missions.services.commands.steering import mission_in_hand
from telemetry.gateway.database import DatabaseThread, DatabaseUnavailable
from telemetry.gateway.options import GatewayOptions
from telemetry.gateway.session import Session
from telemetry.models import FlightLog

CARRY_KEYS = frozenset({mavlink.MAVLINK_MSG_ID_SETUP_SIGNING})
BUFFER = 64 * 1024
logger = logging.getLogger(__name__)
SYNC_INTERVAL_S = 2.0
DISARMED_FOR_S = 2.0
FORGOTTEN_AFTER_S = 1_800.0  # a flight whose end was not received
ROWS_WAITING = 1_000


@transaction.atomic
def begin_flight_log(*, uav_id: int, path: str, started_at: datetime) -> None:
    """Store the start of a log. Idempotent; does nothing for a deleted UAV. path: relative to the log folder."""
    uav = Uav.objects.select_for_update(of=("self",), no_key=True).filter(pk=uav_id).first()
    if uav is None or FlightLog.objects.filter(path=path).exists():
        return
    for left_open in FlightLog.objects.filter(uav=uav, ended_at=None):
        end_flight_log(path=left_open.path, ended_at=_last_written(left_open.path) or started_at)
    FlightLog.objects.create(organisation_id=uav.organisation_id, uav=uav, mission=mission_in_hand(uav), path=path, started_at=started_at)


def end_flight_log(*, path: str, ended_at: datetime) -> None:
    FlightLog.objects.filter(path=path, ended_at=None).update(ended_at=ended_at, size_bytes=_size_bytes(path))


def _file(path: str) -> Path:
    return Path(settings.FLIGHT_LOG_DIR) / path


def _size_bytes(path: str) -> int:
    return _file(path).stat().st_size if _file(path).exists() else 0


def _last_written(path: str) -> datetime | None:
    return datetime.fromtimestamp(_file(path).stat().st_mtime).astimezone() if _file(path).exists() else None


@dataclass
class FlightRecorder:
    """One open log file. A full disk or the size limit ends the recording only."""

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
        """Write the data to the disk. May block: not for the event loop."""
        if self._file is None:
            return
        try:
            self._file.flush()
            os.fsync(self._file.fileno())
        except (OSError, ValueError):  # closed in the meantime
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


@dataclass
class Flights:
    options: GatewayOptions
    _open: dict[int, tuple[Session, FlightRecorder, str]] = field(default_factory=dict)  # by system id
    _disarmed_s: dict[int, float] = field(default_factory=dict)  # since when
    _rows: list[Callable[[], None]] = field(default_factory=list)

    def watch(self, session: Session, now_s: float) -> None:
        """Update the logs after each frame of a session."""
        is_open = session.log is not None
        if session.state.is_armed and not is_open:
            self._begin(session, now_s)
        elif is_open and session.state.is_armed:
            self._disarmed_s.pop(session.uav.system, None)
        elif is_open and session.state.is_armed is False:
            self._disarmed_s.setdefault(session.uav.system, now_s)

    def end(self, session: Session, now_s: float) -> None:
        found = self._open.pop(session.uav.system, None)
        self._disarmed_s.pop(session.uav.system, None)
        session.log = None
        if found is None:
            return
        _, recorder, path = found
        ended_at = datetime.fromtimestamp(now_s, UTC)

        def close() -> None:
            recorder.close()
            end_flight_log(path=path, ended_at=ended_at)

        self._later(close)

    def end_all(self, now_s: float) -> None:
        """Close all files at once, at the end of the process."""
        for session, recorder, _ in list(self._open.values()):
            self.end(session, now_s)
            recorder.close()

    async def sync(self, now_s: float) -> None:
        for session, recorder, _ in list(self._open.values()):
            await asyncio.to_thread(recorder.sync)
            disarmed_s = self._disarmed_s.get(session.uav.system)
            if disarmed_s is not None and abs(now_s - disarmed_s) >= DISARMED_FOR_S:
                self.end(session, disarmed_s)
            elif now_s - session.last_message_s > FORGOTTEN_AFTER_S:
                self.end(session, session.last_message_s)

    async def write_rows(self, database: DatabaseThread) -> None:
        """Write the rows in order; keep the rest for later if the database is unavailable."""
        while self._rows:
            try:
                await database.run(self._rows[0])
            except DatabaseUnavailable:
                return
            except Exception:
                logger.exception("the row of a flight's log could not be written")
            self._rows.pop(0)

    def _begin(self, session: Session, now_s: float) -> None:
        started_at = datetime.fromtimestamp(now_s, UTC)
        uav_id = session.uav.uav_id
        path = f"{uav_id}/{started_at:%Y-%m-%dT%H-%M-%S}-{started_at.microsecond // 1000:03d}-{self.options.run}.tlog"
        recorder = FlightRecorder(self.options.log_dir / path, int(self.options.log_mib * 1024 * 1024))
        if not recorder.is_complete:
            logger.error(
                "no log of the flight of %s can be written in %s", session.uav.name, self.options.log_dir, extra={"uav": session.uav.uav_id}
            )
        self._open[session.uav.system] = (session, recorder, path)
        session.log = recorder.write
        self._later(lambda: begin_flight_log(uav_id=uav_id, path=path, started_at=started_at))

    def _later(self, row: Callable[[], None]) -> None:
        self._rows.append(row)
        del self._rows[:-ROWS_WAITING]
