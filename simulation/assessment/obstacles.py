"""How near flights came to the ground, and to towers and wires."""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from simulation.assessment.flown import BoolArray, FloatArray, FlownFlight, FlownTrack

LOOK_M = 60.0  # across the ground: what is farther is not told of


@dataclass(frozen=True, eq=False)
class Standing:
    """k spans from top to top; what stands alone is one from its place to its place. Wires hang no higher than straight between.

    start, end (k, 2) lon, lat [deg]; start_top_m, end_top_m (k,) above sea level, or above the assumed flat ground.
    """

    start: FloatArray
    end: FloatArray
    start_top_m: FloatArray
    end_top_m: FloatArray

    def __len__(self) -> int:
        return len(self.start)


@dataclass(frozen=True)
class Approach:
    """The nearest moment: metres, when, and to which waypoint it was flying. is_column: right over where it takes off or lands."""

    away_m: float
    t_s: float
    waypoint: int
    position: LonLat
    is_column: bool = False


def lowest_of(flown: FlownFlight, ground_amsl_m: FloatArray, *, column_m: float) -> Approach | None:
    """The least height above the ground, but for the columns of take-off and landing; None where the ground is not known there."""
    track = flown.track
    if track is None:
        return None
    away_m = np.where(track.is_in_air & ~in_columns(flown, column_m), track.amsl_m - ground_amsl_m, np.nan)
    return None if np.isnan(away_m).all() else _approach(track, int(np.nanargmin(away_m)), float(np.nanmin(away_m)), is_column=False)


def nearest_standing(flown: FlownFlight, standing: Standing, *, column_m: float) -> tuple[Approach | None, Approach | None]:
    """The nearest to a tower or wire on the way, and in the columns of take-off and landing; None for farther than LOOK_M.

    What stands is a wall from the ground to its top, as sags are not known: over it the way up counts, beside it the way across.
    """
    track = flown.track
    if track is None or not len(standing) or not track.is_in_air.any():
        return None, None
    rows = np.flatnonzero(track.is_in_air)
    frame = LocalFrame.around(*track.position[rows].mean(axis=0).tolist())
    flat, start, end = (frame.to_metres(places) for places in (track.position[rows], standing.start, standing.end))
    (west, south), (east, north) = flat.min(axis=0) - LOOK_M, flat.max(axis=0) + LOOK_M
    low, high = np.minimum(start, end), np.maximum(start, end)
    near = np.flatnonzero((low[:, 0] <= east) & (high[:, 0] >= west) & (low[:, 1] <= north) & (high[:, 1] >= south))
    if not len(near):
        return None, None
    lines = np.array(shapely.linestrings(np.stack([start[near], end[near]], axis=1)), dtype=object).reshape(-1)
    moment, span = shapely.STRtree(lines).query(shapely.points(flat), predicate="dwithin", distance=LOOK_M)
    if not len(moment):
        return None, None
    away_m = _from_walls(flat[moment], track.amsl_m[rows[moment]], start, end, standing, near[span])
    is_column = in_columns(flown, column_m)[rows[moment]]
    found: list[Approach | None] = []
    for mask, column in ((~is_column, False), (is_column, True)):
        own = np.where(mask, away_m, math.inf)
        best = int(np.argmin(own))
        found.append(None if math.isinf(own[best]) else _approach(track, int(rows[moment[best]]), float(own[best]), is_column=column))
    return found[0], found[1]


def in_columns(flown: FlownFlight, column_m: float) -> BoolArray:
    """(n,): whether a moment is over where the flight takes off, or where it came down."""
    track = flown.track
    assert track is not None  # noqa: S101 - callers look
    ends = [np.array(flown.flight.take_off.position)]
    if track.is_coming_down.any():
        ends.append(track.position[np.flatnonzero(track.is_coming_down)[-1]])
    frame = LocalFrame.around(*flown.flight.take_off.position)
    flat = frame.to_metres(track.position)
    inside = np.zeros(len(track), dtype=bool)
    for end in ends:
        inside |= np.hypot(*(flat - frame.to_metres(end[None, :])).T) <= column_m
    return inside


def _from_walls(
    flat: FloatArray, amsl_m: FloatArray, start: FloatArray, end: FloatArray, standing: Standing, span: FloatArray
) -> FloatArray:
    along = end[span] - start[span]
    squared = (along**2).sum(axis=1)
    share = np.clip(((flat - start[span]) * along).sum(axis=1) / np.maximum(squared, 1e-9), 0.0, 1.0)
    beside_m = np.hypot(*(flat - (start[span] + share[:, None] * along)).T)
    top_m = standing.start_top_m[span] + share * (standing.end_top_m[span] - standing.start_top_m[span])
    away_m: FloatArray = np.hypot(beside_m, np.maximum(np.nan_to_num(amsl_m - top_m, nan=0.0), 0.0))
    return away_m


def _approach(track: FlownTrack, row: int, away_m: float, *, is_column: bool) -> Approach:
    lon, lat = track.position[row].tolist()
    return Approach(away_m, float(track.t_s[row]), int(track.waypoint[row]), LonLat(lon, lat), is_column)
