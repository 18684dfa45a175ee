"""The estimator process: once a second it reads new reports, estimates every UAV that it holds, and stores the estimates."""

import logging
import math
import threading
import time
from collections import Counter, deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Protocol
from uuid import UUID

import numpy as np
from django.db import close_old_connections, connection, transaction

from inspection.geodesy import LonLat
from mavlink.decoding.measurement import Measurement
from operation import loop_heartbeats
from operation.metrics import ESTIMATED_UAVS, ESTIMATOR_ERROR_M, ESTIMATOR_INNOVATIONS, ESTIMATOR_ROUND_SECONDS
from telemetry.alerting.detector_input import WatchedUav
from telemetry.estimation.estimate import innovation
from telemetry.estimation.report import Report
from telemetry.estimation.tracker import Tracker
from telemetry.selectors.watched import (
    StoredReport,
    WatchedFlight,
    last_record_id,
    newest_reports,
    places_received,
    reports_stored_after,
    watched_flights,
)
from telemetry.services.alerts.alerting import poll_alerts
from telemetry.services.approved_flights import knowledge_of
from telemetry.services.targets_checked import LOOKBACK_S, TargetChecks
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
from telemetry.watch.options import EstimatorOptions
from workspace.api.errors import DATABASE_UNAVAILABLE
from workspace.live.changes import publish_live

OPEN_FOR_S = 30.0  # a transaction may commit this much later than others with higher ids
CHECK_INTERVAL_S = 10.0  # per UAV; at each report if these are farther apart
logger = logging.getLogger(__name__)
INTERVAL_S = 1.0
UNAVAILABLE_INTERVAL_S = 60.0  # between log lines
LOOP, HANGS_AFTER_S = "the watch", 300.0  # a database that does not respond may block it for minutes
READ_BACK = 60  # reports of a UAV, to restore its state
FAULTS = (ArithmeticError, ValueError, LookupError, np.linalg.LinAlgError)
WITHOUT_RECORD_S = 3.0
LEARN_AT_ONCE = 3  # UAVs per round
RECEIVED_BACK, RECEIVED_INTERVAL = 20_000, 20  # records of a UAV


@dataclass
class NewReports:
    """Reads new reports. Ids are assigned before commit, so lower ids may still appear and are read again for a while."""

    _behind: int = -1  # all ids up to this one are read, or older than the start
    _watched_uav: deque[tuple[float, int]] = field(default_factory=deque)

    def begin(self) -> None:
        """Start from the present on, at the first call."""
        if self._behind < 0:
            self._behind = last_record_id()

    def read(self, uav_ids: Sequence[int], now_s: float) -> list[StoredReport]:
        """Return reports of these UAVs stored since the last call. now_s: any monotonic clock."""
        found = reports_stored_after(self._behind, but=[key for _, key in self._watched_uav], uav_ids=uav_ids)
        self._watched_uav.extend((now_s, report.id) for report in found)
        while self._watched_uav and self._watched_uav[0][0] < now_s - OPEN_FOR_S:
            self._behind = max(self._behind, self._watched_uav.popleft()[1])
        return found


class Judged(Protocol):
    """A monitored UAV."""

    tracker: Tracker
    judged_s: float


def judge(watched: Judged, report: Report) -> None:
    """Compare the estimate for a report's moment with the report, before the estimator takes it. Sampled at intervals, at low cost."""
    reported, newest = report.measurement, watched.tracker.newest
    if newest is None or report.measured_s <= newest.measured_s or report.measured_s < watched.judged_s + CHECK_INTERVAL_S:
        return
    if reported.longitude_deg is None or reported.latitude_deg is None:
        return
    watched.judged_s = report.measured_s
    estimate = watched.tracker.estimate(report.measured_s)
    if estimate is None or estimate.is_lost:
        return
    found = innovation(estimate, LonLat(reported.longitude_deg, reported.latitude_deg))
    ESTIMATOR_ERROR_M.observe(found.error_m)
    ESTIMATOR_INNOVATIONS.labels("within" if found.is_within else "outside").inc()


def count_states(made: Iterable[Made], *, held: int) -> None:
    """Set the metric of UAVs by state."""
    states = Counter({"measured": 0, "estimated": 0, "lost": 0})
    for one in made:
        states["lost" if one.estimate.is_lost else "measured" if one.estimate.is_measured else "estimated"] += 1
    states["unknown"] = held - states.total()
    for state, number in states.items():
        ESTIMATED_UAVS.labels(state).set(number)


