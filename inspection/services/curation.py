"""What curators write by hand: each change marks the row as edited, is recorded, and counts as a change of the ground."""

import uuid
from typing import Any

import numpy as np
from django.contrib.gis.geos import GEOSGeometry, LineString, Point
from django.db import transaction
from django.utils import timezone

from inspection.geodesy.wgs84 import path_length_m
from inspection.graph.ground_data import NO_OSM_NODE
from inspection.models import Asset, AssetKind, NoFlyZone
from inspection.services.ground import hold_ground, mark_ground_changed
from inspection.services.supports import number_supports
from workspace.models import User
from workspace.services import record_change

GEOMETRY_TYPES = {
    AssetKind.TOWER: {"Point"},
    AssetKind.LINE: {"LineString"},
    AssetKind.RAILWAY: {"LineString"},
    AssetKind.BRIDGE: {"Polygon", "MultiPolygon"},
}


class WrongGeometry(ValueError):
    """The geometry is of another type than the asset's kind has."""


def geometry_fault(*, kind: AssetKind, geometry: GEOSGeometry) -> str | None:
    """A sentence, if assets of this kind have another type of geometry."""
    types = GEOMETRY_TYPES[kind]
    if geometry.geom_type in types:
        return None
    return f"A {kind.label.lower()} is drawn as {' or '.join(sorted(types))}, not as {geometry.geom_type}."


def save_asset(*, asset: Asset, actor: User) -> Asset:
    """Store a new or changed asset with all that follows from its geometry and voltages. Raises WrongGeometry."""
    kind = AssetKind(asset.kind)
    if asset.geometry.geom_type not in GEOMETRY_TYPES[kind]:
        raise WrongGeometry(
            f"A {kind.label.lower()} is drawn as {' or '.join(sorted(GEOMETRY_TYPES[kind]))}, not as {asset.geometry.geom_type}."
        )
    with transaction.atomic():
        hold_ground()
        before = Asset.objects.select_for_update().filter(pk=asset.pk).first()
        asset.is_edited = True
        asset.voltages_v = sorted(set(asset.voltages_v), reverse=True)
        asset.max_voltage_v = max(asset.voltages_v, default=None)
        asset.centre = _centre(asset.geometry)
        if isinstance(asset.geometry, LineString):
            asset.length_m = path_length_m(np.array(asset.geometry.coords))
            asset.node_osm_ids = _osm_nodes(asset.geometry, before)
        asset.save()
        _record(actor, before, asset, asset_facts)
        _number_supports_after(kind)
        mark_ground_changed()
    return asset


def delete_asset(*, asset: Asset, actor: User) -> None:
    """Remove an asset. One from a file comes back with the file's next import; clear `is_flyable` to keep it out of the graph.

    One that a mission's target points at is marked as vanished instead: the target keeps its place.
    """
    with transaction.atomic():
        hold_ground()
        kept = Asset.objects.select_for_update().get(pk=asset.pk)
        if _is_pointed_at(kept):
            before = Asset.objects.get(pk=asset.pk)
            kept.is_edited = True
            kept.vanished_at = kept.vanished_at or timezone.now()
            kept.save(update_fields=["is_edited", "vanished_at", "updated_at"])
            _record(actor, before, kept, asset_facts)
        else:
            _record(actor, asset, None, asset_facts)
            asset.delete()
        _number_supports_after(AssetKind(kept.kind))
        mark_ground_changed()


def save_zone(*, zone: NoFlyZone, actor: User) -> NoFlyZone:
    """Store a new or changed zone. Its geometry has passed the gate (zones/geometry_gate.py)."""
    with transaction.atomic():
        before = NoFlyZone.objects.select_for_update(of=["self"]).filter(pk=zone.pk).first()
        zone.identifier = zone.identifier or f"drawn-{uuid.uuid4()}"
        if before is not None and before.geometry != zone.geometry:
            zone.circle = None  # what was drawn anew is no longer the circle that the source stated
        zone.save()
        _record(actor, before, zone, zone_facts)
        mark_ground_changed()
    return zone


def delete_zone(*, zone: NoFlyZone, actor: User) -> None:
    with transaction.atomic():
        _record(actor, zone, None, zone_facts)
        zone.delete()
        mark_ground_changed()


def _number_supports_after(kind: AssetKind) -> None:
    """A changed line or support may change which place others have."""
    if kind in {AssetKind.LINE, AssetKind.TOWER}:
        number_supports()


def _is_pointed_at(asset: Asset) -> bool:
    """Whether a row of a later app, which this one does not know, points at the asset and shows it (related_name "+" does not)."""
    pointing = [
        (relation.related_model, relation.field.name)
        for relation in Asset._meta.related_objects
        if relation.related_model._meta.app_label != Asset._meta.app_label
    ]
    return any(model._base_manager.filter(**{field: asset.pk}).exists() for model, field in pointing)


def asset_facts(asset: Asset) -> dict[str, Any]:
    names = ("kind", "subtype", "name", "ref", "operator", "voltages_v", "circuits", "height_m", "is_flyable", "tags")
    return {name: getattr(asset, name) for name in names} | {
        "geometry": _geojson(asset.geometry),
        "vanished": asset.vanished_at is not None,
    }


def zone_facts(zone: NoFlyZone) -> dict[str, Any]:
    names = ("identifier", "layer", "name", "restriction", "reason", "lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference")
    return {name: getattr(zone, name) for name in names} | {"geometry": _geojson(zone.geometry), "schedule": zone.schedule}


def _record(actor: User, before: Any, after: Any, facts: Any) -> None:
    action = "changed" if before and after else "created" if after else "deleted"
    row = after or before
    record_change(
        organisation=actor.organisation,
        actor=actor,
        action=action,
        subject_type="zone" if isinstance(row, NoFlyZone) else "asset",
        subject_id=row.pk,
        before=before and facts(before),
        after=after and facts(after),
    )


def _geojson(geometry: GEOSGeometry) -> dict[str, Any]:
    return {"type": geometry.geom_type, "coordinates": geometry.coords}


def _centre(geometry: GEOSGeometry) -> Point:
    if isinstance(geometry, Point):
        return geometry.clone()
    if isinstance(geometry, LineString):
        return geometry.interpolate_normalized(0.5)
    return geometry.centroid if geometry.contains(geometry.centroid) else geometry.point_on_surface


def _osm_nodes(line: LineString, before: Asset | None) -> list[int]:
    """The OSM node of each vertex that was not moved; the others are drawn by hand."""
    known: dict[tuple[float, ...], int] = {}
    if before is not None and len(before.node_osm_ids) == len(before.geometry.coords):
        known = dict(zip(before.geometry.coords, before.node_osm_ids, strict=True))
    return [known.get(vertex, NO_OSM_NODE) for vertex in line.coords]
