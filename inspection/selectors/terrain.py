"""Terrain heights from the stored models, also under the nodes of a graph."""

from functools import lru_cache
from threading import Lock
from weakref import WeakKeyDictionary

import numpy as np
from django.db.models import Count, Max

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import TerrainTile
from inspection.network.inspection_graph import InspectionGraph
from inspection.selectors.ground import DatasetVersion, ground_dataset_version
from inspection.terrain.heights import HeightGrid, unpacked
from inspection.terrain.tiled_terrain import IntArray, TerrainHeights, TiledTerrain

TILES_IN_MEMORY = 256  # of 256 KiB each
_FETCHED_AT_ONCE = 32


def has_terrain() -> bool:
    return TerrainTile.objects.exists()


def terrain_dataset_version() -> tuple[int | None, int]:
    """Return a value that changes with the terrain only, not with other map data."""
    tiles = TerrainTile.objects.aggregate(newest=Max("pk"), number=Count("pk"))
    return tiles["newest"], tiles["number"]


def ground_heights_m(positions: FloatArray, dataset_version: DatasetVersion | None = None) -> FloatArray:
    """Return terrain heights above sea level [m] at positions of shape (n, 2), lon lat [deg]; NaN where no model has data.

    Where models overlap the newest counts, and older ones fill its voids. dataset_version: one just read; None: read it.
    """
    return ground_truth(positions, dataset_version).heights_m


def ground_truth(positions: FloatArray, dataset_version: DatasetVersion | None = None) -> TerrainHeights:
    """Return ground_heights_m with the model of each height."""
    return _tiles(dataset_version or ground_dataset_version()).heights_at(positions)


def grids_around(box: tuple[float, float, float, float], most: int) -> list[HeightGrid] | None:
    """Return the tiles that touch west, south, east, north [deg], or the gaps between them; None if there are more than `most`."""
    tiles = tiles_around(box)
    return None if len(tiles) > most else [grid for _, grid in tiles.grids()]


def tiles_around(box: tuple[float, float, float, float], dataset_version: DatasetVersion | None = None) -> TiledTerrain:
    """Return the same as a separate terrain. dataset_version: one just read; None: read it."""
    return _tiles(dataset_version or ground_dataset_version()).around(box)


@lru_cache(maxsize=2)
def _tiles(dataset_version: DatasetVersion) -> TiledTerrain:
    """Return the tiles of this dataset version; adding or removing tiles makes a new one."""
    fields = ("pk", "data_import_id", "west_deg", "north_deg", "step_lon_deg", "step_lat_deg", "columns", "rows")
    rows = np.array(list(TerrainTile.objects.order_by("-pk").values_list(*fields)), dtype=np.float64).reshape(-1, len(fields))
    return TiledTerrain(rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64), rows[:, 2:6], rows[:, 6:8].astype(np.int64), _grids.grid)


class _Grids:
    """Cache of unpacked tiles by last use; tiles are never changed, only added and removed."""

    def __init__(self) -> None:
        self._kept: dict[int, HeightGrid] = {}
        self._lock = Lock()

    def grid(self, keys: IntArray, number: int, wanted: IntArray) -> HeightGrid | None:
        """Return the tile `number` of keys; None if an import has replaced it. The next ones of `wanted` are loaded with it."""
        key = int(keys[number])
        with self._lock:
            grid = self._kept.pop(key, None)
            if grid is None:
                following = keys[wanted[wanted >= number][:_FETCHED_AT_ONCE]].tolist()
                self._fetch([other for other in following if other not in self._kept])
                grid = self._kept.pop(key, None)
            if grid is not None:
                self._kept[key] = grid  # last used, last in order
            return grid

    def _fetch(self, keys: list[int]) -> None:
        for tile in TerrainTile.objects.filter(pk__in=keys):
            heights = unpacked(bytes(tile.heights_amsl_m), tile.rows, tile.columns)
            self._kept[tile.pk] = HeightGrid(tile.west_deg, tile.north_deg, tile.step_lon_deg, tile.step_lat_deg, heights)
        for key in list(self._kept)[: max(len(self._kept) - TILES_IN_MEMORY, 0)]:
            del self._kept[key]


_grids = _Grids()


Terrain = tuple[int | None, int]

_one_thread = Lock()
_kept: WeakKeyDictionary[InspectionGraph, tuple[Terrain, FloatArray]] = WeakKeyDictionary()


def node_ground_m(graph: InspectionGraph, terrain: Terrain) -> FloatArray:
    """Return heights above sea level (n,), NaN where no terrain model has data; the same array while the terrain is unchanged."""
    with _one_thread:
        kept = _kept.get(graph)
        if kept is None or kept[0] != terrain:
            heights_m = ground_heights_m(graph.position)
            heights_m.setflags(write=False)
            kept = _kept[graph] = terrain, heights_m
        return kept[1]
