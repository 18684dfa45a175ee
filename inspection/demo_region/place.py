"""Location, size and UAVs of the demo region. Every name is invented.

It is in the Great Sand Sea of Egypt's Western Desert: land without settlements, roads or power lines, so that no real tower can be
mistaken for a synthetic one and a base map under it stays empty (docs/decisions/0010-synthetic-demo-location.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, radians

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat

FloatArray = NDArray[np.float64]
Point = tuple[float, float]  # east, north [m] of the region's centre

REGION_NAME = "Elme Valley"
DEFAULT_SEED = 20_260
CENTRE = LonLat(26.6, 25.7)
HALF_WIDTH_M = 20_000.0
HALF_HEIGHT_M = 13_000.0

# Metres in a degree at the centre's latitude (series of the WGS84 radii of curvature). A synthetic region needs no better projection.
_LATITUDE = radians(CENTRE.lat)
METRES_PER_DEG_LON = 111_412.84 * cos(_LATITUDE) - 93.5 * cos(3 * _LATITUDE) + 0.118 * cos(5 * _LATITUDE)
METRES_PER_DEG_LAT = 111_132.92 - 559.82 * cos(2 * _LATITUDE) + 1.175 * cos(4 * _LATITUDE)


def lon_lat(east_m: float, north_m: float) -> LonLat:
    """Return the position of a point of the region, on OSM's grid of 1e-7 degrees."""
    return LonLat(round(CENTRE.lon + east_m / METRES_PER_DEG_LON, 7), round(CENTRE.lat + north_m / METRES_PER_DEG_LAT, 7))


@dataclass(frozen=True)
class BasedUav:
    """A UAV with the values of its type; all but battery, range and speed are those of the simulated airframe Inspector."""

    name: str
    sensors: tuple[str, ...]
    max_range_m: float
    cruise_speed_mps: float
    battery_wh: float
    mass_kg: float = 3.77
    max_airspeed_mps: float = 19.0
    rotor_disk_m2: float = 0.5188
    hover_power_w: float = 430.0  # 263.2 Wh last 36 minutes and a half
    cameras: tuple[str, ...] = ()  # keys of the camera catalogue

    @property
    def type_name(self) -> str:
        return self.name.rpartition(" ")[0]


@dataclass(frozen=True)
class DemoBase:
    name: str
    position: LonLat
    uavs: tuple[BasedUav, ...]


BASES = (
    DemoBase(
        "Elmsgard depot",
        lon_lat(-9_050.0, 2_450.0),
        (
            BasedUav("Kestrel 1", ("RGB camera", "Thermal camera"), 24_000.0, 12.0, 263.2, cameras=("sony-a7r-iv-55",)),
            BasedUav("Kestrel 2", ("RGB camera", "Thermal camera"), 24_000.0, 12.0, 263.2, cameras=("sony-a7r-iv-55",)),
        ),
    ),
    DemoBase(
        "Varneck depot",
        lon_lat(10_900.0, 3_150.0),
        (
            BasedUav("Osprey 1", ("RGB camera", "Lidar"), 36_000.0, 12.0, 395.0),
            BasedUav("Osprey 2", ("RGB camera", "Lidar"), 36_000.0, 12.0, 395.0),
        ),
    ),
)


def smooth_path(points: Sequence[Point], rounds: int = 4) -> FloatArray:
    """Return the path after Chaikin's corner cutting with both ends kept, for the bends of roads, railways and rivers."""
    path = np.asarray(points, dtype=np.float64)
    for _ in range(rounds):
        near = 0.75 * path[:-1] + 0.25 * path[1:]
        far = 0.25 * path[:-1] + 0.75 * path[1:]
        path = np.vstack([path[:1], np.stack([near, far], axis=1).reshape(-1, 2), path[-1:]])
    return path


def distance_along(path: FloatArray) -> FloatArray:
    steps = np.diff(path, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def point_along(path: FloatArray, at_m: float) -> FloatArray:
    along = distance_along(path)
    return np.array([np.interp(at_m, along, path[:, 0]), np.interp(at_m, along, path[:, 1])])


def piece_of(path: FloatArray, start_m: float, end_m: float) -> FloatArray:
    """Return the part of a path between two distances along it, with its vertices in between."""
    along = distance_along(path)
    inside = path[(along > start_m + 0.5) & (along < end_m - 0.5)]
    return np.vstack([point_along(path, start_m), inside, point_along(path, end_m)])


def offset_path(path: FloatArray, offset_m: float) -> FloatArray:
    """Return the path moved sideways, to the left for a positive offset; meant for short, nearly straight paths."""
    direction = np.gradient(path, axis=0)
    direction /= np.hypot(direction[:, 0], direction[:, 1])[:, None]
    return path + offset_m * np.column_stack([-direction[:, 1], direction[:, 0]])


def spans_between(corners: FloatArray, span_m: float, generator: np.random.Generator) -> tuple[FloatArray, set[int]]:
    """Return nearly evenly spaced supports from corner to corner, and the indices of the corners."""
    points = [corners[0]]
    corner_indices = {0}
    for start, end in pairwise(corners):
        count = max(1, round(float(np.hypot(*(end - start))) / span_m))
        shares = np.arange(1, count) / count + generator.uniform(-0.09, 0.09, count - 1) / count
        points.extend(start + share * (end - start) for share in shares)
        points.append(end)
        corner_indices.add(len(points) - 1)
    return np.array(points), corner_indices
