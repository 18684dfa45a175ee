"""What is in the way when UAVs of a mission are told to return or abort."""

from dataclasses import asdict
from uuid import UUID

from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.serializers.returns import ReturnChecksSerializer
from missions.services.commands.rtl_check import return_checks
from missions.views.missions import mission_or_404
from missions.views.problems import api_problems
from workspace.api.signed_in import SignedInRequest


class MissionReturns(APIView):
    @extend_schema(
        operation_id="get_mission_returns",
        summary="What is in the way when UAVs of a mission are told to return or abort",
        description="An autopilot then flies home straight and as high as its own parameters say, whatever was approved. From all along"
        " each route that way is looked at against zones, the ground, towers and wires, at the height that was last read from the UAV.",
        responses=ReturnChecksSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        with api_problems():
            checks = return_checks(mission)
        return Response(ReturnChecksSerializer({"results": [asdict(check) for check in checks]}).data)
