"""Undo an import of assets: its new rows are marked as removed, changed and removed ones get the facts that they had before it.

Rows that a user edited, or that a later import changed, stay as they are.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any

import numpy as np
from django.contrib.gis.geos import LineString
from django.utils import timezone

from inspection.geodesy.wgs84 import path_length_m
from inspection.models import Asset, ChangeAction, DataImport
from inspection.services.curation import centre_of
from inspection.services.facts import asset_facts, take_asset_facts
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from inspection.services.imports.regions import fit_regions
from workspace.models import DEFAULT_ORGANISATION_ID, AuditEntry, User

MAX_IMPORT_TIME = timedelta(hours=12)  # the entries of an import are written in its transaction
BATCH = 1_000
_WRITTEN = (
    "subtype", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits", "height_m", "length_m", "is_flyable", "tags", "parts",
    "node_osm_ids", "geometry", "centre", "content_hash", "data_import", "is_edited", "source_facts", "vanished_at", "revision",
    "updated_at",
)  # fmt: skip


@dataclass
class AssetUndo:
    """The rows that undoing an import changes. `restored` have their facts from before it; `kept` were changed since."""

    removed: list[Asset] = field(default_factory=list)
    restored: list[tuple[Asset, AuditEntry]] = field(default_factory=list)
    kept: list[Asset] = field(default_factory=list)

    def changes(self) -> Iterator[tuple[ChangeAction, Asset, dict[str, Any] | None]]:
        """Yield the action of each row, the row as it is, and the facts that it gets."""
        for asset in self.removed:
            yield ChangeAction.VANISHED, asset, None
        for asset, entry in self.restored:
            returns = asset.vanished_at is not None and not (entry.before or {}).get("vanished")
            yield ChangeAction.NEW if returns else ChangeAction.CHANGED, asset, entry.before
        for asset in self.kept:
            yield ChangeAction.KEPT, asset, None

    def without(self, excluded: Collection[str]) -> "AssetUndo":
        return AssetUndo(
            [asset for asset in self.removed if key_of(asset) not in excluded],
            [(asset, entry) for asset, entry in self.restored if key_of(asset) not in excluded],
            self.kept,
        )


def key_of(asset: Asset) -> str:
    return f"asset {asset.pk}"


class HistoryIncomplete(Exception):
    """Raised where the history does not have every row that the import changed, as of one by an earlier version."""


def undo_of(data_import: DataImport) -> AssetUndo:
    """Return what undoing the import changes now. Raises HistoryIncomplete: a changed row would be taken for a new one."""
    written = AuditEntry.objects.filter(
        subject_type="asset", action__in=("changed", "vanished"), after__data_import_id=data_import.pk,
        recorded_at__range=(data_import.imported_at, data_import.imported_at + MAX_IMPORT_TIME),
    )  # fmt: skip
    entries = {int(entry.subject_id): entry for entry in written.order_by("-pk")}  # of a row the first one: its state before the import
    if len(entries) != sum(data_import.counts.get(action, 0) for action in ("changed", "vanished")):
        raise HistoryIncomplete
    found = AssetUndo()
    for asset in Asset.objects.filter(pk__in=entries).order_by("pk").iterator(BATCH):
        if asset.data_import_id == data_import.pk and not asset.is_edited:
            found.restored.append((asset, entries[asset.pk]))
        else:
            found.kept.append(asset)
    new = Asset.objects.filter(data_import=data_import, vanished_at=None).exclude(pk__in=entries).order_by("pk")
    for asset in new.iterator(BATCH):
        (found.kept if asset.is_edited else found.removed).append(asset)
    return found


def write_undo(found: AssetUndo, *, actor: User | None) -> None:
    """Write the rows and their history, in the caller's transaction."""
    hold_ground()
    now = timezone.now()
    entries, rows = [], []
    origins = DataImport.objects.in_bulk({(entry.before or {}).get("data_import_id") for _asset, entry in found.restored} - {None})
    for action, asset, facts in found.changes():
        if action == ChangeAction.KEPT:
            continue
        before = asset_facts(asset)
        if facts is None:
            asset.vanished_at = now
        else:
            _restore(asset, facts, origins)
        asset.revision += 1
        asset.updated_at = now
        rows.append(asset)
        entries.append(
            AuditEntry(
                organisation_id=actor.organisation_id if actor else DEFAULT_ORGANISATION_ID,
                actor=actor,
                action="undone import",
                subject_type="asset",
                subject_id=str(asset.pk),
                before=before,
                after=asset_facts(asset),
            )
        )
    AuditEntry.objects.bulk_create(entries, batch_size=BATCH)
    Asset.objects.bulk_update(rows, _WRITTEN, batch_size=BATCH)
    fit_regions({row.data_import.region_id for row in rows if row.data_import is not None and row.data_import.region_id is not None})
    if number_supports() or rows:
        mark_ground_changed()


def _restore(asset: Asset, facts: dict[str, Any], origins: Mapping[int, DataImport]) -> None:
    """Set the row to the facts, with everything that is derived from them. origins: the imports of all such facts, by key."""
    in_file = asset_facts(asset)
    take_asset_facts(asset, facts)
    asset.content_hash = facts.get("content_hash") or asset.content_hash
    asset.data_import = origins.get(facts.get("data_import_id", 0)) or asset.data_import
    asset.is_edited = bool(facts.get("is_edited"))
    asset.source_facts = in_file if asset.is_edited else None
    asset.vanished_at = (asset.vanished_at or timezone.now()) if facts.get("vanished") else None
    asset.max_voltage_v = max(asset.voltages_v, default=None)
    asset.centre = centre_of(asset.geometry)
    if isinstance(asset.geometry, LineString):
        asset.length_m = path_length_m(np.array(asset.geometry.coords))
