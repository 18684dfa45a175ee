"""Ground given by posts, for the planner as tiles of a terrain model and for tests by a reader of its own."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from inspection.terrain.heights import HeightGrid
from inspection.terrain.profile import profile_under
from inspection.terrain.tiled_terrain import TiledTerrain
from planning.trajectory.heights import FloatArray, GroundModel


class PostedGround:
    """heights_m (rows, columns) of posts from the north-west corner on, NaN for voids; in tiles of tile_posts a side."""

    def __init__(self, heights_m: Any, west_deg: float, north_deg: float, step_deg: float, tile_posts: int = 64) -> None:
        posts = np.asarray(heights_m, dtype="f4")
        rows, columns = posts.shape
        grids = [
            HeightGrid(west_deg + column * step_deg, north_deg - row * step_deg, step_deg, step_deg,
                       np.ascontiguousarray(posts[row : row + tile_posts, column : column + tile_posts]))
            for row in range(0, rows, tile_posts) for column in range(0, columns, tile_posts)
        ]  # fmt: skip
        self.tiles = tiled(grids)
        self.ground = ground_of(self.tiles)
        self._posts = RegularGridInterpolator(
            (north_deg - step_deg * np.arange(rows)[::-1], west_deg + step_deg * np.arange(columns)), posts[::-1].astype(np.float64)
        )

    def metres(self, positions: Any) -> Any:
        """Heights at positions (n, 2), bilinear by scipy, (n,)."""
        return self._posts(np.asarray(positions)[:, ::-1])


def tiled(grids: list[HeightGrid]) -> TiledTerrain:
    """A terrain of these grids, newest first."""
    lattice = [(grid.west_deg, grid.north_deg, grid.step_lon_deg, grid.step_lat_deg) for grid in grids]
    return TiledTerrain(
        np.arange(len(grids)), np.zeros(len(grids), dtype=np.int64), np.array(lattice),
        np.array([grid.heights_m.shape[::-1] for grid in grids]), lambda keys, number, wanted: grids[int(keys[number])],
    )  # fmt: skip


def ground_of(tiles: TiledTerrain) -> GroundModel:
    return GroundModel(lambda positions: tiles.heights_at(positions).heights_m, lambda start, end: profile_under(start, end, tiles.around))


def ground_like(
    height_m: Callable[[FloatArray], FloatArray], west_deg: float, north_deg: float, size_deg: float, step_deg: float = 0.0005
) -> PostedGround:
    """Posts on a surface that is given by a function of positions (n, 2)."""
    count = round(size_deg / step_deg) + 1
    across, down = np.meshgrid(np.arange(count), np.arange(count))
    positions = np.column_stack([west_deg + step_deg * across.ravel(), north_deg - step_deg * down.ravel()])
    return PostedGround(height_m(positions).reshape(count, count), west_deg, north_deg, step_deg)
