"""Mission report, its results as files, and all data of a mission as one file."""

from collections.abc import Callable
from typing import Any, NamedTuple
from uuid import UUID

from django.http import FileResponse, Http404, HttpResponse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import Mission
from telemetry.exports.results import MissionResults
from telemetry.exports.results_geojson import results_geojson
from telemetry.exports.results_kml import results_kml
from telemetry.exports.results_table import results_csv, results_xlsx
from telemetry.selectors.mission_record import mission_on_record, mission_record, whole_record
from telemetry.selectors.mission_results import mission_results
from telemetry.serializers.mission_record import MissionRecordSerializer
from telemetry.services.record_file import record_file
from telemetry.views.exports import NOTHING, file_stem
from workspace.api.errors import ApiProblem
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest


class ResultKind(NamedTuple):
    media_type: str
    bytes_of: Callable[[MissionResults], bytes]


def _xlsx(results: MissionResults) -> bytes:
    headings = {
        "number": _("No."),
        "asset": _("Asset"),
        "asset_id": _("Asset ID"),
        "external_id": _("External ID"),
        "line": _("Line"),
        "result": _("Result"),
        "reason": _("Reason"),
        "reason_at": _("Time of the reason (UTC)"),
        "uav": _("UAV"),
        "reached_at": _("Reached (UTC)"),
        "planned_hold_s": _("Planned hold [s]"),
        "held_s": _("Hold [s]"),
        "distance_m": _("Distance [m]"),
        "altitude_relative_m": _("Height above take-off [m]"),
        "longitude_deg": _("Longitude [deg]"),
        "latitude_deg": _("Latitude [deg]"),
    }
    return results_xlsx(results, headings, _("Results"))


RESULT_KINDS = {
    "csv": ResultKind("text/csv; charset=utf-8", results_csv),
    "xlsx": ResultKind("application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", _xlsx),
    "geojson": ResultKind("application/geo+json", results_geojson),
    "kml": ResultKind(
        "application/vnd.google-earth.kml+xml",
        lambda results: results_kml(results, [_("Targets"), _("Incidents"), _("Planned"), _("Flown")]),
    ),
}
RESULT_KIND = OpenApiParameter("kind", str, OpenApiParameter.PATH, enum=[*RESULT_KINDS], description="how the file ends")
RESULT_FILES: dict[Any, Any] = {(200, kind.media_type.partition(";")[0]): OpenApiTypes.BINARY for kind in RESULT_KINDS.values()} | NOTHING


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
        responses={(200, "application/zip"): OpenApiTypes.BINARY, **NOTHING},
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> FileResponse:
        mission = _mission(request, mission_id)
        if not (mission.approvals.exists() or mission.records.exists()):
            raise ApiProblem(409, "nothing_recorded", _("This mission was not approved: nothing of it is recorded."))
        response = FileResponse(
            record_file(request.user.organisation, mission),
            as_attachment=True,
            filename=f"{file_stem(mission.name)}-record.zip",
            content_type="application/zip",
        )
        response["Cache-Control"] = "private, no-cache"
        return response


class MissionResultsFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_mission_results",
        summary="The results of a mission, as CSV, XLSX, GeoJSON or KML",
        description=(
            "Of each target: asset, line, result, reason, UAV, time, hold, distance and height, in flown order. GeoJSON and KML also have "
            "what happened to UAVs, the planned lines, and the flown ones with a point a second. GeoJSON also has the photos."
        ),
        parameters=[RESULT_KIND],
        responses=RESULT_FILES,
    )
    def get(self, request: SignedInRequest, mission_id: UUID, kind: str) -> HttpResponse:
        mission = _mission(request, mission_id)
        whole = whole_record(mission)
        if not whole.targets or whole.approval is None:
            raise ApiProblem(409, "no_results", _("This mission was not approved: it has no results."))
        wanted = RESULT_KINDS[kind]
        response = HttpResponse(wanted.bytes_of(mission_results(whole)), content_type=wanted.media_type)
        response["Content-Disposition"] = f'attachment; filename="{file_stem(mission.name)}-results.{kind}"'
        response["Cache-Control"] = "private, no-cache"
        return response
