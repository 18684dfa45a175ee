"""Zones from an ED-269 document: {"features": [...]}, whose features are not GeoJSON's. Each geometry entry is a layer."""

from typing import Any

from inspection.zones.circles import checked_radius_m, enclosing_polygon
from inspection.zones.faults import FaultList
from inspection.zones.geometry_gate import MAX_POLYGONS, GeometryFault, VertexBudget, checked_area, checked_position
from inspection.zones.height_bands import height_band
from inspection.zones.records import ZoneRecord
from inspection.zones.texts import MAX_IDENTIFIER, MAX_NAME, checked_text

_OWN_FIELDS = {"identifier", "name", "restriction", "geometry", "applicability"}


def is_ed269(document: Any) -> bool:
    """An object with a list of features, none of which says that it is a GeoJSON Feature."""
    if not isinstance(document, dict) or not isinstance(document.get("features"), list) or document.get("type") == "FeatureCollection":
        return False
    return all(isinstance(feature, dict) and feature.get("type") != "Feature" for feature in document["features"])


def zones_of_ed269(document: dict[str, Any], faults: FaultList) -> list[ZoneRecord]:
    budget = VertexBudget()
    if len(document["features"]) > MAX_POLYGONS:
        raise GeometryFault("features", f"there are {len(document['features'])} features; at most {MAX_POLYGONS} are taken")
    records: list[ZoneRecord] = []
    for index, feature in enumerate(document["features"]):
        with faults.gathering():
            records += _layers(feature, f"features[{index}]", faults, budget)
    return records


def _layers(feature: dict[str, Any], place: str, faults: FaultList, budget: VertexBudget) -> list[ZoneRecord]:
    identifier = checked_text(feature.get("identifier"), f"{place}.identifier", MAX_IDENTIFIER)
    if not identifier:
        raise GeometryFault(f"{place}.identifier", "a zone needs an identifier")
    name = checked_text(feature.get("name"), f"{place}.name", MAX_NAME) or identifier
    restriction = checked_text(feature.get("restriction"), f"{place}.restriction", 100)
    reasons = feature.get("reason") or []
    if not isinstance(reasons, list) or not all(isinstance(reason, str) for reason in reasons):
        raise GeometryFault(f"{place}.reason", "reasons are a list of texts")
    schedule = _schedule(feature.get("applicability"), f"{place}.applicability")
    geometry = feature.get("geometry")
    if not isinstance(geometry, list) or not geometry:
        raise GeometryFault(f"{place}.geometry", "a zone needs a list of at least one geometry")
    rest = {key: value for key, value in feature.items() if key not in _OWN_FIELDS}
    records = []
    for layer, volume in enumerate(geometry):
        with faults.gathering():
            records.append(
                _layer(
                    volume, f"{place}.geometry[{layer}]", budget,
                    {"identifier": identifier, "layer": layer, "name": name, "restriction": restriction, "schedule": schedule,
                     "reason": checked_text(", ".join(reasons), f"{place}.reason", 255), "properties": rest},
                )
            )  # fmt: skip
    return records


def _layer(volume: Any, place: str, budget: VertexBudget, facts: dict[str, Any]) -> ZoneRecord:
    if not isinstance(volume, dict):
        raise GeometryFault(place, "a geometry is an object")
    band = height_band(volume, place)
    shape, place = volume.get("horizontalProjection"), f"{place}.horizontalProjection"
    if not isinstance(shape, dict):
        raise GeometryFault(place, "a geometry needs a horizontal projection")
    if shape.get("type") != "Circle":
        return ZoneRecord(geometry=checked_area(shape, place, budget), band=band, **facts)
    centre = checked_position(shape.get("center"), f"{place}.center")
    # Sources give the radius in metres also where heights are in feet; of the two readings this is the larger area.
    radius_m = checked_radius_m(shape.get("radius"), f"{place}.radius")
    circle = {"centre": list(centre), "radius_m": radius_m}
    return ZoneRecord(geometry=enclosing_polygon(centre, radius_m, place, budget), band=band, circle=circle, **facts)


def _schedule(applicability: Any, place: str) -> list[Any] | None:
    """The periods as the file gives them, or None for a zone that is permanent."""
    if applicability is None or applicability == []:
        return None
    if not isinstance(applicability, list) or not all(isinstance(period, dict) for period in applicability):
        raise GeometryFault(place, "periods of applicability are a list of objects")
    if all(period.get("permanent") == "YES" and set(period) == {"permanent"} for period in applicability):
        return None
    return applicability
