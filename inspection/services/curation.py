"""Curators' edits: each one marks the row as edited, is recorded, and counts as a change of the map data."""

import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np
from django.contrib.gis.geos import GEOSGeometry, LineString, Point
from django.db import IntegrityError, transaction
from django.db.models import F
from django.db.models.functions import Now
from django.utils import timezone

from inspection.geodesy.wgs84 import path_length_m
from inspection.models import Asset, AssetKind, AssetReference, NoFlyZone
from inspection.network.infrastructure import NO_OSM_NODE
from inspection.services.facts import asset_facts, says_the_same, take_asset_facts, zone_facts
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from workspace.audit import record_change
from workspace.models import AuditEntry, User

GEOMETRY_TYPES = {
    AssetKind.TOWER: {"Point"},
    AssetKind.LINE: {"LineString"},
    AssetKind.RAILWAY: {"LineString"},
    AssetKind.BRIDGE: {"Polygon", "MultiPolygon"},
}


PLACED = "spanwise:placed"  # tag of a support at an OSM node that OSM does not tag as one

_numbers_later: ContextVar[bool] = ContextVar("numbers_later", default=False)


class WrongGeometry(ValueError):
    """Raised for a geometry of a wrong type for the asset's kind."""


class StaleRevision(Exception):
    """Raised when another user has changed or deleted the row since it was read; nothing was written."""

    def __init__(self, subject: str, key: int | None) -> None:
        super().__init__(f"{subject} {key} has changed in the meantime")
        self.subject, self.key = subject, key


def geometry_fault(*, kind: AssetKind, geometry: GEOSGeometry) -> str | None:
    """Return a sentence if assets of this kind have another type of geometry, else None."""
    types = GEOMETRY_TYPES[kind]
    if geometry.geom_type in types:
        return None
    return f"A {kind.label.lower()} is drawn as {' or '.join(sorted(types))}, not as {geometry.geom_type}."


def save_asset(*, asset: Asset, actor: User, expected_revision: int | None = None, action: str = "") -> Asset:
    """Store a new or changed asset with everything derived from its geometry and voltages. Raises WrongGeometry, StaleRevision.

    A row that equals its source again counts as not edited: imports then keep it up to date.
    """
    kind = AssetKind(asset.kind)
    if fault := geometry_fault(kind=kind, geometry=asset.geometry):
        raise WrongGeometry(fault)
    with transaction.atomic():
        hold_ground()
        before = Asset.objects.select_for_update(of=["self"]).filter(pk=asset.pk).first()
        check_revision(before, expected_revision, "asset", asset.pk)
        if not derive(asset, before):
            return asset  # saved unchanged
        asset.revision = before.revision + 1 if before else max(asset.revision, 1)
        asset.save(force_insert=before is None)
        _record(actor, asset_facts(before) if before else None, asset_facts(asset), asset, action)
        _number_supports_after(kind)
        mark_ground_changed()
    return asset


def derive(asset: Asset, before: Asset | None) -> bool:
    """Set what follows from geometry, voltages and source of a new or changed asset. Returns whether its facts differ from before."""
    asset.voltages_v = sorted(set(asset.voltages_v), reverse=True)
    asset.max_voltage_v = max(asset.voltages_v, default=None)
    asset.centre = centre_of(asset.geometry)
    if isinstance(asset.geometry, LineString):
        asset.length_m = path_length_m(np.array(asset.geometry.coords))
        asset.node_osm_ids = _osm_nodes(asset, before)
    if before is not None and not before.is_edited and is_sourced(before):
        asset.source_facts = asset_facts(before)
    follows_source = asset.source_facts is not None and says_the_same(asset, asset.source_facts)
    if asset.source_facts is not None and follows_source:
        take_asset_facts(asset, asset.source_facts)  # including the OSM nodes of its vertices
        asset.source_facts = None
    asset.is_edited = not follows_source
    return before is None or asset_facts(before) != asset_facts(asset)


