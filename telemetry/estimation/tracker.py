"""Tracker of one UAV: takes reports, and returns an estimate for any moment."""

import math
from bisect import bisect_right
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from statistics import median

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from telemetry.estimation.estimate import Arrival, Ellipse, Estimate
from telemetry.estimation.eta import arrivals_of, end_of
from telemetry.estimation.knowledge import Knowledge
from telemetry.estimation.link_model import PROMPT_S, SILENT_INTERVALS, SILENT_S, LinkModel
from telemetry.estimation.motion import State, after
from telemetry.estimation.phases import Phase
from telemetry.estimation.profile import profile_of
from telemetry.estimation.report import Report, sound
from telemetry.estimation.state_estimate import StateEstimate
from telemetry.estimation.step import Course, first_state, next_state
from telemetry.estimation.uav_clock import UavClock

KEPT_S = 300.0  # of reports: later ones are ignored
KEPT = 400
MAX_CONFIDENT_BOUND_M = 400.0  # a wider bound counts as lost
CONFIDENCE_HORIZON_S = 900.0
CONFIDENCE_HORIZON_AWAY_S = 30.0  # of a UAV that leaves its route without a link
MEASURED_WITHIN_S = 1.0
ARRIVALS_KEPT = 6
TOGETHER_S = 0.2  # reports within this time arrive as one batch


