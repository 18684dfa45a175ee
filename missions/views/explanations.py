"""Why a plan is as it is. Nothing is stored: whoever may read a mission may ask."""

from drf_spectacular.utils import extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.serializers import explanations
from missions.serializers.inputs import plan_request
from missions.views.problems import api_problems
from workspace.models import Role
from workspace.throttling import ScopedRate

EVERYBODY = frozenset(Role)


class _Explanation(APIView):
    write_roles = EVERYBODY
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"


class WhyTarget(_Explanation):
    @extend_schema(
        operation_id="explain_unreached_target",
        summary="Why no route of a plan visits a target, and what would help",
        request=explanations.WhyTargetInputSerializer,
        responses=explanations.TargetExplanationSerializer,
    )
    def post(self, request: Request) -> Response:
        organisation = request.user.organisation
        body = explanations.WhyTargetInputSerializer(data=request.data, context={"organisation": organisation})
        body.is_valid(raise_exception=True)
        asked = plan_request(body.validated_data)
        with api_problems():
            answer = services.explain_unreached_target(request=asked, target=body.validated_data["target"], organisation=organisation)
        return Response(explanations.TargetExplanationSerializer(answer).data)


class WhyRoute(_Explanation):
    @extend_schema(
        operation_id="explain_route",
        summary="Where the kilometres of a route come from, and what another UAV would fly",
        request=explanations.WhyRouteInputSerializer,
        responses=explanations.RouteExplanationSerializer,
    )
    def post(self, request: Request) -> Response:
        body = explanations.WhyRouteInputSerializer(data=request.data, context={"organisation": request.user.organisation})
        body.is_valid(raise_exception=True)
        values = body.validated_data
        with api_problems():
            answer = services.explain_route(
                request=plan_request(values), routes=values["routes"], uav=values["uav"], is_by_length=values["shortest_ways"]
            )
        return Response(explanations.RouteExplanationSerializer(answer).data)
