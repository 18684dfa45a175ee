"""The table of all zones: areas, the heights above ground that they may reach, and when they apply."""

import math
from collections import OrderedDict
from datetime import datetime
from threading import Lock

import numpy as np
import shapely
from django.conf import settings
from django.contrib.gis.db.models.functions import AsWKB

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import NoFlyZone
from inspection.selectors.ground import ground_dataset_version
from inspection.selectors.terrain import grids_around, ground_heights_m, terrain_dataset_version
from inspection.terrain.heights import HeightGrid
from inspection.zones.reach import HeightLimits, ZoneTable, agl_band

MAX_TILES = 256  # of terrain under one zone, some 120 km square at 30 m; under a larger zone it counts as unknown
MAX_VOIDS = 10_000  # posts without a height under one zone that are searched in older models
KEPT_RANGES = 20_000
COLUMNS = ("pk", "name", "wkb", "lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "schedule")

GroundRange = tuple[float, float]
UNKNOWN: GroundRange = (math.nan, math.nan)

_lock = Lock()
_table: tuple[tuple[int, datetime | None], ZoneTable] | None = None
_ranges: OrderedDict[tuple[tuple[int | None, int], bytes], GroundRange] = OrderedDict()


def zone_table() -> ZoneTable:
    """Return the current zones. Costs one small query until they change."""
    return zone_table_of_version(ground_dataset_version())


def zone_table_of_version(key: tuple[int, datetime | None]) -> ZoneTable:
    """Return the zones of a dataset version that has just been read: they are at least as new."""
    global _table
    remembered = _table
    if remembered is None or remembered[0] != key or remembered[1].rules != settings.ZONE_RULES or key[1] is None:
        _table = remembered = key, _read()  # map data without a version were never marked as changed
    return remembered[1]


def _read() -> ZoneTable:
    rows = list(NoFlyZone.objects.annotate(wkb=AsWKB("geometry")).order_by("pk").values_list(*COLUMNS))
    wkb = tuple(bytes(row[2]) for row in rows)
    polygons = np.array(shapely.from_wkb(np.array(wkb, dtype=object)), dtype=object)
    limits = tuple(HeightLimits(*row[3:7]) for row in rows)
    terrain = terrain_dataset_version() if any(limit.needs_ground for limit in limits) else (None, 0)
    ranges = [
        _kept_range(terrain, code, polygon) if limit.needs_ground else UNKNOWN
        for code, polygon, limit in zip(wkb, polygons, limits, strict=True)
    ]
    bands = [agl_band(limit, *ground) for limit, ground in zip(limits, ranges, strict=True)]
    return ZoneTable(
        ids=np.array([row[0] for row in rows], dtype=np.int64),
        names=tuple(row[1] for row in rows),
        wkb=wkb,
        box=shapely.bounds(polygons).reshape(-1, 4),
        floor_agl_m=np.array([floor for floor, _ in bands], dtype=np.float64),
        ceiling_agl_m=np.array([ceiling for _, ceiling in bands], dtype=np.float64),
        limits=limits,
        schedules=tuple(row[7] for row in rows),
        rules=settings.ZONE_RULES,
    )


def _kept_range(terrain: tuple[int | None, int], wkb: bytes, polygon: shapely.MultiPolygon) -> GroundRange:
    """Return the range, cached per polygon and terrain: a new zone requires no terrain queries under the others."""
    key = terrain, wkb
    with _lock:
        if key in _ranges:
            _ranges.move_to_end(key)
            return _ranges[key]
    found = ground_range_m(polygon)
    with _lock:
        _ranges[key] = found
        while len(_ranges) > KEPT_RANGES:
            _ranges.popitem(last=False)
    return found


def ground_range_m(polygon: shapely.MultiPolygon) -> GroundRange:
    """Return the lowest and highest terrain above sea level [m] under a polygon's box, in any model; NaN if it is unknown anywhere.

    All posts of the models are read, and the terrain between posts is within their range: it can be too wide, but not too narrow.
    """
    if polygon.is_empty:
        return UNKNOWN
    grids = grids_around(polygon.bounds, MAX_TILES)
    if not grids or not _are_under_all_of(grids, polygon):
        return UNKNOWN
    lowest, highest = math.inf, -math.inf
    voids = [np.zeros((0, 2))]
    for grid in grids:
        heights, positions = _posts(grid, polygon.bounds)
        if np.isnan(heights).any():
            voids.append(positions[np.isnan(heights).ravel()])
        known = heights[~np.isnan(heights)]
        if len(known):
            lowest, highest = min(lowest, float(known.min())), max(highest, float(known.max()))
    unknown = np.concatenate(voids)
    if len(unknown):
        unknown = unknown[shapely.intersects_xy(polygon, unknown)]
    if len(unknown) > MAX_VOIDS or np.isnan(ground_heights_m(unknown)).any() or lowest > highest:
        return UNKNOWN
    return lowest, highest


def _are_under_all_of(grids: list[HeightGrid], polygon: shapely.MultiPolygon) -> bool:
    """Whether the grids, each half a step wider than its outermost posts, cover the whole polygon."""
    extents = np.array([grid.extent for grid in grids])
    half = np.array([[grid.step_lon_deg, grid.step_lat_deg] for grid in grids]) * 0.501
    covered = shapely.union_all(
        shapely.box(extents[:, 0] - half[:, 0], extents[:, 1] - half[:, 1], extents[:, 2] + half[:, 0], extents[:, 3] + half[:, 1])
    )
    return bool(shapely.covers(covered, polygon))


def _posts(grid: HeightGrid, box: tuple[float, float, float, float]) -> tuple[FloatArray, FloatArray]:
    """Return heights (rows, columns) of the posts in the box and of those around it, and their positions (rows * columns, 2)."""
    west, south, east, north = box
    rows, columns = grid.heights_m.shape
    left, right = math.floor((west - grid.west_deg) / grid.step_lon_deg), math.ceil((east - grid.west_deg) / grid.step_lon_deg)
    top, bottom = math.floor((grid.north_deg - north) / grid.step_lat_deg), math.ceil((grid.north_deg - south) / grid.step_lat_deg)
    across = np.arange(min(max(left, 0), columns), min(max(right + 1, 0), columns))
    down = np.arange(min(max(top, 0), rows), min(max(bottom + 1, 0), rows))
    lon, lat = np.meshgrid(grid.west_deg + across * grid.step_lon_deg, grid.north_deg - down * grid.step_lat_deg)
    return grid.heights_m[np.ix_(down, across)].astype(np.float64), np.column_stack([lon.ravel(), lat.ravel()])
