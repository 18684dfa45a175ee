"""Checks before the UAVs of a mission are started."""

from uuid import UUID

from django.utils import timezone
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.views.missions import mission_or_404
from missions.views.problems import api_problems
from telemetry.serializers.preflight import PreflightSerializer
from telemetry.services.preflight import preflight_of
from workspace.signed_in import SignedInRequest


class MissionPreflight(APIView):
    @extend_schema(
        operation_id="get_mission_preflight",
        summary="Checks before the UAVs of a mission are started, and the next act",
        description="For each UAV that has not begun its first flight: link, position, battery, the mission on board, its way home, wind"
        " and others in the air; and what speaks against the mission as the ground is now. A start is refused in any case while the"
        " mission is not on board, a zone is in the way, or a UAV in the air is too near.",
        responses=PreflightSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        with api_problems():
            found = preflight_of(mission, now=timezone.now())
        return Response(PreflightSerializer(found).data)
