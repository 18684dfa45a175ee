"""A block of a terrain model: heights above sea level on a regular grid in longitude and latitude."""

import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy.wgs84 import FloatArray

BLOCK_SIZE = 256
MIN_HEIGHT_M, MAX_HEIGHT_M = -500.0, 9_000.0  # Dead Sea shore -430 m, Everest 8,849 m; all else is a void
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


def packed(heights: NDArray[np.float32]) -> bytes:
    """Little-endian float32, row by row, zlib."""
    return zlib.compress(np.ascontiguousarray(heights, dtype="<f4").tobytes(), level=6)


def unpacked(data: bytes, rows: int, columns: int) -> NDArray[np.float32]:
    """The inverse of packed; never unpacks more than the block has."""
    text = zlib.decompressobj().decompress(data, rows * columns * 4)
    return np.frombuffer(text, dtype="<f4").reshape(rows, columns).astype(np.float32)
