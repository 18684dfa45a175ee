"""Flown heights over terrain: the fewest waypoints that keep every leg at or above its planned height and within the tolerance over it."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.terrain.profile import GroundProfile
from planning.trajectory.waypoints import FloatArray, IntArray

BELOW_M = 0.5  # by which a leg may come lower than planned
ROUNDING_M = 0.01  # of heights that are stored and sent
SAG_M = 0.05  # by which the ground may leave a straight line between two of its places that are looked at
SLACK_M = SAG_M + ROUNDING_M
MIN_BAND_M = BELOW_M - 3 * SLACK_M
STEEPEST_M = 1e5  # height per leg; a link that would be steeper is straight up or down
MAX_CORNERS = 64
HAIR_M = 1e-6  # less is rounding

BoolArray = NDArray[np.bool_]


class LegHeights(NamedTuple):
    """What each point of a route, and each leg at so many places, may be flown at.

    Leg i has the places first[i] up to but without first[i + 1], its ends among them: share of the leg, ground_m, low_m, high_m and the
    planned level_m above sea level, (v,) each, all of which are straight lines between two places. own_high_m, planned_m: of points, (n,).
    """

    first: IntArray
    share: FloatArray
    ground_m: FloatArray
    low_m: FloatArray
    high_m: FloatArray
    level_m: FloatArray
    own_high_m: FloatArray
    planned_m: FloatArray
    is_vertical: BoolArray


class FollowedTerrain(NamedTuple):
    """own_m and own_agl_m: of each point above sea level and above ground, (n,). Points to put in, (k,) each, in their order: leg,
    share of it, level_m and ground_m likewise."""

    own_m: FloatArray
    own_agl_m: FloatArray
    leg: IntArray
    share: FloatArray
    level_m: FloatArray
    ground_m: FloatArray


def followed_terrain(
    agl_m: FloatArray,
    floor_agl_m: FloatArray,
    is_vertical: BoolArray,
    may_rise: BoolArray,
    ground: GroundProfile,
    tolerance_m: float,
    max_agl_m: float,
) -> FollowedTerrain:
    """Return the heights of points, and the points to put in between, so that all legs are straight lines in the band.

    The band reaches from BELOW_M under floor_agl_m to tolerance_m above agl_m, (n,) each with straight lines between, and never above
    max_agl_m. Points are flown at agl_m, those that may_rise (n,) up to the upper end of the band. Legs that are vertical, (n - 1,), have
    nothing put in. Points are put in where the ground is looked at, and are as few as links from the start make possible.
    """
    band = _band(agl_m, floor_agl_m, is_vertical, may_rise, ground.first, ground.share, ground.heights_m, tolerance_m, max_agl_m)
    own_m, leg, share, level_m, ground_m = _followed(band, agl_m)
    rise_m = np.where(own_m - band.planned_m > HAIR_M, own_m - band.planned_m, 0.0)
    return FollowedTerrain(band.planned_m + rise_m, agl_m + rise_m, leg, share, level_m, ground_m)


@njit(cache=True, nogil=True)
def _band(
    agl_m: FloatArray,
    floor_agl_m: FloatArray,
    is_vertical: BoolArray,
    may_rise: BoolArray,
    first: IntArray,
    share: FloatArray,
    heights_m: FloatArray,
    tolerance_m: float,
    max_agl_m: float,
) -> LegHeights:
    legs = len(agl_m) - 1
    parts = np.empty(len(share), dtype=np.int64)
    for piece in range(len(share)):
        bulge_m = abs(heights_m[piece, 1] - (heights_m[piece, 0] + heights_m[piece, 2]) / 2.0)
        parts[piece] = max(1, int(np.ceil(np.sqrt(bulge_m / SAG_M))))
    most = (parts + 1).sum()
    own_first = np.empty(legs + 1, dtype=np.int64)
    shares, ground_m = np.empty(most), np.empty(most)
    low_m, high_m, level_m = np.empty(most), np.empty(most), np.empty(most)
    at = 0
    for leg in range(legs):
        own_first[leg] = at
        for piece in range(first[leg], first[leg + 1]):
            begin_m, middle_m, end_m = heights_m[piece]
            for part in range(parts[piece] + 1):
                along = part / parts[piece]
                here_m = begin_m * (1 - along) * (1 - 2 * along) + 4 * middle_m * along * (1 - along) + end_m * along * (2 * along - 1)
                if part == 0 and piece > first[leg] and abs(here_m - ground_m[at - 1]) < SAG_M / 2:
                    continue
                shares[at] = share[piece, 0] + along * (share[piece, 1] - share[piece, 0])
                ground_m[at] = here_m
                over_m = agl_m[leg] + shares[at] * (agl_m[leg + 1] - agl_m[leg])
                floor_m = floor_agl_m[leg] + shares[at] * (floor_agl_m[leg + 1] - floor_agl_m[leg])
                level_m[at] = here_m + over_m
                low_m[at], high_m[at] = _limits(here_m + floor_m, level_m[at], here_m + max_agl_m, tolerance_m)
                at += 1
    own_first[legs] = at
    planned_m = np.empty(legs + 1)
    for point in range(legs + 1):
        planned_m[point] = agl_m[point] + (ground_m[own_first[point]] if point < legs else ground_m[at - 1])
    own_high_m = planned_m.copy()
    for point in range(legs + 1):
        if may_rise[point]:
            own_high_m[point] = max(
                _limits(planned_m[point], planned_m[point], planned_m[point] - agl_m[point] + max_agl_m, tolerance_m)[1], planned_m[point]
            )
    for point in range(1, legs + 1):  # points at one place and height stay together
        if is_vertical[point - 1] and agl_m[point] == agl_m[point - 1]:
            own_high_m[point] = min(own_high_m[point], own_high_m[point - 1])
    for point in range(legs - 1, -1, -1):
        if is_vertical[point] and agl_m[point] == agl_m[point + 1]:
            own_high_m[point] = min(own_high_m[point], own_high_m[point + 1])
    return LegHeights(own_first, shares[:at].copy(), ground_m[:at].copy(), low_m[:at].copy(), high_m[:at].copy(),
                      level_m[:at].copy(), own_high_m, planned_m, is_vertical)  # fmt: skip


@njit(cache=True, nogil=True)
def _limits(floor_m: float, planned_m: float, highest_m: float, tolerance_m: float) -> tuple[float, float]:
    low_m = floor_m - BELOW_M + SLACK_M
    high_m = min(planned_m + tolerance_m - BELOW_M, max(highest_m, planned_m)) - SLACK_M
    return low_m, max(high_m, low_m + MIN_BAND_M)


@njit(cache=True, nogil=True)
def _followed(band: LegHeights, agl_m: FloatArray) -> tuple[FloatArray, IntArray, FloatArray, FloatArray, FloatArray]:
    legs = len(band.first) - 1
    knot = np.empty(len(band.share), dtype=np.int64)  # places at which links end inside of legs
    knot_first = np.empty(legs + 1, dtype=np.int64)
    window_m = np.empty((len(band.share), 2))
    own_window_m = np.empty((legs + 1, 2))
    own_window_m[0] = band.planned_m[0], band.own_high_m[0]
    count = 0
    for leg in range(legs):
        knot_first[leg] = count
        if band.is_vertical[leg]:
            own_window_m[leg + 1] = band.planned_m[leg + 1], band.own_high_m[leg + 1]
            if agl_m[leg] == agl_m[leg + 1]:
                own_window_m[leg + 1] = own_window_m[leg]
            continue
        count = _linked(band, leg, own_window_m, knot, window_m, count)
    knot_first[legs] = count

    own_m, level_m = np.empty(legs + 1), np.empty(count)
    own_m[legs] = _clamped(band.planned_m[legs], own_window_m[legs, 0], own_window_m[legs, 1])
    for leg in range(legs - 1, -1, -1):
        if band.is_vertical[leg]:
            is_one = agl_m[leg] == agl_m[leg + 1]
            own_m[leg] = own_m[leg + 1] if is_one else _clamped(band.planned_m[leg], own_window_m[leg, 0], own_window_m[leg, 1])
            continue
        place, here_m = band.first[leg + 1] - 1, own_m[leg + 1]
        for number in range(knot_first[leg + 1] - 1, knot_first[leg] - 1, -1):
            low_m, high_m = _seen_back(band, place, here_m, knot[number], window_m[number])
            place = knot[number]
            here_m = level_m[number] = _clamped(band.level_m[place], low_m, high_m)
        low_m, high_m = _seen_back(band, place, here_m, band.first[leg], own_window_m[leg])
        own_m[leg] = _clamped(band.planned_m[leg], low_m, high_m)

    leg_of, share, level, ground = np.empty(count, dtype=np.int64), np.empty(count), np.empty(count), np.empty(count)
    at = 0
    for leg in range(legs):
        before, before_m = band.first[leg], own_m[leg]
        for number in range(knot_first[leg], knot_first[leg + 1]):
            is_last = number + 1 == knot_first[leg + 1]
            after = band.first[leg + 1] - 1 if is_last else knot[number + 1]
            after_m = own_m[leg + 1] if is_last else level_m[number + 1]
            place, place_m = _between(band, before, before_m, after, after_m, knot[number], level_m[number])
            if place < 0:
                continue  # seen straight from the one before to the one after
            leg_of[at], share[at], level[at], ground[at] = leg, band.share[place], place_m, band.ground_m[place]
            before, before_m = place, place_m
            at += 1
    return own_m, leg_of[:at].copy(), share[:at].copy(), level[:at].copy(), ground[:at].copy()


@njit(cache=True, nogil=True)
def _clamped(value_m: float, low_m: float, high_m: float) -> float:
    return float(max(min(value_m, high_m), low_m))


@njit(cache=True, nogil=True)
def _linked(band: LegHeights, leg: int, own_window_m: FloatArray, knot: IntArray, window_m: FloatArray, count: int) -> int:
    """Put down the knots of a leg, each as far on as a straight link from the one before reaches, and the heights possible at each."""
    corner_m, other_m = np.empty((MAX_CORNERS, 2)), np.empty((MAX_CORNERS, 2))  # lines: height at the link's begin, and height per share
    begin, last = band.first[leg], band.first[leg + 1] - 1
    low_m, high_m = own_window_m[leg]
    while True:
        corner_m[0], corner_m[1] = (low_m, -STEEPEST_M), (high_m, -STEEPEST_M)
        corner_m[2], corner_m[3] = (high_m, STEEPEST_M), (low_m, STEEPEST_M)
        corners = 4
        reach_low_m, reach_high_m = low_m, high_m
        place = begin + 1
        while place <= last:
            gate_low_m = band.planned_m[leg + 1] if place == last else band.low_m[place]
            gate_high_m = band.own_high_m[leg + 1] if place == last else band.high_m[place]
            along = band.share[place] - band.share[begin]
            corners = _cut(corner_m, corners, other_m, along, gate_high_m, 1.0)
            corners = _cut(other_m, corners, corner_m, along, gate_low_m, -1.0)
            if corners == 0:
                break
            reach_low_m, reach_high_m = np.inf, -np.inf
            for number in range(corners):
                value_m = corner_m[number, 0] + corner_m[number, 1] * along
                reach_low_m, reach_high_m = min(reach_low_m, value_m), max(reach_high_m, value_m)
            reach_low_m, reach_high_m = max(reach_low_m, gate_low_m), min(reach_high_m, gate_high_m)
            place += 1
        if place > last:
            own_window_m[leg + 1] = reach_low_m, reach_high_m
            return count
        if place == begin + 1:  # no line but a vertical one
            if place == last:
                own_window_m[leg + 1] = band.planned_m[leg + 1], band.own_high_m[leg + 1]
                return count
            begin, low_m, high_m = place, band.low_m[place], band.high_m[place]
        else:
            begin, low_m, high_m = place - 1, reach_low_m, reach_high_m
        knot[count], window_m[count, 0], window_m[count, 1] = begin, low_m, high_m
        count += 1


@njit(cache=True, nogil=True)
def _cut(corner: FloatArray, corners: int, kept: FloatArray, along: float, limit_m: float, sign: float) -> int:
    """Write what of a convex polygon of lines lies below a limit (sign 1), or above it (-1), so far along; returns its corners."""
    count = 0
    for number in range(corners):
        here, there = corner[number], corner[(number + 1) % corners]
        here_m = sign * (limit_m - here[0] - here[1] * along)
        there_m = sign * (limit_m - there[0] - there[1] * along)
        if here_m >= 0.0 and count < MAX_CORNERS:
            kept[count] = here
            count += 1
        if (here_m < 0.0) != (there_m < 0.0) and count < MAX_CORNERS:
            part = here_m / (here_m - there_m)
            kept[count, 0] = here[0] + part * (there[0] - here[0])
            kept[count, 1] = here[1] + part * (there[1] - here[1])
            count += 1
    return count


@njit(cache=True, nogil=True)
def _seen_back(band: LegHeights, place: int, level_m: float, begin: int, window_m: FloatArray) -> tuple[float, float]:
    """The heights in the window at `begin` from which a straight link through the band ends at a place at this level."""
    least, most = -STEEPEST_M, STEEPEST_M
    for between in range(place - 1, begin, -1):
        along = band.share[place] - band.share[between]
        if along > 0.0:
            least, most = max(least, (level_m - band.high_m[between]) / along), min(most, (level_m - band.low_m[between]) / along)
    along = band.share[place] - band.share[begin]
    low_m, high_m = level_m - most * along, level_m - least * along
    low_m, high_m = max(low_m, window_m[0]), min(high_m, window_m[1])
    if low_m > high_m:  # by rounding
        low_m = high_m = _clamped((low_m + high_m) / 2.0, window_m[0], window_m[1])
    return low_m, high_m


@njit(cache=True, nogil=True)
def _between(band: LegHeights, before: int, before_m: float, after: int, after_m: float, knot: int, knot_m: float) -> tuple[int, float]:
    """The place and height for a knot between two others, as near to their middle and as low as links to both allow; -1 if none is needed.

    The knot as it is where nothing better is found.
    """
    ahead_m = np.empty((after - before + 1, 2))
    least, most, until = -STEEPEST_M, STEEPEST_M, before
    for place in range(before + 1, after):
        along = band.share[place] - band.share[before]
        if along <= 0.0:
            break
        least, most = max(least, (band.low_m[place] - before_m) / along), min(most, (band.high_m[place] - before_m) / along)
        if least > most:
            break
        ahead_m[place - before, 0], ahead_m[place - before, 1] = before_m + least * along, before_m + most * along
        until = place
    length = band.share[after] - band.share[before]
    if until == after - 1 and length > 0.0 and least <= (after_m - before_m) / length <= most:
        return -1, 0.0
    middle = (band.share[before] + band.share[after]) / 2.0
    found, found_m, away = knot, knot_m, np.inf
    least, most = -STEEPEST_M, STEEPEST_M
    for place in range(after - 1, before, -1):
        along = band.share[after] - band.share[place]
        if along <= 0.0:
            break
        least, most = max(least, (after_m - band.high_m[place]) / along), min(most, (after_m - band.low_m[place]) / along)
        if least > most:
            break
        if place > until:
            continue
        low_m = max(ahead_m[place - before, 0], after_m - most * along)
        high_m = min(ahead_m[place - before, 1], after_m - least * along)
        if low_m <= high_m and abs(band.share[place] - middle) < away:
            away, found, found_m = abs(band.share[place] - middle), place, _clamped(band.level_m[place], low_m, high_m)
    return found, found_m
