"""The missions of an asset."""

from typing import Any

from django.http import Http404
from drf_spectacular.utils import extend_schema
from rest_framework import serializers
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import Asset
from missions.models import MissionState
from missions.selectors.inspections import MissionOfAsset, missions_of_asset
from workspace.api.paging import page_of
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