def delete_asset(*, asset: Asset, actor: User, expected_revision: int | None = None) -> None:
    """Delete an asset. Raises StaleRevision.

    An asset from a file, or one that a mission's target refers to, is marked as manually vanished: the target keeps its place, and the
    file's next import does not restore the asset. A drawn one is deleted.
    """
    with transaction.atomic():
        hold_ground()
        kept = Asset.objects.select_for_update(of=["self"]).filter(pk=asset.pk).first()
        check_revision(kept, expected_revision, "asset", asset.pk)
        if kept is None:
            return
        before = asset_facts(kept)
        if is_sourced(kept) or _is_pointed_at(kept):
            if not kept.is_edited and is_sourced(kept):
                kept.source_facts = before
            kept.is_edited = True
            kept.vanished_at = kept.vanished_at or timezone.now()
            kept.revision += 1
            kept.save(update_fields=["is_edited", "vanished_at", "source_facts", "revision", "updated_at"])
            _record(actor, before, asset_facts(kept), kept, "deleted")
        else:
            _record(actor, before, None, kept)
            kept.delete()
        _number_supports_after(AssetKind(kept.kind))
        mark_ground_changed()


def save_zone(*, zone: NoFlyZone, actor: User, expected_revision: int | None = None, action: str = "") -> NoFlyZone:
    """Store a new or changed zone, whose geometry geodesy/geometry_validator.py has accepted. Raises StaleRevision."""
    with transaction.atomic():
        hold_ground()
        before = NoFlyZone.objects.select_for_update(of=["self"]).filter(pk=zone.pk).first()
        check_revision(before, expected_revision, "zone", zone.pk)
        zone.identifier = zone.identifier or f"drawn-{uuid.uuid4()}"
        if before is not None and before.geometry != zone.geometry and before.circle == zone.circle:
            zone.circle = None  # a redrawn zone is no longer the circle that the source stated
        if before is not None and zone_facts(before) == zone_facts(zone):
            return zone  # saved unchanged
        zone.is_edited = zone.zone_set_id is not None
        zone.revision = before.revision + 1 if before else max(zone.revision, 1)
        zone.save(force_insert=before is None)
        _record(actor, zone_facts(before) if before else None, zone_facts(zone), zone, action)
        mark_ground_changed()
    return zone


def delete_zone(*, zone: NoFlyZone, actor: User, expected_revision: int | None = None) -> None:
    """Remove a zone; its source's next file restores it as a new one in the difference. Raises StaleRevision."""
    with transaction.atomic():
        hold_ground()
        kept = NoFlyZone.objects.select_for_update(of=["self"]).filter(pk=zone.pk).first()
        check_revision(kept, expected_revision, "zone", zone.pk)
        if kept is None:
            return
        _record(actor, zone_facts(kept), None, kept)
        kept.delete()
        mark_ground_changed()


def is_sourced(asset: Asset) -> bool:
    """Whether it came from a file, which may be imported again."""
    was_placed = PLACED in asset.tags and asset.source_facts is None
    return (asset.osm_id is not None and not was_placed) or asset.asset_set_id is not None


@contextmanager
def many_edits() -> Iterator[None]:
    """Make several edits of assets in one transaction; supports are numbered once, at its end."""
    with transaction.atomic():
        hold_ground()
        token = _numbers_later.set(True)
        try:
            yield
        finally:
            _numbers_later.reset(token)
        number_supports()


def check_revision(row: Asset | NoFlyZone | None, expected: int | None, subject: str, key: int | None) -> None:
    """Raise StaleRevision for a missing row, or one with another revision than expected; None accepts any."""
    if expected is not None and (row is None or row.revision != expected):
        raise StaleRevision(subject, key)


def _number_supports_after(kind: AssetKind) -> None:
    """Number the supports again: a changed line or support may change the places of others."""
    if kind in {AssetKind.LINE, AssetKind.TOWER} and not _numbers_later.get():
        number_supports()


