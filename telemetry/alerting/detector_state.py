"""Detector state of a UAV, kept between polls. If it is lost, alerts come slightly later."""

from collections import deque
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from inspection.geodesy import LonLat
from telemetry.alerting.consumption import DrainState
from telemetry.alerting.modes import ModeKind
from telemetry.alerting.route_line import RouteLine, RoutePlace
from telemetry.estimation.report import Report

INTERVALS_KEPT = 5
UNKNOWN_INTERVAL_S = 10.0  # the interval of slow links
FALL_MPS = 8.0  # multicopters are set to descend by 1 to 5 m/s
MIN_FALL_S = 0.2  # between two reports, to compute a speed from heights


@dataclass
class AlertCause:
    """Since when a cause is found at each level or above, and since when it is gone."""

    since_s: dict[str, float] = field(default_factory=dict)
    gone_s: float | None = None


@dataclass(frozen=True, slots=True)
class RouteProgress:
    """Progress along the route at a time."""

    at_s: float
    along_m: float
    height_m: float | None


@dataclass
class DetectorState:
    """State of one UAV. `before` is the report before the newest one; `place` is the newest position on its route."""

    newest: Report | None = None
    before: Report | None = None
    place: RoutePlace | None = None
    line: RouteLine | None = None
    progress: deque[RouteProgress] = field(default_factory=deque)
    jumped_s: float | None = None
    jump_m: float = 0.0
    was_in_flight: bool = False  # on this line
    fell_s: float | None = None  # last measured time at which it descended faster than in powered flight
    down_s: float | None = None  # measured time since when it is on the ground after a flight on this line
    down_at: LonLat | None = None  # where it came down
    has_ended: bool = False  # that flight is recorded as ended in its mission
    mode: ModeKind | None = None  # last known
    mode_since_s: float | None = None  # measured time of its first report in this mode; None: it was in it from the first report on
    mode_words: tuple[str, str] = ("", "")  # a mode, and the vehicle's status texts around the change to it
    drain: DrainState = field(default_factory=DrainState)
    battery: dict[str, Any] | None = None  # as shown on live pages
    causes: dict[tuple[str, str], AlertCause] = field(default_factory=dict)
    _intervals_s: deque[float] = field(default_factory=lambda: deque(maxlen=INTERVALS_KEPT))

    def take(self, report: Report | None, line: RouteLine | None = None) -> bool:
        """Store a report; return whether it is a new one."""
        if line is not self.line:
            self.line, self.place = line, None
            self.was_in_flight = False
            self.fell_s = self.down_s = self.down_at = None
            self.has_ended = False
            self.drain = DrainState()
            self.progress.clear()
        if report is None or (self.newest is not None and report.measured_s <= self.newest.measured_s):
            return False
        if self.newest is not None:
            self._intervals_s.append(report.received_s - self.newest.received_s)
        self.before, self.newest = self.newest, report
        if _is_falling(report, self.before):
            self.fell_s = report.measured_s
        self.place = None if line is None else _place(line, report, self.place)
        return True

    def note_flight(self, *, is_in_flight: bool) -> None:
        """Update take-off and landing of a UAV with an approved flight, by the newest report."""
        if is_in_flight:
            self.was_in_flight, self.down_s, self.down_at, self.has_ended = True, None, None, False
        elif self.was_in_flight and self.newest is not None:
            self.down_s = self.newest.measured_s if self.down_s is None else self.down_s
            self.down_at = position_of(self.newest) if self.down_at is None else self.down_at

    def note_mode(self, mode: ModeKind | None, measured_s: float) -> None:
        """Store the mode; an unreported one changes nothing."""
        if mode is not None and mode is not self.mode:
            self.mode_since_s = None if self.mode is None else measured_s
            self.mode = mode

    @property
    def usual_interval_s(self) -> float:
        """Return the median interval of the last few reports."""
        return median(self._intervals_s) if self._intervals_s else UNKNOWN_INTERVAL_S


def position_of(report: Report) -> LonLat | None:
    reported = report.measurement
    return (
        None if reported.longitude_deg is None or reported.latitude_deg is None else LonLat(reported.longitude_deg, reported.latitude_deg)
    )


def _is_falling(report: Report, before: Report | None) -> bool:
    """Return whether it falls, by its reported speed, else by its heights and its own clock."""
    reported = report.measurement
    if reported.velocity_down_mps is not None:
        return reported.velocity_down_mps > FALL_MPS
    earlier_m = None if before is None else before.measurement.altitude_relative_m
    if before is None or earlier_m is None or reported.altitude_relative_m is None:
        return False
    seconds = report.measured_s - before.measured_s
    if report.boot is not None and before.boot is not None and report.boot.stream == before.boot.stream:
        seconds = report.boot.clock_s - before.boot.clock_s
    return seconds >= MIN_FALL_S and (earlier_m - reported.altitude_relative_m) / seconds > FALL_MPS


def _place(line: RouteLine, report: Report, before: RoutePlace | None) -> RoutePlace | None:
    position = position_of(report)
    return None if position is None else line.place(position, report.measurement.waypoint_sequence, before)
