"""The log: records by place, time, mission and UAV, and the newest of a UAV."""

from django.http import Http404
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.views.uavs import uav_or_404
from telemetry.exports.geojson_file import record_feature
from telemetry.selectors.log import as_logged, in_time, latest_record, records_that_match
from telemetry.serializers.log import RecordCollectionSerializer, RecordFeatureSerializer
from telemetry.views.log_filters import FILTERS, asked_log, sampled
from workspace.paging import page_of
from workspace.renderers import FastJSONRenderer
from workspace.schema import PAGE_PARAMETERS
from workspace.signed_in import SignedInRequest


class TelemetryLog(APIView):
    renderer_classes = [FastJSONRenderer]

    @extend_schema(
        operation_id="list_telemetry",
        summary="What UAVs reported, in the order of measurement",
        description=(
            "GeoJSON. Without a UAV, a mission or a beginning: of the last day. Records from the future and out of order are among them, "
            "flagged. Thinning out is done in the database: `every_s` keeps the first record of each UAV in each so many seconds, `most` "
            "chooses the seconds."
        ),
        parameters=[*FILTERS, *PAGE_PARAMETERS],
        responses=RecordCollectionSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        records = records_that_match(request.user.organisation, asked_log(request))
        chosen = sampled(request, records, of=in_time)
        page = page_of(request, chosen.rows.select_related("uav", "stream"), order=("measured_at", "pk"))
        return Response(
            {
                "type": "FeatureCollection",
                "features": [record_feature(as_logged(record)) for record in page.rows],
                "every_s": chosen.every_s,
                "next": chosen.next(page.next),
            }
        )


class LatestTelemetry(APIView):
    @extend_schema(
        operation_id="get_latest_telemetry",
        summary="What a UAV measured last; never a record from the future",
        responses=RecordFeatureSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        record = latest_record(uav_or_404(request.user, uav_id))
        if record is None:
            raise Http404
        return Response(record_feature(as_logged(record)))
