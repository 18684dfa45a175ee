"""The register of zones: counts, files, and edits of many at once."""

from typing import Any

from django.http import HttpResponseBase
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import ZoneSet
from inspection.selectors.register.zones import ZoneFilter, zone_counts, zones_that_match
from inspection.serializers.export_rows import ZONE_COLUMNS, zone_rows
from inspection.serializers.register import (
    BulkEditOutputSerializer,
    BulkUndoOutputSerializer,
    BulkUndoSerializer,
    ZoneBulkEditSerializer,
    ZoneCountsSerializer,
)
from inspection.services.bulk_edits import LimitsCrossed, RowsChanged, change_zones, undo_zone_changes
from inspection.views import export_files
from inspection.views.export_files import FILE_ANSWERS, FORMAT, MAX_DIRECT, check_number, file_response, most_of
from inspection.views.exports import EXPORT_JOB, JOB_ANSWERS, export_job
from inspection.views.register_filters import ZONE_FILTERS, zone_filter
from workspace.api.errors import ApiProblem
from workspace.api.permissions import CURATORS
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest
from workspace.models import Role

NAMED = 3  # zones of a refused edit


class ZoneCountsView(APIView):
    @extend_schema(
        operation_id="count_zones",
        summary="How many zones match filters, by restriction, reason and set",
        parameters=ZONE_FILTERS,
        responses=ZoneCountsSerializer,
    )
    def get(self, request: Request) -> Response:
        counts = zone_counts(zone_filter(request))
        names = dict(ZoneSet.objects.values_list("pk", "name"))
        sets = sorted(((key, names.get(key, "") if key else "", count) for key, count in counts.zone_sets.items()), key=lambda row: row[1])
        return Response(
            {
                "total": counts.total,
                "restrictions": _sorted(counts.restrictions),
                "reasons": _sorted(counts.reasons),
                "zone_sets": [{"zone_set": key, "name": name, "count": count} for key, name, count in sets],
            }
        )


def _sorted(counts: dict[str, int]) -> list[dict[str, Any]]:
    return [{"value": value, "count": count} for value, count in sorted(counts.items(), key=lambda entry: (-entry[1], entry[0]))]


def check_zones(wanted: ZoneFilter, most: int) -> int:
    return check_number(
        zones_that_match(wanted),
        most,
        none=_("No zone matches: there is nothing to export."),
        too_many=_("More than %(most)s zones match. Narrow the filters, such as by set."),
    )


class ZoneExport(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_zones",
        summary="Zones that match filters, as CSV, GeoJSON or GeoPackage",
        description="CSV has a position, the others the geometry. Limits are in metres; empty ones are not stated. "
        f"A GeoPackage has at most {MAX_DIRECT:,} rows: `POST /api/v1/zones/exports` writes larger ones.",
        parameters=[FORMAT, *ZONE_FILTERS],
        responses=FILE_ANSWERS,
    )
    def get(self, request: Request, ending: str) -> HttpResponseBase:
        wanted = zone_filter(request)
        check_zones(wanted, most_of(ending))
        return file_response(zone_rows(wanted), ZONE_COLUMNS, ending, "zones")


class ZoneExportJobs(APIView):
    write_roles = frozenset(Role)
    throttle_scope = "exports"

    @extend_schema(
        operation_id="start_zone_export",
        summary="Write a GeoPackage of the zones that match filters, in a job",
        description=EXPORT_JOB,
        parameters=ZONE_FILTERS,
        request=None,
        responses=JOB_ANSWERS,
    )
    def post(self, request: SignedInRequest) -> Response:
        wanted = zone_filter(request)
        return export_job("zones", wanted, check_zones(wanted, export_files.MAX_EXPORTED), request.user)


class ZoneEdits(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="change_zones",
        summary="Correct facts of many zones at once",
        description="All or none. Each zone has its entry in the history, and imports leave it alone as after a correction by itself.",
        parameters=ZONE_FILTERS,
        request=ZoneBulkEditSerializer,
        responses={
            200: BulkEditOutputSerializer,
            409: OpenApiResponse(description="Some zones have another revision (`details.changed`), or the filters find another number."),
        },
    )
    def post(self, request: SignedInRequest) -> Response:
        body = ZoneBulkEditSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        asked = body.validated_data
        try:
            entries = change_zones(
                values=asked["values"],
                actor=request.user,
                revisions={zone["id"]: zone["revision"] for zone in asked["zones"]} if "zones" in asked else None,
                found=None if "zones" in asked else zones_that_match(zone_filter(request)),
                expected=asked.get("expected", 0),
            )
        except RowsChanged as error:
            raise _conflict(error) from error
        except LimitsCrossed as error:
            names = ", ".join(zone.name for zone in list(error.zones)[:NAMED])
            message = _("The upper limit would lie below the lower one, such as of %(names)s. Nothing was changed.") % {"names": names}
            raise ApiProblem(400, "invalid", message, details={"values": [message]}) from error
        return Response({"changed": len(entries), "entries": entries})


def _conflict(error: RowsChanged) -> ApiProblem:
    if error.is_of_filters:
        message = _("The filters find another number of zones by now. Nothing was changed.")
        return ApiProblem(409, "changed", message, details={"found": len(error.keys)})
    message = _("Others have changed or deleted some of these zones in the meantime. Nothing was changed.")
    return ApiProblem(409, "changed", message, details={"changed": error.keys})


class ZoneEditsUndo(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="undo_zone_changes",
        summary="Take a correction of many zones back",
        description="Zones that were edited or imported again since stay as they are.",
        request=BulkUndoSerializer,
        responses=BulkUndoOutputSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        body = BulkUndoSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        found = undo_zone_changes(entries=set(body.validated_data["entries"]), actor=request.user)
        return Response({"undone": found.undone, "kept": found.kept})
