"""Features of one layer as lines of JSON: first the layer, then a list for each feature, then their number."""

import base64
import ctypes
from collections.abc import Callable
from typing import Any

from inspection.importers.gdal_child.libgdal import Gdal, Unreadable

MAX_LAYERS = 100
_NO_GEOMETRY = 100  # wkbNone
_LITTLE_ENDIAN = 1
_INTEGER, _REAL, _BINARY, _DATE, _DATE_TIME, _INTEGER64 = 0, 2, 8, 9, 11, 12  # OGRFieldType
_LISTS = (1, 3, 5, 13)
_BOOLEAN = 1  # OGRFieldSubType
_HIDDEN_LAYERS = {"blocks"}  # of DXF: the drawings that the entities of "entities" refer to

Report = Callable[[Any], None]


def report_features(gdal: Gdal, data_set: Any, wanted: str, most: int, report: Report) -> None:
    """Report the layer that is wanted, else the first one, and at most `most` of its features. Raises Unreadable."""
    layers = _layers(gdal, data_set)
    if not layers:
        raise Unreadable(gdal.failure() or "no layer has geometries")
    name = wanted if wanted in layers else next(iter(layers))
    layer = layers[name]
    system = gdal.OGR_L_GetSpatialRef(layer)
    fields = _fields(gdal, layer)
    report({"layer": name, "layers": list(layers), "columns": [field for field, _, _ in fields], "wkt": gdal.wkt(system)})
    number = 0
    if most:
        while feature := gdal.OGR_L_GetNextFeature(layer):
            report([_geometry(gdal, feature, system), *(_value(gdal, feature, index, kind) for _, index, kind in fields)])
            gdal.OGR_F_Destroy(feature)
            number += 1
            if number == most:
                break
    if failure := gdal.failure():
        raise Unreadable(failure)
    report({"features": number})


def _layers(gdal: Gdal, data_set: Any) -> dict[str, Any]:
    found = (gdal.GDALDatasetGetLayer(data_set, number) for number in range(min(gdal.GDALDatasetGetLayerCount(data_set), MAX_LAYERS)))
    named = {_text(gdal.OGR_L_GetName(layer)): layer for layer in found if gdal.OGR_L_GetGeomType(layer) != _NO_GEOMETRY}
    return {name: layer for name, layer in named.items() if name not in _HIDDEN_LAYERS or len(named) == 1}


def _fields(gdal: Gdal, layer: Any) -> list[tuple[str, int, int]]:
    """Return name, index and type of the fields; a type of -1 is a boolean."""
    definition = gdal.OGR_L_GetLayerDefn(layer)
    found = []
    for index in range(gdal.OGR_FD_GetFieldCount(definition)):
        field = gdal.OGR_FD_GetFieldDefn(definition, index)
        kind = -1 if gdal.OGR_Fld_GetSubType(field) == _BOOLEAN else gdal.OGR_Fld_GetType(field)
        if kind != _BINARY:
            found.append((_text(gdal.OGR_Fld_GetNameRef(field)), index, kind))
    return found


def _value(gdal: Gdal, feature: Any, index: int, kind: int) -> Any:
    if not gdal.OGR_F_IsFieldSetAndNotNull(feature, index):
        return None
    if kind in (_INTEGER, _INTEGER64):
        return gdal.OGR_F_GetFieldAsInteger64(feature, index)
    if kind == _REAL:
        return gdal.OGR_F_GetFieldAsDouble(feature, index)
    if kind == -1:
        return bool(gdal.OGR_F_GetFieldAsInteger64(feature, index))
    text = _text(gdal.OGR_F_GetFieldAsString(feature, index))
    if kind in _LISTS:  # "(3:1,1,1)"
        return text.partition(":")[2].removesuffix(")")
    return text.replace("/", "-") if kind in (_DATE, _DATE_TIME) else text


def _geometry(gdal: Gdal, feature: Any, system: Any) -> str | bool | None:
    """Return the geometry as WKB in base 64; None without one; False if it is in another system than its layer."""
    geometry = gdal.OGR_F_GetGeometryRef(feature)
    if not geometry:
        return None
    own = gdal.OGR_G_GetSpatialReference(geometry)
    if own and own != system and not (system and gdal.OSRIsSame(own, system)):
        return False
    if gdal.OGR_G_HasCurveGeometry(geometry, False) and not gdal.OGR_G_HasCurveGeometry(geometry, True):
        straight = gdal.OGR_G_GetLinearGeometry(geometry, 0.0, None)  # exact: it is a curve by its type alone
        found = _wkb(gdal, straight)
        gdal.OGR_G_DestroyGeometry(straight)
        return found
    return _wkb(gdal, geometry)


def _wkb(gdal: Gdal, geometry: Any) -> str:
    wkb = ctypes.create_string_buffer(gdal.OGR_G_WkbSizeEx(geometry))
    gdal.OGR_G_ExportToIsoWkb(geometry, _LITTLE_ENDIAN, wkb)
    return base64.b64encode(wkb.raw).decode("ascii")


def _text(value: bytes | None) -> str:
    return (value or b"").decode("utf-8", "replace")
