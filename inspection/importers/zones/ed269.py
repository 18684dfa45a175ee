"""Zones from an ED-269 document, whose features differ from GeoJSON's; each geometry entry is a layer.

Both envelopes in use are read: {"title", "description", "features": [...]} and {"formatVersion", "createdAt", "UASZoneList": [...]}.
"""

from typing import Any

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
from inspection.zones.schedule import checked_schedule

_OWN_FIELDS = {"identifier", "name", "restriction", "geometry", "applicability"}


ENVELOPES = ("features", "UASZoneList")


def is_ed269(document: Any) -> bool:
    """Whether it is an object with a list of zones, none of which is a GeoJSON Feature."""
    if not isinstance(document, dict) or document.get("type") == "FeatureCollection":
        return False
    zones = document.get(_envelope(document))
    return isinstance(zones, list) and all(isinstance(zone, dict) and zone.get("type") != "Feature" for zone in zones)


def _envelope(document: dict[str, Any]) -> str:
    return next((name for name in ENVELOPES if name in document), ENVELOPES[0])


def zones_of_ed269(document: dict[str, Any], faults: FaultList) -> list[ZoneRecord]:
    budget = VertexBudget()
    envelope = _envelope(document)
    zones = document[envelope]
    if len(zones) > MAX_POLYGONS:
        raise GeometryFault(envelope, f"there are {len(zones)} zones; at most {MAX_POLYGONS} are taken")
    records: list[ZoneRecord] = []
    for index, zone in enumerate(zones):
        with faults.gathering():
            records += _layers(zone, f"{envelope}[{index}]", faults, budget)
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
    schedule = checked_schedule(feature.get("applicability"), f"{place}.applicability")
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
    # Sources state the radius in metres even where heights are in feet; this reading also gives the larger area.
    radius_m = checked_radius_m(shape.get("radius"), f"{place}.radius")
    circle = {"centre": list(centre), "radius_m": radius_m}
    return ZoneRecord(geometry=enclosing_polygon(centre, radius_m, place, budget), band=band, circle=circle, **facts)
