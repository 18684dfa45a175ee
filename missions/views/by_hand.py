"""Routes changed by hand."""

from uuid import UUID

from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.leg_selectors import LegEnd, faults_of_legs
from missions.serializers import by_hand, shapes
from missions.views.missions import CHANGED, IF_MATCH, answer_mission, expected_revision, mission_or_404
from missions.views.problems import api_problems
from workspace.models import Role
from workspace.throttling import ScopedRate


class RouteWaypoints(APIView):
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="change_route_by_hand",
        summary="Fly a route over other waypoints",
        description="Start, end and targets stay, in their order; `was` tells which waypoint until now each one is. Every leg is checked"
        " against zones, heights and the battery before anything is kept.",
        parameters=[IF_MATCH],
        request=by_hand.HandRouteSerializer,
        responses={200: shapes.MissionSerializer, 400: OpenApiResponse(description="What is wrong, by waypoint or leg."), **CHANGED},
    )
    def put(self, request: Request, mission_id: UUID, uav: int) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        body = by_hand.HandRouteSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        with api_problems(has_precondition=expected is not None):
            services.change_route(mission=mission, actor=request.user, uav=uav, points=body.points(), expected_revision=expected)
        return answer_mission(request.user, mission_id)


class LegChecks(APIView):
    write_roles = frozenset(Role)
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"

    @extend_schema(
        operation_id="check_legs",
        summary="Whether legs are clear of zones at their height and time",
        request=by_hand.LegChecksInputSerializer,
        responses=by_hand.LegChecksSerializer,
    )
    def post(self, request: Request) -> Response:
        body = by_hand.LegChecksInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        departs_at = body.validated_data.get("departs_at")
        found = faults_of_legs([(_end(leg["start"]), _end(leg["end"])) for leg in body.validated_data["legs"]], departs_at)
        return Response(by_hand.LegChecksSerializer({"legs": found}).data)


def _end(value: dict[str, object]) -> LegEnd:
    return LegEnd(value["position"], value["altitude_agl_m"], value.get("arrival_s"))  # type: ignore[arg-type]
