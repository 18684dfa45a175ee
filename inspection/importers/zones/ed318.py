"""Zones from ED-318: GeoJSON features with zone properties, a layer of heights in each geometry, circles as points with an extent.

Source: EUROCAE ED-318 and its published JSON schema. Feeds in use nest more than that (properties.UASZone, verticalLayer); both are read.
"""

from typing import Any

from inspection.geodesy.geometry_validator import MAX_POLYGONS, GeometryFault, VertexBudget, checked_area, checked_position
from inspection.importers.rows import FaultList
from inspection.importers.zones.geojson import is_hidden, left_out
from inspection.importers.zones.records import (
    MAX_IDENTIFIER,
    MAX_NAME,
    ZoneRecord,
    checked_radius_m,
    checked_text,
    enclosing_polygon,
    height_band,
)
from inspection.zones.schedule import checked_schedule, moment_of

TYPES = ("USPACE", "PROHIBITED", "REQ_AUTHORIZATION", "CONDITIONAL", "NO_RESTRICTION")
VARIANTS = ("COMMON", "CUSTOMIZED")
MAX_LAYERS = 100
_OWN_FIELDS = {"identifier", "name", "type", "reason", "limitedApplicability", "UASZone"}
_LAYER_KEYS = {
    "uom": "uomDimensions", "lower": "lowerLimit", "lowerReference": "lowerVerticalReference", "upper": "upperLimit",
    "upperReference": "upperVerticalReference",
}  # fmt: skip


def is_ed318(document: Any) -> bool:
    """Whether it is a FeatureCollection with a feature that has a zone's properties."""
    if not isinstance(document, dict) or document.get("type") != "FeatureCollection" or not isinstance(document.get("features"), list):
        return False
    return any(
        isinstance(feature, dict) and isinstance(feature.get("properties"), dict) and _looks_like_a_zone(feature["properties"])
        for feature in document["features"]
    )


def zones_of_ed318(document: dict[str, Any], faults: FaultList, notes: list[str]) -> list[ZoneRecord]:
    if len(document["features"]) > MAX_POLYGONS:
        raise GeometryFault("features", f"there are {len(document['features'])} features; at most {MAX_POLYGONS} are taken")
    budget = VertexBudget()
    records: list[ZoneRecord] = []
    for index, feature in enumerate(document["features"]):
        if not is_hidden(feature):
            with faults.gathering():
                records += _layers(feature, f"features[{index}]", faults, budget)
    notes += left_out(sum(map(is_hidden, document["features"])), "zone", "that the source hides")
    return records


def stated_validity(document: dict[str, Any], faults: FaultList) -> tuple[str | None, str | None]:
    """Return the stated start and end of validity (RFC 3339, UTC); None where not stated."""
    metadata = document.get("metadata")
    if metadata is None:
        return None, None
    found: list[str | None] = []
    for name in ("validFrom", "validTo", "issued"):
        with faults.gathering():
            if not isinstance(metadata, dict):
                raise GeometryFault("metadata", "metadata are an object")
            found.append(moment_of(metadata.get(name), f"metadata.{name}"))
    return (found[0], found[1]) if len(found) == 3 else (None, None)


def text_of(value: Any, place: str, maximum: int) -> str:
    """Return a text; of a list of texts in several languages the English one, else the first."""
    if not isinstance(value, list):
        return checked_text(value, place, maximum)
    texts = []
    for index, entry in enumerate(value):
        if not isinstance(entry, dict):
            raise GeometryFault(f"{place}[{index}]", "a text is an object with text and lang")
        lang = checked_text(entry.get("lang"), f"{place}[{index}].lang", 40)
        texts.append((not lang.lower().startswith("en"), checked_text(entry.get("text"), f"{place}[{index}].text", maximum)))
    return min(texts, key=lambda pair: pair[0])[1] if texts else ""


def _looks_like_a_zone(properties: dict[str, Any]) -> bool:
    return isinstance(properties.get("UASZone"), dict) or "zoneAuthority" in properties or "variant" in properties


def _layers(feature: Any, place: str, faults: FaultList, budget: VertexBudget) -> list[ZoneRecord]:
    if not isinstance(feature, dict) or feature.get("type") != "Feature":
        raise GeometryFault(place, "a Feature is expected")
    holder, place_of = feature.get("properties"), f"{place}.properties"
    if not isinstance(holder, dict):
        raise GeometryFault(place_of, "a zone has properties")
    properties = holder
    if isinstance(holder.get("UASZone"), dict):
        properties, place_of = {**holder, **holder["UASZone"]}, f"{place_of}.UASZone"
    facts = _facts(properties, place_of)
    records = []
    for index, (geometry, geometry_place) in enumerate(_geometries(feature.get("geometry"), f"{place}.geometry")):
        with faults.gathering():
            records.append(_layer(geometry, geometry_place, holder, budget, facts | {"layer": index}))
    return records


