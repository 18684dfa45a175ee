"""Edits of many assets at once: one transaction, with a history entry for each asset, and undone together."""

from collections.abc import Callable, Collection, Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any

from django.db import transaction
from django.db.models import Max
from django.utils import timezone

from inspection.models import Asset
from inspection.services.curation import derive
from inspection.services.facts import asset_facts, differing, take_asset_facts
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from workspace.models import AuditEntry, User

BULK_FACTS = ("operator", "voltages_v", "circuits", "height_m", "is_flyable")
ROWS_A_STATEMENT = 100  # each row is compared with all others of its statement
_WRITTEN = (*BULK_FACTS, "max_voltage_v", "is_edited", "source_facts", "revision", "updated_at")


@dataclass(frozen=True)
class BulkUndo:
    undone: int
    kept: int  # changed again since, or gone


def change_assets(*, keys: Collection[int], values: Mapping[str, Any], actor: User) -> list[int]:
    """Set some of BULK_FACTS and return the keys of the history entries, one for each asset that changed."""

    def change(asset: Asset) -> None:
        for name, value in values.items():
            setattr(asset, name, value)

    with transaction.atomic():
        return _edit(keys, change, actor, "changed")


def undo_changes(*, entries: Collection[int], actor: User) -> BulkUndo:
    """Bring assets back to what they were before these changes; those that were changed again since stay."""
    with transaction.atomic():
        hold_ground()
        wanted = {entry.subject_id: entry for entry in AuditEntry.objects.filter(pk__in=entries, subject_type="asset", action="changed")}
        numbers = AuditEntry.objects.filter(subject_type="asset", subject_id__in=wanted).order_by().values_list("subject_id")
        last = dict(numbers.annotate(last=Max("pk")))
        own = {
            int(key): earlier for key, entry in wanted.items() if last[key] == entry.pk and (earlier := _facts_before(entry)) is not None
        }
        undone = _edit(own, lambda asset: take_asset_facts(asset, own[asset.pk]), actor, "reverted")
    return BulkUndo(len(undone), len(entries) - len(undone))


def _facts_before(entry: AuditEntry) -> dict[str, Any] | None:
    """Return BULK_FACTS before a change; None for a change of other facts."""
    before, after = differing(entry.before, entry.after)
    if entry.before is None or after is None or not {*(before or ())} <= {*BULK_FACTS, "is_edited"}:
        return None
    return {name: entry.before[name] for name in BULK_FACTS}


def _edit(keys: Collection[int], change: Callable[[Asset], None], actor: User, action: str) -> list[int]:
    hold_ground()
    now, rows, entries = timezone.now(), [], []
    for asset in Asset.objects.select_for_update(of=["self"]).filter(pk__in=keys, vanished_at=None).order_by("pk"):
        before = copy(asset)
        change(asset)
        if not derive(asset, before):
            continue
        asset.revision, asset.updated_at = before.revision + 1, now
        rows.append(asset)
        entries.append(
            AuditEntry(
                organisation=actor.organisation, actor=actor, action=action, subject_type="asset", subject_id=str(asset.pk),
                before=asset_facts(before), after=asset_facts(asset),
            )
        )  # fmt: skip
    if not rows:
        return []
    Asset.objects.bulk_update(rows, _WRITTEN, batch_size=ROWS_A_STATEMENT)
    AuditEntry.objects.bulk_create(entries, batch_size=1_000)
    number_supports()
    mark_ground_changed()
    return [entry.pk for entry in entries]
