"""Matches photos with captures that UAVs reported, by time and position, and with the targets next to them.

A photo is matched only where the next candidate is clearly worse.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import shapely

MAX_TIME_S = 3.0  # between a photo's own time and the report's, beside the report's bound: cameras write whole seconds
MAX_CAPTURE_DISTANCE_M = 25.0  # between a photo's own position and the report's, beside the report's bound
CLEAR_TIME_S = 1.0  # that the runner-up is farther away in time

MAX_TARGET_DISTANCE_M = 120.0  # from a camera to its target
MAX_CANDIDATES = 2
CLEAR_RATIO = 2.0  # of the runner-up's distance to the nearest one's
CLEAR_DISTANCE_M = 20.0  # that the runner-up is farther away: positions are good to some 10 m
TIME_MARGIN_S = 30.0  # before and after the visit


@dataclass(frozen=True)
class CapturePlace:
    """A capture in east and north metres from the photo. group: captures that show the same, such as those at one waypoint."""

    key: int
    group: str
    taken_s: float
    east_m: float
    north_m: float
    time_bound_s: float = 0.0
    position_bound_m: float = 0.0


def capture_of_photo(taken_s: float, captures: Sequence[CapturePlace]) -> int | None:
    """Return the key of the capture; None where none is near, or where two of different groups are about as near in time."""
    near = [one for one in captures if _is_near(one, taken_s)]
    near.sort(key=lambda one: (abs(one.taken_s - taken_s), one.key))
    if not near:
        return None
    best = near[0]
    gap_s = min((abs(one.taken_s - taken_s) for one in near if one.group != best.group), default=math.inf) - abs(best.taken_s - taken_s)
    return best.key if gap_s >= CLEAR_TIME_S else None


def _is_near(capture: CapturePlace, taken_s: float) -> bool:
    is_then = abs(capture.taken_s - taken_s) <= MAX_TIME_S + capture.time_bound_s
    return is_then and math.hypot(capture.east_m, capture.north_m) <= MAX_CAPTURE_DISTANCE_M + capture.position_bound_m


@dataclass(frozen=True)
class TargetPlace:
    """A target in east and north metres from the photo, and the time of its visit in seconds, if known."""

    key: int
    outline: tuple[tuple[float, float], ...]  # of a stretch, or one point
    visit_s: tuple[float, float] | None = None


@dataclass(frozen=True)
class TargetCandidate:
    key: int
    distance_m: float
    is_in_visit: bool | None  # taken while the target was visited; None: not known of one of the two


@dataclass(frozen=True)
class Placing:
    """chosen: the target, or None where it is not clear. candidates: the best first."""

    chosen: int | None
    candidates: tuple[TargetCandidate, ...]


def place_photo(taken_s: float | None, targets: Sequence[TargetPlace]) -> Placing:
    """Return the nearest target of a photo, if it is clear.

    Targets that were visited at another time do not come into question. A target whose visit holds the photo wins over one whose visit is
    not known.
    """
    candidates = [TargetCandidate(target.key, _distance_m(target.outline), _is_in_visit(taken_s, target)) for target in targets]
    possible = [one for one in candidates if one.distance_m <= MAX_TARGET_DISTANCE_M and one.is_in_visit is not False]
    possible.sort(key=lambda one: (one.is_in_visit is None, one.distance_m, one.key))
    best = tuple(possible[:MAX_CANDIDATES])
    return Placing(best[0].key if best and all(_is_clear(best[0], other) for other in possible[1:]) else None, best)


def _is_clear(nearest: TargetCandidate, other: TargetCandidate) -> bool:
    is_only_visit = nearest.is_in_visit is True and other.is_in_visit is None
    ahead_m = other.distance_m - nearest.distance_m
    return ahead_m >= CLEAR_DISTANCE_M and (is_only_visit or other.distance_m >= CLEAR_RATIO * nearest.distance_m)


def _is_in_visit(taken_s: float | None, target: TargetPlace) -> bool | None:
    if taken_s is None or target.visit_s is None:
        return None
    begin_s, end_s = target.visit_s
    return begin_s - TIME_MARGIN_S <= taken_s <= end_s + TIME_MARGIN_S


def _distance_m(outline: Sequence[tuple[float, float]]) -> float:
    shape = shapely.Point(outline) if len(outline) == 1 else shapely.LineString(outline)
    return float(shapely.distance(shapely.Point(0.0, 0.0), shape))
