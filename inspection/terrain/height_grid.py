"""A block of a terrain model: heights above sea level on a regular grid in longitude and latitude."""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy.wgs84 import FloatArray

BLOCK_SIZE = 256
LOWEST_M, HIGHEST_M = -500.0, 9_000.0  # Dead Sea shore -430 m, Everest 8,849 m; all else is a void that the file does not declare
NO_WEIGHT = 1e-6  # of a post: less than this is the rounding of a position, a micrometre of height


@dataclass(frozen=True, eq=False)
class HeightGrid:
    """heights_m[row, column] stands at (west + column * step_lon, north - row * step_lat); NaN is void. float32, metres."""

    west_deg: float
    north_deg: float
    step_lon_deg: float
    step_lat_deg: float
    heights_m: NDArray[np.float32]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """West, south, east, north of the outermost posts [deg]."""
        rows, columns = self.heights_m.shape
        east, south = self.west_deg + (columns - 1) * self.step_lon_deg, self.north_deg - (rows - 1) * self.step_lat_deg
        return (self.west_deg, south, east, self.north_deg)

    def sample(self, positions: FloatArray) -> FloatArray:
        """Bilinear heights [m] at positions of shape (n, 2), lon lat [deg]; NaN outside the grid and beside a void.

        Beside a void means that a post with weight is void: on a post itself its own height is enough.
        """
        rows, columns = self.heights_m.shape
        x = (positions[:, 0] - self.west_deg) / self.step_lon_deg
        y = (self.north_deg - positions[:, 1]) / self.step_lat_deg
        tolerance = 1e-9 * (abs(self.west_deg) + 360.0) / min(self.step_lon_deg, self.step_lat_deg)  # rounding of the file's own origin
        inside = (x >= -tolerance) & (y >= -tolerance) & (x <= columns - 1 + tolerance) & (y <= rows - 1 + tolerance)
        heights = np.full(len(positions), np.nan)
        if not inside.any():
            return heights
        x, y = np.clip(x[inside], 0.0, columns - 1.0), np.clip(y[inside], 0.0, rows - 1.0)
        column, row = np.minimum(x.astype(np.intp), max(columns - 2, 0)), np.minimum(y.astype(np.intp), max(rows - 2, 0))
        right, down = np.minimum(column + 1, columns - 1), np.minimum(row + 1, rows - 1)
        east, south = x - column, y - row
        total = np.zeros(len(x))
        corners = (
            (row, column, (1 - east) * (1 - south)), (row, right, east * (1 - south)),
            (down, column, (1 - east) * south), (down, right, east * south),
        )  # fmt: skip
        for at_row, at_column, weight in corners:
            total += np.where(weight > NO_WEIGHT, self.heights_m[at_row, at_column].astype(np.float64) * weight, 0.0)
        heights[inside] = total
        return heights

    def blocks(self, size: int = BLOCK_SIZE) -> Iterator["HeightGrid"]:
        """Parts of at most size posts a side that share their edge posts; parts that are all void are left out."""
        rows, columns = self.heights_m.shape
        for row in _starts(rows, size):
            for column in _starts(columns, size):
                part = self.heights_m[row : row + size, column : column + size]
                if not np.isnan(part).all():
                    west, north = self.west_deg + column * self.step_lon_deg, self.north_deg - row * self.step_lat_deg
                    yield HeightGrid(west, north, self.step_lon_deg, self.step_lat_deg, part)


def _starts(count: int, size: int) -> range:
    return range(0, max(count - 1, 1), size - 1)


def without_voids(raw: NDArray[np.generic], declared_void: float | None) -> NDArray[np.float32]:
    """Heights as float32, with NaN for the declared void value and for what cannot be a height on earth."""
    heights = raw.astype(np.float32)
    void = ~((heights >= LOWEST_M) & (heights <= HIGHEST_M))
    if declared_void is not None and not np.isnan(declared_void):
        void |= raw.astype(np.float64) == declared_void
    heights[void] = np.nan
    return heights


def packed(heights: NDArray[np.float32]) -> bytes:
    """Little-endian float32, row by row, zlib."""
    return zlib.compress(np.ascontiguousarray(heights, dtype="<f4").tobytes(), level=6)


def unpacked(data: bytes, rows: int, columns: int) -> NDArray[np.float32]:
    """The inverse of packed; never unpacks more than the block has."""
    text = zlib.decompressobj().decompress(data, rows * columns * 4)
    return np.frombuffer(text, dtype="<f4").reshape(rows, columns).astype(np.float32)
