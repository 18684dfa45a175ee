"""Motion models: predict a UAV from its last known state, by its phase of flight."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from telemetry.estimation.along_track_filter import AlongTrack, ahead, velocity
from telemetry.estimation.phases import Phase
from telemetry.estimation.profile import LANDING_MPS, SLOW_BELOW_M, FlightProfile
from telemetry.estimation.state_estimate import CHI2_95, StateEstimate, gate2_of, isotropic_covariance

FloatArray = NDArray[np.float64]

# Calibrated on the truth generator, with seeds that no test uses; see benchmarks/telemetry/estimator.py.
ASIDE_S = 8.0  # decay time of an offset from its route
TURNS_S = 1.6  # decay time of a velocity other than its route's
OFF_ROUTE_M = 0.7  # standard deviation across the route, each way
OFF_ROUTE_S = 4.0  # time until that offset is reached
OFF_HEIGHT_M = 0.5
BESIDE_SHARE = 0.3  # uncertain share of the offset caused by a velocity other than the route's
SPEED_SD_MPS, SPEED_SHARE, SPEED_S = 0.38, 0.06, 4.0
BRAKES_S = 1.3
DRIFT_MPS = 0.06  # of a UAV that holds
STEERED_S = 6.0  # how long a velocity predicts the flight of a UAV flown manually
STEERED_MPS2 = 0.9
UNFORESEEN_HZ, MAX_UNFORESEEN = 1.0 / 2_000.0, 0.03  # rate of unexpected stops or returns of a UAV on its route
SHARED_M, SHARED_HEIGHT_M = 1.07, 0.95  # errors common to consecutive reports: of GPS and barometer


@dataclass(frozen=True, eq=False)
class Track:
    """A profile and the position along it."""

    profile: FlightProfile
    along_track: AlongTrack


@dataclass(frozen=True, eq=False)
class State:
    """State after a report; positions are in metres in the frame. Variances exclude the error common to consecutive reports.

    `route` is the approved flight with the position along it, also during another activity; `home` is the RTL path during a return.
    `placed_s` is when a position was last measured, `report_s` when anything was. With `is_about_to_start` it stands at the start of the
    route, armed and in mission mode, and may start at any moment.
    """

    report_s: float
    placed_s: float
    phase: Phase
    mode: str
    east_m: float
    north_m: float
    height_m: float | None
    east_mps: float
    north_mps: float
    up_mps: float
    variance_m2: float
    height_variance_m2: float
    heading_deg: float | None
    amsl_above_m: float | None  # altitude AMSL of the take-off
    route: Track | None
    home: Track | None = None
    sequence: int | None = None
    is_about_to_start: bool = False

    @property
    def followed(self) -> Track | None:
        if self.phase is Phase.MISSION or self.phase is Phase.TAKE_OFF:
            return self.route
        return self.home if self.phase is Phase.RETURN else None


def after(state: State, after_s: float, *, with_gate: bool = True) -> StateEstimate:
    """Return the estimate after a time.

    after_s: since the report, at least 0. Without with_gate the gate, which is slow to compute, is that of a normal distribution.
    """
    followed = state.followed
    if followed is not None:
        return _along(state, followed, after_s, with_gate=with_gate)
    if state.phase is Phase.GROUND and state.is_about_to_start and state.route is not None:
        return _along(state, state.route, after_s, with_gate=with_gate, is_surely_under_way=False)
    if state.phase is Phase.GROUND:
        return _plain(state, after_s, 0.0, 0.0, 0.02 * after_s, 0.0)
    if state.phase is Phase.HOLD or state.phase is Phase.LAND:
        return _plain(state, after_s, BRAKES_S, DRIFT_MPS * after_s, 0.3 * state_speed(state), 0.3)
    return _plain(state, after_s, STEERED_S, STEERED_MPS2 * min(after_s, 12.0) * math.sqrt(after_s + 0.25), 0.0, 1.0)


def _held(after_s: float) -> float:
    """Return the share that the ellipse must hold of UAVs that still fly on, to hold 95 % of all: the others may be anywhere behind."""
    return 0.95 / (1.0 - min(UNFORESEEN_HZ * after_s, MAX_UNFORESEEN))


def state_speed(state: State) -> float:
    return math.hypot(state.east_mps, state.north_mps)


def _plain(state: State, after_s: float, keeps_s: float, drift_m: float, braking_m: float, up_sd_mps: float) -> StateEstimate:
    """Predict with a decaying velocity and an isotropic uncertainty."""
    gone = -math.expm1(-after_s / keeps_s) if keeps_s else 0.0
    left = 1.0 - gone if keeps_s else 0.0
    variance_m2 = SHARED_M**2 + state.variance_m2 + drift_m**2 + (braking_m * gone) ** 2
    height_m, up_mps, kept_s = state.height_m, state.up_mps * left, keeps_s * gone
    if height_m is not None and state.phase is Phase.LAND:
        height_m, up_mps = _sunk(height_m, -state.up_mps, after_s)
        kept_s = after_s if height_m > 0 else 0.0
    elif height_m is not None:
        height_m += state.up_mps * kept_s
    height_sd_m = math.sqrt(SHARED_HEIGHT_M**2 + state.height_variance_m2 + OFF_HEIGHT_M**2 * gone + (up_sd_mps * kept_s) ** 2)
    speed_sd_mps = math.hypot(SPEED_SD_MPS, drift_m / max(after_s, 1.0) + 0.3 * state_speed(state) * gone * left)
    return StateEstimate(
        state.east_m + state.east_mps * keeps_s * gone,
        state.north_m + state.north_mps * keeps_s * gone,
        height_m,
        state.east_mps * left,
        state.north_mps * left,
        up_mps,
        isotropic_covariance(variance_m2),
        CHI2_95,
        height_sd_m,
        speed_sd_mps,
    )


def _sunk(height_m: float, sinks_mps: float, after_s: float) -> tuple[float, float]:
    """Return height and upward speed of a landing UAV: at its speed, slower near the ground, never below it."""
    fast_mps = max(sinks_mps, LANDING_MPS)
    fast_s = min(max(height_m - SLOW_BELOW_M, 0.0) / fast_mps, after_s)
    below_m = height_m - fast_mps * fast_s - LANDING_MPS * (after_s - fast_s)
    if below_m <= 0.0:
        return min(height_m, 0.0), 0.0
    return below_m, -fast_mps if fast_s == after_s else -LANDING_MPS


def _along(state: State, track: Track, after_s: float, *, with_gate: bool, is_surely_under_way: bool = True) -> StateEstimate:
    """Predict along the profile, with a decaying offset from it, for each possible place on it."""
    profile = track.profile
    later = ahead(profile, track.along_track, after_s, is_surely_under_way=is_surely_under_way)
    weight, clock = later.weight, later.clock
    aside, turning = math.exp(-after_s / ASIDE_S), math.exp(-after_s / TURNS_S)
    turned_s = TURNS_S * (1.0 - turning)
    at_report = np.interp(track.along_track.nominal_s, profile.nominal_s, clock)
    reported_position = (state.east_m, state.north_m, state.height_m)
    columns = (profile.east_m, profile.north_m, profile.height_m)
    velocity_now = velocity(profile, clock, at_report)
    each_mps = velocity(profile, clock, later.reading_s)
    places, speeds, beside_mps = [], [], []
    for place, column, reported_mps, then, now_mps in zip(
        reported_position, columns, (state.east_mps, state.north_mps, state.up_mps), each_mps, velocity_now, strict=True
    ):
        besides_mps = reported_mps - float(now_mps.mean())
        each = np.interp(later.reading_s, clock, column) + besides_mps * turned_s
        if place is not None:
            each += np.repeat(place - np.interp(at_report, clock, column), len(weight) // len(at_report)) * aside
        places.append(each)
        speeds.append(float(weight @ then) + besides_mps * turning)
        beside_mps.append(besides_mps)
    middle = [float(weight @ each) for each in places]
    wandered = -math.expm1(-after_s / OFF_ROUTE_S)
    turning_m = BESIDE_SHARE * math.hypot(*beside_mps[:2]) * turned_s
    isotropic_variance_m2 = SHARED_M**2 + state.variance_m2 + OFF_ROUTE_M**2 * wandered + turning_m**2
    off_east, off_north = places[0] - middle[0], places[1] - middle[1]
    across = float(weight @ (off_east * off_north))
    covariance = np.array([[weight @ off_east**2, across], [across, weight @ off_north**2]]) + isotropic_covariance(isotropic_variance_m2)
    level_mps = np.hypot(each_mps[0], each_mps[1])
    mean_mps = float(weight @ level_mps)
    settled = -math.expm1(-after_s / SPEED_S)
    height_m2 = SHARED_HEIGHT_M**2 + state.height_variance_m2 + OFF_HEIGHT_M**2 * wandered + (BESIDE_SHARE * beside_mps[2] * turned_s) ** 2
    return StateEstimate(
        middle[0],
        middle[1],
        None if state.height_m is None else middle[2],
        speeds[0],
        speeds[1],
        speeds[2],
        covariance,
        gate2_of(off_east, off_north, weight, isotropic_variance_m2, covariance, _held(after_s)) if with_gate else CHI2_95,
        math.sqrt(height_m2 + float(weight @ (places[2] - middle[2]) ** 2)),
        math.sqrt(SPEED_SD_MPS**2 + float(weight @ (level_mps - mean_mps) ** 2) + (SPEED_SHARE * mean_mps * settled) ** 2),
        float(np.interp(float(weight @ later.reading_s), clock, profile.nominal_s)),
    )
