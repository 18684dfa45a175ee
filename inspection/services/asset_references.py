"""An organisation's own ids and attributes of assets."""

from typing import Any

from django.db import IntegrityError, transaction
from django.db.models import F
from django.db.models.functions import Now

from inspection.models import Asset, AssetReference
from inspection.services.curation import check_revision
from workspace.audit import record_change
from workspace.models import AuditEntry, User

REFERENCE_FIELDS = ("external_id", "attributes")


class ExternalIdTaken(Exception):
    """Another asset has this external id in the organisation."""


def save_asset_reference(*, asset: Asset, actor: User, values: dict[str, Any], expected_revision: int | None = None) -> None:
    """Store what the actor's organisation keeps with an asset; `values` has some of REFERENCE_FIELDS.

    The asset's revision counts it. The map data stay as they are: no mission becomes stale, and the asset does not count as edited.
    Raises StaleRevision or ExternalIdTaken.
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
    """Bring back what each organisation kept with an asset that had been deleted, but for ids that are another asset's by now."""
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
