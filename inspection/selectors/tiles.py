"""Vector tiles: one SQL statement makes all layers of a tile."""

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from django.contrib.gis.db.models import GeometryField
from django.contrib.gis.geos import Polygon
from django.core.cache import cache
from django.db import connection
from django.db.models import BinaryField, F, FloatField, Func, QuerySet, Value
from django.utils.translation import get_language

from inspection.models import AssetKind
from inspection.selectors.asset_names import DETAIL_SQL, LABEL_SQL, LINE_VOLTAGE_V, VOLTAGES_SQL, sql_words
from inspection.selectors.ground import DatasetVersion, ground_dataset_version, ground_extent
from workspace.cache_unavailable import CACHE_UNAVAILABLE

LAST_KEPT_ZOOM = 11
KEPT_S = 3_600
MAX_ZOOM = 22
RECIPE = 7  # part of the ETag: incremented when this file's statements change
EXTENT = 4096
BUFFER = 64  # in units of the extent
MERCATOR_LIMIT_M = 20_037_508.342789244  # half of the equator of EPSG:3857
# Zoom levels from which objects are in the tiles: ui.md section 6. A tile of zoom z serves the map up to z + 1.
ALL_VOLTAGES_ZOOM = 10
MEDIUM_VOLTAGE_ZOOM, MEDIUM_VOLTAGE_V = 8, 50_000
HIGH_VOLTAGE_V = 100_000
RAILWAY_ZOOM = 8
BRIDGE_ZOOM = 10
TOWER_ZOOM = 10
OUT_OF_USE_ZOOM = 13  # underground, disused, busbars and bays
ZONE_LABEL_ZOOM = 9
LAST_COUNT_ZOOM = 7  # up to here cells of a tile say how many assets they have that it does not draw
COUNT_CELLS = 4  # along a side of a tile
SMALL_REGION_PX, TILE_PX = 120, 512  # static/js/domain/regions.js
MAX_SCHEDULE_LENGTH = 4_000  # characters; a tile omits longer schedules
MAX_FEATURES = 20_000  # of a layer in one tile; the most important ones stay
MAX_FEATURES_FAR = ((4, 1_500), (7, 3_500))  # up to a zoom: more would add no information, and make tiles slow and large
TOWERS = """inspection_asset LEFT JOIN (
    SELECT id AS own_id, max_voltage_v AS line_voltage_v,
           COALESCE(NULLIF(ref, ''), NULLIF(name, ''), NULLIF(operator, '')) AS line_owner
    FROM inspection_asset
) line ON own_id = line_id"""
ZONE_COLUMNS = f"""
    id AS feature_id, id, name, name AS label, NULLIF(restriction, '') AS restriction, NULLIF(reason, '') AS reason,
    lower_limit_m, NULLIF(lower_reference, '') AS lower_reference, upper_limit_m, NULLIF(upper_reference, '') AS upper_reference,
    (ST_XMax(geometry) - ST_XMin(geometry))::float8 AS width_deg,
    CASE WHEN LENGTH(schedule::text) <= {MAX_SCHEDULE_LENGTH} THEN schedule::text END AS schedule
"""
ON_GROUND = "vanished_at IS NULL AND (is_flyable OR %(zoom)s >= %(out_of_use_zoom)s)"
SIMPLIFIED = "ST_Simplify(geometry, %(tolerance_deg)s, true)"


def tiles_version(version: DatasetVersion | None = None) -> str:
    """Return a text that differs after each change of the map data and for each language: the pages' maps have it in tiles' addresses."""
    revision, changed_at = version or ground_dataset_version()
    return f"{revision}-{changed_at.timestamp() if changed_at else 0:.6f}-{RECIPE}-{get_language()}"


def map_data() -> dict[str, Any]:
    """Return what a page with a map needs of the map data: their extent, and the version of the tiles."""
    return {"extent": ground_extent(), "tiles": tiles_version()}


def tile_of_version(zoom: int, column: int, row: int, dataset_version: str | None) -> bytes:
    """Return the tile of the current map data in the reader's language. Raises NoSuchTile.

    `dataset_version` is a text that differs after each change of the map data and for each language; None disables the cache.
    """
    if dataset_version is None or zoom > LAST_KEPT_ZOOM:
        return vector_tile(zoom, column, row)
    key = f"tile:{dataset_version}:{zoom}/{column}/{row}"
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        if (kept := cache.get(key)) is not None:
            return bytes(kept)
    tile = vector_tile(zoom, column, row)
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        cache.set(key, tile, KEPT_S)
    return tile


def _asset_columns(kind: AssetKind, voltage_v: str = "max_voltage_v") -> str:
    return f"""
        id AS feature_id, id, kind, NULLIF(subtype, '') AS subtype, {LABEL_SQL} AS label, {DETAIL_SQL[kind]} AS detail,
        NULLIF(ref, '') AS ref, NULLIF(name, '') AS name, NULLIF(operator, '') AS operator, is_flyable AS flyable,
        ({voltage_v} / 1000.0)::float8 AS voltage, {VOLTAGES_SQL} AS voltages,
        CASE WHEN kind IN ('line', 'railway') THEN ROUND(length_m)::int END AS length_m
    """


