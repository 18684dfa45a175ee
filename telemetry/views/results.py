"""Results of targets over all missions."""

from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from django.db.models import Exists, OuterRef, Prefetch, Q, QuerySet
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import AssetReference
from inspection.selectors import references_of
from missions.models import InspectionTarget, TargetState, Waypoint
from planning.trajectory.waypoints import WaypointKind
from telemetry.models import InspectionResult
from telemetry.serializers.results import ResultPageSerializer, result_json
from telemetry.views.log_filters import mission_of, time_of
from workspace.api.external_data import asked_external_id
from workspace.api.paging import asked_instant, page_of
from workspace.api.schema import CHANGED_SINCE, PAGE_PARAMETERS, TIME
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber

NEWEST_FIRST = ("-state_at", "-pk")
ASSET = WholeNumber("asset", "id of an asset")
FILTERS = [
    ASSET.documented,
    OpenApiParameter("external_id", str, description="your organisation's id of the asset"),
    OpenApiParameter("mission", UUID, description="id of a mission"),
    OpenApiParameter("from", TIME, description="`state_at` at or after this time, with its zone"),
    OpenApiParameter("to", TIME, description="`state_at` before this time, with its zone"),
    OpenApiParameter("reached_from", TIME, description="`reached_at` at or after this time, with its zone"),
    OpenApiParameter("reached_before", TIME, description="`reached_at` before this time, with its zone"),
]


@dataclass(frozen=True, slots=True)
class ResultFilter:
    """None or empty: any value."""

    asset_id: int | None = None
    external_id: str = ""  # of the asset
    mission_id: UUID | None = None
    settled_from: datetime | None = None
    settled_before: datetime | None = None
    reached_from: datetime | None = None
    reached_before: datetime | None = None
    changed_since: datetime | None = None


def results_that_match(organisation_id: int, wanted: ResultFilter) -> QuerySet[InspectionTarget]:
    """Return the targets that were visited or left out, with their planned waypoints and the UAVs' reports.

    Needs three queries for any number of targets.
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


class Results(APIView):
    @extend_schema(
        operation_id="list_results",
        summary="What came of targets over all missions, the newest first",
        description="Targets that are still pending are in their missions alone.",
        parameters=[*FILTERS, CHANGED_SINCE, *PAGE_PARAMETERS],
        responses=ResultPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        organisation_id = request.user.organisation_id
        page = page_of(request, results_that_match(organisation_id, _asked(request)), order=NEWEST_FIRST)
        references = references_of(organisation_id, {row.asset_id for row in page.rows if row.asset_id is not None})
        results = [result_json(row, None if row.asset_id is None else references.get(row.asset_id)) for row in page.rows]
        return Response({"results": results, "next": page.next})


def _asked(request: Request) -> ResultFilter:
    """Return the requested filter. Raises ApiProblem 400."""
    return ResultFilter(
        asset_id=ASSET.asked(request),
        external_id=asked_external_id(request),
        mission_id=mission_of(request),
        settled_from=time_of(request, "from"),
        settled_before=time_of(request, "to"),
        reached_from=time_of(request, "reached_from"),
        reached_before=time_of(request, "reached_before"),
        changed_since=asked_instant(request, "changed_since"),
    )
