"""Restoring an asset or a zone: undoing one change, reverting to an earlier state, or following the source."""

from django.db import IntegrityError, transaction
from django.utils.translation import gettext as _

from inspection.models import Asset, NoFlyZone
from inspection.services.curation import delete_asset, delete_zone, restore_references, save_asset, save_zone
from inspection.services.facts import asset_from_facts, take_asset_facts, take_zone_facts, zone_from_facts
from inspection.services.ground import hold_ground
from workspace.models import AuditEntry, User

SUBJECTS = ("asset", "zone")


class CannotUndo(ValueError):
    """Raised when the change cannot be undone; the message has the reason and the remedy."""


def revert_asset(*, asset: Asset, entry: AuditEntry, actor: User, expected_revision: int | None) -> Asset:
    """Revert the asset to its state before the entry's change. Raises CannotUndo, StaleRevision."""
    if entry.before is None:
        raise CannotUndo(_("Before this there was nothing: delete the asset instead."))
    take_asset_facts(asset, entry.before)
    if not entry.before.get("vanished"):
        asset.vanished_at = None
    return save_asset(asset=asset, actor=actor, expected_revision=expected_revision, action="reverted")


def revert_zone(*, zone: NoFlyZone, entry: AuditEntry, actor: User, expected_revision: int | None) -> NoFlyZone:
    if entry.before is None:
        raise CannotUndo(_("Before this there was nothing: delete the zone instead."))
    take_zone_facts(zone, entry.before)
    return save_zone(zone=zone, actor=actor, expected_revision=expected_revision, action="reverted")


def follow_source(*, asset: Asset, actor: User, expected_revision: int | None) -> Asset:
    """Drop manual edits: the row takes its source's values, and imports keep it so. Raises CannotUndo, StaleRevision."""
    if asset.source_facts is None:
        raise CannotUndo(_("This asset has no other source than what was drawn here."))
    take_asset_facts(asset, asset.source_facts)
    asset.vanished_at = None
    return save_asset(asset=asset, actor=actor, expected_revision=expected_revision, action="followed source")


def undo(*, entry: AuditEntry, actor: User) -> Asset | NoFlyZone | None:
    """Undo the newest change of an asset or zone: a deleted one is restored, a created one removed. Raises CannotUndo."""
    with transaction.atomic():
        hold_ground()
        newer = AuditEntry.objects.filter(subject_type=entry.subject_type, subject_id=entry.subject_id, pk__gt=entry.pk)
        if newer.exists():
            raise CannotUndo(_("It was changed again after this. Undo the newer change first, or revert to an earlier state."))
        try:
            with transaction.atomic():
                return _undo_asset(entry, actor) if entry.subject_type == "asset" else _undo_zone(entry, actor)
        except IntegrityError as error:
            raise CannotUndo(_("An import has brought it back already.")) from error


def _undo_asset(entry: AuditEntry, actor: User) -> Asset | None:
    asset = Asset.objects.filter(pk=entry.subject_id).first()
    if entry.before is None:
        if asset is not None:
            delete_asset(asset=asset, actor=actor)
        return None
    if asset is None:
        asset = asset_from_facts(entry.before, key=int(entry.subject_id))
        restored = save_asset(asset=asset, actor=actor, action="restored")
        restore_references(asset=restored)
        return restored
    return revert_asset(asset=asset, entry=entry, actor=actor, expected_revision=None)


def _undo_zone(entry: AuditEntry, actor: User) -> NoFlyZone | None:
    zone = NoFlyZone.objects.filter(pk=entry.subject_id).first()
    if entry.before is None:
        if zone is not None:
            delete_zone(zone=zone, actor=actor)
        return None
    if zone is None:
        zone = zone_from_facts(entry.before, key=int(entry.subject_id))
        return save_zone(zone=zone, actor=actor, action="restored")
    return revert_zone(zone=zone, entry=entry, actor=actor, expected_revision=None)
