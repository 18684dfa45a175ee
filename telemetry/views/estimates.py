"""Where UAVs of a mission were estimated to be while nothing was heard of them."""

from uuid import UUID

from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.views.missions import mission_or_404
from telemetry.selectors.estimates import estimates_of_mission
from telemetry.serializers.estimates import EstimateCollectionSerializer, estimate_feature
from telemetry.views.log_filters import THINNED, UAV, sampled, time_of
from workspace.paging import asked_flag, page_of
from workspace.renderers import FastJSONRenderer
from workspace.schema import PAGE_PARAMETERS, TIME
from workspace.signed_in import SignedInRequest

FILTERS = [
    OpenApiParameter("from", TIME, description="of moments at or after this time, with its zone"),
    OpenApiParameter("to", TIME, description="of moments before this time, with its zone"),
    UAV.documented,
    OpenApiParameter("replaced", bool, description="true: those for whose second a measurement came later; false: the others"),
    *THINNED,
]


class MissionEstimates(APIView):
    renderer_classes = [FastJSONRenderer]

    @extend_schema(
        operation_id="list_estimates",
        summary="Where UAVs of a mission were estimated to be between their reports, second by second",
        description=(
            "GeoJSON, in the order of the moments. There is an estimate for each second of the server's clock in which nothing was "
            "measured, or in which what was measured came later: then it is marked as replaced, and stays, so that it can be seen how "
            "good it was."
        ),
        parameters=[*FILTERS, *PAGE_PARAMETERS],
        responses=EstimateCollectionSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        estimates = estimates_of_mission(
            mission_or_404(request.user, mission_id),
            uav_id=UAV.asked(request),
            estimated_from=time_of(request, "from"),
            estimated_before=time_of(request, "to"),
            is_replaced=asked_flag(request, "replaced"),
        )
        chosen = sampled(request, estimates, time="estimated_for")
        page = page_of(request, chosen.rows, order=("estimated_for", "pk"))
        features = [estimate_feature(row) for row in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "every_s": chosen.every_s, "next": chosen.next(page.next)})
