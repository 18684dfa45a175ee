"""Photos of a mission, in pages and as files."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple
from uuid import UUID

from django.http import Http404, StreamingHttpResponse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import Mission
from telemetry.exports.captures import CaptureRow, capture_feature, captures_csv, captures_geojson
from telemetry.selectors.captures import ORDER, all_captures, capture_rows, captures_of_mission
from telemetry.selectors.mission_record import mission_on_record
from telemetry.serializers.captures import CaptureCollectionSerializer
from telemetry.views.exports import NOTHING, file_stem
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.renderers import FastJSONRenderer, OneAnswer
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest


class CaptureFile(NamedTuple):
    media_type: str
    pieces: Callable[[Iterable[CaptureRow]], Iterator[str]]


CAPTURE_KINDS = {
    "csv": CaptureFile("text/csv; charset=utf-8", captures_csv),
    "geojson": CaptureFile("application/geo+json", captures_geojson),
}
KIND = OpenApiParameter("kind", str, OpenApiParameter.PATH, enum=[*CAPTURE_KINDS], description="how the file ends")
FILES: dict[Any, Any] = {(200, kind.media_type.partition(";")[0]): OpenApiTypes.STR for kind in CAPTURE_KINDS.values()} | NOTHING


def _mission(request: SignedInRequest, mission_id: UUID) -> Mission:
    mission = mission_on_record(request.user.organisation, mission_id)
    if mission is None:
        raise Http404
    return mission


class MissionCaptures(APIView):
    renderer_classes = [FastJSONRenderer]

    @extend_schema(
        operation_id="list_mission_captures",
        summary="Photos that UAVs took in a mission, by time",
        description=(
            "GeoJSON. Of each photo: where and when it was taken and where the camera looked, with the source of each and its bound. "
            "Several messages about one photo are one Feature."
        ),
        parameters=PAGE_PARAMETERS,
        responses=CaptureCollectionSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        page = page_of(request, captures_of_mission(_mission(request, mission_id)), order=ORDER)
        features = [capture_feature(row) for row in capture_rows(page.rows)]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class MissionCapturesFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_mission_captures",
        summary="Photos that UAVs took in a mission, as CSV or GeoJSON",
        parameters=[KIND],
        responses=FILES,
    )
    def get(self, request: SignedInRequest, mission_id: UUID, kind: str) -> StreamingHttpResponse:
        mission = _mission(request, mission_id)
        if not mission.captures.exists():
            raise ApiProblem(409, "no_photos", _("No photo of this mission was reported."))
        wanted = CAPTURE_KINDS[kind]
        response = StreamingHttpResponse(wanted.pieces(all_captures(mission)), content_type=wanted.media_type)
        response["Content-Disposition"] = f'attachment; filename="{file_stem(mission.name)}-photos.{kind}"'
        response["Cache-Control"] = "private, no-cache"
        return response
