"""What came of targets, over all missions of an organisation."""

from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from django.db.models import Exists, OuterRef, Prefetch, Q, QuerySet

from inspection.models import AssetReference
from missions.models import InspectionTarget, TargetState, Waypoint, WaypointKind
from telemetry.models import InspectionResult


@dataclass(frozen=True, slots=True)
class ResultFilter:
    """None, or empty: whatever it is."""

    asset_id: int | None = None
    external_id: str = ""  # of the asset
    mission_id: UUID | None = None
    settled_from: datetime | None = None
    settled_before: datetime | None = None
    reached_from: datetime | None = None
    reached_before: datetime | None = None
    changed_since: datetime | None = None


def results_that_match(organisation_id: int, wanted: ResultFilter) -> QuerySet[InspectionTarget]:
    """The targets that a UAV was at, or that were left out, with what was planned and what UAVs reported of each.

    Three queries, however many there are.
    """
    targets = InspectionTarget.objects.filter(
        mission__organisation=organisation_id, mission__deleted_at=None, state_at__isnull=False
    ).exclude(state=TargetState.PENDING)
    if wanted.external_id:
        named = AssetReference.objects.filter(organisation=organisation_id, external_id=wanted.external_id)
        targets = targets.filter(asset__in=named.values("asset"))
    if wanted.changed_since is not None:
        reported = InspectionResult.objects.filter(target=OuterRef("pk"), received_at__gte=wanted.changed_since)
        since = Q(state_at__gte=wanted.changed_since) | Q(visit_stored_at__gte=wanted.changed_since)
        targets = targets.filter(since | Exists(reported))
    asked = {
        "asset": wanted.asset_id, "mission": wanted.mission_id, "state_at__gte": wanted.settled_from, "state_at__lt": wanted.settled_before,
        "reached_at__gte": wanted.reached_from, "reached_at__lt": wanted.reached_before,
    }  # fmt: skip
    targets = targets.filter(**{name: value for name, value in asked.items() if value is not None})
    planned = Waypoint.objects.filter(kind=WaypointKind.TARGET).select_related("route__mission_uav").order_by("sequence")
    reported_all = InspectionResult.objects.select_related("uav").order_by("measured_at", "pk")
    return targets.select_related("mission", "asset").prefetch_related(
        Prefetch("waypoints", planned, to_attr="planned_waypoints"), Prefetch("results", reported_all, to_attr="reported_results")
    )
