"""How far a flown track was beside its route, seen from above."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame

FloatArray = NDArray[np.float64]


def cross_track_m(track: FloatArray, legs: NDArray[np.int64], waypoints: Sequence[LonLat]) -> FloatArray:
    """Distance of each point of the track from the leg that it was on, or from the one before or after, whichever is nearest [m].

    track (n, 2), lon lat [deg]; legs (n,): how many waypoints had been passed before, at least 1, so that leg k leads from waypoint k - 1
    to waypoint k. A leg is the straight line between its waypoints in longitude and latitude, and no longer than that. Returns shape (n,).
    """
    nearest = np.full(len(track), np.inf)
    for leg in np.unique(legs):
        rows = np.flatnonzero(legs == leg)
        for near in (leg - 1, leg, leg + 1):
            if 1 <= near < len(waypoints):
                nearest[rows] = np.minimum(nearest[rows], _beside_m(track[rows], waypoints[near - 1], waypoints[near]))
        if len(waypoints) == 1:
            nearest[rows] = _beside_m(track[rows], waypoints[0], waypoints[0])
    return nearest


def _beside_m(points: FloatArray, start: LonLat, end: LonLat) -> FloatArray:
    frame = LocalFrame.around(*start)
    away = frame.to_metres(points)
    along = frame.to_metres(np.array([end]))[0]
    length2 = float(along @ along)
    share = np.clip(away @ along / length2, 0.0, 1.0) if length2 > 0.0 else np.zeros(len(points))
    off = away - share[:, None] * along
    return np.asarray(np.hypot(off[:, 0], off[:, 1]), dtype=np.float64)
