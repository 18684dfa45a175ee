"""Finds the report of a capture that a photo belongs to, by time and position. Without both nothing is certain, and nothing is chosen."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

MAX_TIME_S = 3.0  # between a photo's own time and the report's, beside the report's bound: cameras write whole seconds
MAX_DISTANCE_M = 25.0  # between a photo's own position and the report's, beside the report's bound
CLEAR_TIME_S = 1.0  # that the runner-up is farther away in time


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
    return is_then and math.hypot(capture.east_m, capture.north_m) <= MAX_DISTANCE_M + capture.position_bound_m
