"""Updates a UAV's state with one report."""

import math
from dataclasses import dataclass, replace

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.decoding.measurement import Measurement
from telemetry.estimation.along_track_filter import PLACES, AlongTrack, ProfileObservation, anywhere, at_start, updated
from telemetry.estimation.knowledge import Knowledge
from telemetry.estimation.motion import SHARED_HEIGHT_M, SHARED_M, State, Track, after
from telemetry.estimation.phases import Phase, phase_of
from telemetry.estimation.profile import FlightProfile, way_home
from telemetry.estimation.report import Report
from telemetry.estimation.state_estimate import StateEstimate

GPS_VARIANCE_M2 = 0.45**2  # per axis, without the error common to consecutive reports
BARO_VARIANCE_M2 = 0.25**2
MAX_DIFFERENCE_S = 15.0  # between two positions, to derive a velocity
STANDS_BELOW_MPS = 0.7
CLIMBS_ABOVE_MPS = 0.5
AT_HOME_M, CREEPS_MPS = 8.0, 1.5  # it descends there
RETURN_SPEED_FACTOR_SD = 0.15


@dataclass(frozen=True, eq=False)
class Course:
    """Constants of a flight: `profile` is None without a route. All positions are in `frame`."""

    knowledge: Knowledge
    frame: LocalFrame
    profile: FlightProfile | None


def first_state(course: Course, report: Report) -> State | None:
    """Return the state after the first report; None without a position."""
    reported, place = report.measurement, _place(course, report.measurement)
    if place is None:
        return None
    stated = phase_of(reported.mode, is_armed=reported.is_armed, is_in_air=reported.is_in_air)
    phase = stated or (Phase.MISSION if course.profile is not None else Phase.FREE)
    east_mps, north_mps, up_mps = _velocity(reported) or (0.0, 0.0, 0.0)
    route = None
    if course.profile is not None:
        along_track = at_start() if phase is Phase.GROUND else anywhere(course.profile, _observation(phase, reported, place))
        route = None if along_track is None else Track(course.profile, along_track)
    return _with_way(
        course,
        State(
            report.measured_s, report.measured_s, _on_route(phase, route), reported.mode, *place, reported.altitude_relative_m,
            east_mps, north_mps, up_mps,
            GPS_VARIANCE_M2, BARO_VARIANCE_M2, reported.heading_deg, _amsl_above(reported), route, None, reported.waypoint_sequence,
            _is_about_to_start(reported, phase, route),
        ),
    )  # fmt: skip


def next_state(course: Course, state: State, report: Report) -> State:
    """Return the state after a report measured no earlier than the state's."""
    reported, after_s = report.measurement, max(report.measured_s - state.report_s, 0.0)
    state_estimate = after(state, after_s, with_gate=False)
    stated = phase_of(reported.mode, is_armed=reported.is_armed, is_in_air=reported.is_in_air)
    phase = stated or state.phase
    place = _place(course, reported)
    east_m, north_m, variance_m2 = _fused(state_estimate, place)
    height_m, height_variance_m2 = _fused_height(state_estimate, reported.altitude_relative_m)
    east_mps, north_mps, up_mps = _velocity(reported) or _velocity_from(state, state_estimate, place, report.measured_s)
    sequence = reported.waypoint_sequence if reported.waypoint_sequence is not None else state.sequence
    route = _route(course, state, phase, after_s, _observation(phase, reported, place))
    if phase is Phase.FREE and stated is None and route is not None:
        phase = Phase.MISSION
    return _with_way(
        course,
        State(
            report.measured_s, state.placed_s if place is None else report.measured_s, _on_route(phase, route), reported.mode or state.mode,
            east_m, north_m, height_m, east_mps, north_mps, up_mps, variance_m2, height_variance_m2,
            state.heading_deg if reported.heading_deg is None else reported.heading_deg,
            _kept_amsl(state, _amsl_above(reported)), route, None, sequence,
            _is_about_to_start(reported, phase, route),
        ),
    )  # fmt: skip


def _place(course: Course, reported: Measurement) -> tuple[float, float] | None:
    if reported.longitude_deg is None or reported.latitude_deg is None:
        return None
    east_m, north_m = course.frame.to_metres(np.array([[reported.longitude_deg, reported.latitude_deg]]))[0]
    return float(east_m), float(north_m)


def _velocity(reported: Measurement) -> tuple[float, float, float] | None:
    if reported.velocity_east_mps is None or reported.velocity_north_mps is None:
        return None
    return reported.velocity_east_mps, reported.velocity_north_mps, -(reported.velocity_down_mps or 0.0)


def _observation(phase: Phase, reported: Measurement, place: tuple[float, float] | None) -> ProfileObservation:
    """Return the observation, with velocity only in phases that follow the route."""
    velocity = _velocity(reported) if phase in {Phase.MISSION, Phase.TAKE_OFF} else None
    east_m, north_m = place or (None, None)
    east_mps, north_mps, up_mps = velocity or (None, None, None)
    return ProfileObservation(east_m, north_m, east_mps, north_mps, up_mps, reported.waypoint_sequence)


