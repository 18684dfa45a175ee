"""Manual edits of routes."""

from typing import Any
from uuid import UUID

from django.http import Http404
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.models import Mission
from missions.selectors import missions
from missions.selectors.legs import Leg, LegEnd, LegFlyer, faults_of_legs
from missions.serializers import manual_edits, shapes
from missions.views.missions import CHANGED, IF_MATCH, answer_mission, expected_revision, mission_or_404
from missions.views.problems import api_problems
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.models import Role


class RouteWaypoints(APIView):
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="change_route_by_hand",
        summary="Fly a route over other waypoints",
        description="Start, end and targets stay, in their order; `was` tells which waypoint until now each one is. Every leg is checked"
        " against zones, heights and the battery before anything is kept.",
        parameters=[IF_MATCH],
        request=manual_edits.HandRouteSerializer,
        responses={200: shapes.MissionSerializer, 400: OpenApiResponse(description="What is wrong, by waypoint or leg."), **CHANGED},
    )
    def put(self, request: SignedInRequest, mission_id: UUID, uav: int) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        body = manual_edits.HandRouteSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with api_problems(has_precondition=expected is not None):
            services.change_route(mission=mission, actor=request.user, uav=uav, points=body.points(), expected_revision=expected)
        return answer_mission(request.user, mission_id)


class RouteWaypointsLook(APIView):
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="look_at_route_by_hand",
        summary="What flying a route over other waypoints would take, and what is wrong with it",
        description="Nothing is kept. Unlike when it is to be kept, all that is wrong is told, and beside it length, time and battery.",
        request=manual_edits.HandRouteSerializer,
        responses=manual_edits.HandLookSerializer,
    )
    def post(self, request: SignedInRequest, mission_id: UUID, uav: int) -> Response:
        try:
            mission = missions.mission_alone(request.user.organisation, mission_id)
        except Mission.DoesNotExist as error:
            raise Http404 from error
        body = manual_edits.HandRouteSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with api_problems():
            check = services.check_manual_edit(mission=mission, uav=uav, points=body.points())
        return Response(manual_edits.manual_edit_check_json(check))


class RouteWaypointsUndo(APIView):
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="take_back_change_by_hand",
        summary="Take back the last change of a route by hand",
        description="The route is as before, checked against the zones of now. `hand_steps` of the route tells how many changes can be"
        " taken back; planning again ends that.",
        parameters=[IF_MATCH],
        request=None,
        responses={200: shapes.MissionSerializer, 400: OpenApiResponse(description="What is wrong, by waypoint or leg."), **CHANGED},
    )
    def post(self, request: SignedInRequest, mission_id: UUID, uav: int) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        with api_problems(has_precondition=expected is not None):
            services.take_back_change(mission=mission, actor=request.user, uav=uav, expected_revision=expected)
        return answer_mission(request.user, mission_id)


class LegChecks(APIView):
    write_roles = frozenset(Role)
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="check_legs",
        summary="Whether legs are clear of zones at their height and time",
        request=manual_edits.LegChecksInputSerializer,
        responses=manual_edits.LegChecksSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        body = manual_edits.LegChecksInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        departs_at = body.validated_data.get("departs_at")
        legs = [Leg(_end(leg["start"]), _end(leg["end"]), leg.get("speed_mps")) for leg in body.validated_data["legs"]]
        found = faults_of_legs(legs, departs_at, self._flyer(request, body.validated_data, legs))
        return Response(manual_edits.LegChecksSerializer({"legs": found}).data)

    def _flyer(self, request: SignedInRequest, body: dict[str, Any], legs: list[Leg]) -> LegFlyer | None:
        """Return the UAV that flies the legs that have a speed."""
        if all(leg.speed_mps is None for leg in legs):
            return None
        with api_problems():
            asked = services.request_of_mission(mission=mission_or_404(request.user, body["mission"]))
        if body["uav"] >= len(asked.uavs):
            raise Http404
        uav = asked.uavs[body["uav"]]
        return LegFlyer(uav.name, uav.cruise_speed_mps, uav.performance, asked.conditions)


def _end(value: dict[str, object]) -> LegEnd:
    return LegEnd(value["position"], value["altitude_agl_m"], value.get("arrival_s"))  # type: ignore[arg-type]
