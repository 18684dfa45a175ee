"""Facts of assets and zones in the history: enough to compare two states, and to restore one."""

import json
from typing import Any

from django.contrib.gis.geos import GeometryCollection, GEOSGeometry, LineString, MultiPolygon, Point, Polygon

from inspection.models import Asset, AssetKind, AssetSet, NoFlyZone, ZoneSet

# Facts that users read and edit; the others describe how the row relates to its source.
ASSET_FACTS = ("kind", "subtype", "name", "ref", "operator", "voltages_v", "circuits", "height_m", "is_flyable", "tags")
_ASSET_SOURCE = ("osm_type", "osm_id", "node_osm_ids", "parts", "asset_set_id", "source_key", "data_import_id", "content_hash", "is_edited")
ZONE_FACTS = (
    "name", "restriction", "reason", "lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "schedule", "circle",
)  # fmt: skip
_ZONE_SOURCE = ("identifier", "layer", "zone_set_id", "source_heights", "properties", "is_edited")


def asset_facts(asset: Asset) -> dict[str, Any]:
    return _values(asset, ASSET_FACTS + _ASSET_SOURCE) | {"geometry": geojson(asset.geometry), "vanished": asset.vanished_at is not None}


def zone_facts(zone: NoFlyZone) -> dict[str, Any]:
    return _values(zone, ZONE_FACTS + _ZONE_SOURCE) | {"geometry": geojson(zone.geometry)}


def says_the_same(asset: Asset, facts: dict[str, Any]) -> bool:
    """Whether the facts that users read equal the asset's."""
    own = asset_facts(asset)
    return all(own[name] == facts.get(name, own[name]) for name in (*ASSET_FACTS, "geometry"))


def take_asset_facts(asset: Asset, facts: dict[str, Any]) -> None:
    """Set the row's values from the facts, as far as present; nothing is saved."""
    for name in ("subtype", "name", "ref", "operator", "voltages_v", "circuits", "height_m", "is_flyable", "tags", "parts"):
        if name in facts:
            setattr(asset, name, facts[name])
    if "geometry" in facts:
        asset.geometry = geometry_of(facts["geometry"])
    if len(facts.get("node_osm_ids") or []) == len(coordinates_of(asset.geometry)) and asset.kind in {AssetKind.LINE, AssetKind.RAILWAY}:
        asset.node_osm_ids = facts["node_osm_ids"]


def asset_from_facts(facts: dict[str, Any], *, key: int) -> Asset:
    """Return the deleted row with its former key; its source may no longer exist."""
    asset = Asset(pk=key, kind=facts["kind"], osm_type=facts.get("osm_type") or "", osm_id=facts.get("osm_id"))
    key_of_set = facts.get("asset_set_id")
    asset.asset_set = None if key_of_set is None else AssetSet.objects.filter(pk=key_of_set).first()
    asset.source_key = facts.get("source_key") or ""
    asset.content_hash = facts.get("content_hash") or ""
    take_asset_facts(asset, facts)
    return asset


def take_zone_facts(zone: NoFlyZone, facts: dict[str, Any]) -> None:
    for name in (*ZONE_FACTS, "source_heights", "properties"):
        if name in facts:
            setattr(zone, name, facts[name])
    if "geometry" in facts:
        area = geometry_of(facts["geometry"])
        if not isinstance(area, MultiPolygon):
            raise TypeError(f"a zone's area is a MultiPolygon, not a {area.geom_type}")
        zone.geometry = area


def zone_from_facts(facts: dict[str, Any], *, key: int) -> NoFlyZone:
    zone = NoFlyZone(pk=key, identifier=facts["identifier"], layer=facts.get("layer") or 0)
    key_of_set = facts.get("zone_set_id")
    zone.zone_set = None if key_of_set is None else ZoneSet.objects.filter(pk=key_of_set).first()
    take_zone_facts(zone, facts)
    return zone


def differing(before: dict[str, Any] | None, after: dict[str, Any] | None) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Return both sides reduced to the facts that differ; a missing side stays None and leaves the other one complete."""
    if before is None or after is None:
        return before, after
    names = [name for name in {**before, **after} if name in before and name in after and before[name] != after[name]]
    return {name: before[name] for name in names}, {name: after[name] for name in names}


def geojson(geometry: GEOSGeometry) -> dict[str, Any]:
    return {"type": geometry.geom_type, "coordinates": _as_lists(coordinates_of(geometry))}


def coordinates_of(geometry: GEOSGeometry) -> tuple[Any, ...]:
    """Return the coordinates as GeoJSON nests them, in tuples."""
    if not isinstance(geometry, Point | LineString | Polygon | GeometryCollection):
        raise TypeError(f"a {geometry.geom_type} has no coordinates of its own")
    return geometry.coords


def geometry_of(value: dict[str, Any]) -> GEOSGeometry:
    return GEOSGeometry(json.dumps(value), srid=4326)


def _values(row: Any, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: getattr(row, name) for name in names}


def _as_lists(coordinates: Any) -> Any:
    """Return coordinates as lists, as in JSON, so that stored and new facts compare."""
    return [_as_lists(part) for part in coordinates] if isinstance(coordinates, tuple) else coordinates
