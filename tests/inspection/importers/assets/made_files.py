"""Asset files of each format, made for a test."""

import json
import sqlite3
import struct
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import shapefile
import shapely
from pyproj import CRS

TOWERS = [("T1", 45.5, (7.4386, 46.9511)), ("T2", 38.0, (7.4426, 46.9511))]  # near Bern, in LV95 about 2600000, 1200000


def point(lon: float, lat: float) -> dict[str, Any]:
    return {"type": "Point", "coordinates": [lon, lat]}


def line(*positions: Sequence[float]) -> dict[str, Any]:
    return {"type": "LineString", "coordinates": [list(position) for position in positions]}


def geojson(path: Path, *rows: tuple[dict[str, Any], dict[str, Any] | None], **members: Any) -> Path:
    features = [{"type": "Feature", "properties": properties, "geometry": geometry} for properties, geometry in rows]
    path.write_text(json.dumps({"type": "FeatureCollection", **members, "features": features}))
    return path


def kml(path: Path, body: str, head: str = "") -> Path:
    path.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>{head}<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{body}</Document></kml>'
    )
    return path


def placemark(name: str, geometry: str, **data: str) -> str:
    facts = "".join(f'<Data name="{key}"><value>{value}</value></Data>' for key, value in data.items())
    return f"<Placemark><name>{name}</name><ExtendedData>{facts}</ExtendedData>{geometry}</Placemark>"


def zipped(path: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def shapefile_members(
    folder: Path, rows: Iterable[tuple[str, float, tuple[float, float]]] = TOWERS, *, crs: str | None = "EPSG:4326", encoding: str = "utf-8"
) -> dict[str, bytes]:
    """Towers as points with the columns ref and hoehe."""
    with shapefile.Writer(str(folder / "made"), shapeType=shapefile.POINT, encoding=encoding) as writer:
        writer.field("ref", "C", 20)
        writer.field("hoehe", "N", 8, 1)
        for ref, height_m, position in rows:
            writer.point(*position)
            writer.record(ref, height_m)
    members = {f"towers.{ending}": (folder / f"made.{ending}").read_bytes() for ending in ("shp", "shx", "dbf")}
    for ending in ("shp", "shx", "dbf"):
        (folder / f"made.{ending}").unlink()
    if crs is not None:
        members["towers.prj"] = CRS(crs).to_wkt("WKT1_ESRI").encode()
    return members


def gpkg_blob(wkb: bytes, system: int = 4326) -> bytes:
    return b"GP\x00\x01" + struct.pack("<i", system) + wkb


def geopackage(path: Path, rows: Iterable[tuple[str, bytes | None]] = (), *, system: int = 4326, statements: Iterable[str] = ()) -> Path:
    """A layer "towers" with the columns fid, geom and ref; statements are run at the end."""
    rows = list(rows) or [(ref, gpkg_blob(shapely.to_wkb(shapely.Point(position)), system)) for ref, _, position in TOWERS]
    database = sqlite3.connect(path)
    database.executescript(
        """
        PRAGMA application_id = 1196444487;
        CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER PRIMARY KEY, organization TEXT, organization_coordsys_id INTEGER,
                                           definition TEXT);
        CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT, identifier TEXT, srs_id INTEGER);
        CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, geometry_type_name TEXT, srs_id INTEGER, z INTEGER,
                                            m INTEGER);
        CREATE TABLE towers (fid INTEGER PRIMARY KEY, geom BLOB, ref TEXT);
        INSERT INTO gpkg_spatial_ref_sys VALUES ('WGS 84', 4326, 'EPSG', 4326, ''), ('LV95', 2056, 'EPSG', 2056, ''),
                                                ('undefined', -1, 'NONE', -1, 'undefined');
        """
    )
    database.execute("INSERT INTO gpkg_contents VALUES ('towers', 'features', 'towers', ?)", (system,))
    database.execute("INSERT INTO gpkg_geometry_columns VALUES ('towers', 'geom', 'POINT', ?, 0, 0)", (system,))
    database.executemany("INSERT INTO towers (ref, geom) VALUES (?, ?)", rows)
    for statement in statements:
        database.execute(statement)
    database.commit()
    database.close()
    return path
