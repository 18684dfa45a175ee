"""Files in formats that GDAL writes, made for a test by GDAL itself."""

import ctypes
import json
import zipfile
from pathlib import Path
from typing import Any

from django.contrib.gis.gdal.libgdal import lgdal

POINTS = [("T1", 45.5, 1, "2024-02-03", (2600000.0, 1200000.0)), ("Tü2", 38.0, 2, "2025-01-01", (2600300.0, 1200000.0))]
BERN = (7.438632, 46.951083)  # the first of them; swisstopo: 7°26'19.08", 46°57'03.9"


def feature(geometry: dict[str, Any] | None, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def towers() -> list[dict[str, Any]]:
    return [
        feature({"type": "Point", "coordinates": position}, ref=ref, hoehe=height_m, n=number, built=built)
        for ref, height_m, number, built, position in POINTS
    ]


def translated(path: Path, driver: str, features: list[dict[str, Any]], *, system: str = "EPSG:2056") -> Path:
    """Write features with the driver; a geodatabase is a folder. system: empty if the file states none."""
    source = path.with_suffix(".source.geojson")
    source.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    gdal = ctypes.CDLL(lgdal._name)  # functions of its own, without Django's checks
    gdal.GDALAllRegister()
    for name in ("GDALVectorTranslateOptionsNew", "GDALOpenEx", "GDALVectorTranslate"):
        getattr(gdal, name).restype = ctypes.c_void_p
    stated = ctypes.c_void_p(
        gdal.GDALVectorTranslateOptionsNew(_strings(["-f", driver, "-a_srs", system or "NONE", "-nln", "towers"]), None)
    )
    opened = ctypes.c_void_p(gdal.GDALOpenEx(str(source).encode(), 4, None, None, None))
    made = ctypes.c_void_p(gdal.GDALVectorTranslate(str(path).encode(), None, 1, (ctypes.c_void_p * 1)(opened), stated, None))
    assert made, f"GDAL does not write {driver}"
    for data_set in (made, opened):
        gdal.GDALClose(data_set)
    gdal.GDALVectorTranslateOptionsFree(stated)
    source.unlink()
    return path


def geodatabase(path: Path, features: list[dict[str, Any]], *, folder: str = "grid.gdb/", system: str = "EPSG:2056") -> Path:
    made = translated(path.with_suffix(".gdb"), "OpenFileGDB", features, system=system)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member in sorted(made.iterdir()):
            archive.write(member, f"{folder}{member.name}")
    return path


def gml(path: Path, members: str, head: str = "") -> Path:
    path.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>{head}<f:FeatureCollection xmlns:f="http://example.org/f" '
        f'xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:gml="http://www.opengis.net/gml/3.2">{members}</f:FeatureCollection>'
    )
    return path


def gml_member(geometry: str, ref: str = "T1") -> str:
    return f'<gml:featureMember><f:tower gml:id="{ref}"><f:ref>{ref}</f:ref><f:geom>{geometry}</f:geom></f:tower></gml:featureMember>'


def gml_point(position: str = "8 47", system: str = "http://www.opengis.net/def/crs/OGC/1.3/CRS84") -> str:
    return f'<gml:Point srsName="{system}"><gml:pos>{position}</gml:pos></gml:Point>'


def dxf(path: Path, entities: str, blocks: str = "") -> Path:
    """entities and blocks: codes and values, separated by blanks."""
    text = f"0 SECTION 2 HEADER 0 ENDSEC 0 SECTION 2 BLOCKS {blocks} 0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    path.write_text("\n".join(text.split()) + "\n")
    return path


def _strings(values: list[str]) -> Any:
    return (ctypes.c_char_p * (len(values) + 1))(*(value.encode() for value in values), None)
