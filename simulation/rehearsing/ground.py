"""Terrain for simulated UAVs, which read one place at a time, many times per second."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat

FloatArray = NDArray[np.float64]
STEP_DEG = 1.0 / 7_200.0  # half an arc second: 15 m to the north
BLOCK = 32  # steps along a side

Heights = Callable[[FloatArray], FloatArray]


class BlockedGround:
    """Heights interpolated on a fine grid, which is read from the terrain in blocks when a UAV first reaches them.

    Unknown terrain has the height `otherwise_m`, that of the take-off.
    """

    def __init__(self, heights_m: Heights | None, otherwise_m: float) -> None:
        self._heights_m = heights_m
        self._otherwise_m = otherwise_m
        self._blocks: dict[tuple[int, int], list[list[float]]] = {}

    def elevation_m(self, position: LonLat) -> float:
        if self._heights_m is None:
            return self._otherwise_m
        x, y = position[0] / STEP_DEG, position[1] / STEP_DEG
        column, row = math.floor(x), math.floor(y)
        block = column // BLOCK, row // BLOCK
        rows = self._blocks.get(block)
        if rows is None:
            rows = self._blocks[block] = self._read(*block)
        column, row, east, north = column - block[0] * BLOCK, row - block[1] * BLOCK, x - column, y - row
        low, high = rows[row], rows[row + 1]
        south_m = low[column] + east * (low[column + 1] - low[column])
        return south_m + north * (high[column] + east * (high[column + 1] - high[column]) - south_m)

    def _read(self, block_column: int, block_row: int) -> list[list[float]]:
        assert self._heights_m is not None  # noqa: S101 - checked by callers
        lon = (block_column * BLOCK + np.arange(BLOCK + 1)) * STEP_DEG
        lat = (block_row * BLOCK + np.arange(BLOCK + 1)) * STEP_DEG
        places = np.column_stack([np.tile(lon, BLOCK + 1), lat.repeat(BLOCK + 1)])
        found = self._heights_m(places)
        rows: list[list[float]] = np.where(np.isnan(found), self._otherwise_m, found).reshape(BLOCK + 1, BLOCK + 1).tolist()
        return rows
