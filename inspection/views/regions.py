"""Deleting the assets of a whole region."""

from typing import Any

from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import AssetSet, DataImport
from inspection.services.regions import Region, counts_of_region, delete_region
from inspection.views.parameters import invalid
from workspace.api import strict_serializers as serializers
from workspace.api.permissions import CURATORS
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import MAX_NUMBER


class RegionInputSerializer(serializers.Serializer):
    """One of bbox, import and set."""

    bbox = serializers.ListField(
        child=serializers.FloatField(min_value=-180, max_value=180),
        min_length=4,
        max_length=4,
        required=False,
        help_text="west, south, east, north",
    )
    import_id = serializers.IntegerField(required=False, min_value=1, max_value=MAX_NUMBER, help_text="a data import")
    set = serializers.CharField(max_length=200, required=False, help_text="the name of a set of assets")
    dry_run = serializers.BooleanField(default=False, help_text="only count")

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if sum(name in values for name in ("bbox", "import_id", "set")) != 1:
            raise serializers.ValidationError(_("Say one of bbox, import_id and set."))
        if "bbox" in values:
            west, south, east, north = values["bbox"]
            if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south < north <= 90):
                raise serializers.ValidationError({"bbox": [_("West, south, east, north in degrees, south below north.")]})
        return values


class RegionCountsSerializer(serializers.Serializer):
    counts = serializers.DictField(child=serializers.IntegerField(), help_text="assets by kind that are taken off, or would be")


class RegionDelete(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="delete_region",
        summary="Take all assets of a box, an import or a set off the ground",
        description="What was drawn or edited by hand stays, missions keep what they point at, and the next file brings the rest back.",
        request=RegionInputSerializer,
        responses=RegionCountsSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        body = RegionInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        region = self._region(body.validated_data)
        act = counts_of_region(region) if body.validated_data["dry_run"] else delete_region(region=region, actor=request.user)
        return Response({"counts": act})

    def _region(self, values: dict[str, Any]) -> Region:
        if "bbox" in values:
            west, south, east, north = values["bbox"]
            return Region(box=(west, south, east, north))
        if "import_id" in values:
            row = DataImport.objects.filter(pk=values["import_id"]).first()
            if row is None:
                raise invalid("import_id", _("There is no such import."))
            return Region(data_import=row)
        found = AssetSet.objects.filter(name=values["set"]).first()
        if found is None:
            raise invalid("set", _("There is no such set."))
        return Region(asset_set=found)
