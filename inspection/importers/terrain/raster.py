"""A raster of heights that is read window by window, and the blocks that it is stored in."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from inspection.terrain.height_grid import BLOCK_SIZE, MAX_HEIGHT_M, MIN_HEIGHT_M, HeightGrid


class Kind(IntEnum):
    """What stands at a post."""

    HEIGHT = 0
    DECLARED_VOID = 1  # the value that the file declares
    UNDECLARED_VOID = 2  # NaN, or no height on earth, such as -32768 or 99999, that the file does not declare
    OUTSIDE = 3  # beyond the edge of a raster that stands askew in longitude and latitude


@dataclass(frozen=True, eq=False)
class Window:
    """heights_m is NaN wherever kinds is not HEIGHT; both of shape (rows, columns)."""

    heights_m: NDArray[np.float32]
    kinds: NDArray[np.uint8]


class Raster(Protocol):
    """Posts at (west + column * step_lon, north - row * step_lat), row 0 in the north."""

    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def west_deg(self) -> float: ...
    @property
    def north_deg(self) -> float: ...
    @property
    def step_lon_deg(self) -> float: ...
    @property
    def step_lat_deg(self) -> float: ...

    def window(self, row: int, column: int, rows: int, columns: int) -> Window:
        """Raises TerrainFileError where the file is damaged."""


@dataclass(frozen=True, eq=False)
class Block:
    """A part of a raster. Blocks share their edge posts, so that no gap is between them; a post counts in one of them alone."""

    grid: HeightGrid | None  # None where there is nothing but voids
    posts: int
    declared_voids: int
    undeclared_voids: int
    share: float  # of the raster that is read with this block


def window_of(raw: NDArray[np.generic], declared_void: float | None, *, scale: float = 1.0, offset_m: float = 0.0) -> Window:
    """Tells heights from voids; scale and offset_m make metres of what the file has."""
    with np.errstate(invalid="ignore", over="ignore"):  # signalling NaN, and numbers that float32 does not have: both are voids
        values = raw.astype(np.float64)
        declared = np.zeros(raw.shape, dtype=bool)
        if declared_void is not None:
            declared = np.isnan(values) if np.isnan(declared_void) else _is_void(raw, values, declared_void)
        heights = values * scale + offset_m
        undeclared = ~((heights >= MIN_HEIGHT_M) & (heights <= MAX_HEIGHT_M)) & ~declared
        kinds = np.where(declared, Kind.DECLARED_VOID, np.where(undeclared, Kind.UNDECLARED_VOID, Kind.HEIGHT)).astype(np.uint8)
        metres = heights.astype(np.float32)
    metres[kinds != Kind.HEIGHT] = np.nan
    return Window(metres, kinds)


def _is_void(raw: NDArray[np.generic], values: NDArray[np.float64], declared_void: float) -> NDArray[np.bool_]:
    """A float32 file can only hold the declared number as float32 has it: -3.4028234663852886e+38 may be written with fewer digits."""
    same: NDArray[np.bool_] = values == declared_void
    if raw.dtype == np.float32 and abs(declared_void) <= np.finfo(np.float32).max:
        same = same | (raw == np.float32(declared_void))
    return same


def blocks_of(raster: Raster, size: int = BLOCK_SIZE) -> Iterator[Block]:
    """Row by row from the north."""
    rows_left = list(_parts(raster.height, size))
    columns_left = list(_parts(raster.width, size))
    number = len(rows_left) * len(columns_left)
    done = 0
    for row, rows in rows_left:
        for column, columns in columns_left:
            done += 1
            window = raster.window(row, column, rows, columns)
            own = window.kinds[: rows if row + rows == raster.height else -1, : columns if column + columns == raster.width else -1]
            grid = None
            if (window.kinds == Kind.HEIGHT).any():
                west, north = raster.west_deg + column * raster.step_lon_deg, raster.north_deg - row * raster.step_lat_deg
                grid = HeightGrid(west, north, raster.step_lon_deg, raster.step_lat_deg, window.heights_m)
            yield Block(
                grid,
                posts=int((own != Kind.OUTSIDE).sum()),
                declared_voids=int((own == Kind.DECLARED_VOID).sum()),
                undeclared_voids=int((own == Kind.UNDECLARED_VOID).sum()),
                share=done / number,
            )


def _parts(count: int, size: int) -> Iterator[tuple[int, int]]:
    """First post and number of posts of each part; neighbours share a post."""
    for first in range(0, max(count - 1, 1), size - 1):
        yield first, min(size, count - first)
