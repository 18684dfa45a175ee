"""The ground under legs in pieces: between the rows and columns of posts that a leg crosses, bilinear ground is a quadratic."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit

from inspection.geodesy.wgs84 import FloatArray
from inspection.terrain.tiled_terrain import IntArray, TiledTerrain

Box = tuple[float, float, float, float]

SAME_SHARE = 1e-7  # of a leg: crossings nearer to each other are one
INSIDE_DEG = 1e-6  # from the ends of a piece


@dataclass(frozen=True, eq=False)
class GroundProfile:
    """The ground under legs, as pieces on each of which it is a quadratic of the share of the leg.

    Leg i has the pieces first[i] up to but without first[i + 1], (n + 1,); share (p, 2): where each begins and ends; heights_m (p, 3):
    above sea level [m] at its begin, in its middle and at its end, NaN where no model reaches. Where one model follows on another, the
    end of a piece and the begin of the next may differ.
    """

    first: IntArray
    share: FloatArray
    heights_m: FloatArray


def ground_profile(terrain: TiledTerrain, start: FloatArray, end: FloatArray) -> GroundProfile:
    """Return the ground under legs from start to end, (n, 2) lon lat [deg] each, straight in longitude and latitude."""
    start, end = np.ascontiguousarray(start, dtype=np.float64), np.ascontiguousarray(end, dtype=np.float64)
    leg, share = _crossings(start, end, terrain.lattice, terrain.size)
    order = np.lexsort((share, leg))
    first, shares = _pieces(leg[order], share[order], len(start))
    heights_m = terrain.heights_at(_sample_positions(start, end, first, shares)).heights_m.reshape(-1, 3)
    _extrapolate_to_ends(start, end, first, shares, heights_m)
    return GroundProfile(first, shares, heights_m)


def profile_under(start: FloatArray, end: FloatArray, around: Callable[[Box], TiledTerrain]) -> GroundProfile:
    """Return the same of the tiles around the legs, of which there is at least one. around: of west, south, east, north [deg]."""
    west, south = np.minimum(start.min(axis=0), end.min(axis=0)).tolist()
    east, north = np.maximum(start.max(axis=0), end.max(axis=0)).tolist()
    return ground_profile(around((west, south, east, north)), start, end)


def heights_over(profile: GroundProfile, start_m: FloatArray, end_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least and the greatest height over the ground on each leg, (n,), flown straight between levels above the sea, (n,) each.

    NaN where the ground under a leg is not known everywhere.
    """
    return _heights_over(profile.first, profile.share, profile.heights_m, start_m, end_m)


