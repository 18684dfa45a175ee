"""Deletes the assets of a whole region: those that files brought into a box, of an import, or of a set. Renames and deletes regions."""

from dataclasses import dataclass
from typing import Any

from django.db import transaction
from django.db.models import Count, F, Q, QuerySet
from django.utils import timezone

from inspection.hooks import after_deletion
from inspection.models import Asset, AssetSet, DataImport, NoFlyZone, Region, ZoneSet
from inspection.selectors.assets import Box, area_of
from inspection.services.ground import hold_ground, mark_ground_changed, number_supports
from inspection.services.imports.regions import fit_regions, has_demo_data, lies_within
from inspection.services.imports.terrain import remove_terrain
from inspection.services.imports.zone_sets import empty_zone_set
from inspection.services.proposals.reading import Progress
from operation.reasons import Reason
from workspace.audit import record_change
from workspace.jobs.services import JobCancelled, create_job, finish_job
from workspace.models import DEFAULT_ORGANISATION_ID, Job, Organisation, User

DELETE_TASK = "inspection.tasks.delete_region"


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


def assets_of_group(group: AssetGroup) -> QuerySet[Asset]:
    """Return assets from files; drawn or manually edited ones stay, since no file would restore them."""
    sourced = Q(osm_id__isnull=False) | Q(asset_set__isnull=False)
    assets = Asset.objects.filter(sourced, vanished_at=None, is_edited=False).order_by()
    if group.box is not None:
        assets = assets.filter(geometry__intersects=area_of(group.box))
    if group.region is not None:
        assets = assets.filter(data_import__region=group.region)
    if group.data_import is not None:
        assets = assets.filter(data_import=group.data_import)
    return assets.filter(asset_set=group.asset_set) if group.asset_set is not None else assets


def counts_of_group(group: AssetGroup) -> dict[str, int]:
    return dict(assets_of_group(group).values_list("kind").annotate(Count("pk")))


def delete_assets(*, group: AssetGroup, actor: User | None) -> dict[str, int]:
    """Mark all assets of the group as vanished and return the number of each kind; missions keep their references.

    The next file that has an asset restores it. One history entry records the user and the group.
    """
    with transaction.atomic():
        hold_ground()
        counts = counts_of_group(group)
        if not counts:
            return {}
        now = timezone.now()
        assets = assets_of_group(group)
        regions = list(assets.exclude(data_import__region=None).values_list("data_import__region", flat=True).distinct())
        assets.update(vanished_at=now, revision=F("revision") + 1, updated_at=now)
        fit_regions(regions)
        number_supports()
        organisation = actor.organisation if actor else Organisation.objects.get(pk=DEFAULT_ORGANISATION_ID)
        record_change(
            organisation=organisation, actor=actor, action="deleted", subject_type="region", subject_id=now.isoformat(),
            before={**group.words, "counts": counts},
        )  # fmt: skip
        mark_ground_changed()
    return counts


class RegionNameTaken(Exception):
    """Raised where another region has the name."""


def rename_region(*, region: Region, name: str, actor: User) -> None:
    """Rename a region. Raises RegionNameTaken."""
    with transaction.atomic():
        hold_ground()
        if Region.objects.filter(name=name).exclude(pk=region.pk).exists():
            raise RegionNameTaken
        before, region.name = region.name, name
        region.save(update_fields=["name"])
        record_change(
            organisation=actor.organisation, actor=actor, action="renamed", subject_type="region", subject_id=region.pk,
            before={"name": before}, after={"name": name},
        )  # fmt: skip


def delete_region(*, region: Region, actor: User, progress: Progress | None = None) -> dict[str, int]:
    """Delete assets, zones and terrain of a region, and the demo's UAVs if it is the demo and the actor plans. Returns their numbers.

    Zone sets and terrain that reach beyond the region serve others too, and stay.
    """

    def notify(code: str, share: float) -> None:
        if progress is not None:
            progress(Reason(code), share)

    with transaction.atomic():
        hold_ground()
        counts = counts_of_region(region)
        is_demo = has_demo_data(region)
        notify("deleting_zones", 0.0)
        for zone_set in _zone_sets_of(region):
            empty_zone_set(zone_set=zone_set, actor=actor)
        notify("deleting_terrain", 0.2)
        for data_import in _terrain_of(region):
            remove_terrain(data_import=data_import, actor=actor)
        notify("deleting_assets", 0.4)
        delete_assets(group=AssetGroup(region=region), actor=actor)
        notify("deleting_rest", 0.9)
        if is_demo and actor.can_plan:
            after_deletion(actor)
    return counts


def ask_to_delete_region(*, region: Region, actor: User) -> Job:
    """Create the job that deletes a region; the caller sends it to its queue after the commit."""
    return create_job(
        organisation=actor.organisation, created_by=actor, task=DELETE_TASK, parameters={"region": region.pk},
        message=Reason("waiting_to_be_deleted"),
    )  # fmt: skip


def delete_region_of(*, job: Job, progress: Progress) -> None:
    """Delete the region of a job, completely or not at all: one that was interrupted begins again."""
    with transaction.atomic():
        region = Region.objects.filter(pk=job.parameters["region"]).first()
        actor, counts = job.created_by, {}
        if region is not None and actor is not None:
            counts = delete_region(region=region, actor=actor, progress=progress)
        if not finish_job(job=job, result={"counts": counts}, message=Reason("region_deleted")):
            raise JobCancelled


def counts_of_region(region: Region) -> dict[str, int]:
    """Return what delete_region deletes: assets and zones by number, and files of terrain."""
    zones = NoFlyZone.objects.filter(zone_set__in=_zone_sets_of(region)).count()
    counts = counts_of_group(AssetGroup(region=region)) | {"zone": zones, "terrain": len(_terrain_of(region))}
    return {kind: number for kind, number in counts.items() if number}


def _zone_sets_of(region: Region) -> list[ZoneSet]:
    rows = ZoneSet.objects.filter(data_import__region=region).select_related("data_import")
    return [row for row in rows if row.data_import is not None and _is_of(row.data_import, region)]


def _terrain_of(region: Region) -> list[DataImport]:
    return [row for row in region.imports.filter(terrain_tiles__isnull=False).distinct() if _is_of(row, region)]


def _is_of(data_import: DataImport, region: Region) -> bool:
    """Return whether data belong to this region alone: they do not reach beyond it, or are part of the demo."""
    return data_import.is_synthetic or lies_within(data_import, region)
