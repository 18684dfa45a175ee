"""Deletes the assets of a whole region: those that files brought into a box, of an import, or of a set. Renames and deletes regions."""

from dataclasses import dataclass
from typing import Any

from django.db import transaction
from django.db.models import Count, F, Q, QuerySet
from django.utils import timezone

from inspection.models import Asset, AssetSet, DataImport, Region, ZoneSet
from inspection.region_hooks import after_deletion
from inspection.selectors.assets import Box, area_of
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from inspection.services.imports.terrain import remove_terrain
from inspection.services.imports.zone_sets import empty_zone_set
from workspace.audit import record_change
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation, User


@dataclass(frozen=True)
class AssetGroup:
    """One of the four; a box means everything that intersects it."""

    box: Box | None = None
    data_import: DataImport | None = None
    asset_set: AssetSet | None = None
    region: Region | None = None

    @property
    def words(self) -> dict[str, Any]:
        return {
            "bbox": list(self.box) if self.box else None,
            "import": self.data_import and {"id": self.data_import.pk, "file_name": self.data_import.file_name},
            "set": self.asset_set and self.asset_set.name,
            "region": self.region and self.region.name,
        }


def assets_of_region(region: AssetGroup) -> QuerySet[Asset]:
    """Return assets from files; drawn or manually edited ones stay, since no file would restore them."""
    sourced = Q(osm_id__isnull=False) | Q(asset_set__isnull=False)
    assets = Asset.objects.filter(sourced, vanished_at=None, is_edited=False).order_by()
    if region.box is not None:
        assets = assets.filter(geometry__intersects=area_of(region.box))
    if region.region is not None:
        assets = assets.filter(data_import__region=region.region)
    if region.data_import is not None:
        assets = assets.filter(data_import=region.data_import)
    return assets.filter(asset_set=region.asset_set) if region.asset_set is not None else assets


def counts_of_region(region: AssetGroup) -> dict[str, int]:
    return dict(assets_of_region(region).values_list("kind").annotate(Count("pk")))


def delete_region(*, region: AssetGroup, actor: User | None) -> dict[str, int]:
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


class NameTaken(Exception):
    """Raised where another region has the name."""


def rename_region(*, region: Region, name: str, actor: User) -> None:
    """Raises NameTaken."""
    with transaction.atomic():
        hold_ground()
        if Region.objects.filter(name=name).exclude(pk=region.pk).exists():
            raise NameTaken
        before, region.name = region.name, name
        region.save(update_fields=["name"])
        record_change(
            organisation=actor.organisation, actor=actor, action="renamed", subject_type="region", subject_id=region.pk,
            before={"name": before}, after={"name": name},
        )  # fmt: skip


def delete_all_of_region(*, region: Region, actor: User) -> dict[str, int]:
    """Delete assets, zones and terrain of a region, and what other apps have of the demo there. Returns the number of each."""
    with transaction.atomic():
        counts = counts_of_whole_region(region)
        is_demo = region.imports.filter(is_synthetic=True).exists()
        for zone_set in ZoneSet.objects.filter(data_import__region=region):
            empty_zone_set(zone_set=zone_set, actor=actor)
        for data_import in region.imports.filter(terrain_tiles__isnull=False).distinct():
            remove_terrain(data_import=data_import, actor=actor)
        delete_region(region=AssetGroup(region=region), actor=actor)
        if is_demo:
            after_deletion(actor)
    return counts


def counts_of_whole_region(region: Region) -> dict[str, int]:
    zones = ZoneSet.objects.filter(data_import__region=region).aggregate(found=Count("zones"))["found"]
    terrain = region.imports.filter(terrain_tiles__isnull=False).distinct().count()
    counts = counts_of_region(AssetGroup(region=region)) | {"zone": zones, "terrain": terrain}
    return {kind: number for kind, number in counts.items() if number}
