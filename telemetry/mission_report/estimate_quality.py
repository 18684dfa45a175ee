"""Quality of a mission's estimates, compared with measurements of the same moments."""

import math
from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from telemetry.estimation.estimate import Ellipse

GAP_S = 3.0  # between two measurements, up to which positions in between are interpolated
ALONE_S = 0.5  # from a single measurement, up to which it is extrapolated
AGES_S = (2.0, 5.0, 10.0, 30.0, math.inf)  # upper ends


@dataclass(frozen=True, slots=True)
class MeasuredError:
    """A measured position; Unix seconds, speeds [m/s] east and north, None if not reported."""

    at_s: float
    position: LonLat
    altitude_relative_m: float | None = None
    east_mps: float | None = None
    north_mps: float | None = None


@dataclass(frozen=True, slots=True)
class Estimated:
    """An estimate as it was made; `report_s` is the time of measurement of its last report."""

    at_s: float
    position: LonLat
    bound: Ellipse
    report_s: float | None = None
    altitude_relative_m: float | None = None
    bound_height_m: float = math.inf


@dataclass(frozen=True, slots=True)
class Quality:
    """Quality of `count` compared estimates. Errors are horizontal [m]; shares are 0 to 1; None without data.

    `up_to_s` is the upper limit of the last report's age in this group, whose lower limit is that of the previous group; infinite for the
    last.
    """

    up_to_s: float
    count: int
    rms_m: float | None
    largest_m: float | None
    inside_share: float | None
    height_rms_m: float | None
    height_inside_share: float | None


@dataclass(frozen=True, slots=True)
class EstimateQuality:
    """`whole` is of all estimates, `by_age` by the age of the last report; `untold` counts estimates without a measurement to compare."""

    whole: Quality
    by_age: tuple[Quality, ...]
    untold: int


@dataclass(frozen=True, slots=True)
class Compared:
    """One compared estimate: the age of its last report, its error, and whether it is within its bounds."""

    age_s: float
    off_m: float
    is_inside: bool
    height_off_m: float | None
    is_height_inside: bool


def estimate_quality(estimates: Iterable[Estimated], measured: Sequence[MeasuredError]) -> EstimateQuality:
    """Return the quality of one UAV's estimates. measured: sorted by time.

    For several UAVs, call `compare` for each and `quality_of` once with all results.
    """
    compared, untold = compare(estimates, measured)
    return quality_of(compared, untold)


def compare(estimates: Iterable[Estimated], measured: Sequence[MeasuredError]) -> tuple[list[Compared], int]:
    """Return one UAV's compared estimates, and the number of those without a measurement."""
    times = [one.at_s for one in measured]
    found, untold = [], 0
    for estimate in estimates:
        truth = _at(measured, times, estimate.at_s)
        if truth is None:
            untold += 1
        else:
            found.append(_compared(estimate, truth))
    return found, untold


def quality_of(compared: Sequence[Compared], untold: int = 0) -> EstimateQuality:
    by_age, above_s = [], -math.inf
    for up_to_s in AGES_S:
        by_age.append(_quality(up_to_s, [one for one in compared if above_s < one.age_s <= up_to_s]))
        above_s = up_to_s
    return EstimateQuality(_quality(math.inf, compared), tuple(by_age), untold)


def _quality(up_to_s: float, compared: Sequence[Compared]) -> Quality:
    if not compared:
        return Quality(up_to_s, 0, None, None, None, None, None)
    heights = [(one.height_off_m, one.is_height_inside) for one in compared if one.height_off_m is not None]
    return Quality(
        up_to_s,
        len(compared),
        _rms([one.off_m for one in compared]),
        max(one.off_m for one in compared),
        sum(one.is_inside for one in compared) / len(compared),
        _rms([off_m for off_m, _ in heights]) if heights else None,
        sum(is_inside for _, is_inside in heights) / len(heights) if heights else None,
    )


def _rms(errors_m: Sequence[float]) -> float:
    return math.sqrt(sum(error_m**2 for error_m in errors_m) / len(errors_m))


def _at(measured: Sequence[MeasuredError], times: Sequence[float], at_s: float) -> MeasuredError | None:
    """Return the measured position between two near measurements, or extrapolated from one; None without either."""
    place = bisect_left(times, at_s)
    before = measured[place - 1] if place else None
    after = measured[place] if place < len(measured) else None
    if before is not None and after is not None and after.at_s - before.at_s <= GAP_S:
        return _between(before, after, at_s)
    near = [one for one in (before, after) if one is not None and abs(one.at_s - at_s) <= ALONE_S]
    return _beside(min(near, key=lambda one: abs(one.at_s - at_s)), at_s) if near else None


def _between(before: MeasuredError, after: MeasuredError, at_s: float) -> MeasuredError:
    gap_s = after.at_s - before.at_s
    share = (at_s - before.at_s) / gap_s if gap_s > 0 else 0.0
    lon = before.position.lon + share * (after.position.lon - before.position.lon)
    lat = before.position.lat + share * (after.position.lat - before.position.lat)
    heights = before.altitude_relative_m, after.altitude_relative_m
    height_m = None if heights[0] is None or heights[1] is None else heights[0] + share * (heights[1] - heights[0])
    return MeasuredError(at_s, LonLat(lon, lat), height_m)


def _beside(one: MeasuredError, at_s: float) -> MeasuredError:
    if one.east_mps is None or one.north_mps is None:
        return one
    frame, after_s = LocalFrame.around(*one.position), at_s - one.at_s
    lon = one.position.lon + one.east_mps * after_s / frame.metres_per_degree_east
    lat = one.position.lat + one.north_mps * after_s / frame.metres_per_degree_north
    return MeasuredError(at_s, LonLat(lon, lat), one.altitude_relative_m)


def _compared(estimate: Estimated, truth: MeasuredError) -> Compared:
    frame = LocalFrame.around(*estimate.position)
    east_m = (truth.position.lon - estimate.position.lon) * frame.metres_per_degree_east
    north_m = (truth.position.lat - estimate.position.lat) * frame.metres_per_degree_north
    bearing = math.radians(estimate.bound.bearing_deg)
    along_m = east_m * math.sin(bearing) + north_m * math.cos(bearing)
    across_m = east_m * math.cos(bearing) - north_m * math.sin(bearing)
    reach = math.hypot(along_m / max(estimate.bound.along_m, 1e-3), across_m / max(estimate.bound.across_m, 1e-3))
    height_off_m = None
    if estimate.altitude_relative_m is not None and truth.altitude_relative_m is not None:
        height_off_m = abs(truth.altitude_relative_m - estimate.altitude_relative_m)
    return Compared(
        age_s=math.inf if estimate.report_s is None else estimate.at_s - estimate.report_s,
        off_m=math.hypot(east_m, north_m),
        is_inside=reach <= 1.0,
        height_off_m=height_off_m,
        is_height_inside=height_off_m is not None and height_off_m <= estimate.bound_height_m,
    )
