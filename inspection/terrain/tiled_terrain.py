"""Heights from several tiled terrain models: newer tiles take precedence, and gaps between adjacent tiles are interpolated."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.wgs84 import FloatArray
from inspection.terrain.heights import NO_WEIGHT, BoolArray, HeightGrid

_EDGE_DEG = 1e-9
EDGE = 1e-3  # of a step: positions nearer to a tile may be in it by rounding
FEW_TILES = 32  # so few are looked through faster than a tree finds the right ones

IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class TerrainHeights:
    """heights_m of shape (n,): above sea level, NaN where no model has data. imports: the DataImport of each, -1 for none."""

    heights_m: FloatArray
    imports: IntArray


@dataclass(frozen=True, eq=False)
class TiledTerrain:
    """Tiles, newest first: keys and imports (n,), lattice (n, 4): west, north, step_lon, step_lat [deg], size (n, 2): columns, rows.

    grid: returns the heights of a tile by its place in keys, None for a deleted one; given places to come are loaded with it.
    """

    keys: IntArray
    imports: IntArray
    lattice: FloatArray
    size: IntArray
    grid: Callable[[IntArray, int, IntArray], HeightGrid | None]

    def __len__(self) -> int:
        return len(self.keys)

    @cached_property
    def within(self) -> shapely.STRtree:
        """Return a tree of the tiles' extents."""
        return self._tree(_EDGE_DEG, _EDGE_DEG)

    @cached_property
    def beside(self) -> shapely.STRtree:
        """Return a tree of extents one step wider."""
        return self._tree(self.lattice[:, 2], self.lattice[:, 3])

    def _tree(self, more_lon: FloatArray | float, more_lat: FloatArray | float) -> shapely.STRtree:
        west, north, step_lon, step_lat = self.lattice.T
        columns, rows = self.size.T
        east, south = west + (columns - 1) * step_lon, north - (rows - 1) * step_lat
        return shapely.STRtree(shapely.box(west - more_lon, south - more_lat, east + more_lon, north + more_lat))

    def heights_at(self, positions: FloatArray) -> TerrainHeights:
        """Return terrain heights at positions of shape (n, 2), lon lat [deg].

        Where models overlap the newest counts, and older ones fill its voids.
        """
        positions = np.ascontiguousarray(positions, dtype=np.float64).reshape(-1, 2)
        found = TerrainHeights(np.full(len(positions), np.nan), np.full(len(positions), -1, dtype=np.int64))
        if not len(self.keys) or not len(positions):
            return found
        inside = _sample(self, positions, found)
        unmet = np.flatnonzero(~inside & np.isfinite(positions).all(axis=1))
        if len(unmet):
            _bridge(self, positions, unmet, found)
        return found

    def around(self, box: tuple[float, float, float, float]) -> "TiledTerrain":
        """Return the tiles that touch west, south, east, north [deg], or the gaps between them."""
        rows = np.sort(self.beside.query(shapely.box(*box))) if len(self) else np.empty(0, dtype=np.int64)
        return TiledTerrain(self.keys[rows], self.imports[rows], self.lattice[rows], self.size[rows], self.grid)

    def grids(self) -> Iterator[tuple[int, HeightGrid]]:
        """Yield all existing tiles, with their places in keys."""
        every = np.arange(len(self))
        for number in range(len(self)):
            grid = self.grid(self.keys, number, every)
            if grid is not None:
                yield number, grid


def _sample(terrain: TiledTerrain, positions: FloatArray, found: TerrainHeights) -> BoolArray:
    """Fill in the heights inside of tiles; returns which positions are in any tile."""
    if len(terrain) > FEW_TILES:
        return _sample_of_many(terrain, positions, found)
    inside = np.zeros(len(positions), dtype=bool)
    touched = _touched(terrain.lattice, terrain.size, positions)
    for number in touched.tolist():
        grid = terrain.grid(terrain.keys, number, touched)
        if grid is None:
            continue
        filled = grid.fill(positions, found.heights_m)
        found.imports[filled & ~np.isnan(found.heights_m)] = terrain.imports[number]
        inside |= filled
    return inside


@njit(cache=True, nogil=True)
def _touched(lattice: FloatArray, size: IntArray, positions: FloatArray) -> IntArray:
    """The tiles with a position in them or at their edges."""
    is_touched = np.zeros(len(lattice), dtype=np.bool_)
    for tile in range(len(lattice)):
        west, north, step_lon, step_lat = lattice[tile]
        for number in range(len(positions)):
            x, y = (positions[number, 0] - west) / step_lon, (north - positions[number, 1]) / step_lat
            if -EDGE <= x <= size[tile, 0] - 1 + EDGE and -EDGE <= y <= size[tile, 1] - 1 + EDGE:
                is_touched[tile] = True
                break
    return np.flatnonzero(is_touched)


def _sample_of_many(terrain: TiledTerrain, positions: FloatArray, found: TerrainHeights) -> BoolArray:
    places, tiles = terrain.within.query(shapely.points(positions), predicate="intersects")
    inside = np.zeros(len(positions), dtype=bool)
    if not len(places):
        return inside
    inside[places] = True
    order = np.lexsort((places, tiles))
    places, tiles = places[order], tiles[order]
    numbers, firsts = np.unique(tiles, return_index=True)
    for number, rows in zip(numbers.tolist(), np.split(places, firsts[1:]), strict=True):
        open_rows = rows[np.isnan(found.heights_m[rows])]
        grid = terrain.grid(terrain.keys, number, numbers) if len(open_rows) else None
        if grid is not None:
            heights = grid.sample(positions[open_rows])
            found.heights_m[open_rows] = heights
            found.imports[open_rows[~np.isnan(heights)]] = terrain.imports[number]
    return inside


def _bridge(terrain: TiledTerrain, positions: FloatArray, unmet: NDArray[np.intp], found: TerrainHeights) -> None:
    """Fill in heights in the gap of one step between adjacent files, such as GeoTIFF tiles of whole degrees.

    The four posts around such a position belong to different tiles and are interpolated as usual. If one of them is void or missing, the
    terrain stays unknown.
    """
    places, tiles = terrain.beside.query(shapely.points(positions[unmet]), predicate="intersects")
    if not len(places):
        return
    _, newest = np.unique(places[np.lexsort((tiles, places))], return_index=True)
    order = np.lexsort((tiles, places))[newest]
    rows, tiles = unmet[places[order]], tiles[order]
    west, north, step_lon, step_lat = terrain.lattice[tiles].T
    x, y = (positions[rows, 0] - west) / step_lon, (north - positions[rows, 1]) / step_lat
    column, row = np.floor(x), np.floor(y)
    east, south = x - column, y - row
    weights = np.column_stack([(1 - east) * (1 - south), east * (1 - south), (1 - east) * south, east * south])
    corners = np.stack(
        [np.column_stack([west + (column + right) * step_lon, north - (row + down) * step_lat]) for down in (0, 1) for right in (0, 1)],
        axis=1,
    )
    at_corners = TerrainHeights(np.full(4 * len(rows), np.nan), np.full(4 * len(rows), -1, dtype=np.int64))
    _sample(terrain, corners.reshape(-1, 2), at_corners)
    counted = np.where(weights > NO_WEIGHT, weights, 0.0)
    heights = np.where(counted > 0, at_corners.heights_m.reshape(-1, 4), 0.0)
    found.heights_m[rows] = (heights * counted).sum(axis=1) / counted.sum(axis=1)
    known = ~np.isnan(found.heights_m[rows])
    found.imports[rows[known]] = terrain.imports[tiles[known]]
