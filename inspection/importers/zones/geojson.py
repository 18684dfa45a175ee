"""Zones from GeoJSON: a FeatureCollection, a Feature or a bare geometry. A zone with only a name is permanent and covers all heights."""

from typing import Any

from shapely import MultiPolygon

from inspection.geodesy.geometry_validator import MAX_POLYGONS, GeometryFault, VertexBudget, checked_area, checked_position
from inspection.importers.rows import FaultList
from inspection.importers.zones.records import (
    MAX_IDENTIFIER,
    MAX_NAME,
    ZoneRecord,
    checked_radius_m,
    checked_text,
    enclosing_polygon,
    height_band,
)

_WGS84_NAMES = ("CRS84", "EPSG::4326", "EPSG:4326", "OGC:CRS84")
_TITLES = ("name", "Name", "title")
_RADII = ("radius_m", "radius", "buffer_m", "buffer", "Buffer")
_AREAS = {"Polygon", "MultiPolygon"}
_ALL_KINDS = _AREAS | {"Point", "GeometryCollection", "LineString", "MultiLineString", "MultiPoint"}


def zones_of_geojson(document: dict[str, Any], faults: FaultList, notes: list[str]) -> list[ZoneRecord]:
    with faults.gathering():
        _check_crs(document.get("crs"))
    kind = document.get("type")
    budget = VertexBudget()
    if kind == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise GeometryFault("features", "a FeatureCollection has a list of features")
        if len(features) > MAX_POLYGONS:
            raise GeometryFault("features", f"there are {len(features)} features; at most {MAX_POLYGONS} are taken")
        places = [(feature, f"features[{index}]") for index, feature in enumerate(features)]
    elif kind == "Feature":
        places = [(document, "")]
    else:
        places = [({"type": "Feature", "properties": {}, "geometry": document}, "")]
    records: list[ZoneRecord] = []
    markers, hidden = 0, 0
    areas = {_title(feature) for feature, _ in places if not _is_bare_point(feature)} - {""}
    for index, (feature, place) in enumerate(places):
        if is_hidden(feature):
            hidden += 1
        elif _is_bare_point(feature) and _title(feature) in areas:
            markers += 1  # the label of an area in the same file
        else:
            with faults.gathering():
                records += _zones_of_feature(feature, place, index, budget)
    notes += left_out(markers, "marker", "of zones that are here as areas") + left_out(hidden, "zone", "that the source hides")
    return records


def is_hidden(feature: Any) -> bool:
    """Whether the source itself hides it: marked as hidden, or the frame around the country's own zones (Estonia's EERZout)."""
    properties = feature.get("properties") if isinstance(feature, dict) else None
    if not isinstance(properties, dict):
        return False
    return str(properties.get("hidden")).lower() == "true" or properties.get("identifier") == "EERZout"


def left_out(number: int, word: str, which: str) -> list[str]:
    return [f"{number} {word}{'' if number == 1 else 's'} {which}: left out."] if number else []


def _is_bare_point(feature: Any) -> bool:
    geometry = feature.get("geometry") if isinstance(feature, dict) else None
    if not isinstance(geometry, dict) or geometry.get("type") != "Point":
        return False
    properties = feature.get("properties")
    return not isinstance(properties, dict) or _radius(properties) is None


def _radius(properties: dict[str, Any]) -> Any:
    """Return the radius around a point [m], from the property names in use."""
    return next((properties[name] for name in _RADII if properties.get(name) is not None), None)


def _title(feature: Any) -> str:
    """Return the title by which two features are recognised as the same zone."""
    properties = feature.get("properties") if isinstance(feature, dict) else None
    if not isinstance(properties, dict):
        return ""
    return next((str(properties[name]) for name in _TITLES if isinstance(properties.get(name), str) and properties[name]), "")


def _zones_of_feature(feature: Any, place: str, index: int, budget: VertexBudget) -> list[ZoneRecord]:
    if not isinstance(feature, dict) or feature.get("type") != "Feature":
        raise GeometryFault(place, "a Feature is expected")
    properties = feature.get("properties") or {}
    if not isinstance(properties, dict):
        raise GeometryFault(_join(place, "properties"), "properties are an object")
    properties_place = _join(place, "properties")
    titles = (checked_text(properties.get(key), f"{properties_place}.{key}", MAX_NAME) for key in _TITLES)
    name = next((title for title in titles if title), "")
    identifier = checked_text(feature.get("id"), _join(place, "id"), MAX_IDENTIFIER)
    identifier = identifier or checked_text(properties.get("identifier"), f"{properties_place}.identifier", MAX_IDENTIFIER)
    identifier = identifier or name[:MAX_IDENTIFIER] or f"zone {index + 1}"
    band = height_band(properties, properties_place)
    return [
        ZoneRecord(
            identifier=identifier, layer=layer, name=name or identifier, geometry=area, circle=circle, band=band, properties=properties,
            restriction=checked_text(properties.get("restriction"), f"{properties_place}.restriction", 100),
        )
        for layer, (area, circle) in enumerate(_areas(feature.get("geometry"), properties, _join(place, "geometry"), budget))
    ]  # fmt: skip


def _areas(geometry: Any, properties: dict[str, Any], place: str, budget: VertexBudget) -> list[tuple[MultiPolygon, dict[str, Any] | None]]:
    """Return the areas of a geometry; a Point is one if the properties state a radius."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind == "GeometryCollection":
        members = geometry.get("geometries")
        if not isinstance(members, list) or not members:
            raise GeometryFault(f"{place}.geometries", "the collection is empty")
        if len(members) > 100:
            raise GeometryFault(f"{place}.geometries", "the collection has more than 100 members")
        return [(checked_area(member, f"{place}.geometries[{index}]", budget), None) for index, member in enumerate(members)]
    if kind == "Point":
        radius = _radius(properties)
        if radius is None:
            raise GeometryFault(place, "a point is no area; a circle needs a radius (metres) in its properties")
        centre = checked_position(geometry.get("coordinates"), f"{place}.coordinates")
        radius_m = checked_radius_m(radius, _join(place.rpartition("geometry")[0].rstrip("."), "properties.radius"))
        return [(enclosing_polygon(centre, radius_m, place, budget), {"centre": list(centre), "radius_m": radius_m})]
    if isinstance(kind, str) and kind in _ALL_KINDS - _AREAS:
        raise GeometryFault(place, f"a {kind} is no area; a zone is a Polygon, a MultiPolygon or a Point with a radius")
    return [(checked_area(geometry, place, budget), None)]


def _check_crs(crs: Any) -> None:
    """Refuse reference systems, as old GeoJSON may name them, other than longitude and latitude on WGS84."""
    if crs is None:
        return
    name = crs.get("properties", {}).get("name") if isinstance(crs, dict) and isinstance(crs.get("properties"), dict) else None
    if not isinstance(name, str) or not name.endswith(_WGS84_NAMES):
        raise GeometryFault("crs", "only longitude and latitude on WGS84 (EPSG:4326) are taken; convert the file first")


def _join(place: str, key: str) -> str:
    return f"{place}.{key}" if place else key
