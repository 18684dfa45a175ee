"""A raster of heights that is read window by window, and the blocks in which it is stored."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS

from inspection.terrain.heights import BLOCK_SIZE, MAX_HEIGHT_M, MIN_HEIGHT_M, HeightGrid
from operation.reasons import Reason


class PostKind(IntEnum):
    """Kind of a post."""

    HEIGHT = 0
    DECLARED_VOID = 1  # the value that the file declares
    UNDECLARED_VOID = 2  # NaN, or an impossible height such as -32768 or 99999, that the file does not declare
    OUTSIDE = 3  # beyond the edge of a raster that is rotated in longitude and latitude


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
        """Return a window. Raises TerrainFileError for a damaged file."""


@dataclass(frozen=True, eq=False)
class Block:
    """A part of a raster. Blocks share their edge posts, so that there is no gap between them; a post counts in one of them only."""

    grid: HeightGrid | None  # None if all posts are voids
    posts: int
    declared_voids: int
    undeclared_voids: int
    share: float  # of the raster read up to this block


def window_of(raw: NDArray[np.generic], declared_void: float | None, *, scale: float = 1.0, offset_m: float = 0.0) -> Window:
    """Return heights and voids; scale and offset_m convert the file's values to metres."""
    with np.errstate(invalid="ignore", over="ignore"):  # signalling NaN, and numbers beyond float32: both are voids
        values = raw.astype(np.float64)
        declared = np.zeros(raw.shape, dtype=bool)
        if declared_void is not None:
            declared = np.isnan(values) if np.isnan(declared_void) else _is_void(raw, values, declared_void)
        heights = values * scale + offset_m
        undeclared = ~((heights >= MIN_HEIGHT_M) & (heights <= MAX_HEIGHT_M)) & ~declared
        kinds = np.where(declared, PostKind.DECLARED_VOID, np.where(undeclared, PostKind.UNDECLARED_VOID, PostKind.HEIGHT)).astype(np.uint8)
        metres = heights.astype(np.float32)
    metres[kinds != PostKind.HEIGHT] = np.nan
    return Window(metres, kinds)


def _is_void(raw: NDArray[np.generic], values: NDArray[np.float64], declared_void: float) -> NDArray[np.bool_]:
    """Compare as float32 in such a file: -3.4028234663852886e+38 may be written with fewer digits."""
    same: NDArray[np.bool_] = values == declared_void
    if raw.dtype == np.float32 and abs(declared_void) <= np.finfo(np.float32).max:
        same = same | (raw == np.float32(declared_void))
    return same


def blocks_of(raster: Raster, size: int = BLOCK_SIZE) -> Iterator[Block]:
    """Yield blocks row by row from the north."""
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
            if (window.kinds == PostKind.HEIGHT).any():
                west, north = raster.west_deg + column * raster.step_lon_deg, raster.north_deg - row * raster.step_lat_deg
                grid = HeightGrid(west, north, raster.step_lon_deg, raster.step_lat_deg, window.heights_m)
            yield Block(
                grid,
                posts=int((own != PostKind.OUTSIDE).sum()),
                declared_voids=int((own == PostKind.DECLARED_VOID).sum()),
                undeclared_voids=int((own == PostKind.UNDECLARED_VOID).sum()),
                share=done / number,
            )


def _parts(count: int, size: int) -> Iterator[tuple[int, int]]:
    """Yield first post and number of posts of each part; neighbours share a post."""
    for first in range(0, max(count - 1, 1), size - 1):
        yield first, min(size, count - first)


class TerrainFileError(ValueError):
    """Raised for a file that is no terrain model, with the reason."""


