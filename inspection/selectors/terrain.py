"""Heights of the ground from the stored terrain model."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from django.db.models import Count, Max

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import TerrainTile
from inspection.terrain.height_grid import HeightGrid, unpacked

TILES_IN_MEMORY = 256  # of 256 KiB each
_EDGE_DEG = 1e-9


@dataclass(frozen=True, eq=False)
class _TileIndex:
    """Where the tiles lie, newest first; extents of shape (n, 4): west, south, east, north."""

    keys: tuple[int, ...]
    extents: FloatArray


def has_terrain() -> bool:
    return TerrainTile.objects.exists()


def ground_heights_m(positions: FloatArray) -> FloatArray:
    """Height of the ground above sea level [m] at positions of shape (n, 2), lon lat [deg]; NaN where no terrain model tells.

    Where models overlap the newest counts, and an older one fills its voids.
    """
    positions = np.asarray(positions, dtype=np.float64).reshape(-1, 2)
    heights = np.full(len(positions), np.nan)
    index = _tile_index(*TerrainTile.objects.aggregate(newest=Max("pk"), number=Count("pk")).values())
    if not index.keys or not len(positions):
        return heights
    west, south, east, north = (index.extents[:, [column]] for column in range(4))
    lon, lat = positions[:, 0], positions[:, 1]
    holds = (west - _EDGE_DEG <= lon) & (lon <= east + _EDGE_DEG) & (south - _EDGE_DEG <= lat) & (lat <= north + _EDGE_DEG)
    for tile in np.flatnonzero(holds.any(axis=1)):
        rows = np.flatnonzero(holds[tile] & np.isnan(heights))
        grid = _grid(index.keys[tile]) if len(rows) else None
        if grid is not None:
            heights[rows] = grid.sample(positions[rows])
    return heights


@lru_cache(maxsize=2)
def _tile_index(newest: int | None, number: int) -> _TileIndex:
    """The tiles as they stand when the newest key and the number are these; tiles are never changed, only added and taken out."""
    fields = ("pk", "west_deg", "north_deg", "step_lon_deg", "step_lat_deg", "columns", "rows")
    rows = [
        (key, west, north - (rows - 1) * step_lat, west + (columns - 1) * step_lon, north)
        for key, west, north, step_lon, step_lat, columns, rows in TerrainTile.objects.order_by("-pk").values_list(*fields)
    ]
    return _TileIndex(tuple(row[0] for row in rows), np.array([row[1:] for row in rows], dtype=np.float64).reshape(-1, 4))


@lru_cache(maxsize=TILES_IN_MEMORY)
def _grid(key: int) -> HeightGrid | None:
    """None for a tile that an import has replaced in the meantime."""
    tile = TerrainTile.objects.filter(pk=key).first()
    if tile is None:
        return None
    heights = unpacked(bytes(tile.heights_amsl_m), tile.rows, tile.columns)
    return HeightGrid(tile.west_deg, tile.north_deg, tile.step_lon_deg, tile.step_lat_deg, heights)
