"""UAVs as GeoJSON."""

from typing import Any

from django.http import Http404
from django.urls import reverse
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, PolymorphicProxySerializer, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import selectors, services
from missions.models import Uav
from missions.serializers.uavs import UavCollectionSerializer, UavFeatureSerializer, UavFlatSerializer, flat_uav, uav_feature
from missions.views.problems import api_problems
from workspace.idempotency import idempotent
from workspace.models import User
from workspace.paging import page_of
from workspace.schema import PAGE_PARAMETERS

INPUT = PolymorphicProxySerializer(
    component_name="UavWrite", serializers=[UavFlatSerializer, UavFeatureSerializer], resource_type_field_name=None
)
CONFLICT = {409: OpenApiResponse(description="The name is taken, or a mission uses the UAV.")}


def _uav(user: User, uav_id: int) -> Uav:
    uav = selectors.uavs_of_organisation(user.organisation).filter(pk=uav_id).first()
    if uav is None:
        raise Http404
    return uav


def _values(request: Request, *, partial: bool) -> dict[str, Any]:
    serializer = UavFlatSerializer(data=flat_uav(request.data), partial=partial)
    serializer.is_valid(raise_exception=True)
    return dict(serializer.validated_data)


class UavList(APIView):
    @extend_schema(
        operation_id="list_uavs",
        summary="UAVs of one's organisation, by name",
        parameters=[OpenApiParameter("text", str, description="part of the name or of the base's name"), *PAGE_PARAMETERS],
        responses=UavCollectionSerializer,
    )
    def get(self, request: Request) -> Response:
        text = request.query_params.get("text", "").strip()[:100].replace("\0", "")
        page = page_of(request, selectors.uavs_of_organisation(request.user.organisation, text=text), order=("name", "pk"))
        return Response({"type": "FeatureCollection", "features": [uav_feature(uav) for uav in page.rows], "next": page.next})

    @extend_schema(operation_id="create_uav", summary="Register a UAV", request=INPUT, responses={201: UavFeatureSerializer, **CONFLICT})
    @idempotent
    def post(self, request: Request) -> Response:
        values = _values(request, partial=False)
        position = values.pop("position")
        with api_problems():
            uav = services.create_uav(organisation=request.user.organisation, actor=request.user, position=position, values=values)
        return Response(uav_feature(uav), status=201, headers={"Location": reverse("api-uav", args=[uav.pk])})


class UavDetail(APIView):
    @extend_schema(operation_id="get_uav", summary="One UAV", responses=UavFeatureSerializer)
    def get(self, request: Request, uav_id: int) -> Response:
        return Response(uav_feature(_uav(request.user, uav_id)))

    @extend_schema(operation_id="change_uav", summary="Change a UAV", request=INPUT, responses={200: UavFeatureSerializer, **CONFLICT})
    def patch(self, request: Request, uav_id: int) -> Response:
        uav = _uav(request.user, uav_id)
        values = _values(request, partial=True)
        position = values.pop("position", None)
        with api_problems():
            return Response(uav_feature(services.change_uav(uav=uav, actor=request.user, position=position, values=values)))

    @extend_schema(operation_id="delete_uav", summary="Remove a UAV that no mission uses", responses={204: None, **CONFLICT})
    def delete(self, request: Request, uav_id: int) -> Response:
        with api_problems():
            services.delete_uav(uav=_uav(request.user, uav_id), actor=request.user)
        return Response(status=204)
