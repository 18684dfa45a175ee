"""How high a UAV flies over what, and what that is above sea level and above its take-off."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import HIGHEST_VOLTAGE_HEIGHT_M, HIGHEST_VOLTAGE_V, UNTAGGED_HEIGHT_M
from inspection.terrain.heights import counted_from
from inspection.terrain.profile import GroundProfile
from planning.rules import FlightRules
from planning.trajectory.terrain_following import BELOW_M, SLACK_M, followed_terrain
from planning.trajectory.waypoints import PASS, RoutePoints, Waypoints

FloatArray = NDArray[np.float64]
GroundHeights = Callable[[FloatArray], FloatArray]  # positions (n, 2) to metres above sea level (n,), NaN where unknown


class GroundModel(NamedTuple):
    """A terrain model: heights of places (n, 2), and its profile under straight legs from places (n, 2) to places (n, 2)."""

    heights_m: GroundHeights
    profile: Callable[[FloatArray, FloatArray], GroundProfile]


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


def with_heights(
    points: RoutePoints, ground: GroundModel | None, rules: FlightRules, floor_agl_m: FloatArray | None = None
) -> tuple[Waypoints, bool]:
    """Waypoints with all three heights, and whether flat ground had to be assumed: without a terrain model, or where it has a gap.

    A planned height is a floor: waypoints are put in on the straight lon/lat line between two points so that no leg comes lower than the
    straight line between their heights above ground, but for BELOW_M, or higher than the tolerance above it, anywhere over the model's
    own surface. Points that are passed may themselves be flown so much higher, where that needs fewer waypoints; with floor_agl_m, (n,),
    all are flown as they are, and legs may come down to the straight line between these. If the ground is unknown in even one place,
    nothing is put in and no height above sea level is given.
    """
    flat = Waypoints(points, None, points.agl_m)
    if ground is None or len(points) < 2:
        return flat, bool(points)
    profile = ground.profile(points.position[:-1], points.position[1:])
    if np.isnan(profile.heights_m).any():
        return flat, True

    take_off_m = float(profile.heights_m[0, 0])
    is_passed = np.zeros(len(points), dtype=np.bool_)
    if floor_agl_m is None:
        is_passed = points.kind == PASS
        is_passed[list(points.task)] = False
    floors_m, tolerance_m, max_agl_m = points.agl_m + SLACK_M, rules.terrain_tolerance_m, rules.max_agl_m
    if floor_agl_m is not None:  # legs as they were drawn between such points stay as they are
        floors_m, tolerance_m, max_agl_m = floor_agl_m, tolerance_m + BELOW_M, max_agl_m + SLACK_M
    is_vertical = (points.position[:-1] == points.position[1:]).all(axis=1)
    found = followed_terrain(points.agl_m, floors_m, is_vertical, is_passed, profile, tolerance_m, max_agl_m)
    flown = points.with_points_between(found.leg, found.share) if len(found.leg) else points
    place = found.leg + 1 + np.arange(len(found.leg))
    is_own = np.ones(len(flown), dtype=np.bool_)
    is_own[place] = False
    above_sea_m, agl_m = np.empty(len(flown)), np.empty(len(flown))
    above_sea_m[is_own], above_sea_m[place] = found.own_m, found.level_m
    agl_m[is_own], agl_m[place] = found.own_agl_m, found.level_m - found.ground_m
    above_take_off_m = counted_from(above_sea_m, "RELATIVE", ground_amsl_m=above_sea_m - agl_m, take_off_amsl_m=take_off_m)
    return Waypoints(flown.at_heights(agl_m), above_sea_m, above_take_off_m), False
