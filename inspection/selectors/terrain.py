"""Heights of the ground from the stored terrain models."""

from dataclasses import dataclass
from functools import lru_cache
from threading import Lock

import numpy as np
import shapely
from django.db.models import Count, Max
from numpy.typing import NDArray

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import TerrainTile
from inspection.selectors.ground import Edition, ground_edition
from inspection.terrain.height_grid import NO_WEIGHT, HeightGrid, unpacked

TILES_IN_MEMORY = 256  # of 256 KiB each
_EDGE_DEG = 1e-9
_FETCHED_AT_ONCE = 32

IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class GroundTruth:
    """heights_m of shape (n,): above sea level, NaN where no model tells. imports: the DataImport that each is from, -1 for none."""

    heights_m: FloatArray
    imports: IntArray


@dataclass(frozen=True, eq=False)
class _TileIndex:
    """Where the tiles lie, newest first. lattice of shape (n, 4): west, north, step_lon, step_lat."""

    keys: IntArray
    imports: IntArray
    lattice: FloatArray
    within: shapely.STRtree  # of the tiles' extents
    beside: shapely.STRtree  # of extents that are a step wider


def has_terrain() -> bool:
    return TerrainTile.objects.exists()


def terrain_edition() -> tuple[int | None, int]:
    """Another one after every change of the terrain, and the same one after other changes of the ground."""
    tiles = TerrainTile.objects.aggregate(newest=Max("pk"), number=Count("pk"))
    return tiles["newest"], tiles["number"]


def ground_heights_m(positions: FloatArray, edition: Edition | None = None) -> FloatArray:
    """Height of the ground above sea level [m] at positions of shape (n, 2), lon lat [deg]; NaN where no terrain model tells.

    Where models overlap the newest counts, and an older one fills its voids. edition: of the ground that was just read; None: it is read.
    """
    return ground_truth(positions, edition).heights_m


def ground_truth(positions: FloatArray, edition: Edition | None = None) -> GroundTruth:
    """As ground_heights_m, with the model that each height is from."""
    positions = np.asarray(positions, dtype=np.float64).reshape(-1, 2)
    found = GroundTruth(np.full(len(positions), np.nan), np.full(len(positions), -1, dtype=np.int64))
    index = _tile_index(edition or ground_edition())
    if not len(index.keys) or not len(positions):
        return found
    inside = _sample(index, positions, found)
    unmet = np.flatnonzero(~inside & np.isfinite(positions).all(axis=1))
    if len(unmet):
        _bridge(index, positions, unmet, found)
    return found


def grids_around(box: tuple[float, float, float, float], most: int) -> list[HeightGrid] | None:
    """The tiles that touch west, south, east, north [deg], or the gaps between them; None if they are more than `most`."""
    index = _tile_index(ground_edition())
    if not len(index.keys):
        return []
    wanted = np.sort(index.beside.query(shapely.box(*box)))
    if len(wanted) > most:
        return None
    grids = [_grids.grid(index.keys, number, wanted) for number in wanted.tolist()]
    return [grid for grid in grids if grid is not None]


def _sample(index: _TileIndex, positions: FloatArray, found: GroundTruth) -> NDArray[np.bool_]:
    """Fills in what tiles tell by themselves; returns which positions lie in any tile."""
    places, tiles = index.within.query(shapely.points(positions), predicate="intersects")
    inside = np.zeros(len(positions), dtype=bool)
    if not len(places):
        return inside
    inside[places] = True
    order = np.lexsort((places, tiles))
    places, tiles = places[order], tiles[order]
    numbers, firsts = np.unique(tiles, return_index=True)
    for number, rows in zip(numbers.tolist(), np.split(places, firsts[1:]), strict=True):
        open_rows = rows[np.isnan(found.heights_m[rows])]
        grid = _grids.grid(index.keys, number, numbers) if len(open_rows) else None
        if grid is not None:
            heights = grid.sample(positions[open_rows])
            found.heights_m[open_rows] = heights
            found.imports[open_rows[~np.isnan(heights)]] = index.imports[number]
    return inside