def _is_pointed_at(asset: Asset) -> bool:
    """Whether a row of a later app, unknown to this one, refers to the asset and shows it (related_name "+" does not)."""
    pointing = [
        (relation.related_model, relation.field.name)
        for relation in Asset._meta.related_objects
        if relation.related_model._meta.app_label != Asset._meta.app_label
    ]
    return any(model._base_manager.filter(**{field: asset.pk}).exists() for model, field in pointing)


def _record(actor: User, before: dict[str, Any] | None, after: dict[str, Any] | None, row: Asset | NoFlyZone, action: str = "") -> None:
    record_change(
        organisation=actor.organisation,
        actor=actor,
        action=action or ("changed" if before and after else "created" if after else "deleted"),
        subject_type="zone" if isinstance(row, NoFlyZone) else "asset",
        subject_id=row.pk,
        before=before,
        after=after,
    )


def centre_of(geometry: GEOSGeometry) -> Point:
    if isinstance(geometry, Point):
        return geometry.clone()
    if isinstance(geometry, LineString):
        return geometry.interpolate_normalized(0.5)
    return geometry.centroid if geometry.contains(geometry.centroid) else geometry.point_on_surface


def _osm_nodes(asset: Asset, before: Asset | None) -> list[int]:
    """Return the OSM node of each vertex that was not moved, and NO_OSM_NODE for others."""
    vertices = asset.geometry.coords
    if before is None:
        return asset.node_osm_ids if len(asset.node_osm_ids) == len(vertices) else [NO_OSM_NODE] * len(vertices)
    known: dict[tuple[float, ...], int] = {}
    if len(before.node_osm_ids) == len(before.geometry.coords):
        known = dict(zip(before.geometry.coords, before.node_osm_ids, strict=True))
    return [known.get(vertex, NO_OSM_NODE) for vertex in vertices]


REFERENCE_FIELDS = ("external_id", "attributes")


class ExternalIdTaken(Exception):
    """Raised when another asset of the organisation has this external id."""


def save_asset_reference(*, asset: Asset, actor: User, values: dict[str, Any], expected_revision: int | None = None) -> None:
    """Store the organisation's reference of an asset; `values` has some of REFERENCE_FIELDS.

    It increments the asset's revision. The map data are unchanged: no mission becomes stale, and the asset does not count as edited. Raises
    StaleRevision or ExternalIdTaken.
    """
    with transaction.atomic():
        held = Asset.objects.select_for_update(of=["self"]).filter(pk=asset.pk).first()
        check_revision(held, expected_revision, "asset", asset.pk)
        if held is None:
            return
        row, _ = AssetReference.objects.get_or_create(organisation=actor.organisation, asset=held)
        before = _facts(row)
        for name, value in values.items():
            setattr(row, name, value)
        if before == _facts(row):
            return
        try:
            with transaction.atomic():
                row.save()
        except IntegrityError as error:
            if "asset_external_id_unique" in str(error):
                raise ExternalIdTaken from error
            raise
        Asset.objects.filter(pk=held.pk).update(revision=F("revision") + 1, updated_at=Now())
        record_change(
            organisation=actor.organisation, actor=actor, action="changed", subject_type="asset_reference", subject_id=held.pk,
            before=before, after=_facts(row),
        )  # fmt: skip


def restore_references(*, asset: Asset) -> None:
    """Restore each organisation's reference of a restored asset, except ids that another asset has by now."""
    last = AuditEntry.objects.filter(subject_type="asset_reference", subject_id=str(asset.pk))
    AssetReference.objects.bulk_create(
        (
            AssetReference(organisation_id=entry.organisation_id, asset=asset, **entry.after)
            for entry in last.order_by("organisation_id", "-pk").distinct("organisation_id")
            if entry.after
        ),
        ignore_conflicts=True,
    )


def _facts(row: AssetReference) -> dict[str, Any]:
    return {name: getattr(row, name) for name in REFERENCE_FIELDS}
