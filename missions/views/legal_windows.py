"""When a mission or a plan may depart, zone by zone. Nothing is stored: every user who may read a mission may request it."""

import math
from datetime import datetime
from uuid import UUID

from django.utils import timezone
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse, extend_schema
from rest_framework import serializers
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.zones.activity import TimeSpan
from missions.selectors.zones import flown_route, legal_windows
from missions.serializers.inputs import MAX_DAYS_AHEAD
from missions.serializers.legal_windows import LegalWindowsInputSerializer, LegalWindowsSerializer, legal_windows_json
from missions.views.missions import mission_or_404
from workspace.api.errors import ApiProblem
from workspace.api.signed_in import SignedInRequest
from workspace.api.throttling import ScopedRate
from workspace.models import Role

AHEAD_S = 48 * 3_600.0
FROM = OpenApiParameter("from", datetime, description="the first departure that is asked about; else now")


class _LegalWindows(APIView):
    write_roles = frozenset(Role)
    throttle_classes = [ScopedRate]
    throttle_scope = "plans"


class MissionLegalWindows(_LegalWindows):
    @extend_schema(
        operation_id="mission_legal_windows",
        summary="When in the next 48 hours a mission could depart as planned",
        parameters=[FROM],
        responses={200: LegalWindowsSerializer, 409: OpenApiResponse(description="The mission has no routes.")},
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        begin = request.query_params.get("from")
        span = _window(None if begin is None else _moment(begin))
        routes = [route for route in mission.routes.all() if route.geometry is not None]
        if not routes:
            raise ApiProblem(409, "not_planned", _("The mission has no routes yet."))
        found = legal_windows([flown_route(route, 0.0) for route in routes], from_s=span.from_s, to_s=span.to_s)
        answer = legal_windows_json(found, span, [route.mission_uav.sequence for route in routes])
        return Response(LegalWindowsSerializer(answer).data)


class PlanLegalWindows(_LegalWindows):
    @extend_schema(
        operation_id="plan_legal_windows",
        summary="When in the next 48 hours a plan could depart",
        request=LegalWindowsInputSerializer,
        responses=LegalWindowsSerializer,
    )
    def post(self, request: Request) -> Response:
        body = LegalWindowsInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        routes = body.validated_data["routes"]
        span = _window(body.validated_data.get("from"))
        found = legal_windows(routes, from_s=span.from_s, to_s=span.to_s)
        return Response(LegalWindowsSerializer(legal_windows_json(found, span, list(range(len(routes))))).data)


def _moment(text: str) -> datetime:
    try:
        moment: datetime = serializers.DateTimeField().run_validation(text)
    except serializers.ValidationError as error:
        raise serializers.ValidationError({"from": error.detail}) from error
    return moment


def _window(begin: datetime | None) -> TimeSpan:
    """Return the window of departures, in whole seconds."""
    begin = begin or timezone.now()
    if abs((begin - timezone.now()).days) > MAX_DAYS_AHEAD:
        raise serializers.ValidationError({"from": [_("A departure lies within two years of today.")]})
    from_s = float(math.floor(begin.timestamp()))
    return TimeSpan(from_s, from_s + AHEAD_S)
