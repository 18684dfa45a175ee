"""The record of a mission, and all of it as one file."""

from uuid import UUID

from django.http import FileResponse, Http404
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import Mission
from telemetry.selectors.mission_record import mission_on_record, mission_record
from telemetry.serializers.mission_record import MissionRecordSerializer
from telemetry.services.record_file import record_file
from telemetry.views.exports import file_stem
from workspace.negotiation import OneAnswer
from workspace.signed_in import SignedInRequest


def _mission(request: SignedInRequest, mission_id: UUID) -> Mission:
    mission = mission_on_record(request.user.organisation, mission_id)
    if mission is None:
        raise Http404
    return mission


class MissionRecord(APIView):
    @extend_schema(
        operation_id="get_mission_record",
        summary="What was planned, what was flown, and what came of each target",
        description=(
            "By leg: how far off the route and outside of the planned heights the UAV was. By target: when it was reached, how near, how "
            "long it was held. May be asked for at any time; it is whole once the mission has ended. Positions: /telemetry?mission=; "
            "estimates: /missions/{id}/estimates; alerts: /alerts?mission=; commands: /missions/{id}/commands."
        ),
        responses=MissionRecordSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        return Response(MissionRecordSerializer(mission_record(_mission(request, mission_id))).data)


class MissionRecordFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_mission_record",
        summary="All data of a mission in one ZIP file",
        description="Plan as approved, telemetry, estimates, alerts, commands, results, MAVLink logs. README.txt in it says what is where.",
        responses={(200, "application/zip"): OpenApiTypes.BINARY},
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> FileResponse:
        mission = _mission(request, mission_id)
        response = FileResponse(
            record_file(request.user.organisation, mission),
            as_attachment=True,
            filename=f"{file_stem(mission.name)}-record.zip",
            content_type="application/zip",
        )
        response["Cache-Control"] = "private, no-cache"
        return response
