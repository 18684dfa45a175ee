"""The watch as a whole: once a second it reads what came, estimates every UAV that it holds, and writes down what it made of it."""

import logging
import math
import threading
import time
from dataclasses import dataclass, field
from datetime import UTC, datetime
from uuid import UUID

from django.db import close_old_connections, connection, transaction

from telemetry.estimation.tracker import Tracker
from telemetry.selectors.watched import StoredReport, WatchedFlight, newest_reports, watched_flights
from telemetry.services.knowledge import knowledge_of
from telemetry.services.watches import (
    Made,
    forget_what_is_over,
    release_watches,
    renew_watches,
    replace_estimates,
    show_estimates,
    store_estimates,
    take_watches,
)
from telemetry.watch.new_reports import NewReports
from telemetry.watch.options import Options
from workspace.errors import DATABASE_AWAY

logger = logging.getLogger(__name__)

EVERY_S = 1.0
AWAY_EVERY_S = 60.0  # one line of log
READ_BACK = 60  # reports of a UAV, to know again what was known of it


@dataclass
class Watched:
    """A UAV that the watch holds. Another flight than before is another tracker."""

    flight: WatchedFlight
    tracker: Tracker


@dataclass
class Watch:
    """`run` until `stop`."""

    options: Options
    held: dict[int, Watched] = field(default_factory=dict)  # by UAV
    _stop: threading.Event = field(default_factory=threading.Event)
    _new: NewReports = field(default_factory=NewReports)
    _quiet_until_s: float = 0.0

    def run(self) -> None:
        logger.info("watch %s has begun", self.options.holder)
        while not self._stop.wait(_until_next(time.time())):
            try:
                close_old_connections()
                self.round(time.time())
            except DATABASE_AWAY as error:
                self._go_on_without_database(error)
        self._give_back()

    def stop(self) -> None:
        self._stop.set()

    def round(self, now_s: float) -> None:
        """Everything of one second. Raises what the database raises; the next round begins anew."""
        self._new.begin()
        self._hold(watched_flights())
        self._read()
        self._tell([made for watched in self.held.values() if (made := _made(watched, now_s)) is not None])

    # Who is watched

    def _hold(self, flights: list[WatchedFlight]) -> None:
        flying = {flight.uav_id: flight for flight in flights}
        gone = self.held.keys() - flying.keys()
        if gone:
            release_watches(holder=self.options.holder, uav_ids=gone, is_over=True)
        still = renew_watches(uav_ids=self.held.keys() & flying.keys(), holder=self.options.holder, lease_s=self.options.lease_s)
        self.held = {uav_id: watched for uav_id, watched in self.held.items() if uav_id in still}
        wanted = [uav_id for uav_id in flying if uav_id not in self.held][: max(self.options.most_uavs - len(self.held), 0)]
        missions = {uav_id: flying[uav_id].mission_id for uav_id in wanted}
        taken = take_watches(missions=missions, holder=self.options.holder, lease_s=self.options.lease_s) if wanted else set()
        if taken:
            logger.info("watches %s UAVs more", len(taken))
        changed = {uav_id for uav_id, watched in self.held.items() if _flight_of(watched.flight) != _flight_of(flying[uav_id])}
        for uav_id in self.held.keys() - changed:
            self.held[uav_id].flight = flying[uav_id]
        self._begin([flying[uav_id] for uav_id in sorted(taken | changed)])
        forget_what_is_over(flying=flying.keys())

    def _begin(self, flights: list[WatchedFlight]) -> None:
        """From what is stored, as if it had been watched before."""
        for flight in flights:
            known = knowledge_of(flight.approval_id, flight.uav_id, flight.flight)
            self.held[flight.uav_id] = Watched(flight, Tracker(known))
        if flights:
            for stored in newest_reports([flight.uav_id for flight in flights], most=READ_BACK):
                self.held[stored.uav_id].tracker.take(stored.report)

    def _read(self) -> None:
        reports = self._new.read(sorted(self.held), time.monotonic()) if self.held else []
        for stored in reports:
            self.held[stored.uav_id].tracker.take(stored.report)
        if reports:
            replace_estimates(reports=_seconds(reports))

    # What is told

    def _tell(self, made: list[Made]) -> None:
        if not made:
            return
        with transaction.atomic():
            shown = show_estimates(made=made, holder=self.options.holder)
            between = [one for one in made if one.uav_id in shown and not one.estimate.is_measured]
            if between:
                store_estimates(made=between)

    def _go_on_without_database(self, error: Exception) -> None:
        connection.close()
        if time.monotonic() >= self._quiet_until_s:
            self._quiet_until_s = time.monotonic() + AWAY_EVERY_S
            logger.warning("the database is away, nothing is estimated: %s", type(error).__name__)

    def _give_back(self) -> None:
        try:
            release_watches(holder=self.options.holder)
        except DATABASE_AWAY:
            logger.warning("the database is away: leases run out by themselves")


def _made(watched: Watched, now_s: float) -> Made | None:
    at_s = math.floor(now_s)
    estimate = watched.tracker.estimate(float(at_s))
    if estimate is None:
        return None
    report_at = None if estimate.report_s is None else datetime.fromtimestamp(estimate.report_s, UTC)
    flight = watched.flight
    return Made(flight.uav_id, flight.mission_id, datetime.fromtimestamp(at_s, UTC), report_at, estimate)


def _flight_of(flight: WatchedFlight) -> tuple[UUID, int]:
    return flight.approval_id, flight.flight


def _seconds(reports: list[StoredReport]) -> list[tuple[int, datetime]]:
    """One report of each second of each UAV is enough to replace what was estimated for it."""
    return sorted({(stored.uav_id, _end_of_second(stored.measured_at)) for stored in reports})


def _end_of_second(at: datetime) -> datetime:
    return datetime.fromtimestamp(math.ceil(at.timestamp()), UTC)


def _until_next(now_s: float) -> float:
    """Seconds to the next whole one of the server's clock."""
    return EVERY_S - now_s % EVERY_S
