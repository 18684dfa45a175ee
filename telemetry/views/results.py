"""What came of targets, over all missions."""

from uuid import UUID

from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.selectors import references_of
from telemetry.selectors.results import ResultFilter, results_that_match
from telemetry.serializers.results import ResultPageSerializer, result_json
from telemetry.views.log_filters import mission_of, time_of
from workspace.external_data import asked_external_id
from workspace.paging import asked_instant, page_of
from workspace.schema import CHANGED_SINCE, PAGE_PARAMETERS, TIME
from workspace.signed_in import SignedInRequest
from workspace.whole_numbers import WholeNumber

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
    """Raises ApiProblem 400."""
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
