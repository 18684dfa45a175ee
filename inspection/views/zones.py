"""No-fly zones: the list and one of them."""

from django.http import Http404
from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection import selectors
from inspection.models import NoFlyZone
from inspection.serializers.zones import ZoneCollectionSerializer, ZoneDetailFeatureSerializer, zone_detail_feature, zone_feature
from inspection.views.parameters import BOX, box_of
from workspace.paging import page_of
from workspace.schema import PAGE_PARAMETERS


class ZoneList(APIView):
    @extend_schema(
        operation_id="list_zones",
        summary="No-fly zones",
        parameters=[BOX, *PAGE_PARAMETERS],
        responses=ZoneCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        page = page_of(request, selectors.zones(box=box_of(request)))
        features = [zone_feature(zone) for zone in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})


class ZoneDetail(APIView):
    @extend_schema(operation_id="get_zone", summary="One no-fly zone with all its source says", responses=ZoneDetailFeatureSerializer)
    def get(self, request: Request, zone_id: int) -> Response:
        try:
            return Response(zone_detail_feature(selectors.zones().get(pk=zone_id)))
        except NoFlyZone.DoesNotExist as error:
            raise Http404 from error