def _facts(properties: dict[str, Any], place: str) -> dict[str, Any]:
    identifier = checked_text(properties.get("identifier"), f"{place}.identifier", MAX_IDENTIFIER)
    if not identifier:
        raise GeometryFault(f"{place}.identifier", "a zone needs an identifier")
    kind, variant = properties.get("type"), properties.get("variant", "COMMON")
    if kind not in TYPES:
        hint = "; REQ_AUTHORISATION is how ED-269 spells it" if kind == "REQ_AUTHORISATION" else ""
        raise GeometryFault(f"{place}.type", f"the type is one of {', '.join(TYPES)}, not {str(kind)[:40]!r}{hint}")
    if variant not in VARIANTS:
        raise GeometryFault(f"{place}.variant", f"the variant is one of {', '.join(VARIANTS)}, not {str(variant)[:40]!r}")
    authorities = properties.get("zoneAuthority")
    if not isinstance(authorities, list) or not authorities or not all(isinstance(authority, dict) for authority in authorities):
        raise GeometryFault(f"{place}.zoneAuthority", "a zone names at least one authority")
    reasons = properties.get("reason") or []
    if not isinstance(reasons, list) or not all(isinstance(reason, str) for reason in reasons):
        raise GeometryFault(f"{place}.reason", "reasons are a list of texts")
    return {
        "identifier": identifier,
        "name": text_of(properties.get("name"), f"{place}.name", MAX_NAME) or identifier,
        "restriction": kind,
        "reason": checked_text(", ".join(reasons), f"{place}.reason", 255),
        "schedule": checked_schedule(properties.get("limitedApplicability"), f"{place}.limitedApplicability"),
        "properties": {key: value for key, value in properties.items() if key not in _OWN_FIELDS}
        | ({"names": properties["name"]} if isinstance(properties.get("name"), list) else {}),
    }


def _geometries(geometry: Any, place: str) -> list[tuple[dict[str, Any], str]]:
    """Return the members of a collection, each a layer; else the geometry alone."""
    if not isinstance(geometry, dict):
        raise GeometryFault(place, "there is no geometry")
    if geometry.get("type") != "GeometryCollection":
        return [(geometry, place)]
    members = geometry.get("geometries")
    if not isinstance(members, list) or not members or len(members) > MAX_LAYERS:
        raise GeometryFault(f"{place}.geometries", f"a collection has 1 to {MAX_LAYERS} members")
    if not all(isinstance(member, dict) for member in members):
        raise GeometryFault(f"{place}.geometries", "members are geometries")
    return [(member, f"{place}.geometries[{index}]") for index, member in enumerate(members)]


def _layer(geometry: dict[str, Any], place: str, holder: dict[str, Any], budget: VertexBudget, facts: dict[str, Any]) -> ZoneRecord:
    band = height_band(*_limits(geometry, place, holder))
    if geometry.get("type") != "Point":
        return ZoneRecord(geometry=checked_area(geometry, place, budget), band=band, **facts)
    centre = checked_position(geometry.get("coordinates"), f"{place}.coordinates")
    extent = geometry.get("extent")
    if not isinstance(extent, dict) or extent.get("subType") != "Circle":
        raise GeometryFault(f"{place}.extent", "a point is no area; a circle has an extent with subType Circle and radius")
    radius_m = checked_radius_m(extent.get("radius"), f"{place}.extent.radius")
    circle = {"centre": list(centre), "radius_m": radius_m}
    return ZoneRecord(geometry=enclosing_polygon(centre, radius_m, place, budget), band=band, circle=circle, **facts)


def _limits(geometry: dict[str, Any], place: str, holder: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """Return the layer with ED-269's member names, and its place."""
    for owner, key in ((geometry, "layer"), (geometry, "verticalLayer"), (holder, "layer"), (holder, "verticalLayer")):
        layer = owner.get(key)
        if layer is None:
            continue
        if not isinstance(layer, dict):
            raise GeometryFault(f"{place}.{key}", "a layer is an object")
        limits = {name: layer.get(own) for own, name in _LAYER_KEYS.items()}
        if isinstance(limits["uomDimensions"], str):
            limits["uomDimensions"] = limits["uomDimensions"].upper()
        return limits, f"{place}.{key}"
    return {}, place
