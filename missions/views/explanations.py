"""Explanations of plans. Nothing is stored: every user who may read a mission may request them."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any
from uuid import UUID

from django.utils import timezone
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions import services
from missions.models import Mission
from missions.reason_texts import fault_texts
from missions.selectors.planning_context import stored_bases
from missions.serializers import explanations
from missions.serializers.inputs import PlanInputSerializer, plan_request
from missions.services.planning.explanations import explain_route, explain_unreached_target
from missions.services.planning.later_departure import better_departure
from missions.views.missions import mission_or_404
from missions.views.plans import is_small
from missions.views.problems import api_problems
from planning.request import InvalidRequest, PlanRequest
from planning.trajectory.waypoints import WaypointKind
from workspace.api.errors import ApiProblem
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.api.whole_numbers import WholeNumber
from workspace.models import Role

MAX_EXPLAINED = 20  # routes, and targets, of one answer
SHORTEST_WAYS = "shortest_ways"
EVERYBODY = frozenset(Role)
UAVS = WholeNumber("uav", "the routes of these UAVs alone, by their index", minimum=0, maximum=99_999, max_values=1_000)
TARGETS = WholeNumber("target", "these targets alone, by their index", minimum=0, maximum=99_999, max_values=1_000)


def explain_mission(
    *, mission: Mission, request: PlanRequest, uavs: Collection[int] | None = None, targets: Collection[int] | None = None
) -> dict[str, Any]:
    """Explain routes and unassigned targets on current map data; mission: with its routes, waypoints and targets loaded.

    uavs, targets: those requested, by their places in the mission; None: all of them, up to MAX_EXPLAINED of each. A route that can no
    longer be explained, as the map data have changed, has the reason under `fault`. Raises NoGraph.
    """
    place_of = {target.pk: target.sequence for target in mission.targets.all()}
    orders: list[list[int]] = [[] for _ in request.uavs]
    for route in mission.routes.all():
        visited = [waypoint.target_id for waypoint in route.waypoints.all() if waypoint.kind == WaypointKind.TARGET]
        orders[route.mission_uav.sequence] = [place_of[target] for target in visited if target is not None]
    is_by_length = any(warning["code"] == SHORTEST_WAYS for warning in mission.plan_warnings)
    flown = [uav for uav, order in enumerate(orders) if order and (uavs is None or uav in uavs)]
    left_out = [
        target.sequence for target in mission.targets.all() if target.unassigned_reason and (targets is None or target.sequence in targets)
    ]
    return {
        "routes": [_route(request, orders, uav, is_by_length=is_by_length) for uav in flown[:MAX_EXPLAINED]],
        "targets": [
            explain_unreached_target(request=request, target=target, organisation=mission.organisation)
            for target in left_out[:MAX_EXPLAINED]
        ],
        "more_routes": max(0, len(flown) - MAX_EXPLAINED),
        "more_targets": max(0, len(left_out) - MAX_EXPLAINED),
    }


def _route(request: PlanRequest, orders: list[list[int]], uav: int, *, is_by_length: bool) -> dict[str, Any]:
    try:
        found = explain_route(request=request, routes=orders, uav=uav, is_by_length=is_by_length)
    except InvalidRequest as error:
        return {"uav": uav, "fault": next(iter(fault_texts(error).values())), "explanation": None}
    return {"uav": uav, "fault": "", "explanation": found}


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
    def post(self, request: SignedInRequest) -> Response:
        organisation = request.user.organisation
        values = explanations.WhyTargetInputSerializer.read(request.data, organisation=organisation)
        with api_problems():
            answer = services.explain_unreached_target(request=plan_request(values), target=values["target"], organisation=organisation)
        return Response(explanations.TargetExplanationSerializer(answer).data)


class WhyRoute(_Explanation):
    @extend_schema(
        operation_id="explain_route",
        summary="Where the kilometres of a route come from, and what another UAV would fly",
        request=explanations.WhyRouteInputSerializer,
        responses=explanations.RouteExplanationSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        values = explanations.WhyRouteInputSerializer.read(request.data, organisation=request.user.organisation)
        with api_problems():
            answer = services.explain_route(
                request=plan_request(values), routes=values["routes"], uav=values["uav"], is_by_length=values["shortest_ways"]
            )
        return Response(explanations.RouteExplanationSerializer(answer).data)


class LaterDeparture(_Explanation):
    @extend_schema(
        operation_id="find_later_departure",
        summary="Whether departing later, when a zone near has ended, brings a better plan",
        description="Of up to 12 targets. Each departure that is looked at is planned as a whole; nothing is stored.",
        request=PlanInputSerializer,
        responses=explanations.LaterDepartureSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        organisation = request.user.organisation
        asked = plan_request(PlanInputSerializer.read(request.data, organisation=organisation))
        asked = replace(asked, organisation=organisation.pk)  # with a departure it is separated from others
        if not is_small(len(asked.targets)):
            raise ApiProblem(400, "too_many_targets", _("Departures are compared for few targets: pick those that are left out."))
        with api_problems():
            answer = better_departure(request=asked, now=timezone.now())
        return Response(explanations.LaterDepartureSerializer(answer).data)


class MissionExplanation(_Explanation):
    @extend_schema(
        operation_id="explain_mission",
        summary="Why the plan of a mission is as it is",
        description="Each route against the straight line, the zones behind its detours, what another UAV would fly, what binds it; "
        "and why each target that is left out is. Worked out on the ground of now.",
        parameters=[
            UAVS.documented,
            TARGETS.documented,
        ],
        responses={
            200: explanations.MissionExplanationSerializer,
            409: OpenApiResponse(description="The mission has no plan."),
        },
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        if mission.planned_at is None:
            raise ApiProblem(409, "not_planned", _("The mission has no routes yet."))
        uavs: Collection[int] | None = UAVS.all_asked(request)
        targets: Collection[int] | None = TARGETS.all_asked(request)
        if not uavs and not targets:
            uavs = targets = None
        with api_problems():
            asked = services.request_of_mission(mission=mission)
            asked = replace(asked, bases=stored_bases(mission.organisation), organisation=mission.organisation_id)
            answer = explain_mission(mission=mission, request=asked, uavs=uavs, targets=targets)
        return Response(explanations.MissionExplanationSerializer(answer).data)
