"""Terrain of the demo region: a valley that falls eastward between two ridges, with hills and a river bed."""

from dataclasses import dataclass

import numpy as np

from inspection.demo_region.layout import RIVER
from inspection.demo_region.place import (
    CENTRE,
    HALF_HEIGHT_M,
    HALF_WIDTH_M,
    METRES_PER_DEG_LAT,
    METRES_PER_DEG_LON,
    FloatArray,
    smooth_path,
)

STEP_DEG = 2.0 / 3_600.0  # 2 arc seconds: 56 m by 62 m here
MARGIN_M = 2_000.0  # how far the terrain reaches beyond the lines
HILLS = 26
WAVES = 36


@dataclass(frozen=True, eq=False)
class Hills:
    """Heights as a smooth function of position.

    hill   (n, 4)  east, north, height, radius [m]
    wave   (n, 4)  east and north wave number [rad/m], phase [rad], height [m]
    river  (n, 2)  the river's path
    """

    hill: FloatArray
    wave: FloatArray
    river: FloatArray

    def height_amsl_m(self, east_m: FloatArray, north_m: FloatArray) -> FloatArray:
        valley_floor = 240.0 - 0.0032 * east_m
        north_ridge = 330.0 / (1.0 + np.exp(-(north_m - 8_600.0 - 900.0 * np.sin(east_m / 5_200.0)) / 1_150.0))
        south_ridge = 270.0 / (1.0 + np.exp((north_m + 9_400.0 - 700.0 * np.sin(east_m / 4_300.0 + 1.0)) / 1_050.0))
        height = valley_floor + north_ridge + south_ridge
        for east, north, top_m, radius_m in self.hill:
            height = height + top_m * np.exp(-((east_m - east) ** 2 + (north_m - north) ** 2) / (2.0 * radius_m**2))
        ruggedness = 0.12 + (north_ridge + south_ridge) / 330.0
        for east_k, north_k, phase, top_m in self.wave:
            height = height + ruggedness * top_m * np.sin(east_k * east_m + north_k * north_m + phase)
        river_north = np.interp(east_m, self.river[:, 0], self.river[:, 1])
        return np.asarray(height - 9.0 * np.exp(-(((north_m - river_north) / 260.0) ** 2)), dtype=np.float64)


def make_hills(generator: np.random.Generator) -> Hills:
    side = generator.choice([-1.0, 1.0], HILLS)
    hill = np.column_stack(
        [
            generator.uniform(-HALF_WIDTH_M, HALF_WIDTH_M, HILLS),
            side * generator.uniform(4_800.0, 13_000.0, HILLS),
            generator.uniform(30.0, 130.0, HILLS),
            generator.uniform(600.0, 1_700.0, HILLS),
        ]
    )
    wavelength_m = generator.uniform(700.0, 5_000.0, WAVES)
    heading = generator.uniform(0.0, 2.0 * np.pi, WAVES)
    wave = np.column_stack(
        [
            2.0 * np.pi / wavelength_m * np.cos(heading),
            2.0 * np.pi / wavelength_m * np.sin(heading),
            generator.uniform(0.0, 2.0 * np.pi, WAVES),
            wavelength_m * 0.0032,
        ]
    )
    return Hills(hill, wave, smooth_path(RIVER.points))


@dataclass(frozen=True, eq=False)
class TerrainGrid:
    """Heights in rows from north to south; west and north are the outer edges of the first cell, as in GeoTIFF."""

    west_deg: float
    north_deg: float
    step_deg: float
    heights_amsl_m: np.ndarray[tuple[int, int], np.dtype[np.float32]]


def make_terrain_grid(hills: Hills) -> TerrainGrid:
    columns = 2 * int(np.ceil((HALF_WIDTH_M + MARGIN_M) / METRES_PER_DEG_LON / STEP_DEG))
    rows = 2 * int(np.ceil((HALF_HEIGHT_M + MARGIN_M) / METRES_PER_DEG_LAT / STEP_DEG))
    east_m = (np.arange(columns) + 0.5 - columns / 2) * STEP_DEG * METRES_PER_DEG_LON
    north_m = (rows / 2 - np.arange(rows) - 0.5) * STEP_DEG * METRES_PER_DEG_LAT
    heights = hills.height_amsl_m(*np.meshgrid(east_m, north_m))
    return TerrainGrid(
        west_deg=CENTRE.lon - columns / 2 * STEP_DEG,
        north_deg=CENTRE.lat + rows / 2 * STEP_DEG,
        step_deg=STEP_DEG,
        heights_amsl_m=np.round(heights, 1).astype(np.float32),
    )
