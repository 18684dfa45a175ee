"""How a UAV goes on from what was last known of it, by what it is doing."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from telemetry.estimation.belief import CHI2_95, Belief, reach2_of, round_covariance
from telemetry.estimation.pace import Pace, ahead, velocity
from telemetry.estimation.phases import Phase
from telemetry.estimation.profile import Profile

FloatArray = NDArray[np.float64]

# Calibrated on the truth generator, on seeds that no test uses; see tests/telemetry/estimation/calibration.py.
ASIDE_S = 8.0  # how long it stays beside its route
TURNS_S = 1.6  # how long it keeps a velocity that is not its route's
OFF_ROUTE_M = 1.3  # standard deviation across the route, each way
OFF_ROUTE_S = 4.0  # until it is as far as that
OFF_HEIGHT_M, CLIMB_SHARE = 0.5, 0.25
SPEED_SD_MPS, SPEED_SHARE, SPEED_S = 0.35, 0.05, 4.0
BRAKES_S = 1.3
DRIFT_MPS = 0.06  # of one that holds
STEERED_S = 6.0  # how long a velocity tells of one that a person steers
STEERED_MPS2 = 0.9
SHARED_M, SHARED_HEIGHT_M = 1.25, 1.0  # errors that reports share: of GPS, and of the barometer


@dataclass(frozen=True, eq=False)
class Track:
    """A profile and the place on it."""

    profile: Profile
    pace: Pace


@dataclass(frozen=True, eq=False)
class State:
    """What is known right after a report, or of one that told no position. Metres in the frame, variances of what no two reports share.

    `route` is the approved flight with the place on it, also while it does something else; `home` the way back while it returns.
    `placed_s` is when a position was last measured, `report_s` when anything was.
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
    amsl_above_m: float | None  # sea level below the take-off
    route: Track | None
    home: Track | None = None
    sequence: int | None = None

    @property
    def followed(self) -> Track | None:
        if self.phase is Phase.MISSION or self.phase is Phase.TAKE_OFF:
            return self.route
        return self.home if self.phase is Phase.RETURN else None


def after(state: State, after_s: float) -> Belief:
    """after_s: since the report, at least 0."""
    followed = state.followed
    if followed is not None:
        return _along(state, followed, after_s)
    if state.phase is Phase.GROUND:
        return _plain(state, after_s, 0.0, 0.0, 0.02 * after_s, 0.0)
    if state.phase is Phase.HOLD or state.phase is Phase.LAND:
        return _plain(state, after_s, BRAKES_S, DRIFT_MPS * after_s, 0.1 * state_speed(state), 0.3)
    return _plain(state, after_s, STEERED_S, STEERED_MPS2 * min(after_s, 12.0) * math.sqrt(after_s + 0.25), 0.0, 1.0)


def state_speed(state: State) -> float:
    return math.hypot(state.east_mps, state.north_mps)


def _plain(state: State, after_s: float, keeps_s: float, drift_m: float, braking_m: float, up_sd_mps: float) -> Belief:
    """A velocity that dies away, and a doubt that is alike all around."""
    gone = -math.expm1(-after_s / keeps_s) if keeps_s else 0.0
    left = 1.0 - gone if keeps_s else 0.0
    variance_m2 = SHARED_M**2 + state.variance_m2 + drift_m**2 + (braking_m * gone) ** 2
    is_landing = state.phase is Phase.LAND
    height_m = state.height_m
    if height_m is not None:
        height_m += state.up_mps * (after_s if is_landing else keeps_s * gone)
        height_m = max(height_m, min(state.height_m or 0.0, 0.0)) if is_landing else height_m
    height_sd_m = math.sqrt(
        SHARED_HEIGHT_M**2
        + state.height_variance_m2
        + OFF_HEIGHT_M**2 * gone
        + (up_sd_mps * (after_s if is_landing else keeps_s * gone)) ** 2
    )
    speed_sd_mps = math.hypot(SPEED_SD_MPS, drift_m / max(after_s, 1.0) + 0.3 * state_speed(state) * gone * left)
    return Belief(
        state.east_m + state.east_mps * keeps_s * gone,
        state.north_m + state.north_mps * keeps_s * gone,
        height_m,
        state.east_mps * left,
        state.north_mps * left,
        state.up_mps if is_landing else state.up_mps * left,
        round_covariance(variance_m2),
        CHI2_95,
        height_sd_m,
        speed_sd_mps,
    )


