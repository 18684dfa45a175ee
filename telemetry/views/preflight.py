"""Preflight checks of a mission's UAVs."""

from uuid import UUID

from django.utils import timezone
from drf_spectacular.utils import extend_schema
from rest_framework import serializers
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.views.missions import mission_or_404
from missions.views.problems import api_problems
from telemetry.services.preflight import CheckState, NextAct, preflight_of
from workspace.api.signed_in import SignedInRequest


class PreflightCheckSerializer(serializers.Serializer):
    code = serializers.CharField(
        help_text="crash, incomplete, link, position, home, battery, mission, fence, return, wind, others, departure, ground, "
        "or a reason that refuses starts"
    )
    state = serializers.ChoiceField(choices=[(state.value, state.value) for state in CheckState], help_text="failed: it is not started")
    message = serializers.CharField()
    safe_height_m = serializers.FloatField(
        allow_null=True, help_text="above take-off, of a return with something in its way: a height for set-return-height; null: none"
    )
    detail = serializers.CharField(
        allow_blank=True, help_text="parameters of the autopilot that were not read, for whoever sets it up; empty: none"
    )


class UavPreflightSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    name = serializers.CharField()
    place = serializers.IntegerField(help_text="in the mission")
    is_loaded = serializers.BooleanField(help_text="the mission was uploaded, and read back as approved")
    blocks = serializers.BooleanField(help_text="one of its checks has failed")
    is_ready = serializers.BooleanField(
        help_text="it has the mission and none of its checks has failed: it may be started without the others"
    )
    checks = PreflightCheckSerializer(many=True)


class PreflightSerializer(serializers.Serializer):
    next_act = serializers.ChoiceField(
        choices=[(act.value, act.value) for act in NextAct],
        allow_null=True,
        help_text="connect: none is ready, and none that lacks the mission is heard; upload: POST …/dispatch; wait: uploads are under way; "
        "start: POST …/planned-starts with those that are ready; null: nothing is left to start",
    )
    checks = PreflightCheckSerializer(many=True, help_text="of the whole mission")
    uavs = UavPreflightSerializer(many=True, help_text="whose first flight has not begun, in the order of their departures")


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