LINE_COLUMNS, RAILWAY_COLUMNS, BRIDGE_COLUMNS = map(_asset_columns, (AssetKind.LINE, AssetKind.RAILWAY, AssetKind.BRIDGE))
TOWER_COLUMNS = (
    f"{_asset_columns(AssetKind.TOWER, LINE_VOLTAGE_V)}, line_id AS line"  # its line determines from which zoom a tower is drawn
)


@dataclass(frozen=True)
class Layer:
    name: str
    from_zoom: int
    columns: str
    source: str  # table and condition
    shape: str  # the drawn geometry, in EPSG:4326
    found_by: str  # indexed column compared with the tile's box
    order: str  # most important first


LAYERS = (
    Layer(
        "lines", 0, LINE_COLUMNS,
        f"""inspection_asset WHERE kind = 'line' AND {ON_GROUND} AND (
            %(zoom)s >= {ALL_VOLTAGES_ZOOM} OR max_voltage_v >= %(least_voltage_v)s
            OR (max_voltage_v IS NULL AND subtype = 'line' AND %(zoom)s >= {MEDIUM_VOLTAGE_ZOOM}))""",
        SIMPLIFIED, "geometry", "max_voltage_v DESC NULLS LAST, inspection_asset.length_m DESC NULLS LAST",
    ),
    Layer("railways", RAILWAY_ZOOM, RAILWAY_COLUMNS, f"inspection_asset WHERE kind = 'railway' AND {ON_GROUND}", SIMPLIFIED, "geometry",
          "inspection_asset.length_m DESC NULLS LAST"),
    Layer("bridges", BRIDGE_ZOOM, BRIDGE_COLUMNS, f"inspection_asset WHERE kind = 'bridge' AND {ON_GROUND}", "geometry", "geometry", "id"),
    Layer("bridge_points", BRIDGE_ZOOM, BRIDGE_COLUMNS, f"inspection_asset WHERE kind = 'bridge' AND {ON_GROUND}", "centre", "centre",
          "id"),
    Layer("towers", TOWER_ZOOM, TOWER_COLUMNS, f"{TOWERS} WHERE kind = 'tower' AND {ON_GROUND}", "centre", "centre",
          f"{LINE_VOLTAGE_V} DESC NULLS LAST, id"),
    Layer("zones", 0, ZONE_COLUMNS, "inspection_noflyzone WHERE true", "geometry", "geometry", "ST_Area(geometry) DESC"),
    Layer("zone_labels", ZONE_LABEL_ZOOM, ZONE_COLUMNS, "inspection_noflyzone WHERE true", "ST_PointOnSurface(geometry)", "geometry", "id"),
)  # fmt: skip


# Numbers of the assets that a far tile does not draw. A region that is smaller on the screen is a dot with its numbers, drawn by the page.
# Each cell counts what is within the tile only, so that nothing is counted by two tiles.
_COUNTS_SQL = f"""COALESCE((
    SELECT ST_AsMVT(feature, 'counts', {EXTENT}, 'geom') FROM (
        SELECT count, ST_AsMVTGeom(
            ST_Transform(place, 3857), ST_TileEnvelope(%(zoom)s, %(column)s, %(row)s), {EXTENT}, {BUFFER}, true) AS geom
        FROM (
            SELECT COUNT(*)::int AS count, ST_SetSRID(ST_MakePoint(AVG(ST_X(centre)), AVG(ST_Y(centre))), 4326) AS place
            FROM inspection_asset asset
            LEFT JOIN inspection_dataimport source ON source.id = asset.data_import_id
            LEFT JOIN inspection_region region ON region.id = source.region_id
            WHERE vanished_at IS NULL AND is_flyable
              AND NOT COALESCE(asset.kind = 'line' AND max_voltage_v >= %(least_voltage_v)s, false)
              AND (region.id IS NULL OR ST_XMax(region.extent) - ST_XMin(region.extent) >= %(small_deg)s)
              AND centre && ST_MakeEnvelope(%(inner_west)s, %(inner_south)s, %(inner_east)s, %(inner_north)s, 4326)
            GROUP BY FLOOR(ST_X(centre) / %(cell_deg)s), FLOOR(ST_Y(centre) / %(cell_deg)s)
        ) counted
    ) feature WHERE geom IS NOT NULL), '')"""  # noqa: S608 - made of the constants above only


class NoSuchTile(Exception):
    """Raised for an address outside the pyramid of tiles."""


def _check_address(zoom: int, column: int, row: int) -> None:
    if not (0 <= zoom <= MAX_ZOOM and 0 <= column < 2**zoom and 0 <= row < 2**zoom):
        raise NoSuchTile


