"""Incoming geometry, validated and in the form that the database takes."""

from typing import Any

import numpy as np
import shapely
from django.contrib.gis.geos import GEOSGeometry
from shapely.geometry.base import BaseGeometry

from inspection.geodesy.geometry_validator import GeometryFault, checked_area, checked_geometry, checked_position
from inspection.geodesy.wgs84 import WGS84, path_length_m
from inspection.importers.zones.records import checked_radius_m, enclosing_polygon
from inspection.models import AssetKind

SHAPES = {
    AssetKind.TOWER: ("Point",), AssetKind.LINE: ("LineString",), AssetKind.RAILWAY: ("LineString",), AssetKind.BRIDGE: ("MultiPolygon",),
}  # fmt: skip
WORDS = {"Point": "a point", "LineString": "a line", "MultiPolygon": "an area"}


def asset_shape(kind: AssetKind, value: Any, place: str = "geometry") -> BaseGeometry:
    """Return the validated geometry of an asset of this kind. Raises GeometryFault."""
    shape = checked_geometry(value, place)
    if shape.geom_type not in SHAPES[kind]:
        wanted = WORDS[SHAPES[kind][0]]
        raise GeometryFault(place, f"a {kind.label.lower()} is drawn as {wanted}, not as {WORDS[shape.geom_type]}")
    return shape


def zone_shape(geometry: Any, circle: Any) -> tuple[BaseGeometry, dict[str, Any] | None]:
    """Return a zone's area, and its circle if it is one: {"centre": [lon, lat], "radius_m": number}. Raises GeometryFault."""
    if circle is None:
        return checked_area(geometry, "geometry"), None
    if not isinstance(circle, dict):
        raise GeometryFault("circle", "a circle is an object with centre and radius_m")
    centre = checked_position(circle.get("centre"), "circle.centre")
    radius_m = checked_radius_m(circle.get("radius_m"), "circle.radius_m")
    return enclosing_polygon(centre, radius_m, "circle"), {"centre": list(centre), "radius_m": radius_m}


def stored(shape: BaseGeometry) -> GEOSGeometry:
    """Return the geometry for the database. A bridge of one part is a Polygon, as imports write it."""
    return GEOSGeometry(memoryview(shapely.to_wkb(shape)), srid=4326)


def bridge_stored(shape: BaseGeometry) -> GEOSGeometry:
    return stored(shape.geoms[0] if isinstance(shape, shapely.MultiPolygon) and len(shape.geoms) == 1 else shape)


def length_m(shape: BaseGeometry) -> float | None:
    """Return the geodesic length of a line [m]; None for other types."""
    return path_length_m(np.asarray(shape.coords)) if shape.geom_type == "LineString" else None


def area_m2(shape: BaseGeometry) -> float | None:
    """Return the geodesic area [m2]; None for other types."""
    return abs(WGS84.geometry_area_perimeter(shape)[0]) if shape.geom_type == "MultiPolygon" else None
