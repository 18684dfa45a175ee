"""Flown tracks as files, generated while they are sent."""

import math
import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple
from uuid import UUID

from django.db.models import QuerySet
from django.http import Http404, StreamingHttpResponse
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.views import APIView

from inspection.views.parameters import invalid
from missions.models import Mission
from missions.views.uavs import uav_or_404
from telemetry.exports.csv_file import csv_of_records
from telemetry.exports.geojson_file import geojson_of_records
from telemetry.exports.gpx_file import gpx_pieces
from telemetry.exports.kml_file import kml_pieces
from telemetry.exports.logged_record import LoggedRecord
from telemetry.exports.thinning import INTERVAL_S, for_files
from telemetry.models import TelemetryRecord
from telemetry.selectors.log import LogFilter, logged, on_track, records_that_match
from telemetry.views.log_filters import TIMES, time_of
from workspace.api.errors import ApiProblem
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest

BY_TIME = ("measured_at", "pk")
BY_STREAM = ("uav_id", "stream_id", "sequence")  # in counter order, in which a track is drawn
UNSAFE = re.compile(r"[^A-Za-z0-9]+")  # in file names: other programs may fail on these


class ExportFormat(NamedTuple):
    """A file format. `is_track`: it only includes records with a position and a possible time."""

    media_type: str
    order: tuple[str, ...]
    pieces: Callable[[Iterable[LoggedRecord], str], Iterator[str]]
    is_track: bool = False


KINDS = {
    "csv": ExportFormat("text/csv; charset=utf-8", BY_TIME, lambda records, name: csv_of_records(records)),
    "gpx": ExportFormat("application/gpx+xml", BY_STREAM, lambda records, name: gpx_pieces(records, name=name), is_track=True),
    "kml": ExportFormat(
        "application/vnd.google-earth.kml+xml", BY_STREAM, lambda records, name: kml_pieces(records, name=name), is_track=True
    ),
    "geojson": ExportFormat("application/geo+json", BY_TIME, lambda records, name: geojson_of_records(records)),
}
ABOUT = (
    "One record a second of each UAV, and each with which its mode or waypoint changes; `every_s` asks for more or fewer. Values are "
    "rounded to the resolution of their sensors. Each record has the times of measurement, receipt and storage, and in CSV and GeoJSON "
    "a flag where its time is wrong; the tracks of GPX and KML leave out those without a place and those from the future."
)
MAX_S = 3_600.0
EVERY = OpenApiParameter(
    "every_s",
    {"type": "number", "minimum": 0, "maximum": MAX_S},
    description="of each UAV one record in so many seconds; 0 for all",
    default=INTERVAL_S,
)
KIND = OpenApiParameter("kind", str, OpenApiParameter.PATH, enum=[*KINDS], description="how the file ends")
NOTHING = {409: OpenApiResponse(description="Nothing was recorded, or no position for GPX and KML: there is no file.")}
FILES: dict[Any, Any] = {(200, kind.media_type.partition(";")[0]): OpenApiTypes.STR for kind in KINDS.values()} | NOTHING


class MissionTelemetryFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_mission_telemetry", summary="What was flown in a mission, as CSV, GPX, KML or GeoJSON", description=ABOUT,
        parameters=[KIND, *TIMES, EVERY], responses=FILES,
    )  # fmt: skip
    def get(self, request: SignedInRequest, mission_id: UUID, kind: str) -> StreamingHttpResponse:
        organisation = request.user.organisation
        mission = Mission.objects.filter(organisation=organisation, deleted_at=None, pk=mission_id).first()
        if mission is None:
            raise Http404
        wanted = LogFilter(None, mission_id, time_of(request, "from"), time_of(request, "to"))
        return _file(records_that_match(organisation, wanted), kind, mission.name, _every_s(request))


class UavTelemetryFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_uav_telemetry", summary="What a UAV has flown, as CSV, GPX, KML or GeoJSON", description=ABOUT,
        parameters=[KIND, *TIMES, EVERY], responses=FILES,
    )  # fmt: skip
    def get(self, request: SignedInRequest, uav_id: int, kind: str) -> StreamingHttpResponse:
        uav = uav_or_404(request.user, uav_id)
        wanted = LogFilter(uav.pk, None, time_of(request, "from"), time_of(request, "to"))
        return _file(records_that_match(request.user.organisation, wanted), kind, uav.name, _every_s(request))


def file_stem(name: str) -> str:
    """Return the beginning of a file's name."""
    return UNSAFE.sub("-", name).strip("-") or "flight"


def _every_s(request: SignedInRequest) -> float:
    text = request.query_params.get("every_s", "")
    try:
        value = float(text) if text else INTERVAL_S
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= MAX_S:
        raise invalid("every_s", _("A number of seconds from 0 to %(most)s is needed.") % {"most": f"{MAX_S:.0f}"})
    return value


def _file(records: QuerySet[TelemetryRecord], kind: str, name: str, every_s: float) -> StreamingHttpResponse:
    wanted, words = KINDS[kind], _("No telemetry was recorded: there is nothing to export.")
    if wanted.is_track:
        records, words = on_track(records), _("No position was recorded: there is no track to export.")
    if not records.exists():
        raise ApiProblem(409, "nothing_recorded", words)
    chosen = for_files(logged(records, *wanted.order), every_s=every_s)
    response = StreamingHttpResponse(wanted.pieces(chosen, name), content_type=wanted.media_type)
    response["Content-Disposition"] = f'attachment; filename="{file_stem(name)}-telemetry.{kind}"'
    response["Cache-Control"] = "private, no-cache"
    return response
