"""How high a UAV flies over what, and what that is above sea level and above its take-off."""

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import distance_m
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import HIGHEST_VOLTAGE_HEIGHT_M, HIGHEST_VOLTAGE_V, UNTAGGED_HEIGHT_M
from inspection.terrain.heights import amsl_m, counted_from
from planning.rules import FlightRules
from planning.trajectory.waypoints import RoutePoints, Waypoints

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
GroundHeights = Callable[[FloatArray], FloatArray]  # positions (n, 2) to metres above sea level (n,), NaN where unknown

SAMPLE_SPACING_M = 50.0  # how densely the ground under a leg is looked at
# Heights where no tag states one, towards the upper end of what is common, so that the error is on the safe side.
DEFAULT_HEIGHT_M = {
    "pole": 14.0,
    "portal": 20.0,
    "tower": UNTAGGED_HEIGHT_M[NodeKind.SUPPORT],
    "line": UNTAGGED_HEIGHT_M[NodeKind.LINE_VERTEX],
    "railway": UNTAGGED_HEIGHT_M[NodeKind.RAILWAY],
    "bridge": UNTAGGED_HEIGHT_M[NodeKind.BRIDGE],
}
LINE_HEIGHT_M = (
    (HIGHEST_VOLTAGE_V, HIGHEST_VOLTAGE_HEIGHT_M),
    (100_000, 45.0),
    (50_000, 30.0),
    (1, 14.0),
)  # supports of a line of so many volts or more


def asset_height_m(*, kind: str, subtype: str = "", tagged_m: float | None = None, voltage_v: int | None = None) -> float:
    """The height above ground that an asset is taken to have: as tagged, else by voltage for a line, else by kind."""
    if tagged_m is not None and math.isfinite(tagged_m):
        return max(tagged_m, 0.0)
    if kind == "line" and voltage_v:
        return next(height_m for least_v, height_m in LINE_HEIGHT_M if voltage_v >= least_v)
    return DEFAULT_HEIGHT_M.get(subtype, DEFAULT_HEIGHT_M.get(kind, 0.0))


def is_above_limit(height_m: float, rules: FlightRules) -> bool:
    """Whether an asset of this height cannot be flown over with clearance."""
    return height_m + rules.clearance_m > rules.max_agl_m


def pass_agl_m(heights_m: FloatArray, rules: FlightRules) -> FloatArray:
    """Heights above ground at which assets of these heights are passed, (n,)."""
    passed_m: FloatArray = np.maximum(rules.transit_agl_m, heights_m + rules.clearance_m)
    return passed_m


def inspection_agl_m(height_m: float, rules: FlightRules) -> float:
    """Height above ground at which an asset is inspected; over a place without one, height 0, as high as between targets."""
    return height_m + rules.clearance_m if height_m > 0 else rules.transit_agl_m


def with_heights(points: RoutePoints, ground_heights_m: GroundHeights | None, rules: FlightRules) -> tuple[Waypoints, bool]:
    """Waypoints with all three heights, and whether flat ground had to be assumed: without a terrain model, or where it has a gap.

    Where the ground between two points bulges or sags by more than the tolerance, waypoints are put in on the straight lon/lat line
    between them. If the ground is unknown in even one place, nothing is put in and no height above sea level is given.
    """
    flat = Waypoints(points, None, points.agl_m)
    if ground_heights_m is None or not points:
        return flat, bool(points)
    counts = _sample_counts(points.position)
    ground_m = ground_heights_m(_sampled(points.position, counts))
    if np.isnan(ground_m).any():
        return flat, True

    take_off_m = float(ground_m[0])
    legs, bent, ground = _bends(counts, ground_m, rules.terrain_tolerance_m)
    flown = points.with_points_between(legs, bent) if len(legs) else points
    above_sea_m = amsl_m(flown.agl_m, "AGL", ground_amsl_m=ground, take_off_amsl_m=take_off_m)
    above_take_off_m = counted_from(above_sea_m, "RELATIVE", ground_amsl_m=ground, take_off_amsl_m=take_off_m)
    return Waypoints(flown, above_sea_m, above_take_off_m), False


def _sample_counts(position: FloatArray) -> IntArray:
    """Of each leg, its end not counted."""
    length_m = distance_m(position[:-1], position[1:])
    return np.maximum(1, np.ceil(length_m / SAMPLE_SPACING_M)).astype(np.int64)


@njit(cache=True, nogil=True)
def _sampled(position: FloatArray, counts: IntArray) -> FloatArray:
    """Evenly on the straight lon/lat lines between positions (n, 2), counts (n - 1,) on each, and the last position: (counts + 1, 2)."""
    samples, at = np.empty((counts.sum() + 1, 2)), 0
    for leg in range(len(counts)):
        for step in range(counts[leg]):
            share = step / counts[leg]
            samples[at] = position[leg] + share * (position[leg + 1] - position[leg])
            at += 1
    samples[at] = position[-1]
    return samples


@njit(cache=True, nogil=True)
def _bends(counts: IntArray, ground_m: FloatArray, tolerance_m: float) -> tuple[IntArray, FloatArray, FloatArray]:
    """The samples needed so that straight lines between them stay within the tolerance of the ground's shape (Douglas-Peucker).

    Their legs and their shares of them, (k,) each; and the ground under all points, these among them.
    """
    is_bend = np.zeros(len(ground_m), dtype=np.bool_)
    stack = np.empty((counts.max() + 2 if len(counts) else 0, 2), dtype=np.int64)
    first = 0
    for count in counts:
        stack[0, 0], stack[0, 1], depth = 0, count, 1
        while depth:
            depth -= 1
            low, high = stack[depth, 0], stack[depth, 1]
            low_m = ground_m[first + low]
            slope_m = (ground_m[first + high] - low_m) / (high / count - low / count)
            worst_m, bend = tolerance_m, -1
            for sample in range(low + 1, high):
                off_m = abs(ground_m[first + sample] - (slope_m * (sample / count - low / count) + low_m))
                if off_m > worst_m:
                    worst_m, bend = off_m, sample
            if bend >= 0:
                is_bend[first + bend] = True
                stack[depth, 0], stack[depth, 1] = low, bend
                stack[depth + 1, 0], stack[depth + 1, 1] = bend, high
                depth += 2
        first += count
    bends = is_bend.sum()
    legs, shares = np.empty(bends, dtype=np.int64), np.empty(bends)
    under_m = np.empty(bends + len(counts) + 1)
    under_m[0] = ground_m[0]
    first, found, under = 0, 0, 1
    for leg in range(len(counts)):
        for sample in range(counts[leg]):
            if is_bend[first + sample]:
                legs[found], shares[found], under_m[under] = leg, sample / counts[leg], ground_m[first + sample]
                found, under = found + 1, under + 1
        first += counts[leg]
        under_m[under] = ground_m[first]
        under += 1
    return legs, shares, under_m
