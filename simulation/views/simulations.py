"""Simulated UAVs in real time, of missions and of the pool: start, change in flight, end."""

from collections.abc import Callable
from typing import Any
from uuid import UUID

from django.conf import settings
from django.db import transaction
from django.shortcuts import get_object_or_404
from django.urls import reverse
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.views.parameters import invalid
from missions.models import Mission
from missions.views.missions import mission_or_404
from missions.views.problems import api_problems, refusals
from planning.energy.conditions import Conditions, conditions_from_json
from simulation.models import SimulatedAutopilotType, SimulatedVehicle, Simulation
from simulation.selectors import simulations_of_mission, simulations_of_organisation, vehicles_of_organisation
from simulation.serializers import simulations as shapes
from simulation.services.simulated_copies import fly_simulated_copy
from simulation.services.simulated_flights import start_simulated_flights
from simulation.services.simulations import (
    IsOver,
    NoPortFree,
    PoolUav,
    QuotaReached,
    change_simulation,
    end_simulation,
    end_vehicle,
    start_pool,
)
from simulation.vehicle_models import PRESENT
from simulation.views.rehearsals import scenario_of
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.paging import asked_choice, page_of
from workspace.api.permissions import FLYING
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

NEWEST_FIRST = ("-created_at", "-pk")
CALM = Conditions()
WHICH = ("present", "all")
RETRY_AFTER_S = 60
QUOTA = {429: OpenApiResponse(description="The organisation has as many simulated UAVs as it may.")}
OVER = {409: OpenApiResponse(description="The simulation has ended.")}
FLIGHT_REFUSED = {
    409: OpenApiResponse(description="The mission is not approved, or one of its UAVs is real: `details.reasons` has each reason.")
}
COPY_REFUSED = {409: OpenApiResponse(description="It cannot be flown so now: `details.reasons` has each reason.")}
STATE = OpenApiParameter("state", str, enum=WHICH, description="those that wait or fly (present, unless told), or also those that are over")


