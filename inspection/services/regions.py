"""Deletes the assets of a whole region: those that files brought into a box, of an import, or of a set."""

from dataclasses import dataclass
from typing import Any

from django.db import transaction
from django.db.models import Count, F, Q, QuerySet
from django.utils import timezone

from inspection.models import Asset, AssetSet, DataImport
from inspection.selectors.assets import Box, area_of
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from workspace.audit import record_change
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation, User


@dataclass(frozen=True)
class Region:
    """One of the three; a box means everything that intersects it."""

    box: Box | None = None
    data_import: DataImport | None = None
    asset_set: AssetSet | None = None

    @property
    def words(self) -> dict[str, Any]:
        return {
            "bbox": list(self.box) if self.box else None,
            "import": self.data_import and {"id": self.data_import.pk, "file_name": self.data_import.file_name},
            "set": self.asset_set and self.asset_set.name,
        }


def assets_of_region(region: Region) -> QuerySet[Asset]:
    """Return assets from files; drawn or manually edited ones stay, since no file would restore them."""
    sourced = Q(osm_id__isnull=False) | Q(asset_set__isnull=False)
    assets = Asset.objects.filter(sourced, vanished_at=None, is_edited=False).order_by()
    if region.box is not None:
        assets = assets.filter(geometry__intersects=area_of(region.box))
    if region.data_import is not None:
        assets = assets.filter(data_import=region.data_import)
    return assets.filter(asset_set=region.asset_set) if region.asset_set is not None else assets


def counts_of_region(region: Region) -> dict[str, int]:
    return dict(assets_of_region(region).values_list("kind").annotate(Count("pk")))


def delete_region(*, region: Region, actor: User | None) -> dict[str, int]:
    """Mark all assets of the region as vanished and return the number of each kind; missions keep their references.

    The next file that has an asset restores it. One history entry records the user and the region.
    """
    with transaction.atomic():
        hold_ground()
        counts = counts_of_region(region)
        if not counts:
            return {}
        now = timezone.now()
        assets_of_region(region).update(vanished_at=now, revision=F("revision") + 1, updated_at=now)
        number_supports()
        organisation = actor.organisation if actor else Organisation.objects.get(pk=DEFAULT_ORGANISATION_ID)
        record_change(
            organisation=organisation, actor=actor, action="deleted", subject_type="region", subject_id=now.isoformat(),
            before={**region.words, "counts": counts},
        )  # fmt: skip
        mark_ground_changed()
    return counts
