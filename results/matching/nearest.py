"""The first level of matching: the target next to where, and when, a photo was taken.

A photo is placed only where the next candidate is clearly worse; else it stays unplaced, with the two that come into question.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

MAX_DISTANCE_M = 120.0  # from a camera to its target
MAX_CANDIDATES = 2
CLEAR_RATIO = 2.0  # of the runner-up's distance to the nearest one's
CLEAR_DISTANCE_M = 20.0  # that the runner-up is farther away: positions are good to some 10 m
TIME_MARGIN_S = 30.0  # before and after the visit


@dataclass(frozen=True)
class TargetPlace:
    """A target in east and north metres, and the time of its visit in seconds, if known. outline: points on a stretch; one of a point."""

    key: int
    outline: tuple[tuple[float, float], ...]
    visit_s: tuple[float, float] | None = None


@dataclass(frozen=True)
class PhotoPlace:
    east_m: float
    north_m: float
    taken_s: float | None


@dataclass(frozen=True)
class Candidate:
    key: int
    distance_m: float
    is_in_visit: bool | None  # taken while the target was visited; None: not known of one of the two


@dataclass(frozen=True)
class Placing:
    """chosen: the target, or None where it is not clear. candidates: the best first."""

    chosen: int | None
    candidates: tuple[Candidate, ...]


def place_photo(photo: PhotoPlace, targets: Sequence[TargetPlace]) -> Placing:
    """Return the target of a photo.

    Targets that were visited at another time do not come into question. A target whose visit holds the photo wins over one whose visit is
    not known.
    """
    candidates = [Candidate(target.key, _distance_m(photo, target.outline), _is_in_visit(photo, target)) for target in targets]
    possible = [one for one in candidates if one.distance_m <= MAX_DISTANCE_M and one.is_in_visit is not False]
    possible.sort(key=lambda one: (one.is_in_visit is None, one.distance_m, one.key))
    best = tuple(possible[:MAX_CANDIDATES])
    return Placing(best[0].key if best and all(_is_clear(best[0], other) for other in possible[1:]) else None, best)


def _is_clear(nearest: Candidate, other: Candidate) -> bool:
    is_only_visit = nearest.is_in_visit is True and other.is_in_visit is None
    ahead_m = other.distance_m - nearest.distance_m
    return ahead_m >= CLEAR_DISTANCE_M and (is_only_visit or other.distance_m >= CLEAR_RATIO * nearest.distance_m)


def _is_in_visit(photo: PhotoPlace, target: TargetPlace) -> bool | None:
    if photo.taken_s is None or target.visit_s is None:
        return None
    begin_s, end_s = target.visit_s
    return begin_s - TIME_MARGIN_S <= photo.taken_s <= end_s + TIME_MARGIN_S


def _distance_m(photo: PhotoPlace, outline: Sequence[tuple[float, float]]) -> float:
    here = (photo.east_m, photo.north_m)
    if len(outline) == 1:
        return math.dist(here, outline[0])
    return min(_distance_to_leg_m(here, start, end) for start, end in pairwise(outline))


def _distance_to_leg_m(point: tuple[float, float], start: tuple[float, float], end: tuple[float, float]) -> float:
    east_m, north_m = end[0] - start[0], end[1] - start[1]
    square_m2 = east_m**2 + north_m**2
    share = 0.0 if square_m2 == 0.0 else ((point[0] - start[0]) * east_m + (point[1] - start[1]) * north_m) / square_m2
    share = min(max(share, 0.0), 1.0)
    return math.dist(point, (start[0] + share * east_m, start[1] + share * north_m))
