"""No-fly zones: the list and one of them."""

from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.models import NoFlyZone
from inspection.selectors.register.zones import zones_in_order, zones_that_match
from inspection.serializers.edits import ZoneInputSerializer
from inspection.serializers.zones import ZoneCollectionSerializer, ZoneDetailFeatureSerializer, zone_feature
from inspection.services import delete_zone, save_zone
from inspection.views.edits import Curated, answer, with_values, zone_now
from inspection.views.register_filters import ZONE_FILTERS, ZONE_SORT, ZONE_SORTS, zone_filter
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, changed_since, page_of
from workspace.api.permissions import CURATORS
from workspace.api.preconditions import IF_MATCH_REQUIRED, PRECONDITION_ANSWERS
from workspace.api.schema import CHANGED_SINCE, PAGE_PARAMETERS, request_example
from workspace.api.signed_in import SignedInRequest

ZONE_EXAMPLE = {
    "name": "Crane",
    "circle": {"centre": [9.52, 47.14], "radius_m": 200},
    "upper_limit": {"value_m": 120, "reference": "AGL"},
}


class ZoneList(APIView):
    write_roles = CURATORS

    @extend_schema(
        operation_id="list_zones",
        summary="No-fly zones",
        parameters=[
            *ZONE_FILTERS,
            ZONE_SORT,
            CHANGED_SINCE,
            *PAGE_PARAMETERS,
        ],
        responses=ZoneCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        order: tuple[str, ...] = ("pk",)
        found = changed_since(request, zones_that_match(zone_filter(request)))
        if sort := asked_choice(request, "sort", ZONE_SORTS):
            found, order = zones_in_order(found, sort)
        page = page_of(request, found, order=order)
        features = [zone_feature(zone) for zone in page.rows]
        return Response({"type": "FeatureCollection", "features": features, "next": page.next})

    @extend_schema(
        operation_id="create_zone",
        summary="Draw a no-fly zone",
        request=ZoneInputSerializer,
        responses={201: ZoneDetailFeatureSerializer},
        examples=[request_example(ZONE_EXAMPLE)],
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        return ZONES.drawn(request)


ZONES = Curated(
    NoFlyZone,
    ZoneInputSerializer,
    "api-zone",
    zone_now,
    save=lambda zone, values, **by: save_zone(zone=with_values(zone, values), **by),
    delete=lambda zone, **by: delete_zone(zone=zone, **by),
)


class ZoneDetail(APIView):
    write_roles = CURATORS

    @extend_schema(operation_id="get_zone", summary="One no-fly zone with all its source says", responses=ZoneDetailFeatureSerializer)
    def get(self, request: SignedInRequest, zone_id: int) -> Response:
        return answer(zone_now(request.user, zone_id))

    @extend_schema(
        operation_id="change_zone",
        summary="Correct a no-fly zone",
        description="Imports leave what was corrected by hand alone, unless whoever applies one says otherwise.",
        parameters=[IF_MATCH_REQUIRED],
        request=ZoneInputSerializer(partial=True),
        responses={200: ZoneDetailFeatureSerializer} | PRECONDITION_ANSWERS,
    )
    def patch(self, request: SignedInRequest, zone_id: int) -> Response:
        return ZONES.corrected(request, zone_id)

    @extend_schema(
        operation_id="delete_zone",
        summary="Remove a no-fly zone",
        description="Its history can bring it back, and so does its source's next file.",
        parameters=[IF_MATCH_REQUIRED],
        responses={204: None} | PRECONDITION_ANSWERS,
    )
    def delete(self, request: SignedInRequest, zone_id: int) -> Response:
        return ZONES.removed(request, zone_id)
