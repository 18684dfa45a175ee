"""The register of assets: counts, files, and edits of many at once."""

from collections.abc import Iterator
from itertools import islice
from typing import Any

from django.http import HttpResponseBase
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.exporters.rows import Columns, ExportRow
from inspection.models import Asset, AssetKind
from inspection.selectors import references_of
from inspection.selectors.register.assets import AssetFilter, asset_counts, assets_that_match, last_inspections
from inspection.serializers.assets import FIELDS_OF_AN_ASSET, asset_properties
from inspection.serializers.register import (
    MAX_BULK,
    AssetCountsSerializer,
    BulkEditOutputSerializer,
    BulkEditSerializer,
    BulkUndoOutputSerializer,
    BulkUndoSerializer,
)
from inspection.services.bulk_edits import change_assets, undo_changes
from inspection.views.export_files import FILE_ANSWERS, FORMAT, check_number, file_response
from inspection.views.parameters import invalid
from inspection.views.register_filters import ASSET_FILTERS, asset_filter
from workspace.api.errors import ApiProblem
from workspace.api.permissions import CURATORS
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest

BATCH = 2_000
KINDS_WITH = {
    "voltages_v": {AssetKind.TOWER, AssetKind.LINE},
    "circuits": {AssetKind.LINE},
    "height_m": {AssetKind.TOWER, AssetKind.BRIDGE},
}
LAYERS = {AssetKind.TOWER: "towers", AssetKind.LINE: "lines", AssetKind.RAILWAY: "railways", AssetKind.BRIDGE: "bridges"}
COLUMNS: Columns = {
    "kind": "TEXT", "subtype": "TEXT", "label": "TEXT", "name": "TEXT", "ref": "TEXT", "operator": "TEXT", "voltages_v": "TEXT",
    "circuits": "INTEGER", "height_m": "REAL", "length_m": "REAL", "is_flyable": "BOOLEAN", "line_label": "TEXT", "osm": "TEXT",
    "external_id": "TEXT", "inspected_at": "DATETIME", "inspected_share": "REAL",
}  # fmt: skip


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


class AssetExport(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_assets",
        summary="Assets that match filters, as CSV, GeoJSON or GeoPackage",
        description="CSV has a position, the others the geometry. A GeoPackage has one layer for each kind.",
        parameters=[FORMAT, *ASSET_FILTERS],
        responses=FILE_ANSWERS,
    )
    def get(self, request: SignedInRequest, ending: str) -> HttpResponseBase:
        wanted = asset_filter(request)
        check_number(
            assets_that_match(wanted),
            none=_("No asset matches: there is nothing to export."),
            too_many=_("More than %(most)s assets match. Narrow the filters, such as by region."),
        )
        return file_response(_rows(wanted), COLUMNS, ending, "assets")


def _rows(wanted: AssetFilter) -> Iterator[ExportRow]:
    """Yield the assets kind by kind."""
    found = assets_that_match(wanted).only(*FIELDS_OF_AN_ASSET).order_by("kind", "pk").iterator(BATCH)
    while batch := list(islice(found, BATCH)):
        keys = [asset.pk for asset in batch]
        references, inspected = references_of(wanted.organisation_id, keys), last_inspections(wanted.organisation_id, keys)
        for asset in batch:
            values = asset_properties(asset, references.get(asset.pk), inspected.get(asset.pk))
            inspected_at = values["inspected_at"]
            stated = {name: values[name] for name in COLUMNS} | {
                "voltages_v": ";".join(map(str, values["voltages_v"])),
                "inspected_at": inspected_at and inspected_at.isoformat().replace("+00:00", "Z"),
            }
            layer = LAYERS[AssetKind(asset.kind)]
            yield ExportRow(layer, asset.pk, asset.geometry_json, asset.centre.x, asset.centre.y, stated)


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
