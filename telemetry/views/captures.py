"""Photos of a mission, in pages and as files."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple
from uuid import UUID

from django.http import Http404, StreamingHttpResponse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework import serializers
from rest_framework.response import Response
from rest_framework.views import APIView

from mavlink.decoding.captures import AttitudeSource, CaptureTimeSource, PositionSource
from mavlink.decoding.gimbal_attitude import YawFrame
from missions.models import Mission
from missions.serializers.uavs import PointSerializer
from telemetry.exports.captures import CaptureRow, capture_feature, captures_csv, captures_geojson
from telemetry.selectors.captures import ORDER, all_captures, capture_rows, captures_of_mission
from telemetry.selectors.mission_record import mission_on_record
from telemetry.views.exports import NOTHING, file_stem
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.renderers import FastJSONRenderer, OneAnswer
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest


class CapturePropertiesSerializer(serializers.Serializer):
    """A photo. Null is unknown, an empty source too; bounds are those of 95 %."""

    uav = serializers.IntegerField()
    uav_name = serializers.CharField()
    mission = serializers.UUIDField(allow_null=True)
    taken_at = serializers.DateTimeField(help_text="by the server's clock")
    received_at = serializers.DateTimeField()
    time_source = serializers.ChoiceField(choices=[(one.value, one.value) for one in CaptureTimeSource])
    time_bound_s = serializers.FloatField(allow_null=True)
    flight = serializers.IntegerField(allow_null=True, help_text="of the approved route, from 1")
    waypoint_sequence = serializers.IntegerField(allow_null=True, help_text="of the approved route")
    mission_item = serializers.IntegerField(allow_null=True, help_text="that the autopilot's list was at, as it counts")
    is_taken = serializers.BooleanField(help_text="false: the camera reported a failure")
    camera = serializers.IntegerField(allow_null=True, help_text="MAVLink component of the camera")
    image_index = serializers.IntegerField(allow_null=True, help_text="as its sender counts; begins anew after a restart")
    position_source = serializers.ChoiceField(choices=[(one.value, one.value) for one in PositionSource], allow_blank=True)
    position_bound_m = serializers.FloatField(allow_null=True, help_text="radius")
    altitude_amsl_m = serializers.FloatField(allow_null=True)
    altitude_relative_m = serializers.FloatField(allow_null=True, help_text="above take-off")
    altitude_agl_m = serializers.FloatField(allow_null=True, help_text="above ground, as the UAV measured it")
    roll_deg = serializers.FloatField(allow_null=True, help_text="right side down")
    pitch_deg = serializers.FloatField(allow_null=True, help_text="from the horizon; -90 is straight down")
    yaw_deg = serializers.FloatField(allow_null=True, help_text="clockwise")
    yaw_frame = serializers.ChoiceField(
        choices=[(one.value, one.value) for one in YawFrame], allow_blank=True, help_text="earth: from true north; vehicle: from the nose"
    )
    attitude_source = serializers.ChoiceField(
        choices=[(one.value, one.value) for one in AttitudeSource], allow_blank=True,
        help_text="vehicle: of the airframe; where the camera looked is unknown",
    )  # fmt: skip
    file_url = serializers.CharField(allow_blank=True, help_text="of the picture, as the camera names it")


class CaptureFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = PointSerializer(allow_null=True)
    properties = CapturePropertiesSerializer()


class CaptureCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = CaptureFeatureSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="path and query of the next page")


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
