"""Heights in three references: above ground, above sea level, above take-off. Unknown ones are NaN."""

import zlib
from dataclasses import dataclass
from math import ceil

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.wgs84 import FloatArray, distance_m

BoolArray = NDArray[np.bool_]

REFERENCES = ("AGL", "AMSL", "RELATIVE")


class UnknownReference(ValueError):
    """Raised for a height without a valid reference."""


def amsl_m(values_m: FloatArray, reference: str, *, ground_amsl_m: FloatArray, take_off_amsl_m: float) -> FloatArray:
    """Return heights above sea level [m] of values counted from `reference`; NaN where the required ground or take-off is unknown.

    values_m and ground_amsl_m have shape (n,). Raises UnknownReference.
    """
    return np.asarray(values_m + _zero_of(reference, ground_amsl_m, take_off_amsl_m), dtype=np.float64)


def counted_from(heights_amsl_m: FloatArray, reference: str, *, ground_amsl_m: FloatArray, take_off_amsl_m: float) -> FloatArray:
    """Return the inverse of amsl_m."""
    return np.asarray(heights_amsl_m - _zero_of(reference, ground_amsl_m, take_off_amsl_m), dtype=np.float64)


def _zero_of(reference: str, ground_amsl_m: FloatArray, take_off_amsl_m: float) -> FloatArray:
    """Return the zero of a reference, above sea level."""
    if reference == "AGL":
        return ground_amsl_m
    if reference == "AMSL":
        return np.zeros_like(ground_amsl_m)
    if reference == "RELATIVE":
        return np.full_like(ground_amsl_m, take_off_amsl_m)
    raise UnknownReference(f"A height is counted from {', '.join(REFERENCES)}, not from {reference!r}.")


MAX_SAMPLES = 5_000
MIN_STEP_M = 1.0
SAME_PLACE_M = 0.01


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a line. distance_m (n,) along it, positions (n, 2), lon lat [deg]; includes every vertex of the line."""

    distance_m: FloatArray
    positions: FloatArray


def samples_along(line: FloatArray, step_m: float) -> Samples:
    """Return samples of the line of shape (k, 2), k ≥ 2, straight in longitude and latitude between vertices, at most step_m apart.

    The step is widened where that would be more than MAX_SAMPLES.
    """
    lengths_m = distance_m(line[:-1], line[1:])
    step_m = max(step_m, MIN_STEP_M, float(lengths_m.sum()) / max(MAX_SAMPLES - len(line), 1))
    distances, places = [np.zeros(1)], [line[:1]]
    before_m = 0.0
    for start, end, length_m in zip(line[:-1], line[1:], lengths_m.tolist(), strict=True):
        shares = np.arange(1, max(1, ceil(length_m / step_m)) + 1) / max(1, ceil(length_m / step_m))
        distances.append(before_m + shares * length_m)
        places.append(start + shares[:, None] * (end - start))
        before_m += length_m
    return Samples(np.concatenate(distances), np.concatenate(places))


def stretches_inside(line: FloatArray, area: shapely.Geometry) -> list[tuple[float, float]]:
    """Return the stretches along the line [m] in the area; stretches that meet at a vertex are one."""
    legs = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    lengths_m = distance_m(line[:-1], line[1:])
    before_m = np.concatenate([[0.0], np.cumsum(lengths_m)])
    shapely.prepare(area)
    found: list[tuple[float, float]] = []
    for leg in np.flatnonzero(shapely.intersects(legs, area) & (lengths_m > 0)).tolist():
        for part in shapely.get_parts(shapely.intersection(shapely.LineString(line[leg : leg + 2]), area)).tolist():
            ends = shapely.get_coordinates(part)[[0, -1]] - line[leg]
            along = line[leg + 1] - line[leg]
            shares = np.sort(np.clip(ends @ along / (along @ along), 0.0, 1.0))
            from_m, to_m = (float(before_m[leg] + share * lengths_m[leg]) for share in shares)
            if found and from_m - found[-1][1] < SAME_PLACE_M:
                found[-1] = found[-1][0], max(to_m, found[-1][1])
            else:
                found.append((from_m, to_m))
    return found


BLOCK_SIZE = 256
MIN_HEIGHT_M, MAX_HEIGHT_M = -500.0, 9_000.0  # Dead Sea shore -430 m, Everest 8,849 m; other values are voids
NO_WEIGHT = 1e-6  # of a post: smaller weights are position rounding, a micrometre of height


@dataclass(frozen=True, eq=False)
class HeightGrid:
    """heights_m[row, column] is at (west + column * step_lon, north - row * step_lat); NaN is void. float32, metres."""

    west_deg: float
    north_deg: float
    step_lon_deg: float
    step_lat_deg: float
    heights_m: NDArray[np.float32]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Return west, south, east, north of the outermost posts [deg]."""
        rows, columns = self.heights_m.shape
        east, south = self.west_deg + (columns - 1) * self.step_lon_deg, self.north_deg - (rows - 1) * self.step_lat_deg
        return (self.west_deg, south, east, self.north_deg)

    def sample(self, positions: FloatArray) -> FloatArray:
        """Return bilinear heights [m] at positions of shape (n, 2), lon lat [deg]; NaN outside the grid and beside a void.

        Beside a void means that a post with weight is void: on a post itself its own height suffices.
        """
        heights = np.full(len(positions), np.nan)
        self.fill(positions, heights)
        return heights

    def fill(self, positions: FloatArray, heights: FloatArray) -> BoolArray:
        """Fill in the same where heights (n,) are NaN, and return which of these positions are in the grid, (n,)."""
        posts_m = np.ascontiguousarray(self.heights_m)
        return _filled(
            self.west_deg, self.north_deg, self.step_lon_deg, self.step_lat_deg, posts_m, np.ascontiguousarray(positions), heights
        )


