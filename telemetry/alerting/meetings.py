"""Which UAVs in the air come near each other within the next seconds."""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from telemetry.alerting.surroundings import Meeting

STEP_S = 2.0
MOST_BOUND_M = 10.0  # of each; a UAV that may be anywhere would meet everyone
DEGREE_M = 111_195.0
NEAR_M, NEAR_HEIGHT_M = 150.0, 60.0  # farther ones are not told: no limit reaches so far beyond


@dataclass(frozen=True, slots=True)
class Moving:
    """A UAV in the air. `ahead` is where it will be each STEP_S, now first, in lon/lat; `height_m` counts from sea level, None: not known.

    Bounds hold 95 of 100 times. UAVs of different `organisation`s are told of each other nothing.
    """

    uav_id: int
    name: str
    organisation: int
    ahead: tuple[tuple[float, float], ...]
    height_m: float | None
    climb_mps: float
    bound_m: float
    bound_height_m: float


def meetings(moving: Sequence[Moving], within_s: float) -> dict[int, list[Meeting]]:
    """By the UAV with the smaller key of each pair: how near they come within so many seconds."""
    found: dict[int, list[Meeting]] = defaultdict(list)
    if len(moving) < 2:
        return found
    steps = min(min(len(one.ahead) for one in moving), int(within_s / STEP_S) + 1)
    way = np.array([one.ahead[:steps] for one in moving], dtype=np.float64)
    middle_lat = math.radians(float(way[:, 0, 1].mean()))
    way = way * (DEGREE_M * math.cos(middle_lat), DEGREE_M)
    reach_m = np.hypot(*(way - way[:, :1]).transpose(2, 0, 1)).max(axis=1)
    apart_m = np.hypot(way[:, None, 0, 0] - way[None, :, 0, 0], way[:, None, 0, 1] - way[None, :, 0, 1])
    group = np.array([one.organisation for one in moving])
    near = (apart_m - reach_m[:, None] - reach_m[None, :] < NEAR_M) & (group[:, None] == group[None, :])
    for one, other in zip(*np.nonzero(np.triu(near, 1)), strict=True):
        first, second = sorted((moving[one], moving[other]), key=lambda uav: uav.uav_id)
        meeting = _closest(first, second, way[one] - way[other])
        if meeting is not None:
            found[first.uav_id].append(meeting)
    return found


def _closest(first: Moving, second: Moving, between: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Meeting | None:
    """between (steps, 2) [m]: from the one to the other. Of each step the closest moment counts."""
    best_m, at_s = math.hypot(*between[0]), 0.0
    for step in range(len(between) - 1):
        (x, y), (dx, dy) = between[step], between[step + 1] - between[step]
        square = dx * dx + dy * dy
        share = 0.0 if square == 0.0 else min(1.0, max(0.0, -(x * dx + y * dy) / square))
        metres = math.hypot(x + share * dx, y + share * dy)
        if metres < best_m:
            best_m, at_s = metres, (step + share) * STEP_S
    height_m = _height_between_m(first, second, at_s)
    if best_m > NEAR_M or height_m > NEAR_HEIGHT_M:
        return None
    bound_m = math.hypot(min(first.bound_m, MOST_BOUND_M), min(second.bound_m, MOST_BOUND_M))
    bound_height_m = math.hypot(min(first.bound_height_m, MOST_BOUND_M), min(second.bound_height_m, MOST_BOUND_M))
    return Meeting(
        other_id=second.uav_id,
        other_name=second.name,
        in_s=float(at_s),
        lateral_m=float(best_m),
        height_m=height_m,
        least_lateral_m=max(0.0, float(best_m) - bound_m),
        least_height_m=max(0.0, height_m - bound_height_m),
    )


def _height_between_m(first: Moving, second: Moving, at_s: float) -> float:
    """Heights that are not known count as the same. Who climbs or sinks passes all heights on its way."""
    if first.height_m is None or second.height_m is None:
        return 0.0
    now_m = first.height_m - second.height_m
    then_m = now_m + (first.climb_mps - second.climb_mps) * at_s
    return 0.0 if now_m * then_m < 0.0 else min(abs(now_m), abs(then_m))