@dataclass
class Watched:
    """A UAV that the estimator holds. Another flight gets another tracker."""

    flight: WatchedFlight
    tracker: Tracker
    newest: Report | None = None  # the newest report that is a record
    has_learnt: bool = False
    judged_s: float = 0.0
    battery: dict[str, Any] | None = None  # forecast at the last poll

    def keep_time(self) -> None:
        """Continue from its newest report with the present rate of its clock."""
        newest = self.tracker.newest
        self.tracker.time.run_at(self.flight.clock_rate, 0.0 if newest is None else newest.measured_s)

    def note(self, report: Report) -> None:
        if self.newest is None or report.measured_s > self.newest.measured_s:
            self.newest = report


@dataclass
class Watch:
    """The estimator: `run` until `stop`."""

    options: EstimatorOptions
    held: dict[int, Watched] = field(default_factory=dict)  # by UAV
    _stop: threading.Event = field(default_factory=threading.Event)
    _new: NewReports = field(default_factory=NewReports)
    _targets: TargetChecks = field(default_factory=TargetChecks)
    _held_at_s: dict[int, float] = field(default_factory=dict)
    _replaced: set[tuple[int, datetime]] = field(default_factory=set)  # UAVs, and seconds with a measurement
    _quiet_until_s: float = -UNAVAILABLE_INTERVAL_S
    _quiet_about_faults_until_s: float = -UNAVAILABLE_INTERVAL_S

    def run(self) -> None:
        logger.info("watch %s has begun", self.options.holder)
        wait_s = 0.0  # at once: UAVs may have been without an estimator
        while not self._stop.wait(wait_s):
            loop_heartbeats.send_heartbeat(LOOP, within_s=HANGS_AFTER_S)
            try:
                close_old_connections()
                self.round(time.time())
            except DATABASE_UNAVAILABLE as error:
                self._go_on_without_database(error)
            wait_s = _until_next(time.time())
        loop_heartbeats.stop(LOOP)
        self._release()

    def stop(self) -> None:
        self._stop.set()

    def round(self, now_s: float) -> None:
        """Run one second's work. Raises database errors; the next round starts again."""
        with ESTIMATOR_ROUND_SECONDS.time():
            self._round(now_s)

    def _round(self, now_s: float) -> None:
        self._new.begin()
        self._hold(watched_flights())
        self._read()
        self._learn(now_s)
        made = {uav_id: one for uav_id, watched in self.held.items() if (one := self._estimated(watched, now_s)) is not None}
        count_states(made.values(), held=len(self.held))
        self._notify(list(made.values()))
        seen = [_watched_uav(watched, made.get(uav_id)) for uav_id, watched in self.held.items()]
        for uav_id, battery in poll_alerts(watched=seen, now=datetime.fromtimestamp(now_s, UTC)).items():
            self.held[uav_id].battery = battery
        self._check_targets(now_s)

    # Held UAVs

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
            self.held[uav_id].keep_time()
        self._begin([flying[uav_id] for uav_id in sorted(taken | changed)])
        forget_what_is_over(flying=flying.keys())

    def _begin(self, flights: list[WatchedFlight]) -> None:
        """Restore the state from stored reports."""
        if not flights:
            return
        begun = {
            flight.uav_id: Watched(flight, Tracker(knowledge_of(flight.approval_id, flight.uav_id, flight.flight))) for flight in flights
        }
        newest = newest_reports(list(begun), most=READ_BACK)
        for watched in begun.values():
            watched.keep_time()
        self.held |= begun
        for stored in newest:
            self._take(self.held[stored.uav_id], stored.report)

    def _read(self) -> None:
        reports = self._new.read(sorted(self.held), time.monotonic()) if self.held else []
        for stored in reports:
            self._take(self.held[stored.uav_id], stored.report, is_new=True)
            self._replaced.add((stored.uav_id, _end_of_second(stored.measured_at)))
        if self._replaced:
            replace_estimates(reports=sorted(self._replaced))
            self._replaced.clear()
        for watched in self.held.values():
            if (reported := _reported_by_link(watched)) is not None:
                self._take(watched, reported, is_record=False)

    def _take(self, watched: Watched, report: Report, *, is_record: bool = True, is_new: bool = False) -> None:
        if is_record:
            watched.note(report)
        try:
            if is_new:
                judge(watched, report)
            watched.tracker.take(report)
        except FAULTS:
            self._report_fault(watched)

    def _learn(self, now_s: float) -> None:
        """Load for silent UAVs where they were received on earlier flights; a few per round."""
        silent = [watched for watched in self.held.values() if not watched.has_learnt and watched.tracker.is_silent(now_s)]
        for watched in silent[:LEARN_AT_ONCE]:
            watched.tracker.learn(places_received(watched.flight.uav_id, most=RECEIVED_BACK, every=RECEIVED_INTERVAL))
            watched.has_learnt = True

    def _estimated(self, watched: Watched, now_s: float) -> Made | None:
        """Return the estimate; a fault in one UAV's filter does not affect the others."""
        try:
            return _made(watched, now_s)
        except FAULTS:
            self._report_fault(watched)
            return None

    def _report_fault(self, watched: Watched) -> None:
        if time.monotonic() >= self._quiet_about_faults_until_s:
            self._quiet_about_faults_until_s = time.monotonic() + UNAVAILABLE_INTERVAL_S
            about = {"uav": watched.flight.uav_id, "mission": watched.flight.mission_id}
            logger.exception("%s cannot be estimated", watched.flight.name, extra=about)

    def _check_targets(self, now_s: float) -> None:
        """Check targets, including those of missions that have just ended, which completes their last targets."""
        self._held_at_s |= dict.fromkeys(self.held, now_s)
        self._held_at_s = {uav_id: at_s for uav_id, at_s in self._held_at_s.items() if now_s - at_s <= LOOKBACK_S}
        if self._held_at_s:
            self._targets.check(sorted(self._held_at_s))

    # Output

    def _notify(self, made: list[Made]) -> None:
        if not made:
            return
        with transaction.atomic():
            shown = show_estimates(made=made, holder=self.options.holder)
            between = [one for one in made if one.uav_id in shown and not one.estimate.is_measured]
            if between:
                store_estimates(made=between)
        for organisation_id in sorted(set(shown.values())):
            publish_live(organisation_id)

    def _go_on_without_database(self, error: Exception) -> None:
        connection.close()
        if time.monotonic() >= self._quiet_until_s:
            self._quiet_until_s = time.monotonic() + UNAVAILABLE_INTERVAL_S
            logger.warning("the database is away, nothing is estimated: %s", type(error).__name__)

    def _release(self) -> None:
        try:
            release_watches(holder=self.options.holder)
        except DATABASE_UNAVAILABLE:
            logger.warning("the database is away: leases run out by themselves")