@njit(cache=True, nogil=True)
def _filled(
    west_deg: float,
    north_deg: float,
    step_lon_deg: float,
    step_lat_deg: float,
    posts_m: NDArray[np.float32],
    positions: FloatArray,
    heights: FloatArray,
) -> BoolArray:
    rows, columns = posts_m.shape
    rounding = 1e-9 * (abs(west_deg) + 360.0) / min(step_lon_deg, step_lat_deg)  # of the file's own origin
    inside = np.zeros(len(positions), dtype=np.bool_)
    for number in range(len(positions)):
        x = (positions[number, 0] - west_deg) / step_lon_deg
        y = (north_deg - positions[number, 1]) / step_lat_deg
        is_inside = -rounding <= x <= columns - 1 + rounding and -rounding <= y <= rows - 1 + rounding
        if not is_inside or not np.isnan(heights[number]):
            continue
        inside[number] = True
        x, y = min(max(x, 0.0), columns - 1.0), min(max(y, 0.0), rows - 1.0)
        column, row = min(int(x), max(columns - 2, 0)), min(int(y), max(rows - 2, 0))
        east, south = x - column, y - row
        total = 0.0
        for down in range(2):
            for right in range(2):
                weight = (east if right else 1.0 - east) * (south if down else 1.0 - south)
                if weight > NO_WEIGHT:
                    total += posts_m[min(row + down, rows - 1), min(column + right, columns - 1)] * weight
        heights[number] = total
    return inside


def packed(heights: NDArray[np.float32]) -> bytes:
    """Return little-endian float32, row by row, zlib-compressed."""
    return zlib.compress(np.ascontiguousarray(heights, dtype="<f4").tobytes(), level=6)


def unpacked(data: bytes, rows: int, columns: int) -> NDArray[np.float32]:
    """Return the inverse of packed; never unpacks more than the block has."""
    text = zlib.decompressobj().decompress(data, rows * columns * 4)
    return np.frombuffer(text, dtype="<f4").reshape(rows, columns).astype(np.float32)
