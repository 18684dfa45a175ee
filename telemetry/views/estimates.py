"""Estimated positions of a mission's UAVs between their reports."""

from typing import Any
from uuid import UUID

from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework import serializers
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.serializers.uavs import PointSerializer
from missions.views.missions import mission_or_404
from telemetry.exports.logged_record import time_text
from telemetry.models import PositionEstimate
from telemetry.selectors.estimates import estimates_of_mission
from telemetry.views.log_filters import THINNED, UAV, sampled, time_of
from workspace.api.paging import asked_flag, page_of
from workspace.api.renderers import FastJSONRenderer
from workspace.api.schema import PAGE_PARAMETERS, TIME
from workspace.api.signed_in import SignedInRequest

FIGURES = (
    "altitude_amsl_m", "altitude_relative_m", "speed_mps", "heading_deg", "bound_along_m", "bound_across_m", "bound_bearing_deg",
    "bound_height_m", "bound_speed_mps",
)  # fmt: skip
FILTERS = [
    OpenApiParameter("from", TIME, description="of moments at or after this time, with its zone"),
    OpenApiParameter("to", TIME, description="of moments before this time, with its zone"),
    UAV.documented,
    OpenApiParameter("replaced", bool, description="true: those for whose second a measurement came later; false: the others"),
    *THINNED,
]


class EstimatePropertiesSerializer(serializers.Serializer):
    """Bounds hold with 95 %: an ellipse around the position, with semi-axes along a bearing and across it; heights and speed ±."""

    uav = serializers.IntegerField()
    estimated_for = serializers.DateTimeField(help_text="the moment that it speaks of")
    made_at = serializers.DateTimeField(help_text="by the server's clock")
    report_at = serializers.DateTimeField(allow_null=True, help_text="when the last report that it rests on was measured")
    replaced_at = serializers.DateTimeField(allow_null=True, help_text="since when there is a measurement of that second")
    waypoint_sequence = serializers.IntegerField(allow_null=True, help_text="of the approved route that it flew to, or was at")
    is_lost = serializers.BooleanField(help_text="past what the estimator vouches for")

    def get_fields(self) -> dict[str, serializers.Field]:
        known = {"altitude_amsl_m", "altitude_relative_m", "heading_deg"}
        return super().get_fields() | {name: serializers.FloatField(allow_null=name in known) for name in FIGURES}


class EstimateFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = PointSerializer()
    properties = EstimatePropertiesSerializer()


class EstimateCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = EstimateFeatureSerializer(many=True)
    every_s = serializers.FloatField(allow_null=True, help_text="how far apart the estimates of a UAV were chosen; null: all of them")
    next = serializers.CharField(allow_null=True, help_text="path and query of the next page")


def estimate_feature(estimate: PositionEstimate) -> dict[str, Any]:
    times = {name: getattr(estimate, name) for name in ("estimated_for", "made_at", "report_at", "replaced_at")}
    return {
        "type": "Feature",
        "id": estimate.pk,
        "geometry": {"type": "Point", "coordinates": [estimate.position.x, estimate.position.y]},
        "properties": {
            "uav": estimate.uav_id,
            **{name: None if at is None else time_text(at) for name, at in times.items()},
            "waypoint_sequence": estimate.waypoint_sequence,
            "is_lost": estimate.is_lost,
            **{name: getattr(estimate, name) for name in FIGURES},
        },
    }


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
