"""The input of detectors: all data of one UAV at one moment."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from uuid import UUID

from telemetry.alerting.detector_state import DetectorState
from telemetry.alerting.limits import AlertLimits
from telemetry.alerting.modes import AT_THE_END, FLY_LIST, ModeKind, mode_kind
from telemetry.alerting.route_line import RoutePlace
from telemetry.alerting.status_texts import AutopilotText
from telemetry.alerting.surroundings import Conflict, FlightModel, IssuedOrder, LinkFacts, NearZone, OnboardState
from telemetry.estimation.estimate import Estimate
from telemetry.estimation.report import Report

Key = tuple[str, str]  # code and subject
FRESH_S, FRESH_INTERVALS = 5.0, 2.5
AFTER_JUMP_S = 10.0  # after a position jump the position is not compared with the route for so long
AT_END_M = 40.0
AIRBORNE_M = 5.0  # above take-off: counts as in the air if nothing else is reported


@dataclass(frozen=True, slots=True)
class WatchedUav:
    """A UAV whose mission was sent to it or is being flown, or that is still in the air after its mission ended.

    `approval_id` is the approval in force. `flight` is the flight of its route that it flies now or next, from 1 on; one past the last
    after all were flown. `newest` is its newest report that is not from the future; None before the first.
    telemetry/services/alerts/alerting.py reads the rest: its link, onboard list, commands and zones.
    """

    uav_id: int
    organisation_id: int
    name: str
    mission_id: UUID
    approval_id: UUID
    flight: int = 1
    newest: Report | None = None
    estimate: Estimate | None = None
    is_twin: bool = False  # simulated, and the twin of a real UAV


@dataclass(frozen=True, slots=True)
class DetectorInput:
    """`open_levels` are the levels of open alerts by code and subject: an open alert has a stricter threshold to clear."""

    now_s: float
    uav: WatchedUav
    limits: AlertLimits
    detector_state: DetectorState
    link: LinkFacts = field(default_factory=LinkFacts)
    open_levels: Mapping[Key, str] = field(default_factory=dict)
    model: FlightModel | None = None
    held: OnboardState | None = None
    order: IssuedOrder | None = None
    zones: tuple[NearZone, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    status_texts: tuple[AutopilotText, ...] = ()
    is_accounted_for: bool = False  # it is down off plan, and a user has closed that alert

    def is_open(self, code: str, subject: str = "") -> bool:
        return (code, subject) in self.open_levels

    @property
    def last_message_s(self) -> float | None:
        received_s = None if self.uav.newest is None else self.uav.newest.received_s
        reported = [moment for moment in (self.link.last_message_s, received_s) if moment is not None]
        return max(reported) if reported else None

    @property
    def report_interval_s(self) -> float:
        """Return the interval of its last few reports."""
        estimate = self.uav.estimate
        return (
            self.detector_state.usual_interval_s if estimate is None or estimate.report_interval_s is None else estimate.report_interval_s
        )

    @property
    def fresh(self) -> Report | None:
        """Return the newest report, unless further reports are overdue."""
        newest = self.uav.newest
        if newest is None or self.now_s - newest.received_s > max(FRESH_S, FRESH_INTERVALS * self.report_interval_s):
            return None
        return newest

    @property
    def place(self) -> RoutePlace | None:
        """Return its place on the route by the newest report; None without a position or with an old one."""
        return None if self.fresh is None else self.detector_state.place

    @property
    def has_just_jumped(self) -> bool:
        return self.detector_state.jumped_s is not None and self.now_s - self.detector_state.jumped_s < AFTER_JUMP_S

    @property
    def mode(self) -> ModeKind | None:
        newest = self.uav.newest
        return mode_kind((newest.measurement.mode if newest is not None else "") or self.link.mode)

    @property
    def flies_mission(self) -> bool:
        """Return whether it flies its mission, as far as is known. An unreported or unknown mode counts as mission mode."""
        return self.mode in (ModeKind.MISSION, None)

    @property
    def ends_as_planned(self) -> bool:
        """Return whether it is at the end of its route, in a mode that its mission leads to there."""
        place, model = self.detector_state.place, self.model
        is_at_end = place is not None and model is not None and model.line.length_m - place.along_m <= AT_END_M
        return is_at_end and self.mode in AT_THE_END and (self.order is None or self.order.kind in FLY_LIST)

    @property
    def is_in_flight(self) -> bool:
        """Return whether it is in flight, as far as is known. A flight reported over on the link is over, even without a report."""
        if self.link.is_in_air is False:
            return False
        reported = None if self.uav.newest is None else self.uav.newest.measurement
        is_in_air = self.link.is_in_air if reported is None or reported.is_in_air is None else reported.is_in_air
        if is_in_air is not None:
            return is_in_air
        is_armed = self.link.is_armed if reported is None or reported.is_armed is None else reported.is_armed
        if is_armed is not None:
            return is_armed
        return reported is not None and (reported.altitude_relative_m or 0.0) > AIRBORNE_M

    @property
    def is_known_down(self) -> bool:
        """Return whether it has reported that it is on the ground; silence does not count."""
        reported = None if self.uav.newest is None else self.uav.newest.measurement.is_in_air
        return not self.is_in_flight and (self.link.is_in_air is False or reported is False)

    @property
    def is_disarmed(self) -> bool:
        """Return whether it has reported that it is disarmed; silence does not count."""
        reported = None if self.uav.newest is None else self.uav.newest.measurement.is_armed
        return (self.link.is_armed if reported is None else reported) is False

    @property
    def agl_m(self) -> float | None:
        """Return its height above ground as reported, else computed from the plan's ground height."""
        reported = None if self.uav.newest is None else self.uav.newest.measurement
        if reported is None or reported.altitude_agl_m is not None:
            return None if reported is None else reported.altitude_agl_m
        place = self.detector_state.place
        if reported.altitude_relative_m is None or place is None or self.model is None or place.across_m > 200.0:
            return None
        return reported.altitude_relative_m - self.model.line.ground_m(place)
