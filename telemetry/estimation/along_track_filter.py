"""Along-track filter: the position of a UAV along its profile, predicted by time and updated by reports.

The position is a distribution over the profile's clock. The clock of a flight is its profile's, with the time in motion divided by the
UAV's speed factor (flown over planned speed). It counts real seconds: a UAV that flies its profile at this factor advances one second per
second. The uncertainty grows with the time in motion (speed factor, gusts) and with each turn, stop and climb. The UAV never moves back.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from telemetry.estimation.profile import FlightProfile

FloatArray = NDArray[np.float64]

PLACES = 12
SPREAD = np.linspace(-2.8, 2.8, 15)
SPREAD_WEIGHT = np.exp(-0.5 * SPREAD**2) / np.exp(-0.5 * SPREAD**2).sum()
GRID = 241
# Calibrated on the truth generator, with seeds that no test uses; see benchmarks/telemetry/estimator.py.
SPEED_FACTOR_SD = 0.06  # before its flight
SPEED_FACTOR_DRIFT = 0.008  # per second
SUREST_SD = 0.02  # lower bound for the speed factor, after any observation
MIN_SPEED_FACTOR, MAX_SPEED_FACTOR = 0.4, 1.8
GUST_SD, GUST_S = 0.025, 25.0  # of speed, and its correlation time
MIN_S = 0.04
NOW_S = 25.0  # how long the current speed predicts the next
NOW_SHARE = 0.8
EVEN_S = (-4.0, -2.0, 2.0)  # seconds from now at which the planned velocity must equal the present one
MIN_EVEN_MPS = 1.0
ALONG_M, OFF_M = 1.5, 6.0  # standard deviations of a report from the profile, along and across; autopilots cut corners
NOT_EVEN = 0.03  # how often a report is off along the profile as well
FAR_M = 40.0
OFF_MPS = 2.0
NOT_STATED = 0.02  # likelihood if the vehicle reports another waypoint


@dataclass(frozen=True, eq=False)
class AlongTrack:
    """Equally likely places on the profile, in its seconds, shape (PLACES,), and the speed factor with its variance.

    `now` is the relative difference of the current speed from the speed factor.
    """

    nominal_s: FloatArray
    speed_factor: float = 1.0
    variance: float = SPEED_FACTOR_SD**2
    now: float = 0.0


@dataclass(frozen=True, eq=False)
class Ahead:
    """Predicted places: (n,) clock readings with weights that sum to 1."""

    clock: FloatArray
    reading_s: FloatArray
    weight: FloatArray


@dataclass(frozen=True, slots=True)
class ProfileObservation:
    """Data of a report in the profile's frame. None: not reported."""

    east_m: float | None
    north_m: float | None
    east_mps: float | None
    north_mps: float | None
    up_mps: float | None
    sequence: int | None


def at_start() -> AlongTrack:
    return AlongTrack(np.zeros(PLACES))


def anywhere(profile: FlightProfile, observation: ProfileObservation) -> AlongTrack | None:
    """Return the places for the first report of a flight; None if it is far from the profile."""
    start = at_start()
    return _found_anew(profile, start, clock_of(profile, start), 0.0, observation, within_s=math.inf)


def clock_of(profile: FlightProfile, along_track: AlongTrack) -> FloatArray:
    """Return the clock reading of each knot."""
    return profile.moving_s / along_track.speed_factor + profile.standing_s


def ahead(profile: FlightProfile, along_track: AlongTrack, after_s: float, *, is_surely_under_way: bool = True) -> Ahead:
    """Return the places after a time.

    after_s: since the last update, at least 0. Without is_surely_under_way it may have stood still for any part of it.
    """
    clock = clock_of(profile, along_track)
    from_s = np.interp(along_track.nominal_s, profile.nominal_s, clock)
    middle_s, uncertainty_s = _moved(profile, along_track, clock, from_s, after_s)
    if not is_surely_under_way:
        middle_s, uncertainty_s = _at_any_time(from_s, uncertainty_s, after_s)
    reading_s = np.maximum(middle_s[:, None] + uncertainty_s[:, None] * SPREAD, from_s[:, None]).ravel()
    return Ahead(clock, reading_s, np.tile(SPREAD_WEIGHT / PLACES, PLACES))


