"""How high a UAV flies over what, and what that is above sea level and above its take-off."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import distance_m
from inspection.graph.flown_heights import HIGHEST_VOLTAGE_HEIGHT_M, HIGHEST_VOLTAGE_V, UNTAGGED_HEIGHT_M
from inspection.graph.inspection_graph import NodeKind
from inspection.terrain.heights import amsl_m, counted_from
from missions.flight_plan.rules import FlightRules
from missions.flight_plan.waypoints import RoutePoints, Waypoints

FloatArray = NDArray[np.float64]
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
    position = points.position
    shares = [np.arange(count) / count for count in _sample_counts(position)]  # from each leg's start up to but without its end
    samples = [start + share[:, None] * (end - start) for start, end, share in zip(position[:-1], position[1:], shares, strict=True)]
    ground_m = ground_heights_m(np.concatenate([*samples, position[-1:]]))
    if np.isnan(ground_m).any():
        return flat, True

    take_off_m = float(ground_m[0])
    legs: list[int] = []  # with a bend, of which `bent` are the shares
    bent: list[float] = []
    under = [take_off_m]
    first = 0
    for leg, share in enumerate(shares):
        under_m = ground_m[first : first + len(share) + 1]  # the next leg's first sample is this leg's end
        first += len(share)
        for bend in _bends(np.append(share, 1.0), under_m, rules.terrain_tolerance_m):
            legs.append(leg)
            bent.append(float(share[bend]))
            under.append(float(under_m[bend]))
        under.append(float(under_m[-1]))
    flown = points.with_points_between(np.array(legs, dtype=np.int64), np.array(bent, dtype=np.float64)) if legs else points
    ground = np.array(under)
    above_sea_m = amsl_m(flown.agl_m, "AGL", ground_amsl_m=ground, take_off_amsl_m=take_off_m)
    above_take_off_m = counted_from(above_sea_m, "RELATIVE", ground_amsl_m=ground, take_off_amsl_m=take_off_m)
    return Waypoints(flown, above_sea_m, above_take_off_m), False


def _sample_counts(position: FloatArray) -> list[int]:
    return [max(1, math.ceil(length_m / SAMPLE_SPACING_M)) for length_m in distance_m(position[:-1], position[1:]).tolist()]


def _bends(share: FloatArray, ground_m: FloatArray, tolerance_m: float) -> list[int]:
    """The samples needed so that straight lines between them stay within the tolerance of the ground's shape (Douglas-Peucker)."""
    bends: list[int] = []
    open_spans = [(0, len(share) - 1)]
    while open_spans:
        first, last = open_spans.pop()
        if last - first < 2:
            continue
        inner = slice(first + 1, last)
        line_m = np.interp(share[inner], share[[first, last]], ground_m[[first, last]])
        off_m = np.abs(ground_m[inner] - line_m)
        if off_m.max() > tolerance_m:
            bend = first + 1 + int(off_m.argmax())
            bends.append(bend)
            open_spans += [(first, bend), (bend, last)]
    return sorted(bends)