def _along(state: State, track: Track, after_s: float) -> Belief:
    """On its profile, with what it was beside it dying away."""
    profile, now = track.profile, ahead(track.profile, track.pace, 0.0)
    later = ahead(profile, track.pace, after_s) if after_s > 0 else now
    here = _mean_place(profile, now.clock, now.reading_s, now.weight)
    east, north, height = (
        np.interp(later.reading_s, later.clock, column) for column in (profile.east_m, profile.north_m, profile.height_m)
    )
    velocity_now = _mean_velocity(profile, now.clock, now.reading_s, now.weight)
    each_east_mps, each_north_mps, each_up_mps = velocity(profile, later.clock, later.reading_s)
    weight = later.weight
    aside, turning = math.exp(-after_s / ASIDE_S), math.exp(-after_s / TURNS_S)
    turned_s = TURNS_S * (1.0 - turning)
    east_mps, north_mps, up_mps = (float(weight @ each) for each in (each_east_mps, each_north_mps, each_up_mps))
    middle = (float(weight @ east), float(weight @ north), float(weight @ height))
    beside_mps = (state.east_mps - velocity_now[0], state.north_mps - velocity_now[1], state.up_mps - velocity_now[2])
    beside = (
        (state.east_m - here[0]) * aside + beside_mps[0] * turned_s,
        (state.north_m - here[1]) * aside + beside_mps[1] * turned_s,
    )
    wandered = -math.expm1(-after_s / OFF_ROUTE_S)
    round_m2 = SHARED_M**2 + state.variance_m2 + OFF_ROUTE_M**2 * wandered + (0.3 * math.hypot(*beside_mps[:2]) * turned_s) ** 2
    off_east, off_north = east - middle[0], north - middle[1]
    spread = np.array([[weight @ off_east**2, weight @ (off_east * off_north)], [0.0, weight @ off_north**2]])
    spread[1, 0] = spread[0, 1]
    covariance = spread + round_covariance(round_m2)
    each_mps = np.hypot(each_east_mps, each_north_mps)
    speed_spread = float(weight @ (each_mps - float(weight @ each_mps)) ** 2)
    settled = -math.expm1(-after_s / SPEED_S)
    height_m = None
    if state.height_m is not None:
        height_m = middle[2] + (state.height_m - here[2]) * aside + beside_mps[2] * turned_s
    height_m2 = SHARED_HEIGHT_M**2 + state.height_variance_m2 + OFF_HEIGHT_M**2 * wandered + (CLIMB_SHARE * beside_mps[2] * turned_s) ** 2
    return Belief(
        middle[0] + beside[0],
        middle[1] + beside[1],
        height_m,
        east_mps + beside_mps[0] * turning,
        north_mps + beside_mps[1] * turning,
        up_mps + beside_mps[2] * turning,
        covariance,
        reach2_of(off_east, off_north, weight, round_m2, covariance),
        math.sqrt(height_m2 + float(weight @ (height - middle[2]) ** 2)),
        math.sqrt(SPEED_SD_MPS**2 + speed_spread + (SPEED_SHARE * float(weight @ each_mps) * settled) ** 2),
        float(np.interp(float(weight @ later.reading_s), later.clock, profile.nominal_s)),
    )


def _mean_place(profile: Profile, clock: FloatArray, reading_s: FloatArray, weight: FloatArray) -> tuple[float, float, float]:
    east, north, height = (
        float(weight @ np.interp(reading_s, clock, column)) for column in (profile.east_m, profile.north_m, profile.height_m)
    )
    return east, north, height


def _mean_velocity(profile: Profile, clock: FloatArray, reading_s: FloatArray, weight: FloatArray) -> tuple[float, float, float]:
    east, north, up = (float(weight @ each) for each in velocity(profile, clock, reading_s))
    return east, north, up