def _velocity_from(
    state: State, state_estimate: StateEstimate, place: tuple[float, float] | None, at_s: float
) -> tuple[float, float, float]:
    """Return the velocity if none is reported: from two positions, else as estimated."""
    past_s = at_s - state.placed_s
    if place is None or not 0.5 <= past_s <= MAX_DIFFERENCE_S:
        return state_estimate.east_mps, state_estimate.north_mps, state_estimate.up_mps
    return (place[0] - state.east_m) / past_s, (place[1] - state.north_m) / past_s, state_estimate.up_mps


def _fused(state_estimate: StateEstimate, place: tuple[float, float] | None) -> tuple[float, float, float]:
    """Return the mean of measured and estimated position, weighted by variance."""
    predicted_m2 = max(0.5 * float(np.trace(state_estimate.covariance)) - SHARED_M**2, 0.01)
    if place is None:
        return state_estimate.east_m, state_estimate.north_m, predicted_m2
    gain = predicted_m2 / (predicted_m2 + GPS_VARIANCE_M2)
    east_m, north_m = (
        state_estimate.east_m + gain * (place[0] - state_estimate.east_m),
        state_estimate.north_m + gain * (place[1] - state_estimate.north_m),
    )
    return east_m, north_m, gain * GPS_VARIANCE_M2


def _fused_height(state_estimate: StateEstimate, reported_m: float | None) -> tuple[float | None, float]:
    predicted_m2 = max(state_estimate.height_sd_m**2 - SHARED_HEIGHT_M**2, 0.01)
    if reported_m is None:
        return state_estimate.height_m, predicted_m2
    if state_estimate.height_m is None:
        return reported_m, BARO_VARIANCE_M2
    gain = predicted_m2 / (predicted_m2 + BARO_VARIANCE_M2)
    return state_estimate.height_m + gain * (reported_m - state_estimate.height_m), gain * BARO_VARIANCE_M2


def _route(course: Course, state: State, phase: Phase, after_s: float, observation: ProfileObservation) -> Track | None:
    """Return the position along the approved route, kept while the UAV leaves it for a time."""
    if course.profile is None:
        return None
    if phase is Phase.GROUND and state.route is None:
        return Track(course.profile, at_start())
    if phase is Phase.GROUND and state.phase is Phase.GROUND:
        return state.route
    before = state.route
    if before is None:
        along_track = None if observation.east_m is None else anywhere(course.profile, observation)
    elif phase in {Phase.MISSION, Phase.TAKE_OFF} or state.phase in {Phase.MISSION, Phase.TAKE_OFF}:
        is_under_way = state.phase in {Phase.MISSION, Phase.TAKE_OFF} and phase in {Phase.MISSION, Phase.TAKE_OFF}
        along_track = updated(course.profile, before.along_track, after_s, observation, is_surely_under_way=is_under_way)
    else:
        along_track = before.along_track  # it keeps the place where it left the route
    return None if along_track is None else Track(course.profile, along_track)


def _is_about_to_start(reported: Measurement, phase: Phase, route: Track | None) -> bool:
    flies_when_up = phase_of(reported.mode, is_armed=None, is_in_air=None)
    stands_ready = phase is Phase.GROUND and reported.is_armed is True and flies_when_up in {Phase.MISSION, Phase.TAKE_OFF}
    return stands_ready and route is not None and not route.along_track.nominal_s.any()


def _on_route(phase: Phase, route: Track | None) -> Phase:
    """Return the phase; mission mode away from the approved route counts as flown manually."""
    return Phase.FREE if phase is Phase.MISSION and route is None else phase


def _with_way(course: Course, state: State) -> State:
    """Add the RTL path from the present position to a returning UAV."""
    home = course.knowledge.home
    if state.phase is not Phase.RETURN or home is None or state.height_m is None:
        return state if state.phase is not Phase.RETURN else _changed(state, Phase.FREE, None)
    if state.up_mps > CLIMBS_ABOVE_MPS and math.hypot(state.east_mps, state.north_mps) < 2.0 * STANDS_BELOW_MPS:
        return _changed(state, Phase.RETURN, None)
    east_m, north_m = course.frame.to_metres(np.array([home]))[0] - (state.east_m, state.north_m)
    far_m = math.hypot(east_m, north_m)
    if far_m < AT_HOME_M and math.hypot(state.east_mps, state.north_mps) < CREEPS_MPS:
        return _changed(state, Phase.LAND, None)
    towards_mps = 0.0 if far_m < 1.0 else max((state.east_mps * east_m + state.north_mps * north_m) / far_m, 0.0)
    profile = way_home(course.frame, (state.east_m, state.north_m, state.height_m), towards_mps, LonLat(*home), course.knowledge)
    return _changed(state, Phase.RETURN, Track(profile, AlongTrack(np.zeros(PLACES), variance=RETURN_SPEED_FACTOR_SD**2)))


def _changed(state: State, phase: Phase, home: Track | None) -> State:
    return replace(state, phase=phase, home=home)


def _amsl_above(reported: Measurement) -> float | None:
    if reported.altitude_amsl_m is None or reported.altitude_relative_m is None:
        return None
    return reported.altitude_amsl_m - reported.altitude_relative_m


def _kept_amsl(state: State, reported_m: float | None) -> float | None:
    return state.amsl_above_m if reported_m is None else reported_m