@dataclass
class Tracker:
    """`take` accepts reports in any order, also repeatedly; `estimate` returns the estimate for a moment.

    A report measured before known ones corrects the past: all later reports are processed again. The state thus does not depend on the
    order of arrival, and can be rebuilt from the newest reports.

    Times in arguments and results are the server's; states use the UAV's own `time`.
    """

    knowledge: Knowledge
    time: UavClock = field(default_factory=UavClock)
    _course: Course | None = None
    _reports: list[Report] = field(default_factory=list)
    _states: list[State | None] = field(default_factory=list)  # after each report; None before the first position
    _etas: tuple[tuple[float, float], tuple[Arrival, ...], Arrival | None] | None = None
    _link_model: LinkModel | None = None
    _contact: tuple[float, float | None] | None = None  # report at which a silence began, and its expected end
    _arrivals_s: deque[float] = field(default_factory=lambda: deque(maxlen=ARRIVALS_KEPT))

    @property
    def newest(self) -> Report | None:
        """Return the report measured last."""
        return self._reports[-1] if self._reports else None

    def is_silent(self, at_s: float) -> bool:
        """Return whether reports have stopped for longer than usual."""
        quiet_s = at_s - self._arrivals_s[-1] if self._arrivals_s else 0.0
        return bool(self._reports) and quiet_s > SILENT_S and quiet_s > SILENT_INTERVALS * (self.report_interval_s or 1.0)

    @property
    def report_interval_s(self) -> float | None:
        """Return the interval of the last few arrivals, whatever is stored on board; None before the second."""
        gaps_s = [later - earlier for earlier, later in pairwise(self._arrivals_s)]
        return median(gaps_s) if gaps_s else None

    def learn(self, places: Sequence[LonLat]) -> None:
        """Add places where reports of earlier flights were received promptly."""
        if self._link_model is not None and places:
            self._link_model.learn(self._frame.to_metres(np.array(places)))
            self._contact = None

    def take(self, report: Report) -> None:
        read = sound(report)
        if read is not None and (not self._arrivals_s or read.received_s > self._arrivals_s[-1] + TOGETHER_S):
            self._arrivals_s.append(read.received_s)
        if read is None or (self._reports and read.measured_s < self._reports[-1].measured_s - KEPT_S):
            return
        place = bisect_right(self._reports, read.measured_s, key=lambda known: known.measured_s)
        if place and self._reports[place - 1].measured_s == read.measured_s:
            if self._reports[place - 1].has_position or not read.has_position:
                return
            place -= 1
            self._reports[place] = read
        else:
            self._reports.insert(place, read)
            self._states.insert(place, None)
        self._go_through(place)
        self._etas = None
        self._note_received(read)
        self._forget()

    def estimate(self, at_s: float) -> Estimate | None:
        """Return the estimate for a moment not before the first report; None before the first position."""
        place = bisect_right(self._reports, at_s, key=lambda known: known.measured_s) - 1
        state = self._states[place] if place >= 0 else None
        if state is None or self._course is None:
            return None
        state_estimate = after(state, self.time.uav_s(at_s) - state.report_s)
        return self._reported(state, state_estimate, at_s)

    def _go_through(self, place: int) -> None:
        state = self._states[place - 1] if place else None
        for number in range(place, len(self._reports)):
            report = self._by_uav_clock(self._reports[number])
            state = self._begin(report) if state is None or self._course is None else next_state(self._course, state, report)
            self._states[number] = state

    def _by_uav_clock(self, report: Report) -> Report:
        return replace(report, measured_s=self.time.uav_s(report.measured_s), received_s=self.time.uav_s(report.received_s))

    def _begin(self, report: Report) -> State | None:
        reported = report.measurement
        if reported.longitude_deg is None or reported.latitude_deg is None:
            return None
        if self._course is None:
            profile = profile_of(self.knowledge)
            frame = LocalFrame.around(reported.longitude_deg, reported.latitude_deg) if profile is None else profile.frame
            self._course = Course(self.knowledge, frame, profile)
            self._link_model = None if profile is None else LinkModel(profile)
        return first_state(self._course, report)

    def _note_received(self, report: Report) -> None:
        reported = report.measurement
        if self._link_model is None or reported.longitude_deg is None or reported.latitude_deg is None:
            return
        if report.received_s - report.measured_s < PROMPT_S:
            self._link_model.learn(self._frame.to_metres(np.array([[reported.longitude_deg, reported.latitude_deg]])))

    def _forget(self) -> None:
        oldest_s = self._reports[-1].measured_s - KEPT_S
        gone = max(bisect_right(self._reports, oldest_s, key=lambda known: known.measured_s), len(self._reports) - KEPT)
        gone = min(gone, len(self._reports) - 1)  # the newest report is kept regardless of its age
        if gone > 0:
            del self._reports[:gone], self._states[:gone]

    def _reported(self, state: State, state_estimate: StateEstimate, at_s: float) -> Estimate:
        bound = _ellipse(state_estimate)
        since_s = self.time.uav_s(at_s) - state.placed_s
        lon, lat = self._frame.to_degrees(np.array([[state_estimate.east_m, state_estimate.north_m]]))[0]
        height_m = None if state_estimate.height_m is None else float(state_estimate.height_m)
        amsl_m = None if height_m is None or state.amsl_above_m is None else height_m + state.amsl_above_m
        horizon_s = CONFIDENCE_HORIZON_S if self.knowledge.is_to_go_on else CONFIDENCE_HORIZON_AWAY_S
        estimate = Estimate(
            at_s=at_s,
            position=LonLat(float(lon), float(lat)),
            altitude_relative_m=height_m,
            altitude_amsl_m=amsl_m,
            speed_mps=state_estimate.speed_mps,
            heading_deg=_heading_deg(state, state_estimate),
            bound=bound,
            bound_height_m=1.96 * state_estimate.height_sd_m,
            bound_speed_mps=1.96 * state_estimate.speed_sd_mps,
            report_s=self.time.server_s(state.report_s),
            is_measured=at_s - self.time.server_s(state.placed_s) < MEASURED_WITHIN_S,
            is_lost=since_s > horizon_s or bound.along_m > MAX_CONFIDENT_BOUND_M,
            waypoint_sequence=state.sequence,
            report_interval_s=self.report_interval_s,
        )
        return estimate if state_estimate.nominal_s is None else self._with_route(estimate, state, state_estimate.nominal_s)

    @property
    def _frame(self) -> LocalFrame:
        if self._course is None:
            raise ValueError("nothing was reported")
        return self._course.frame

    def _with_route(self, estimate: Estimate, state: State, nominal_s: float) -> Estimate:
        followed = state.followed
        if followed is None:
            return estimate
        arrivals, end = self._foreseen(state)
        at_s = estimate.at_s
        reported = replace(estimate, ends_at_s=None if end is None else max(end.at_s, at_s))
        if followed is not state.route:
            return reported
        profile = followed.profile
        along_m = float(np.interp(nominal_s, profile.nominal_s, profile.along_m))
        knot = min(int(np.searchsorted(profile.nominal_s, nominal_s)), len(profile.leg) - 1)
        sequence = int(profile.sequence[profile.leg[knot]])
        return replace(
            reported,
            waypoint_sequence=estimate.waypoint_sequence if sequence < 0 else sequence,
            along_route_m=along_m,
            to_go_m=profile.length_m - along_m,
            contact_expected_s=self._contact_expected_s(state, along_m, at_s),
            arrivals=tuple(_not_past(arrival, at_s) for arrival in arrivals if arrival.latest_s > at_s),
        )

    def _contact_expected_s(self, state: State, along_m: float, at_s: float) -> float | None:
        """Return the expected contact, computed once per silence: once past it counts as overdue and is not postponed."""
        if self._link_model is None or not self.is_silent(at_s):
            return None
        if self._contact is None or self._contact[0] != state.report_s:
            expected_s = self._link_model.expected_s(state, along_m, self.time.uav_s(at_s))
            self._contact = (state.report_s, None if expected_s is None else self.time.server_s(expected_s))
        return self._contact[1]

    def _foreseen(self, state: State) -> tuple[tuple[Arrival, ...], Arrival | None]:
        """Return the arrivals and the end by the server's clock, computed once per report."""
        if self._etas is None or self._etas[0] != (state.report_s, self.time.rate):
            followed = state.followed
            arrivals = () if state.route is None or followed is not state.route else arrivals_of(state, state.route)
            end = None if followed is None else end_of(state, followed)
            reported = tuple(self._by_server(arrival) for arrival in arrivals)
            self._etas = ((state.report_s, self.time.rate), reported, None if end is None else self._by_server(end))
        return self._etas[1:]

    def _by_server(self, arrival: Arrival) -> Arrival:
        at_s, earliest_s, latest_s = map(self.time.server_s, (arrival.at_s, arrival.earliest_s, arrival.latest_s))
        return replace(arrival, at_s=at_s, earliest_s=earliest_s, latest_s=latest_s)


def _not_past(arrival: Arrival, at_s: float) -> Arrival:
    return replace(arrival, at_s=max(arrival.at_s, at_s), earliest_s=max(arrival.earliest_s, at_s))


def _heading_deg(state: State, state_estimate: StateEstimate) -> float | None:
    """Return the course while it moves, as the nose follows it; else the last reported heading."""
    if state_estimate.speed_mps < 1.0 or state.phase in {Phase.GROUND, Phase.FREE}:
        return state.heading_deg
    return math.degrees(math.atan2(state_estimate.east_mps, state_estimate.north_mps)) % 360.0


def _ellipse(state_estimate: StateEstimate) -> Ellipse:
    values, vectors = np.linalg.eigh(state_estimate.covariance)
    long_m, short_m = (float(np.sqrt(state_estimate.gate2 * max(value, 0.0))) for value in (values[1], values[0]))
    bearing_deg = math.degrees(math.atan2(vectors[0, 1], vectors[1, 1])) % 180.0
    return Ellipse(long_m, short_m, bearing_deg)
