"""Regions: listed, renamed, deleted; and deleting the assets of a box, an import or a set."""

from typing import Any

from django.db import transaction
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.map_pages import region_json
from inspection.models import AssetSet, DataImport, Region
from inspection.selectors.ground import regions_in_use
from inspection.services.regions import (
    AssetGroup,
    RegionNameTaken,
    ask_to_delete_region,
    counts_of_group,
    counts_of_region,
    delete_assets,
    delete_region,
    rename_region,
)
from inspection.views.parameters import invalid
from workspace.api import strict_serializers as serializers
from workspace.api.errors import ApiProblem
from workspace.api.permissions import CURATORS
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import MAX_NUMBER
from workspace.tasks import send_job_on_commit


class RegionInputSerializer(serializers.Serializer):
    """One of bbox, import_id, set and region_id."""

    bbox = serializers.ListField(
        child=serializers.FloatField(min_value=-180, max_value=180),
        min_length=4,
        max_length=4,
        required=False,
        help_text="west, south, east, north",
    )
    import_id = serializers.IntegerField(required=False, min_value=1, max_value=MAX_NUMBER, help_text="a data import")
    set = serializers.CharField(max_length=200, required=False, help_text="the name of a set of assets")
    region_id = serializers.IntegerField(
        required=False,
        min_value=1,
        max_value=MAX_NUMBER,
        help_text="a region: its zones and terrain too, unless they reach beyond it, and UAVs of the demo",
    )
    dry_run = serializers.BooleanField(default=False, help_text="only count")
    as_job = serializers.BooleanField(default=False, help_text="of a region: answer at once with the job that deletes it")

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if sum(name in values for name in ("bbox", "import_id", "set", "region_id")) != 1:
            raise serializers.ValidationError(_("Say one of bbox, import_id, set and region_id."))
        if "bbox" in values:
            west, south, east, north = values["bbox"]
            if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south < north <= 90):
                raise serializers.ValidationError({"bbox": [_("West, south, east, north in degrees, south below north.")]})
        return values


class RegionJobSerializer(serializers.Serializer):
    """The job that deletes a region; its result has `counts`."""

    job = serializers.UUIDField()


class RegionCountsSerializer(serializers.Serializer):
    counts = serializers.DictField(
        child=serializers.IntegerField(), help_text="what is deleted, or would be: assets by kind, `zone`, `terrain`"
    )


class RegionSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    extent = serializers.ListField(child=serializers.FloatField(), help_text="west, south, east, north")
    counts = serializers.DictField(child=serializers.IntegerField(), help_text="assets by kind")
    is_synthetic = serializers.BooleanField(help_text="some of the data is made, not real")
    attribution = serializers.ListField(child=serializers.CharField())


class RegionListSerializer(serializers.Serializer):
    results = RegionSerializer(many=True)


class RegionNameSerializer(serializers.Serializer):
    name = serializers.CharField(max_length=200)


class RegionList(APIView):
    @extend_schema(operation_id="list_regions", summary="The regions with map data, by name", responses=RegionListSerializer)
    def get(self, request: SignedInRequest) -> Response:
        return Response({"results": [region_json(row) for row in regions_in_use()]})


class RegionDetail(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="rename_region",
        summary="Rename a region",
        request=RegionNameSerializer,
        responses={204: OpenApiResponse(description="Renamed."), 409: OpenApiResponse(description="Another region has this name.")},
    )
    def patch(self, request: SignedInRequest, region_id: int) -> Response:
        body = RegionNameSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        try:
            rename_region(region=region_of(region_id), name=body.validated_data["name"], actor=request.user)
        except RegionNameTaken as error:
            raise ApiProblem(409, "name_taken", _("Another region has this name.")) from error
        return Response(status=204)


def region_of(region_id: int) -> Region:
    """Return the region. Raises ApiProblem."""
    region = Region.objects.filter(pk=region_id).first()
    if region is None:
        raise ApiProblem(404, "not_found", _("There is no such region."))
    return region


class RegionDelete(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="delete_region",
        summary="Delete all assets of a box, an import, a set or a region",
        description="Assets that were drawn or edited by hand stay, missions keep their references, and the next file restores the others. "
        "Of a region the zones and terrain are deleted too, unless they reach beyond it; of the demo also its UAVs, if the user plans.",
        request=RegionInputSerializer,
        responses={200: RegionCountsSerializer, 202: RegionJobSerializer},
    )
    def post(self, request: SignedInRequest) -> Response:
        body = RegionInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        if body.validated_data["as_job"] and not body.validated_data["dry_run"]:
            return self._as_job(body.validated_data, request)
        if "region_id" in body.validated_data:
            return Response({"counts": self._whole(body.validated_data, request)})
        group = self._group(body.validated_data)
        act = counts_of_group(group) if body.validated_data["dry_run"] else delete_assets(group=group, actor=request.user)
        return Response({"counts": act})

    def _whole(self, values: dict[str, Any], request: SignedInRequest) -> dict[str, int]:
        region = region_of(values["region_id"])
        return counts_of_region(region) if values["dry_run"] else delete_region(region=region, actor=request.user)

    def _as_job(self, values: dict[str, Any], request: SignedInRequest) -> Response:
        if "region_id" not in values:
            raise invalid("as_job", _("Only a region is deleted by a job."))
        with transaction.atomic():
            job = ask_to_delete_region(region=region_of(values["region_id"]), actor=request.user)
            send_job_on_commit(job)
        return Response({"job": str(job.pk)}, status=202)

    def _group(self, values: dict[str, Any]) -> AssetGroup:
        if "bbox" in values:
            west, south, east, north = values["bbox"]
            return AssetGroup(box=(west, south, east, north))
        if "import_id" in values:
            row = DataImport.objects.filter(pk=values["import_id"]).first()
            if row is None:
                raise invalid("import_id", _("There is no such import."))
            return AssetGroup(data_import=row)
        found = AssetSet.objects.filter(name=values["set"]).first()
        if found is None:
            raise invalid("set", _("There is no such set."))
        return AssetGroup(asset_set=found)