def _made(watched: Watched, now_s: float) -> Made | None:
    at_s = math.floor(now_s)
    estimate = watched.tracker.estimate(float(at_s))
    if estimate is None:
        return None
    report_at = None if estimate.report_s is None else datetime.fromtimestamp(estimate.report_s, UTC)
    flight = watched.flight
    return Made(flight.uav_id, flight.mission_id, datetime.fromtimestamp(at_s, UTC), report_at, estimate, watched.battery)


def _watched_uav(watched: Watched, made: Made | None) -> WatchedUav:
    flight = watched.flight
    return WatchedUav(
        uav_id=flight.uav_id,
        organisation_id=flight.organisation_id,
        name=flight.name,
        mission_id=flight.mission_id,
        approval_id=flight.approval_id,
        flight=flight.flight,
        newest=watched.newest,
        estimate=None if made is None else made.estimate,
        is_twin=flight.is_twin,
    )


def _reported_by_link(watched: Watched) -> Report | None:
    """Return the state on the link if no record has arrived for a while: an autopilot without a position sends no records."""
    flight, newest = watched.flight, watched.tracker.newest
    if flight.last_message_at is None or newest is None or flight.last_message_at.timestamp() < newest.measured_s + WITHOUT_RECORD_S:
        return None
    last_message_s = flight.last_message_at.timestamp()
    reported = Measurement(
        mode=flight.mode, is_armed=flight.is_armed, is_in_air=flight.is_in_air, waypoint_sequence=flight.waypoint_sequence
    )
    return Report(last_message_s, last_message_s, reported)


def _flight_of(flight: WatchedFlight) -> tuple[UUID, int]:
    return flight.approval_id, flight.flight


def _end_of_second(at: datetime) -> datetime:
    return datetime.fromtimestamp(math.ceil(at.timestamp()), UTC)


def _until_next(now_s: float) -> float:
    """Return the seconds to the next whole second of the server's clock."""
    return INTERVAL_S - now_s % INTERVAL_S
