"""The missions and inspections of an asset, the inspected parts of a line, and the tiles of all inspections."""

from hashlib import sha256
from typing import Any

from django.http import Http404, HttpResponse
from django.utils.cache import get_conditional_response
from django.utils.translation import gettext as _
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework import serializers
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset, AssetKind
from inspection.selectors import NoSuchTile
from inspection.selectors.picking import NotOneLine
from inspection.views.ground import TILE_TYPE
from missions.models import MissionState
from missions.selectors.line_inspections import PartOfLine, inspections_tile, parts_inspected
from missions.selectors.missions import MissionOfAsset, missions_of_asset
from workspace.api.errors import ApiProblem
from workspace.api.paging import page_of
from workspace.api.renderers import OneAnswer
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest


class AssetMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    state = serializers.ChoiceField(choices=MissionState.choices)
    is_simulated = serializers.BooleanField(help_text="simulated UAVs fly it: it inspects nothing")
    departs_at = serializers.DateTimeField(allow_null=True)
    created_at = serializers.DateTimeField()
    target_count = serializers.IntegerField(help_text="targets at the asset and, of a line, at its supports")
    inspected_count = serializers.IntegerField(help_text="of these, the completed ones")


class AssetMissionPageSerializer(serializers.Serializer):
    results = AssetMissionSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="address of the next page")


class AssetMissions(APIView):
    @extend_schema(
        operation_id="list_asset_missions",
        summary="The missions that inspect an asset or, of a line, its supports, newest first",
        parameters=PAGE_PARAMETERS,
        responses=AssetMissionPageSerializer,
    )
    def get(self, request: SignedInRequest, asset_id: int) -> Response:
        asset = Asset.objects.filter(pk=asset_id).first()
        if asset is None:
            raise Http404
        page = page_of(request, missions_of_asset(request.user.organisation_id, asset), order=("-created_at", "-pk"), default_limit=20)
        return Response({"results": [_mission_json(row) for row in page.rows], "next": page.next})


def _mission_json(row: MissionOfAsset) -> dict[str, Any]:
    names = ("name", "state", "is_simulated", "departs_at", "created_at", "target_count", "inspected_count")
    return {"id": str(row.pk)} | {name: getattr(row, name) for name in names}


class InspectingMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()


class InspectedPartSerializer(serializers.Serializer):
    """A part that one mission inspected last, or that was never inspected: then both are null."""

    from_m = serializers.FloatField(help_text="along the line, from its first vertex")
    to_m = serializers.FloatField()
    stretch = serializers.ListField(
        child=serializers.ListField(child=serializers.FloatField()), min_length=2, max_length=2, help_text="where it begins and ends"
    )
    can_be_target = serializers.BooleanField(help_text="whether a target with this `stretch` is this part; not where a line meets itself")
    inspected_at = serializers.DateTimeField(allow_null=True)
    mission = InspectingMissionSerializer(allow_null=True)


class InspectedPartsSerializer(serializers.Serializer):
    length_m = serializers.FloatField()
    inspected_m = serializers.FloatField(help_text="the sum of the parts that were ever inspected")
    parts = InspectedPartSerializer(many=True, help_text="from the line's first vertex to its last")


class InspectedParts(APIView):
    @extend_schema(
        operation_id="list_inspected_parts",
        summary="Which parts of a line or railway aircraft of your organisation inspected, and when last",
        responses=InspectedPartsSerializer,
    )
    def get(self, request: SignedInRequest, asset_id: int) -> Response:
        line = Asset.objects.filter(pk=asset_id, kind__in=[AssetKind.LINE, AssetKind.RAILWAY]).first()
        if line is None:
            raise Http404
        try:
            parts = parts_inspected(request.user.organisation_id, line)
        except NotOneLine as error:
            raise ApiProblem(400, "not_one_line", _("This asset is not drawn as one line, so it cannot be flown along.")) from error
        inspected_m = sum(part.part.length_m for part in parts if part.inspected)
        return Response({"length_m": parts[-1].part.to_m, "inspected_m": inspected_m, "parts": list(map(_part_json, parts))})


def _part_json(part: PartOfLine) -> dict[str, Any]:
    return {
        "from_m": part.part.from_m,
        "to_m": part.part.to_m,
        "stretch": [list(part.part.start), list(part.part.end)],
        "can_be_target": part.can_be_target,
        "inspected_at": part.inspected and part.inspected.inspected_at,
        "mission": part.inspected and {"id": str(part.inspected.mission), "name": part.inspected.name},
    }


class InspectionsTile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "tiles"

    @extend_schema(
        operation_id="get_inspections_tile",
        summary="A vector tile of inspections by aircraft of your organisation",
        description="Layer `inspections`: parts of lines and railways and, from zoom 10 on, towers and bridges, each with `asset` and "
        "`inspected_s`, Unix seconds. Where parts of several missions lie on each other draw the greatest `inspected_s` on top.",
        responses={(200, TILE_TYPE): OpenApiTypes.BINARY, 304: OpenApiResponse(description="The tile has not changed.")},
    )
    def get(self, request: SignedInRequest, zoom: int, column: int, row: int) -> HttpResponse:
        try:
            tile = inspections_tile(request.user.organisation_id, zoom, column, row)
        except NoSuchTile as error:
            raise Http404 from error
        etag = f'"{sha256(tile).hexdigest()[:32]}"'
        not_changed = get_conditional_response(request._request, etag=etag)
        response = not_changed if not_changed is not None else HttpResponse(tile, content_type=TILE_TYPE)
        response["ETag"] = etag
        response["Cache-Control"] = "private, no-cache"
        return response
