"""Reads of missions and UAVs, always within one organisation, and of the inspections of assets."""

from datetime import timedelta
from typing import TYPE_CHECKING, TypedDict
from uuid import UUID

from django.contrib.gis.db.models import Extent
from django.db.models import Prefetch, Q, QuerySet
from django.db.models.functions import Coalesce
from django.utils import timezone

from inspection.models import Asset, AssetKind
from inspection.selectors import UNREAD_OF_A_LINE
from inspection.selectors.picking import supports_of_line
from missions.models import Approval, InspectionTarget, Mission, MissionState, MissionUav, Route, TargetState, Waypoint
from missions.selectors.mission_list import count_of, with_simulated_uav
from workspace.models import OPEN_STATES, AuditEntry, Job, Organisation

PLAN_MISSION = "missions.tasks.plan_mission"
SHOWN_AFTER_END = timedelta(hours=1)  # on live pages


def mission_of_organisation(organisation: Organisation, mission_id: UUID, *, deleted: bool = False) -> Mission:
    """One mission with all that belongs to it. Raises Mission.DoesNotExist also for another organisation's mission."""
    routes = Route.objects.select_related("mission_uav").prefetch_related(Prefetch("waypoints", Waypoint.objects.order_by("sequence")))
    unread = {"geometry", "tags", "node_osm_ids", "parts"} | UNREAD_OF_A_LINE
    targets = InspectionTarget.objects.select_related("asset__line").defer(*(f"asset__{name}" for name in unread))
    return (
        Mission.objects.filter(organisation=organisation, deleted_at__isnull=not deleted)
        .select_related("author", "organisation")
        .prefetch_related(
            Prefetch("mission_uavs", MissionUav.objects.select_related("uav")), Prefetch("targets", targets), Prefetch("routes", routes)
        )
        .get(pk=mission_id)
    )


def mission_alone(organisation: Organisation, mission_id: UUID) -> Mission:
    """One mission without what belongs to it. Raises Mission.DoesNotExist also for another organisation's mission."""
    return Mission.objects.get(organisation=organisation, deleted_at=None, pk=mission_id)


def revision_of_mission(organisation_id: int, mission_id: UUID) -> int | None:
    """Return the revision behind the ETag with a query for one column; None if the mission does not exist."""
    return Mission.objects.filter(organisation=organisation_id, deleted_at=None, pk=mission_id).values_list("revision", flat=True).first()


def state_of_mission(organisation_id: int, mission_id: UUID) -> MissionState | None:
    """Return the mission's state; None if it does not exist."""
    found = Mission.objects.filter(organisation=organisation_id, deleted_at=None, pk=mission_id).values_list("state", flat=True).first()
    return None if found is None else MissionState(found)


def missions_in_the_air(organisation_id: int, *, limit: int) -> list[UUID]:
    """Return the newest missions that fly, or ended within the last hour, as live pages show them."""
    shown = Q(state__in=(MissionState.DISPATCHED, MissionState.ACTIVE)) | Q(ended_at__gt=timezone.now() - SHOWN_AFTER_END)
    rows = Mission.objects.filter(shown, organisation=organisation_id, deleted_at=None).order_by("-started_at", "pk")
    return list(rows.values_list("pk", flat=True)[:limit])


def open_plan_of_mission(mission: Mission) -> UUID | None:
    """Return the job that is planning the mission, the latest if there are several."""
    jobs = Job.objects.filter(organisation=mission.organisation_id, state__in=OPEN_STATES, task=PLAN_MISSION)
    return jobs.filter(parameters__mission=str(mission.pk)).order_by("-created_at").values_list("pk", flat=True).first()


def approval_in_force(mission: Mission) -> Approval | None:
    """Return the approval by which the mission is frozen; None if it was never approved or the approval is revoked."""
    found = Approval.objects.select_related("approved_by", "revoked_by").filter(mission=mission, revoked_at=None)
    return found.defer("document").first()  # large, and rarely read


def history_of_mission(mission: Mission) -> QuerySet[AuditEntry]:
    return AuditEntry.objects.filter(organisation=mission.organisation, subject_type="mission", subject_id=str(mission.pk)).select_related(
        "actor"
    )


def mission_bounds(mission_id: UUID) -> tuple[float, float, float, float] | None:
    """Return west, south, east, north of the mission's initial map view: targets and routes, or UAV positions if there are no routes."""
    targets = InspectionTarget.objects.filter(mission=mission_id).order_by()
    of_targets = targets.aggregate(
        points=Extent("position"), stretches=Extent("stretch"), assets=Extent("asset__centre", filter=Q(position=None, stretch=None))
    )
    routes = Route.objects.filter(mission=mission_id).order_by().aggregate(extent=Extent("geometry"))["extent"]
    starts = None if routes else MissionUav.objects.filter(mission=mission_id).order_by().aggregate(extent=Extent("start"))["extent"]
    boxes = [box for box in (*of_targets.values(), routes, starts) if box]
    if not boxes:
        return None
    west, south, east, north = zip(*boxes, strict=True)
    return min(west), min(south), max(east), max(north)


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