@njit(cache=True, nogil=True)
def _heights_over(
    first: IntArray, share: FloatArray, heights_m: FloatArray, start_m: FloatArray, end_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    least_m, most_m = np.full(len(start_m), np.inf), np.full(len(start_m), -np.inf)
    for leg in range(len(start_m)):
        for piece in range(first[leg], first[leg + 1]):
            begin, until = share[piece]
            over_begin_m = start_m[leg] + begin * (end_m[leg] - start_m[leg]) - heights_m[piece, 0]
            over_end_m = start_m[leg] + until * (end_m[leg] - start_m[leg]) - heights_m[piece, 2]
            middle_m = start_m[leg] + (begin + until) / 2.0 * (end_m[leg] - start_m[leg]) - heights_m[piece, 1]
            if np.isnan(over_begin_m + middle_m + over_end_m):
                least_m[leg] = most_m[leg] = np.nan
                break
            least_m[leg] = min(least_m[leg], over_begin_m, over_end_m)
            most_m[leg] = max(most_m[leg], over_begin_m, over_end_m)
            square_m = 2.0 * (over_begin_m + over_end_m) - 4.0 * middle_m  # of the quadratic in the share of the piece
            along_m = over_end_m - over_begin_m - square_m
            if 0.0 < -along_m * square_m < 2.0 * square_m * square_m:  # it turns inside of the piece
                turn_m = over_begin_m - along_m * along_m / (4.0 * square_m)
                least_m[leg], most_m[leg] = min(least_m[leg], turn_m), max(most_m[leg], turn_m)
    return least_m, most_m


@njit(cache=True, nogil=True)
def _crossings(start: FloatArray, end: FloatArray, lattice: FloatArray, size: IntArray) -> tuple[IntArray, FloatArray]:
    """Where legs cross the rows and columns of the tiles beside them: legs and shares, (k,) each, in no order."""
    count = 0
    for leg in range(len(start)):
        for tile in range(len(lattice)):
            for axis in range(2):
                low, high = _lines_crossed(start[leg], end[leg], lattice[tile], size[tile], axis)
                count += max(high - low + 1, 0)
    legs, shares = np.empty(count, dtype=np.int64), np.empty(count)
    at = 0
    for leg in range(len(start)):
        for tile in range(len(lattice)):
            for axis in range(2):
                low, high = _lines_crossed(start[leg], end[leg], lattice[tile], size[tile], axis)
                step = lattice[tile, 2] if axis == 0 else -lattice[tile, 3]
                for number in range(low, high + 1):
                    legs[at] = leg
                    shares[at] = (lattice[tile, axis] + number * step - start[leg, axis]) / (end[leg, axis] - start[leg, axis])
                    at += 1
    return legs, shares


@njit(cache=True, nogil=True)
def _lines_crossed(start: FloatArray, end: FloatArray, tile: FloatArray, size: IntArray, axis: int) -> tuple[int, int]:
    """The first and the last of a tile's columns (axis 0) or rows (1) that a leg crosses, as far as it lies beside the tile."""
    begin, until = 0.0, 1.0
    for other in range(2):
        step = tile[2] if other == 0 else -tile[3]
        along, before = (end[other] - start[other]) / step, (start[other] - tile[other]) / step
        if along == 0.0:
            if not -1.0 <= before <= size[other]:
                return 0, -1
            continue
        enters, leaves = (-1.0 - before) / along, (size[other] - before) / along
        begin, until = max(begin, min(enters, leaves)), min(until, max(enters, leaves))
    step = tile[2] if axis == 0 else -tile[3]
    along, before = (end[axis] - start[axis]) / step, (start[axis] - tile[axis]) / step
    if along == 0.0 or begin > until:
        return 0, -1
    ends = before + begin * along, before + until * along
    return max(int(np.ceil(min(ends))), 0), min(int(np.floor(max(ends))), size[axis] - 1)


@njit(cache=True, nogil=True)
def _pieces(leg: IntArray, share: FloatArray, legs: int) -> tuple[IntArray, FloatArray]:
    """First piece of each leg (legs + 1,), and begin and end of each piece (p, 2), from the crossings in order."""
    first, shares = np.empty(legs + 1, dtype=np.int64), np.empty((legs + len(leg), 2))
    at = crossing = 0
    for number in range(legs):
        first[number] = at
        begin = 0.0
        while crossing < len(leg) and leg[crossing] == number:
            if begin + SAME_SHARE < share[crossing] < 1.0 - SAME_SHARE:
                shares[at, 0], shares[at, 1] = begin, share[crossing]
                begin, at = share[crossing], at + 1
            crossing += 1
        shares[at, 0], shares[at, 1] = begin, 1.0
        at += 1
    first[legs] = at
    return first, shares[:at].copy()


@njit(cache=True, nogil=True)
def _inside(length: float, leg_deg: float) -> float:
    """The share of a leg by which a piece of this length is looked at inside its ends, clear of the rounding at edges of tiles."""
    return min(INSIDE_DEG / leg_deg if leg_deg > 0.0 else 1.0, length / 4.0)


@njit(cache=True, nogil=True)
def _sample_positions(start: FloatArray, end: FloatArray, first: IntArray, shares: FloatArray) -> FloatArray:
    """Positions near the begin, in the middle and near the end of each piece, (3 p, 2)."""
    positions = np.empty((3 * len(shares), 2))
    for leg in range(len(first) - 1):
        leg_deg = max(abs(end[leg, 0] - start[leg, 0]), abs(end[leg, 1] - start[leg, 1]))
        for piece in range(first[leg], first[leg + 1]):
            begin, until = shares[piece]
            inside = _inside(until - begin, leg_deg)
            for place, share in enumerate((begin + inside, (begin + until) / 2.0, until - inside)):
                for axis in range(2):
                    positions[3 * piece + place, axis] = start[leg, axis] + share * (end[leg, axis] - start[leg, axis])
    return positions


@njit(cache=True, nogil=True)
def _extrapolate_to_ends(start: FloatArray, end: FloatArray, first: IntArray, shares: FloatArray, heights_m: FloatArray) -> None:
    """Turn heights near the ends of pieces into those at their ends, by the quadratic through all three."""
    for leg in range(len(first) - 1):
        leg_deg = max(abs(end[leg, 0] - start[leg, 0]), abs(end[leg, 1] - start[leg, 1]))
        for piece in range(first[leg], first[leg + 1]):
            length = shares[piece, 1] - shares[piece, 0]
            near = 1.0 - 2.0 * _inside(length, leg_deg) / length  # of half of the piece, from its middle
            before_m, middle_m, after_m = heights_m[piece]
            slope_m, bend_m = (after_m - before_m) / (2.0 * near), (after_m + before_m - 2.0 * middle_m) / (2.0 * near * near)
            heights_m[piece, 0], heights_m[piece, 2] = middle_m - slope_m + bend_m, middle_m + slope_m + bend_m