def tile_of_rows(rows: QuerySet[Any], layer: str, fields: Sequence[str], zoom: int, column: int, row: int) -> bytes:
    """Return the vector tile with one layer of the first rows, each with its `shape` [EPSG:4326] and these fields. Raises NoSuchTile."""
    _check_address(zoom, column, row)
    tolerance_deg = Value(_tolerance_deg(zoom), output_field=FloatField())
    simple = Func(F("shape"), tolerance_deg, Value(True), function="ST_Simplify", output_field=GeometryField())
    drawn = Func(
        Func(simple, Value(3857), function="ST_Transform", output_field=GeometryField()),
        Func(Value(zoom), Value(column), Value(row), function="ST_TileEnvelope", output_field=GeometryField()),
        Value(EXTENT), Value(BUFFER), Value(True),
        function="ST_AsMVTGeom", output_field=BinaryField(),
    )  # fmt: skip
    sql, parameters = rows.annotate(geom=drawn).values(*fields, "geom")[: _max_features(zoom)].query.sql_with_params()
    with connection.cursor() as cursor:
        cursor.execute(
            f"SELECT ST_AsMVT(feature, %s, {EXTENT}, 'geom') FROM ({sql}) feature WHERE geom IS NOT NULL",  # noqa: S608 - made by Django
            [layer, *parameters],
        )
        return bytes(cursor.fetchone()[0])


def box_of_tile(zoom: int, column: int, row: int) -> Polygon:
    """Return the tile with its buffer, EPSG:4326. Raises NoSuchTile."""
    _check_address(zoom, column, row)
    box = Polygon.from_bbox(_box_deg(zoom, column, row))
    box.srid = 4326
    return box


def _max_features(zoom: int) -> int:
    return next((most for last_zoom, most in MAX_FEATURES_FAR if zoom <= last_zoom), MAX_FEATURES)


def _tolerance_deg(zoom: int) -> float:
    return 360 / 2**zoom / EXTENT * 4  # half a pixel of a 512 pixel tile


def vector_tile(zoom: int, column: int, row: int) -> bytes:
    """Return the Mapbox vector tile; empty where there is nothing. Raises NoSuchTile."""
    _check_address(zoom, column, row)
    layers = [layer for layer in LAYERS if zoom >= layer.from_zoom]
    west, south, east, north = _box_deg(zoom, column, row)
    inner = _box_deg(zoom, column, row, buffer=0)
    least_voltage_v = HIGH_VOLTAGE_V if zoom < MEDIUM_VOLTAGE_ZOOM else MEDIUM_VOLTAGE_V
    with connection.cursor() as cursor:
        cursor.execute(
            "SELECT " + " || ".join([*map(_layer_sql, layers), *([_COUNTS_SQL] if zoom <= LAST_COUNT_ZOOM else [])]),
            {
                "cell_deg": 360 / 2**zoom / COUNT_CELLS, "small_deg": SMALL_REGION_PX * 360 / TILE_PX / 2**zoom,
                "inner_west": inner[0], "inner_south": inner[1], "inner_east": inner[2], "inner_north": inner[3],
                "zoom": zoom, "column": column, "row": row, "west": west, "south": south, "east": east, "north": north,
                "tolerance_deg": _tolerance_deg(zoom),
                "most": _max_features(zoom),
                "least_voltage_v": least_voltage_v, "out_of_use_zoom": OUT_OF_USE_ZOOM, **sql_words(),
            },
        )  # fmt: skip
        return bytes(cursor.fetchone()[0])


def _layer_sql(layer: Layer) -> str:
    return f"""COALESCE((
        SELECT ST_AsMVT(feature, '{layer.name}', {EXTENT}, 'geom', 'feature_id') FROM (
            SELECT * FROM (
                SELECT {layer.columns}, ST_AsMVTGeom(
                    ST_Transform({layer.shape}, 3857), ST_TileEnvelope(%(zoom)s, %(column)s, %(row)s), {EXTENT}, {BUFFER}, true) AS geom
                FROM {layer.source} AND {layer.found_by} && ST_MakeEnvelope(%(west)s, %(south)s, %(east)s, %(north)s, 4326)
                ORDER BY {layer.order} LIMIT %(most)s
            ) drawn WHERE geom IS NOT NULL
        ) feature), '')"""  # noqa: S608 - made of the constants above only


def _box_deg(zoom: int, column: int, row: int, buffer: int = BUFFER) -> tuple[float, float, float, float]:
    """Return west, south, east, north of the tile with a buffer in units of the extent, in degrees."""
    size_m = 2 * MERCATOR_LIMIT_M / 2**zoom
    margin_m = size_m * buffer / EXTENT
    west_m = column * size_m - MERCATOR_LIMIT_M
    north_m = MERCATOR_LIMIT_M - row * size_m
    west, south = _lon_lat_deg(west_m - margin_m, north_m - size_m - margin_m)
    east, north = _lon_lat_deg(west_m + size_m + margin_m, north_m + margin_m)
    return max(west, -180.0), south, min(east, 180.0), north


def _lon_lat_deg(x_m: float, y_m: float) -> tuple[float, float]:
    radius_m = MERCATOR_LIMIT_M / math.pi
    return math.degrees(x_m / radius_m), math.degrees(2 * math.atan(math.exp(y_m / radius_m)) - math.pi / 2)