class PostSurvey:
    """Counts each post of the blocks once, although blocks share their edges."""

    def __init__(self) -> None:
        self.blocks = self.posts = self.declared_voids = self.undeclared_voids = 0
        self.lowest_m, self.highest_m = np.inf, -np.inf
        self._extent = [np.inf, np.inf, -np.inf, -np.inf]

    def add(self, block: Block) -> None:
        self.posts += block.posts
        self.declared_voids += block.declared_voids
        self.undeclared_voids += block.undeclared_voids
        if block.grid is None:
            return
        self.blocks += 1
        self.lowest_m = min(self.lowest_m, float(np.nanmin(block.grid.heights_m)))
        self.highest_m = max(self.highest_m, float(np.nanmax(block.grid.heights_m)))
        west, south, east, north = block.grid.extent
        least, most = self._extent[:2], self._extent[2:]
        self._extent = [min(least[0], west), min(least[1], south), max(most[0], east), max(most[1], north)]

    @property
    def voids(self) -> int:
        return self.declared_voids + self.undeclared_voids

    def counts(self) -> dict[str, Any]:
        """Return the counts of a file with at least one height."""
        return {
            "blocks": self.blocks, "posts": self.posts, "voids": self.voids, "undeclared_voids": self.undeclared_voids,
            "lowest_m": round(self.lowest_m, 2), "highest_m": round(self.highest_m, 2), "extent": self._extent,
        }  # fmt: skip

    def notes(self) -> list[Reason]:
        """Return notes for users about its voids."""
        if not self.voids:
            return []
        figures = {"voids": self.voids, "posts": self.posts, "percent": float(f"{100 * self.voids / self.posts:.2g}")}
        if self.undeclared_voids:
            return [Reason("undeclared_voids", figures | {"undeclared": self.undeclared_voids})]
        return [Reason("voids", figures)]


MAX_NAME_LENGTH = 50
_NAMES = {5773: "EGM96", 5798: "EGM84", 3855: "EGM2008", 5703: "NAVD88", 6360: "NAVD88", 5621: "EVRF2007", 7837: "DHHN2016"}
_NAMES_OF_DATUMS = {5171: "EGM96", 1027: "EGM2008", 5203: "EGM84", 5103: "NAVD88", 5215: "EVRF2007"}
_GEOTIFF_ELLIPSOIDS = range(5001, 5034)  # GeoTIFF 1.0, 6.3.4.1: "VertCS_..._ellipsoid"
_ELLIPSOIDAL_WORDS = ("ellipsoid", "wgs84", "wgs 84", "epsg:4979", "hae")
ELLIPSOIDAL = (
    "The heights are counted from the ellipsoid, which lies up to 100 m above or below sea level. Convert them first: "
    "gdalwarp -s_srs EPSG:4979 -t_srs EPSG:4326+5773"
)


class DatumFault(TerrainFileError):
    """Raised for text that names no vertical datum with comparable heights."""


def datum_named(name: str) -> str:
    """Return the name as it is stored. Raises DatumFault."""
    name = " ".join(name.split())
    if not name or len(name) > MAX_NAME_LENGTH or not name.isprintable():
        raise DatumFault(f"A vertical datum is a name of 1 to {MAX_NAME_LENGTH} characters, such as EGM96.")
    if any(words in name.lower() for words in _ELLIPSOIDAL_WORDS):
        raise DatumFault(ELLIPSOIDAL)
    return next((known for known in _NAMES.values() if known.lower() == name.lower()), name)


def datum_of_system(system: CRS | None) -> str | None:
    """Return the datum of a system of heights; None for none."""
    if system is None:
        return None
    described = system.to_json_dict()
    code, datum_code = (part.get("id", {}).get("code", 0) for part in (described, described.get("datum", {})))
    if code in _GEOTIFF_ELLIPSOIDS or "ellipsoid" in system.name.lower():
        raise TerrainFileError(ELLIPSOIDAL)
    if code in _NAMES or datum_code in _NAMES_OF_DATUMS:
        return _NAMES.get(code) or _NAMES_OF_DATUMS[datum_code]
    return datum_named(system.name.removesuffix(" height")[:MAX_NAME_LENGTH])


def metres_of_system(system: CRS | None) -> float:
    """Return the metres per unit of a system of heights."""
    return float(system.axis_info[0].unit_conversion_factor) if system is not None and system.axis_info else 1.0


def refuse_if_ellipsoidal(system: CRS) -> None:
    """Refuse a system with a third axis, which measures heights from its ellipsoid."""
    if system.is_geographic and len(system.axis_info) == 3:
        raise TerrainFileError(ELLIPSOIDAL)
