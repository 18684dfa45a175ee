"""Judges what the turns of a course take, by the speed that a UAV may have at every half metre of its way."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from tests.missions.air import ACCELERATION_MPS2

CORNER_MPS2 = 4.0  # across the way
INSIDE_M = 1.3  # how far from a waypoint its corner is rounded at most
STANDS_RAD = math.radians(150.0)  # from here on a turn is made standing
NO_TURN_RAD = 0.001
STEP_M = 0.5
SHORT_M = 0.05
Way = tuple[float, float, float]


def turns_s(ways: Sequence[Way], seconds: Sequence[float], stands: Sequence[bool], brakes_s: float) -> list[float]:
    """Seconds of each leg beside those at one speed, and beside the `brakes_s` before and after each place where it stands.

    ways: metres to east, north and up; stands: of each leg's ends.
    """
    legs = [number for number, way in enumerate(ways) if math.hypot(*way) >= SHORT_M]
    if not legs or not all(map(math.isfinite, seconds)):
        return [0.0] * len(ways)
    lengths_m = [math.hypot(*ways[leg]) for leg in legs]
    speeds_mps = [length_m / seconds[leg] for length_m, leg in zip(lengths_m, legs, strict=True)]
    corners = [(0.0, 0.0, 0.0)]  # speed, metres taken of both legs, metres of the arc
    for number, (leg, follows) in enumerate(pairwise(legs)):
        is_stand = any(stands[leg + 1 : follows + 1])
        is_doubled = follows > leg + 1
        pair = ways[leg], ways[follows]
        corners.append((0.0, 0.0, 0.0) if is_stand else _corner(*pair, speeds_mps[number : number + 2], is_doubled=is_doubled))
    corners.append((0.0 if any(stands[legs[-1] + 1 :]) else speeds_mps[-1], 0.0, 0.0))
    at_m, most_mps, first = _limits(lengths_m, speeds_mps, corners)
    slope = 2.0 * ACCELERATION_MPS2 * at_m
    square = np.minimum.accumulate(most_mps**2 - slope) + slope
    square = np.minimum.accumulate((square + slope)[::-1])[::-1] - slope
    speed_mps = np.sqrt(np.maximum(square, 0.0))
    lost_s = [0.0] * len(ways)
    for number, leg in enumerate(legs):
        own = slice(first[number], first[number + 1])
        place_m, mps = at_m[own] - at_m[own][0], speed_mps[own]
        steps_s = np.diff(place_m) / np.maximum(0.5 * (mps[1:] + mps[:-1]), 1e-9)
        middle_m = 0.5 * (place_m[1:] + place_m[:-1])
        for (_mps, taken_m, arc_m), is_near in (
            (corners[number], middle_m < corners[number][1]),
            (corners[number + 1], middle_m > lengths_m[number] - corners[number + 1][1]),
        ):
            if taken_m > 0.0:
                steps_s[is_near] *= 0.5 * arc_m / taken_m
        lost_s[leg] = max(float(steps_s.sum()) - seconds[leg], 0.0)
    return _without_stops(lost_s, ways, stands, brakes_s)


def _corner(before: Way, after: Way, speeds_mps: Sequence[float], *, is_doubled: bool) -> tuple[float, float, float]:
    slower_mps = min(speeds_mps)
    long_m, next_m = math.hypot(*before), math.hypot(*after)
    across = math.hypot(*np.cross(before, after).tolist()) / (long_m * next_m)
    turn = math.atan2(across, float(np.dot(before, after)) / (long_m * next_m))
    if turn < NO_TURN_RAD:
        return slower_mps, 0.0, 0.0
    if turn > STANDS_RAD or is_doubled:
        return 0.0, 0.0, 0.0
    half = 0.5 * (math.pi - turn)  # between a leg and the line to the arc's centre
    radius_m = min(INSIDE_M * math.sin(half) / (1.0 - math.sin(half)), slower_mps**2 / CORNER_MPS2)
    taken_m = min(radius_m / math.tan(half), 0.5 * min(long_m, next_m))
    radius_m = taken_m * math.tan(half)
    return min(slower_mps, math.sqrt(CORNER_MPS2 * radius_m)), taken_m, radius_m * turn


def _limits(
    lengths_m: Sequence[float], speeds_mps: Sequence[float], corners: Sequence[tuple[float, float, float]]
) -> tuple[np.ndarray, np.ndarray, list[int]]:
    """Places along the way, the most speed at each, and the first place of each leg; where legs meet there are two."""
    at_m, most_mps, first, so_far_m = [], [], [0], 0.0
    for number, (length_m, speed_mps) in enumerate(zip(lengths_m, speeds_mps, strict=True)):
        (start_mps, start_m, _arc), (end_mps, end_m, _other) = corners[number], corners[number + 1]
        own_m = np.unique([*np.arange(0.0, length_m, STEP_M), start_m, length_m - end_m, length_m])
        own_mps = np.full(len(own_m), speed_mps)
        own_mps[own_m <= start_m] = np.minimum(own_mps[own_m <= start_m], start_mps)
        own_mps[own_m >= length_m - end_m] = np.minimum(own_mps[own_m >= length_m - end_m], end_mps)
        at_m.append(own_m + so_far_m)
        most_mps.append(own_mps)
        first.append(first[-1] + len(own_m))
        so_far_m += length_m
    return np.concatenate(at_m), np.concatenate(most_mps), first


def _without_stops(lost_s: list[float], ways: Sequence[Way], stands: Sequence[bool], brakes_s: float) -> list[float]:
    """What a stop counts covers the legs straight up and down beside it, and the one before or after those."""
    left_s = list(lost_s)
    for place in (place for place, is_stand in enumerate(stands) if is_stand):
        for legs in (range(place - 1, -1, -1), range(place, len(ways))):
            covers_s = brakes_s
            for leg in legs:
                covered_s = min(left_s[leg], covers_s)
                left_s[leg], covers_s = left_s[leg] - covered_s, covers_s - covered_s
                if math.hypot(*ways[leg][:2]) >= SHORT_M:
                    break
    return left_s
