"""Unknown vehicles that gateways received, for administrators."""

from django.shortcuts import get_object_or_404
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import Uav
from missions.selectors.fleet import types_of_organisation
from missions.serializers.uavs import UavFeatureSerializer, uav_feature
from missions.views.problems import TAKEN, fleet_problems, refusals
from missions.views.uavs import uav_or_404
from telemetry.models import UnknownVehicle, UnknownVehicleState
from telemetry.selectors.vehicles import unknown_vehicles
from telemetry.serializers.vehicles import AdoptionSerializer, UnknownVehiclePageSerializer, UnknownVehicleSerializer, vehicle_json
from telemetry.services.links.unknown_vehicles import AlreadySettled, NewUav, NoPlace, adopt_vehicle, heed_vehicle, ignore_vehicle
from workspace.api.errors import ApiProblem
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import AdministratorsAlone
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest

SETTLED = {409: OpenApiResponse(description="The vehicle has been adopted, or the name or the system id is taken.")}


class UnknownVehicles(APIView):
    permission_classes = [AdministratorsAlone]

    @extend_schema(
        operation_id="list_unknown_vehicles",
        summary="Vehicles that spoke to a gateway and belong to no UAV, the last heard first",
        parameters=[
            OpenApiParameter("state", str, enum=UnknownVehicleState.values, description="new ones unless told"),
            *PAGE_PARAMETERS,
        ],
        responses=UnknownVehiclePageSerializer,
    )
    def get(self, request: Request) -> Response:
        state = asked_choice(request, "state", UnknownVehicleState.values) or UnknownVehicleState.NEW
        page = page_of(request, unknown_vehicles().filter(state=state), order=("-last_message_at", "-pk"))
        return Response({"results": [vehicle_json(vehicle) for vehicle in page.rows], "next": page.next})


class UnknownVehicleAdoption(APIView):
    permission_classes = [AdministratorsAlone]

    @extend_schema(
        operation_id="adopt_unknown_vehicle",
        summary="Say whose vehicle it is: a UAV that exists gets its system id, or a new one is made",
        request=AdoptionSerializer,
        responses={200: UavFeatureSerializer, **TAKEN, **SETTLED},
    )
    def post(self, request: SignedInRequest, vehicle_id: int) -> Response:
        vehicle = get_object_or_404(UnknownVehicle, pk=vehicle_id)
        serializer = AdoptionSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        asked = serializer.validated_data
        if "uav" in asked:
            owner = uav_or_404(request.user, asked["uav"])
            with fleet_problems():
                adopted = _adopted(vehicle, request, owner)
        else:
            wanted = asked.get("uav_type")
            uav_type = get_object_or_404(types_of_organisation(request.user.organisation), pk=wanted) if wanted else None
            with fleet_problems():
                adopted = _adopted(vehicle, request, NewUav(asked["name"], uav_type, asked.get("position")))
        return Response(uav_feature(uav_or_404(request.user, adopted)))


class UnknownVehicleIgnoring(APIView):
    permission_classes = [AdministratorsAlone]

    @extend_schema(
        operation_id="ignore_unknown_vehicle", summary="Do not tell of a vehicle any more", request=None,
        responses={200: UnknownVehicleSerializer, **SETTLED},
    )  # fmt: skip
    def post(self, request: SignedInRequest, vehicle_id: int) -> Response:
        vehicle = get_object_or_404(UnknownVehicle, pk=vehicle_id)
        try:
            ignore_vehicle(vehicle=vehicle, actor=request.user)
        except AlreadySettled as error:
            raise _settled() from error
        return Response(vehicle_json(unknown_vehicles().get(pk=vehicle_id)))

    @extend_schema(
        operation_id="heed_unknown_vehicle",
        summary="Tell of an ignored vehicle again",
        responses={200: UnknownVehicleSerializer, **SETTLED},
    )
    def delete(self, request: SignedInRequest, vehicle_id: int) -> Response:
        vehicle = get_object_or_404(UnknownVehicle, pk=vehicle_id)
        try:
            heed_vehicle(vehicle=vehicle, actor=request.user)
        except AlreadySettled as error:
            raise _settled() from error
        return Response(vehicle_json(unknown_vehicles().get(pk=vehicle_id)))


def _adopted(vehicle: UnknownVehicle, request: SignedInRequest, uav: Uav | NewUav) -> int:
    try:
        with refusals():
            return adopt_vehicle(vehicle=vehicle, actor=request.user, uav=uav).pk
    except AlreadySettled as error:
        raise _settled() from error
    except NoPlace as error:
        message = _("The vehicle has not said where it is: a new UAV needs a position.")
        raise ApiProblem(409, "no_position", message, details={"position": [message]}) from error


def _settled() -> ApiProblem:
    return ApiProblem(409, "already_settled", _("The vehicle has been adopted in the meantime."))
