"""The register of assets: counts, files, and edits of many at once."""

from typing import Any

from django.http import HttpResponseBase
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset, AssetKind
from inspection.selectors.register.assets import AssetFilter, asset_counts, assets_that_match
from inspection.serializers.export_rows import ASSET_COLUMNS, asset_rows
from inspection.serializers.register import (
    MAX_BULK,
    AssetCountsSerializer,
    BulkEditOutputSerializer,
    BulkEditSerializer,
    BulkUndoOutputSerializer,
    BulkUndoSerializer,
)
from inspection.services.bulk_edits import change_assets, undo_changes
from inspection.views import export_files
from inspection.views.export_files import FILE_ANSWERS, FORMAT, MAX_DIRECT, check_number, file_response, most_of
from inspection.views.exports import EXPORT_JOB, JOB_ANSWERS, export_job
from inspection.views.parameters import invalid
from inspection.views.register_filters import ASSET_FILTERS, asset_filter
from workspace.api.errors import ApiProblem
from workspace.api.permissions import CURATORS
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest
from workspace.models import Role

KINDS_WITH = {
    "voltages_v": {AssetKind.TOWER, AssetKind.LINE},
    "circuits": {AssetKind.LINE},
    "height_m": {AssetKind.TOWER, AssetKind.BRIDGE},
}


class AssetCountsView(APIView):
    @extend_schema(
        operation_id="count_assets",
        summary="How many assets match filters, by kind, voltage and operator",
        parameters=ASSET_FILTERS,
        responses=AssetCountsSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        counts = asset_counts(asset_filter(request))
        return Response(
            {
                "total": counts.total,
                "kinds": counts.kinds,
                "voltages": [{"voltage_v": voltage, "count": count} for voltage, count in counts.voltages_v],
                "operators": [{"operator": operator, "count": count} for operator, count in counts.operators],
            }
        )


def check_assets(wanted: AssetFilter, most: int) -> int:
    return check_number(
        assets_that_match(wanted),
        most,
        none=_("No asset matches: there is nothing to export."),
        too_many=_("More than %(most)s assets match. Narrow the filters, such as by region."),
    )


class AssetExport(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_assets",
        summary="Assets that match filters, as CSV, GeoJSON or GeoPackage",
        description="CSV has a position, the others the geometry. A GeoPackage has one layer for each kind, "
        f"and at most {MAX_DIRECT:,} rows: `POST /api/v1/assets/exports` writes larger ones.",
        parameters=[FORMAT, *ASSET_FILTERS],
        responses=FILE_ANSWERS,
    )
    def get(self, request: SignedInRequest, ending: str) -> HttpResponseBase:
        wanted = asset_filter(request)
        check_assets(wanted, most_of(ending))
        return file_response(asset_rows(wanted), ASSET_COLUMNS, ending, "assets")


class AssetExportJobs(APIView):
    write_roles = frozenset(Role)
    throttle_scope = "exports"

    @extend_schema(
        operation_id="start_asset_export",
        summary="Write a GeoPackage of the assets that match filters, in a job",
        description=EXPORT_JOB,
        parameters=ASSET_FILTERS,
        request=None,
        responses=JOB_ANSWERS,
    )
    def post(self, request: SignedInRequest) -> Response:
        wanted = asset_filter(request)
        return export_job("assets", wanted, check_assets(wanted, export_files.MAX_EXPORTED), request.user)


class AssetEdits(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="change_assets",
        summary="Correct facts of many assets at once",
        description="All or none. Each asset has its entry in the history, and imports leave it alone as after a correction by itself.",
        parameters=ASSET_FILTERS,
        request=BulkEditSerializer,
        responses={200: BulkEditOutputSerializer, 409: OpenApiResponse(description="The filters find another number by now.")},
    )
    def post(self, request: SignedInRequest) -> Response:
        body = BulkEditSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data["values"]
        keys = self._keys(request, body.validated_data)
        self._check_kinds(keys, values)
        entries = change_assets(keys=keys, values=values, actor=request.user)
        return Response({"changed": len(entries), "entries": entries})

    def _keys(self, request: SignedInRequest, asked: dict[str, Any]) -> list[int]:
        if "ids" in asked:
            return list(dict.fromkeys(asked["ids"]))
        keys = list(assets_that_match(asset_filter(request)).order_by().values_list("pk", flat=True)[: MAX_BULK + 1])
        if len(keys) != asked["expected"]:
            message = _("The filters find another number of assets by now. Nothing was changed.")
            raise ApiProblem(409, "changed", message, details={"found": len(keys)})
        return keys

    def _check_kinds(self, keys: list[int], values: dict[str, Any]) -> None:
        kinds = {AssetKind(kind) for kind in Asset.objects.filter(pk__in=keys).order_by().values_list("kind", flat=True).distinct()}
        for name, known in KINDS_WITH.items():
            if name in values and not kinds <= known:
                raise invalid(name, _("Not all of these assets have this fact. Choose one kind."))


class AssetEditsUndo(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="undo_asset_changes",
        summary="Take a correction of many assets back",
        description="Assets that were changed again since stay as they are.",
        request=BulkUndoSerializer,
        responses=BulkUndoOutputSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        body = BulkUndoSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        found = undo_changes(entries=set(body.validated_data["entries"]), actor=request.user)
        return Response({"undone": found.undone, "kept": found.kept})
