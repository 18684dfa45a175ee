"""GeoPackage 1.3 (OGC 12-128r17): an SQLite file with a table of features for each layer."""

import sqlite3
import struct
from collections.abc import Iterable
from datetime import datetime
from itertools import groupby, islice
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from pyproj import CRS

from inspection.exporters.rows import Columns, ExportRow

APPLICATION_ID = 0x47504B47  # "GPKG"
USER_VERSION = 10300
WGS84 = 4326
HEAD = b"GP\x00\x01" + struct.pack("<i", WGS84)  # little endian, no envelope
BATCH = 1_000
_TYPES = {"Point": "POINT", "LineString": "LINESTRING", "MultiPolygon": "MULTIPOLYGON"}
_SCHEMA = """
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL,
    organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
    description TEXT DEFAULT '', last_change DATETIME NOT NULL, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
    srs_id INTEGER REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL PRIMARY KEY REFERENCES gpkg_contents(table_name),
    column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL REFERENCES gpkg_spatial_ref_sys(srs_id),
    z TINYINT NOT NULL, m TINYINT NOT NULL);
"""


def write_geopackage(path: Path, rows: Iterable[ExportRow], columns: Columns, written_at: datetime) -> None:
    """Write a new file. The rows of a layer have one type of geometry and follow each other. written_at: in UTC."""
    database = sqlite3.connect(path)
    try:
        database.executescript(f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {USER_VERSION};{_SCHEMA}")
        database.executemany("INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, NULL)", [
            ("WGS 84 geodetic", WGS84, "EPSG", WGS84, CRS(WGS84).to_wkt("WKT1_GDAL")),
            ("Undefined cartesian SRS", -1, "NONE", -1, "undefined"),
            ("Undefined geographic SRS", 0, "NONE", 0, "undefined"),
        ])  # fmt: skip
        for layer, of_layer in groupby(rows, key=lambda row: row.layer):
            _write_layer(database, layer, of_layer, columns, written_at)
        database.commit()
    finally:
        database.close()


def _write_layer(database: sqlite3.Connection, layer: str, rows: Iterable[ExportRow], columns: Columns, written_at: datetime) -> None:
    stated = ", ".join(f'"{name}" {kind}' for name, kind in columns.items())
    database.execute(f'CREATE TABLE "{layer}" (fid INTEGER PRIMARY KEY, geom BLOB, {stated})')
    marks = ", ".join("?" * (len(columns) + 2))
    bounds, geometry_type, rest = np.array([np.inf, np.inf, -np.inf, -np.inf]), "GEOMETRY", iter(rows)
    while batch := list(islice(rest, BATCH)):
        shapes = [_single_type(shape) for shape in shapely.from_geojson([row.geometry for row in batch])]
        geometry_type = _TYPES[shapes[0].geom_type]
        west, south, east, north = shapely.total_bounds(shapes)
        bounds = np.array([min(bounds[0], west), min(bounds[1], south), max(bounds[2], east), max(bounds[3], north)])
        database.executemany(f'INSERT INTO "{layer}" VALUES ({marks})', (  # noqa: S608 - a layer of ours
            (row.key, HEAD + wkb, *(row.values.get(name) for name in columns))
            for row, wkb in zip(batch, shapely.to_wkb(shapes, byte_order=1), strict=True)
        ))  # fmt: skip
    contents = (layer, "features", layer, "", written_at.strftime("%Y-%m-%dT%H:%M:%S.000Z"), *map(float, bounds), WGS84)
    database.execute("INSERT INTO gpkg_contents VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", contents)
    database.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 0, 0)", (layer, geometry_type, WGS84))


def _single_type(shape: Any) -> Any:
    """Return areas as MultiPolygon, so that a layer has one type of geometry."""
    return shapely.MultiPolygon([shape]) if shape.geom_type == "Polygon" else shape