def updated(
    profile: FlightProfile, along_track: AlongTrack, after_s: float, observation: ProfileObservation, *, is_surely_under_way: bool = True
) -> AlongTrack | None:
    """Return the places after a report and an improved speed factor; None if the report is far from the profile.

    Without is_surely_under_way it may have stood still for any part of the time.
    """
    clock = clock_of(profile, along_track)
    from_s = np.interp(along_track.nominal_s, profile.nominal_s, clock)
    middle_s, uncertainty_s = _moved(profile, along_track, clock, from_s, after_s)
    if not is_surely_under_way:
        middle_s, uncertainty_s = _at_any_time(from_s, uncertainty_s, after_s)
    low_s, high_s = float((middle_s - 4.5 * uncertainty_s).min()), float((middle_s + 4.5 * uncertainty_s).max())
    grid_s = np.linspace(max(low_s, float(from_s.min()) - 0.5, float(clock[0])), min(high_s, float(clock[-1])) + 1e-3, GRID)
    prior = np.exp(-0.5 * ((grid_s[:, None] - middle_s) / uncertainty_s) ** 2) / uncertainty_s
    weight = prior.sum(axis=1) * _likelihood(profile, clock, grid_s, observation)
    if observation.east_m is not None and observation.north_m is not None:
        gap_m = np.hypot(_at(grid_s, clock, profile.east_m) - observation.east_m, _at(grid_s, clock, profile.north_m) - observation.north_m)
        if not weight.max() > 0 or gap_m[int(weight.argmax())] > FAR_M:
            return _found_anew(profile, along_track, clock, float(middle_s.mean()), observation)
    places_s = _places(grid_s, weight)
    if places_s is None:
        return replace(along_track, nominal_s=np.interp(np.sort(middle_s), clock, profile.nominal_s))
    if not is_surely_under_way:
        return replace(
            along_track, nominal_s=np.interp(places_s, clock, profile.nominal_s), now=_now(profile, clock, places_s, observation)
        )
    return _learnt(profile, along_track, clock, from_s, middle_s, places_s, after_s, observation)


def _moved(
    profile: FlightProfile, along_track: AlongTrack, clock: FloatArray, from_s: FloatArray, after_s: float
) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of the clock after a time, for each place."""
    plain_s = from_s + after_s
    moving_s = (_at(plain_s, clock, profile.moving_s) - _at(from_s, clock, profile.moving_s)) / along_track.speed_factor
    slack_s2 = _at(plain_s, clock, profile.variance_s2) - _at(from_s, clock, profile.variance_s2)
    middle_s = plain_s + along_track.now * NOW_S * -np.expm1(-moving_s / NOW_S)
    gusts_s2 = 2.0 * GUST_SD**2 * GUST_S**2 * (moving_s / GUST_S + np.expm1(-moving_s / GUST_S))
    return middle_s, np.sqrt(MIN_S**2 + gusts_s2 + along_track.variance * moving_s**2 + slack_s2)


def _at_any_time(from_s: FloatArray, uncertainty_s: FloatArray, after_s: float) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of the clock for a UAV that starts at any moment of the time, or later."""
    return from_s + 0.5 * after_s, np.hypot(uncertainty_s, 0.4 * after_s)


def _at(reading_s: FloatArray, clock: FloatArray, column: FloatArray) -> FloatArray:
    return np.interp(reading_s, clock, column)


