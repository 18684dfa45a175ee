"""A log for each flight: begun when a vehicle arms, ended some seconds after it disarms.

One that arms and disarms all the time keeps to one file, and no disk is waited for in the loop.
"""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime

from telemetry.gateway.database import DatabaseAway, DatabaseThread
from telemetry.gateway.flight_log import FlightRecorder
from telemetry.gateway.options import Options
from telemetry.gateway.session import Session
from telemetry.services.flight_logs import begin_flight_log, end_flight_log

logger = logging.getLogger(__name__)

SYNC_EVERY_S = 2.0
DISARMED_FOR_S = 2.0
FORGOTTEN_AFTER_S = 1_800.0  # a flight that ended unheard
ROWS_WAITING = 1_000


@dataclass
class Flights:
    options: Options
    _open: dict[int, tuple[Session, FlightRecorder, str]] = field(default_factory=dict)  # by system id
    _disarmed_s: dict[int, float] = field(default_factory=dict)  # since when
    _rows: list[Callable[[], None]] = field(default_factory=list)

    def watch(self, session: Session, now_s: float) -> None:
        """After each frame of a session."""
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
        """Nothing else is to be done any more: the files are closed at once."""
        for session, recorder, _ in list(self._open.values()):
            self.end(session, now_s)
            recorder.close()

    async def sync(self, now_s: float) -> None:
        for session, recorder, _ in list(self._open.values()):
            await asyncio.to_thread(recorder.sync)
            disarmed_s = self._disarmed_s.get(session.uav.system)
            if disarmed_s is not None and abs(now_s - disarmed_s) >= DISARMED_FOR_S:
                self.end(session, disarmed_s)
            elif now_s - session.heard_s > FORGOTTEN_AFTER_S:
                self.end(session, session.heard_s)

    async def write_rows(self, database: DatabaseThread) -> None:
        """In order; what cannot be written now is written later."""
        while self._rows:
            try:
                await database.run(self._rows[0])
            except DatabaseAway:
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