def _bridge(index: _TileIndex, positions: FloatArray, unmet: NDArray[np.intp], found: GroundTruth) -> None:
    """Between files whose posts stand side by side, such as GeoTIFF tiles of whole degrees, lies a gap of one step.

    There the four posts around a position are of different tiles; between them it is as between any four posts. If one of them is void or
    missing, the ground stays unknown.
    """
    places, tiles = index.beside.query(shapely.points(positions[unmet]), predicate="intersects")
    if not len(places):
        return
    _, newest = np.unique(places[np.lexsort((tiles, places))], return_index=True)
    order = np.lexsort((tiles, places))[newest]
    rows, tiles = unmet[places[order]], tiles[order]
    west, north, step_lon, step_lat = index.lattice[tiles].T
    x, y = (positions[rows, 0] - west) / step_lon, (north - positions[rows, 1]) / step_lat
    column, row = np.floor(x), np.floor(y)
    east, south = x - column, y - row
    weights = np.column_stack([(1 - east) * (1 - south), east * (1 - south), (1 - east) * south, east * south])
    corners = np.stack(
        [np.column_stack([west + (column + right) * step_lon, north - (row + down) * step_lat]) for down in (0, 1) for right in (0, 1)],
        axis=1,
    )
    at_corners = GroundTruth(np.full(4 * len(rows), np.nan), np.full(4 * len(rows), -1, dtype=np.int64))
    _sample(index, corners.reshape(-1, 2), at_corners)
    counted = np.where(weights > NO_WEIGHT, weights, 0.0)
    heights = np.where(counted > 0, at_corners.heights_m.reshape(-1, 4), 0.0)
    found.heights_m[rows] = (heights * counted).sum(axis=1) / counted.sum(axis=1)
    known = ~np.isnan(found.heights_m[rows])
    found.imports[rows[known]] = index.imports[tiles[known]]


@lru_cache(maxsize=2)
def _tile_index(edition: Edition) -> _TileIndex:
    """The tiles as they stand at this edition of the ground; what brings them in or takes them out makes a new one."""
    fields = ("pk", "data_import_id", "west_deg", "north_deg", "step_lon_deg", "step_lat_deg", "columns", "rows")
    rows = np.array(list(TerrainTile.objects.order_by("-pk").values_list(*fields)), dtype=np.float64).reshape(-1, len(fields))
    west, north, step_lon, step_lat, columns, lines = rows[:, 2:].T
    east, south = west + (columns - 1) * step_lon, north - (lines - 1) * step_lat
    return _TileIndex(
        keys=rows[:, 0].astype(np.int64),
        imports=rows[:, 1].astype(np.int64),
        lattice=rows[:, 2:6],
        within=shapely.STRtree(shapely.box(west - _EDGE_DEG, south - _EDGE_DEG, east + _EDGE_DEG, north + _EDGE_DEG)),
        beside=shapely.STRtree(shapely.box(west - step_lon, south - step_lat, east + step_lon, north + step_lat)),
    )


class _Grids:
    """The tiles last used, unpacked; tiles are never changed, only added and taken out."""

    def __init__(self) -> None:
        self._kept: dict[int, HeightGrid] = {}
        self._lock = Lock()

    def grid(self, keys: IntArray, number: int, wanted: IntArray) -> HeightGrid | None:
        """The tile `number` of keys; None for one that an import has replaced in the meantime. The next ones of `wanted` come with it."""
        key = int(keys[number])
        with self._lock:
            grid = self._kept.pop(key, None)
            if grid is None:
                following = keys[wanted[wanted >= number][:_FETCHED_AT_ONCE]].tolist()
                self._fetch([other for other in following if other not in self._kept])
                grid = self._kept.pop(key, None)
            if grid is not None:
                self._kept[key] = grid  # the one last used stands last
            return grid

    def _fetch(self, keys: list[int]) -> None:
        for tile in TerrainTile.objects.filter(pk__in=keys):
            heights = unpacked(bytes(tile.heights_amsl_m), tile.rows, tile.columns)
            self._kept[tile.pk] = HeightGrid(tile.west_deg, tile.north_deg, tile.step_lon_deg, tile.step_lat_deg, heights)
        for key in list(self._kept)[: max(len(self._kept) - TILES_IN_MEMORY, 0)]:
            del self._kept[key]


_grids = _Grids()