def velocity(profile: FlightProfile, clock: FloatArray, reading_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return east, north and up [m/s] by the profile, over a second around each reading; over half a second at the beginning."""
    before, after = np.maximum(reading_s - 0.5, clock[0]), reading_s + 0.5
    columns = (profile.east_m, profile.north_m, profile.height_m)
    east, north, up = ((_at(after, clock, column) - _at(before, clock, column)) / (after - before) for column in columns)
    return east, north, up


def _likelihood(profile: FlightProfile, clock: FloatArray, grid_s: FloatArray, observation: ProfileObservation) -> FloatArray:
    found = np.ones_like(grid_s)
    if observation.east_m is not None and observation.north_m is not None:
        off_east, off_north = (
            _at(grid_s, clock, profile.east_m) - observation.east_m,
            _at(grid_s, clock, profile.north_m) - observation.north_m,
        )
        gap_m2 = off_east**2 + off_north**2
        east, north, _ = velocity(profile, clock, grid_s)
        along_m2 = (off_east * east + off_north * north) ** 2 / np.maximum(east**2 + north**2, 1.0)
        near = np.exp(-0.5 * (along_m2 / ALONG_M**2 + np.maximum(gap_m2 - along_m2, 0.0) / OFF_M**2))
        found *= near + NOT_EVEN * np.exp(-0.5 * gap_m2 / OFF_M**2) + 1e-5 * np.exp(-0.5 * gap_m2 / FAR_M**2)
    if observation.east_mps is not None and observation.north_mps is not None:
        east, north, _ = velocity(profile, clock, grid_s)
        gap_mps2 = (east - observation.east_mps) ** 2 + (north - observation.north_mps) ** 2
        found *= np.exp(-0.5 * gap_mps2 / OFF_MPS**2) + 1e-3
    if observation.sequence is not None and len(profile.sequence):
        leg = profile.leg[np.minimum(np.searchsorted(clock, grid_s), len(profile.leg) - 1)]
        found *= np.where(np.abs(profile.sequence[leg] - observation.sequence) <= 0, 1.0, NOT_STATED)
    return found


def _found_anew(
    profile: FlightProfile,
    along_track: AlongTrack,
    clock: FloatArray,
    expected_s: float,
    observation: ProfileObservation,
    *,
    within_s: float = 120.0,
) -> AlongTrack | None:
    """Search the whole profile for a UAV that is not at its predicted place; None if it is far from all of it."""
    grid_s = np.unique(np.concatenate([clock, np.linspace(clock[0], clock[-1], max(GRID, int(clock[-1] - clock[0])))]))
    weight = (
        _likelihood(profile, clock, grid_s, observation) * (1e-3 + np.exp(-np.abs(grid_s - expected_s) / within_s)) * np.gradient(grid_s)
    )
    best = int(weight.argmax())
    gap_m = math.hypot(_one(grid_s[best], clock, profile.east_m) - (observation.east_m or 0.0),
                       _one(grid_s[best], clock, profile.north_m) - (observation.north_m or 0.0))  # fmt: skip
    places_s = _places(grid_s, weight)
    if gap_m > FAR_M or places_s is None:
        return None
    return replace(along_track, nominal_s=np.interp(places_s, clock, profile.nominal_s), now=0.0)


def _one(reading_s: float, clock: FloatArray, column: FloatArray) -> float:
    return float(np.interp(reading_s, clock, column))


def _places(grid_s: FloatArray, weight: FloatArray) -> FloatArray | None:
    total = np.cumsum(weight)
    if not (total[-1] > 0 and math.isfinite(total[-1])):
        return None
    return np.interp((np.arange(PLACES) + 0.5) / PLACES, (total - 0.5 * weight) / total[-1], grid_s)


def _learnt(
    profile: FlightProfile,
    along_track: AlongTrack,
    clock: FloatArray,
    from_s: FloatArray,
    middle_s: FloatArray,
    places_s: FloatArray,
    after_s: float,
    observation: ProfileObservation,
) -> AlongTrack:
    """Update the speed factor, only from time in motion and from reports with a position."""
    nominal_s = np.interp(places_s, clock, profile.nominal_s)
    variance = along_track.variance + SPEED_FACTOR_DRIFT**2 * after_s
    if observation.east_m is None:
        return replace(along_track, nominal_s=nominal_s, variance=min(variance, SPEED_FACTOR_SD**2))
    moving_s = float((_at(middle_s, clock, profile.moving_s) - _at(from_s, clock, profile.moving_s)).mean()) / along_track.speed_factor
    better = along_track.speed_factor
    if moving_s > 0.5 * after_s:
        slack_s2 = float((_at(middle_s, clock, profile.variance_s2) - _at(from_s, clock, profile.variance_s2)).mean())
        observed_s2 = 2.0 * GUST_SD**2 * GUST_S * moving_s + slack_s2 + float(places_s.var()) + float(middle_s.var()) + 0.2**2
        gain = variance / (variance + observed_s2 / moving_s**2)
        better = along_track.speed_factor * (1.0 + gain * float(places_s.mean() - middle_s.mean()) / moving_s)
        variance *= 1.0 - gain
    better, variance = min(max(better, MIN_SPEED_FACTOR), MAX_SPEED_FACTOR), min(max(variance, SUREST_SD**2), SPEED_FACTOR_SD**2)
    return AlongTrack(nominal_s, better, variance, _now(profile, clock, places_s, observation))


def _now(profile: FlightProfile, clock: FloatArray, places_s: FloatArray, observation: ProfileObservation) -> float:
    """Return the relative difference of the reported speed from the profile's; 0 near corners and stops."""
    if observation.east_mps is None or observation.north_mps is None:
        return 0.0
    here_s = float(places_s.mean())
    each = np.array(velocity(profile, clock, here_s + np.array([0.0, *EVEN_S])))
    by_profile_mps = float(np.linalg.norm(each[:, 0]))
    if by_profile_mps < MIN_EVEN_MPS or np.linalg.norm(each[:, 1:] - each[:, :1], axis=0).max() > 0.1 * by_profile_mps:
        return 0.0
    reported_mps = math.sqrt(observation.east_mps**2 + observation.north_mps**2 + (observation.up_mps or 0.0) ** 2)
    return NOW_SHARE * min(max(reported_mps / by_profile_mps - 1.0, -0.5), 0.5)
