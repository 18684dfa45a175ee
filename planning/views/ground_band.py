"""The heights that a UAV may have over the ground around an inspected asset, cell by cell."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from planning.views.solids import FloatArray

BoolArray = NDArray[np.bool_]

HALF_SIDE_M, CELL_M = 180.0, 2.0  # of the square, if nothing else is asked for
STEP_M = 1.0  # between places of a way whose height over the ground is looked at
PAIRS_AT_ONCE = 4_000


@dataclass(frozen=True, eq=False)
class GroundBand:
    """Least and greatest heights [m] over the asset's foot, float64 (k, k), in cells from the south-west corner of a square around it.

    Each cell has the highest and the lowest ground in it and in the cells beside it. Beyond the square the cell at its edge counts.
    half_side_m: of the square; min_height_m: by which low_m is over the ground.
    """

    low_m: FloatArray
    high_m: FloatArray
    half_side_m: float = HALF_SIDE_M
    min_height_m: float = 0.0

    @classmethod
    def level(cls, min_height_m: float, max_height_m: float) -> "GroundBand":
        """Over ground that is as high everywhere as at the foot."""
        return cls(np.full((1, 1), min_height_m), np.full((1, 1), max_height_m), min_height_m=min_height_m)

    @classmethod
    def over(
        cls, ground_m: Callable[[FloatArray], FloatArray], min_height_m: float, max_height_m: float, half_side_m: float = HALF_SIDE_M
    ) -> "GroundBand":  # fmt: skip
        """Over the ground that ground_m tells at places (n, 2) over that at the foot [m].

        Where it does not know the ground (NaN), the highest one that it knows counts from below, and the lowest from above.
        """
        edge_m = np.arange(-half_side_m, half_side_m + CELL_M, CELL_M)
        east, north = np.meshgrid(edge_m, edge_m)
        heights_m = ground_m(np.column_stack([east.ravel(), north.ravel()])).reshape(east.shape)
        known = heights_m[~np.isnan(heights_m)]
        highest_m, lowest_m = (float(known.max()), float(known.min())) if len(known) else (0.0, 0.0)
        above = maximum_filter(np.where(np.isnan(heights_m), highest_m, heights_m), size=3)
        below = minimum_filter(np.where(np.isnan(heights_m), lowest_m, heights_m), size=3)
        return cls(above + min_height_m, below + max_height_m, half_side_m, min_height_m)

    def limits_at(self, places: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Least and greatest height [m] at places (n, 2)."""
        last = len(self.low_m) - 1
        cell = np.clip(np.rint((places + self.half_side_m) / CELL_M), 0, last).astype(np.int64)
        return self.low_m[cell[:, 1], cell[:, 0]], self.high_m[cell[:, 1], cell[:, 0]]

    def ground_m(self, place: FloatArray) -> float:
        """The height [m] of the ground at a place, (2,), or beside it."""
        return float(self.limits_at(place[None, :])[0][0]) - self.min_height_m

    def highest_low_m(self, places: FloatArray) -> float:
        """The highest least height [m] in the box around places (n, 2)."""
        last = len(self.low_m) - 1
        box = np.array([np.floor(places.min(axis=0) + self.half_side_m), np.ceil(places.max(axis=0) + self.half_side_m)])
        (west, south), (east, north) = np.clip(np.rint(box / CELL_M), 0, last).astype(np.int64).tolist()
        return float(self.low_m[south : north + 1, west : east + 1].max())

    def leaves_out(self, points: FloatArray) -> BoolArray:
        """Whether each point, (n, 3), is lower or higher than allowed there."""
        low_m, high_m = self.limits_at(points[:, :2])
        return np.asarray((points[:, 2] < low_m) | (points[:, 2] > high_m))

    def limits_between(self, start: FloatArray, end: FloatArray) -> tuple[float, float]:
        """The highest least height and the lowest greatest one [m] under the line between two places, (2,) each."""
        count = max(math.ceil(float(np.linalg.norm(end - start)) / STEP_M), 1)
        low_m, high_m = self.limits_at(start + (end - start) * np.linspace(0.0, 1.0, count + 1)[:, None])
        return float(low_m.max()), float(high_m.min())

    def left_between(self, start: FloatArray, end: FloatArray) -> BoolArray:
        """Whether each straight way, from start to end (n, 3), comes lower or higher than allowed, looked at every STEP_M."""
        left = self.leaves_out(start) | self.leaves_out(end)
        lowest_m, highest_m = np.minimum(start[:, 2], end[:, 2]), np.maximum(start[:, 2], end[:, 2])
        open_ = np.flatnonzero(~left & ((lowest_m < self.low_m.max()) | (highest_m > self.high_m.min())))
        for rows in np.split(open_, range(PAIRS_AT_ONCE, len(open_), PAIRS_AT_ONCE)):
            way = end[rows] - start[rows]
            count = max(math.ceil(float(np.linalg.norm(way, axis=1).max(initial=0.0)) / STEP_M), 1)
            for share in np.linspace(0.0, 1.0, count + 1)[1:-1].tolist():
                left[rows] |= self.leaves_out(start[rows] + share * way)
        return np.asarray(left)
