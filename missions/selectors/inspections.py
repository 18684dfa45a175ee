"""Inspections of assets: targets that an aircraft has completed, and the missions of an asset."""

from typing import TYPE_CHECKING, TypedDict

from django.db.models import QuerySet
from django.db.models.functions import Coalesce

from inspection.models import Asset, AssetKind
from inspection.selectors.picking import supports_of_line
from missions.models import InspectionTarget, Mission, TargetState
from missions.selectors.mission_list import count_of, with_simulated_uav


def inspections_of_assets(organisation_id: int) -> QuerySet[InspectionTarget]:
    """Return an organisation's completed targets with `inspected_at`; missions with simulated UAVs inspect nothing."""
    done = InspectionTarget.objects.filter(
        mission__organisation=organisation_id, mission__deleted_at=None, state=TargetState.COMPLETE, asset__isnull=False
    )
    return done.filter(~with_simulated_uav("mission")).annotate(inspected_at=Coalesce("reached_at", "state_at"))


class InspectedCounts(TypedDict):
    """Columns that the query of an asset's missions computes."""

    target_count: int
    inspected_count: int
    is_simulated: bool


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    MissionOfAsset = WithAnnotations[Mission, InspectedCounts]
else:
    MissionOfAsset = Mission


def missions_of_asset(organisation_id: int, asset: Asset) -> QuerySet[MissionOfAsset]:
    """Return missions with targets at the asset or, of a line, at its supports, and the number of these targets."""
    keys = (asset.pk, *(supports_of_line(asset) if asset.kind == AssetKind.LINE else ()))
    targets = InspectionTarget.objects.filter(asset__in=keys)
    missions = Mission.objects.filter(organisation=organisation_id, deleted_at=None)
    return missions.annotate(
        target_count=count_of(targets),
        inspected_count=count_of(targets.filter(state=TargetState.COMPLETE)),
        is_simulated=with_simulated_uav("pk"),
    ).filter(target_count__gt=0)
