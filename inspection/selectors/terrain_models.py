"""The terrain models in use: where they reach, how fine they are, and which of them counts at a place."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, radians

from django.contrib.gis.db.models import Extent
from django.contrib.gis.geos import Point
from django.db.models import Max, Min, Sum

from inspection.geodesy import LonLat
from inspection.models import DataImport, ImportKind, TerrainTile

DEGREE_M = 111_320.0  # of latitude, and of longitude at the equator


@dataclass(frozen=True)
class TerrainModel:
    """One file. Of several at a place the newest counts, and an older one fills its voids."""

    data_import: DataImport
    extent: tuple[float, float, float, float]  # west, south, east, north [deg]
    vertical_datum: str
    resolution_m: float
    tiles: int


def terrain_models() -> list[TerrainModel]:
    """Newest first: what counts on top."""
    imports = (
        DataImport.objects.filter(kind=ImportKind.TERRAIN, terrain_tiles__isnull=False)
        .annotate(
            extent=Extent("terrain_tiles__extent"), datum=Max("terrain_tiles__vertical_datum"), step_lat=Min("terrain_tiles__step_lat_deg"),
            step_lon=Min("terrain_tiles__step_lon_deg"), newest=Max("terrain_tiles__pk"), tiles=Sum("terrain_tiles__rows"),
        )
        .order_by("-newest")
    )  # fmt: skip
    return [_model(row) for row in imports]


def model_at(position: LonLat) -> TerrainTile | None:
    """The newest tile that reaches over the position."""
    place = Point(position.lon, position.lat, srid=4326)
    return (
        TerrainTile.objects.select_related("data_import").defer("heights_amsl_m").filter(extent__intersects=place).order_by("-pk").first()
    )


def datums_along(extent: Iterable[float]) -> list[str]:
    """The vertical datums of the models that touch a box; more than one means that heights of different zero points meet."""
    west, south, east, north = extent
    tiles = TerrainTile.objects.filter(extent__bboverlaps=_box(west, south, east, north))
    return sorted(set(tiles.values_list("vertical_datum", flat=True).order_by()))


def _box(west: float, south: float, east: float, north: float):  # type: ignore[no-untyped-def]
    box = Point(west, south, srid=4326).union(Point(east, north, srid=4326)).envelope
    box.srid = 4326
    return box


def _model(row: DataImport) -> TerrainModel:
    middle = radians((row.extent[1] + row.extent[3]) / 2)
    step_m = max(row.step_lat * DEGREE_M, row.step_lon * DEGREE_M * cos(middle))
    return TerrainModel(row, row.extent, row.datum, step_m, row.tiles)