class MissionSimulatedFlights(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="list_simulated_flights",
        summary="Simulations that stand in for a mission's UAVs, the newest first",
        parameters=[STATE, *PAGE_PARAMETERS],
        responses=shapes.SimulationPageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        return _listed(request, simulations_of_mission(request.user.organisation, mission.pk))

    @extend_schema(
        operation_id="start_simulated_flights",
        summary="Fly an approved mission by simulated UAVs, through the gateway",
        description=(
            "For each of its UAVs a simulated one connects to the gateway with that UAV's system id and key, and stands where its route "
            "begins. From there on it is sent, started, held and called back like any UAV. Only UAVs that the fleet marks as simulated are "
            "stood in for; one without a key or a system id is given one, which is shown to nobody."
        ),
        request=shapes.SimulatedFlightsInputSerializer,
        responses={201: shapes.SimulationSerializer, **FLIGHT_REFUSED, **QUOTA},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        return _flown(request, mission_or_404(request.user, mission_id), start_simulated_flights)


class MissionSimulatedCopy(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="fly_simulated_copy",
        summary="Fly an approved mission by simulated twins of its UAVs",
        description=(
            "`mission` of the answer is a copy of the mission, with the same routes and without a departure, approved by the caller; its "
            "UAVs are simulated twins, made once and used again. The mission itself and its UAVs stay as they are. A copy of the present "
            "plan that is flown already is answered as it is."
        ),
        request=shapes.SimulatedFlightsInputSerializer,
        responses={201: shapes.SimulationSerializer, **COPY_REFUSED, **QUOTA},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        return _flown(request, mission_or_404(request.user, mission_id), fly_simulated_copy)


def _flown(request: SignedInRequest, mission: Mission, fly: Callable[..., Simulation]) -> Response:
    body = shapes.SimulatedFlightsInputSerializer(data=request.data)
    body.is_valid(raise_exception=True)
    values = body.validated_data
    try:
        with api_problems(), refusals(), transaction.atomic():
            simulation = fly(
                mission=mission,
                actor=request.user,
                scenario=scenario_of(values["conditions"], conditions_from_json(mission.conditions or None)),
                speed=float(values["speed"]),
                autopilot_type=SimulatedAutopilotType(values["autopilot_type"]),
                seed=values["seed"],
                faults=values.get("faults"),
            )
    except QuotaReached as error:
        raise _too_many(error) from error
    return _answer(request.user, simulation.pk, status=201)


class Simulations(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="list_simulations",
        summary="Simulated UAVs of one's organisation that wait or fly, the newest first",
        parameters=[STATE, *PAGE_PARAMETERS],
        responses=shapes.SimulationPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return _listed(request, simulations_of_organisation(request.user.organisation))

    @extend_schema(
        operation_id="start_simulation",
        summary="Start simulated UAVs for a ground station or a program of one's own",
        description=(
            "Each listens at a UDP port of its own until its lifetime ends: `connect` says where, with commands for QGroundControl, "
            "MAVProxy and MAVSDK. They are not of the fleet, and no gateway hears them: a UAV of the fleet is flown in simulation with a "
            "mission (POST /missions/{id}/simulated-flights). One whose simulator is lost begins anew."
        ),
        request=shapes.SimulationInputSerializer,
        responses={201: shapes.SimulationSerializer, **QUOTA},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = shapes.SimulationInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        if values["lifetime_s"] > settings.MAX_SIMULATION_H * 3_600:
            raise invalid("lifetime_s", _("At most %(hours)g hours.") % {"hours": settings.MAX_SIMULATION_H})
        try:
            simulation = start_pool(
                organisation=request.user.organisation,
                actor=request.user,
                uavs=[PoolUav(**uav) for uav in values["uavs"]],
                lifetime_s=values["lifetime_s"],
                scenario=scenario_of(values["conditions"], CALM),
                airframe=values["airframe"],
                autopilot_type=SimulatedAutopilotType(values["autopilot_type"]),
                speed=float(values["speed"]),
                first_system_id=values["first_system_id"],
                seed=values["seed"],
                faults=values.get("faults"),
            )
        except QuotaReached as error:
            raise _too_many(error) from error
        except NoPortFree as error:
            raise ApiProblem(503, "no_port_free", _("All ports of the pool are taken."), retry_after_s=RETRY_AFTER_S) from error
        return _answer(request.user, simulation.pk, status=201)


class SimulationDetail(APIView):
    write_scopes = FLYING

    @extend_schema(operation_id="get_simulation", summary="A simulation with each of its UAVs", responses=shapes.SimulationSerializer)
    def get(self, request: SignedInRequest, simulation_id: UUID) -> Response:
        return _answer(request.user, simulation_id)

    @extend_schema(
        operation_id="change_simulation",
        summary="Speed, air and faults of all UAVs of a simulation, in flight",
        description="Done within a second. Its UAVs share a clock: the speed is always everybody's.",
        request=shapes.SimulationChangeSerializer,
        responses={200: shapes.SimulationSerializer, **OVER},
    )
    def patch(self, request: SignedInRequest, simulation_id: UUID) -> Response:
        simulation = _simulation_or_404(request.user, simulation_id)
        body = shapes.SimulationChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        _change(request.user, simulation, None, body.validated_data)
        return _answer(request.user, simulation_id)

    @extend_schema(
        operation_id="end_simulation",
        summary="End a simulation",
        description="Its UAVs are gone within a second, wherever they are; of one in the air the gateway loses the link.",
        responses={204: None},
    )
    def delete(self, request: SignedInRequest, simulation_id: UUID) -> Response:
        end_simulation(simulation=_simulation_or_404(request.user, simulation_id), actor=request.user)
        return Response(status=204)


class SimulatedVehicleDetail(APIView):
    write_scopes = FLYING

    @extend_schema(operation_id="get_simulated_vehicle", summary="One simulated UAV", responses=shapes.SimulatedVehicleSerializer)
    def get(self, request: SignedInRequest, vehicle_id: UUID) -> Response:
        return Response(shapes.vehicle_json(_vehicle_or_404(request.user, vehicle_id)))

    @extend_schema(
        operation_id="change_simulated_vehicle",
        summary="Air and faults of one simulated UAV, in flight",
        description="Done within a second. The speed is changed with its simulation.",
        request=shapes.VehicleChangeSerializer,
        responses={200: shapes.SimulatedVehicleSerializer, **OVER},
    )
    def patch(self, request: SignedInRequest, vehicle_id: UUID) -> Response:
        vehicle = _vehicle_or_404(request.user, vehicle_id)
        body = shapes.VehicleChangeSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        _change(request.user, vehicle.simulation, vehicle, body.validated_data)
        return Response(shapes.vehicle_json(_vehicle_or_404(request.user, vehicle_id)))

    @extend_schema(
        operation_id="end_simulated_vehicle",
        summary="End one simulated UAV; the others fly on",
        description="It is gone within a second, wherever it is; of one in the air the gateway loses the link. With the last one its "
        "simulation ends.",
        request=None,
        responses={204: None},
    )
    def delete(self, request: SignedInRequest, vehicle_id: UUID) -> Response:
        end_vehicle(vehicle=_vehicle_or_404(request.user, vehicle_id), actor=request.user)
        return Response(status=204)


def _listed(request: Request, found: Any) -> Response:
    which = asked_choice(request, "state", WHICH) or WHICH[0]
    page = page_of(request, found.filter(state__in=PRESENT) if which == WHICH[0] else found, order=NEWEST_FIRST, default_limit=20)
    return Response({"results": [shapes.simulation_json(simulation) for simulation in page.rows], "next": page.next})


def _answer(user: User, simulation_id: UUID, *, status: int = 200) -> Response:
    headers = {"Location": reverse("api-simulation", args=[simulation_id])} if status == 201 else {}
    return Response(shapes.simulation_json(_simulation_or_404(user, simulation_id)), status=status, headers=headers)


def _simulation_or_404(user: User, simulation_id: UUID) -> Simulation:
    return get_object_or_404(simulations_of_organisation(user.organisation), pk=simulation_id)


def _vehicle_or_404(user: User, vehicle_id: UUID) -> SimulatedVehicle:
    return get_object_or_404(vehicles_of_organisation(user.organisation), pk=vehicle_id)


def _change(user: User, simulation: Simulation, vehicle: SimulatedVehicle | None, values: dict[str, Any]) -> None:
    planned = CALM if simulation.mission is None else conditions_from_json(simulation.mission.conditions or None)
    speed = values.get("speed")
    if vehicle is not None and vehicle.state not in PRESENT:
        raise _is_over()
    try:
        change_simulation(
            simulation=simulation,
            actor=user,
            vehicle=vehicle,
            speed=None if speed is None else float(speed),
            scenario=scenario_of(values["conditions"], planned) if "conditions" in values else None,
            faults=values.get("faults"),
        )
    except IsOver as error:
        raise _is_over() from error


def _is_over() -> ApiProblem:
    return ApiProblem(409, "simulation_over", _("This simulation has ended."))


def _too_many(error: QuotaReached) -> ApiProblem:
    words = _("Your organisation may have %(most)s simulated UAVs at once; %(free)s are free.")
    values = {"most": settings.MAX_SIMULATED_UAVS, "free": error.free}
    return ApiProblem(429, "too_many_simulated_uavs", words % values, retry_after_s=RETRY_AFTER_S)
