"""The terrain models in use: extents, resolutions, and precedence where several overlap."""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, radians
from typing import Any

from django.contrib.gis.db.models import Extent, Union
from django.contrib.gis.db.models.functions import SnapToGrid
from django.contrib.gis.geos import GEOSGeometry, Polygon
from django.db.models import Max, Min

from inspection.models import DataImport, ImportKind
from inspection.selectors.ground import ground_dataset_version

DEGREE_M = 111_320.0  # of latitude, and of longitude at the equator
USUAL_STEP_M = 30.0  # without a model
_SNAP_DEG = 1e-7  # edges of neighbouring tiles are equal except for rounding


@dataclass(frozen=True)
class TerrainModel:
    """One file. Where several overlap the newest counts, and older ones fill its voids."""

    data_import: DataImport
    footprint: GEOSGeometry  # of its blocks that have heights
    extent: tuple[float, float, float, float]  # west, south, east, north [deg]
    vertical_datum: str
    resolution_m: float
    over: tuple[int, ...]  # older models under parts of it
    step_at: tuple[str, ...]  # other vertical datums where it meets or covers another model


def terrain_models() -> list[TerrainModel]:
    """Return the models, newest first, in order of precedence."""
    return list(_models(ground_dataset_version()))


def model_of(data_import: int) -> TerrainModel | None:
    return next((model for model in terrain_models() if model.data_import.pk == data_import), None)


def finest_step_m(box: tuple[float, float, float, float]) -> float:
    """Return half the post distance of the finest model that touches a box: denser samples add no information."""
    west, south, east, north = box
    steps = [
        model.resolution_m / 2
        for model in terrain_models()
        if model.extent[0] <= east and model.extent[2] >= west and model.extent[1] <= north and model.extent[3] >= south
    ]
    return min(steps, default=USUAL_STEP_M)


@lru_cache(maxsize=2)
def _models(dataset_version: object) -> tuple[TerrainModel, ...]:
    """Return the models of this dataset version."""
    rows = (
        DataImport.objects.filter(kind=ImportKind.TERRAIN, terrain_tiles__isnull=False)
        .annotate(
            extent=Extent("terrain_tiles__extent"),
            footprint=Union(SnapToGrid("terrain_tiles__extent", _SNAP_DEG)),
            datum=Max("terrain_tiles__vertical_datum"),
            step_lat=Min("terrain_tiles__step_lat_deg"),
            step_lon=Min("terrain_tiles__step_lon_deg"),
            newest=Max("terrain_tiles__pk"),
        )
        .order_by("-newest")
    )
    return tuple(_model(row, place, list(rows)) for place, row in enumerate(rows))


def _model(row: Any, place: int, rows: list[Any]) -> TerrainModel:
    middle = radians((row.extent[1] + row.extent[3]) / 2)
    step_m = max(row.step_lat * DEGREE_M, row.step_lon * DEGREE_M * cos(middle))
    around = Polygon.from_bbox(row.extent).buffer(2 * row.step_lat)
    return TerrainModel(
        data_import=row,
        footprint=row.footprint,
        extent=row.extent,
        vertical_datum=row.datum,
        resolution_m=step_m,
        over=tuple(other.pk for other in rows[place + 1 :] if other.footprint.intersection(row.footprint).area > 0),
        step_at=tuple(sorted({other.datum for other in rows if other.datum != row.datum and other.footprint.intersects(around)})),
    )
