"""Starting a mission's UAVs in planned order."""

from dataclasses import asdict
from datetime import timedelta
from uuid import UUID

from django.db.models import Q
from django.utils import timezone
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import PlannedStarts
from missions.serializers.starts import (
    MissionStartsSerializer,
    PlannedStartsListSerializer,
    PlannedStartsSerializer,
    ReturnChecksSerializer,
    StartsInputSerializer,
    planned_starts_json,
    waiting_json,
)
from missions.services.commands.planned_starts import begin_planned_starts, stop_planned_starts, waiting_for_start
from missions.services.commands.rtl_check import return_checks
from missions.views.approvals import REFUSED
from missions.views.missions import mission_or_404
from missions.views.problems import api_problems, refusals
from workspace.api.idempotency import idempotent
from workspace.api.permissions import FLYING
from workspace.api.signed_in import SignedInRequest

SHOWN_AFTER = timedelta(minutes=5)


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


class PlannedStartsList(APIView):
    @extend_schema(
        operation_id="list_planned_starts",
        summary="Missions whose UAVs are being started in planned order",
        responses=PlannedStartsListSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        now = timezone.now()
        recent = Q(ended_at=None) | Q(ended_at__gt=now - SHOWN_AFTER)
        found = PlannedStarts.objects.filter(recent, mission__organisation=request.user.organisation, mission__deleted_at=None)
        rows = found.select_related("mission", "created_by", "ended_by").order_by("-created_at")
        return Response({"server_time": now, "results": [planned_starts_json(starts) for starts in rows]})


class MissionPlannedStarts(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="get_planned_starts",
        summary="How the starts of a mission's UAVs stand",
        responses=MissionStartsSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        newest = mission.planned_starts.select_related("mission", "created_by", "ended_by").first()
        return Response(
            {
                "server_time": timezone.now(),
                "starts": None if newest is None else planned_starts_json(newest),
                "waiting": waiting_json(waiting_for_start(mission)),
            }
        )

    @extend_schema(
        operation_id="begin_planned_starts",
        summary="Start all UAVs of a mission in planned order",
        description="On the server: whoever closes the page stops nothing. Each start is checked when it is due as a single one is, also"
        " against the actual state of those in the air, and waits where it has to. It ends when a UAV of the mission is told to pause,"
        " hold, return or land, or the mission is aborted.",
        request=StartsInputSerializer,
        responses={201: PlannedStartsSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        asked = StartsInputSerializer(data=request.data)
        asked.is_valid(raise_exception=True)
        with api_problems(), refusals():
            starts = begin_planned_starts(mission=mission, actor=request.user, **asked.validated_data)
        return Response(planned_starts_json(starts), status=201)

    @extend_schema(
        operation_id="stop_planned_starts",
        summary="Start no further UAV of a mission",
        description="A start that was given and not sent is withdrawn; UAVs in the air fly on.",
        responses={200: PlannedStartsSerializer, **REFUSED},
    )
    def delete(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        with refusals():
            starts = stop_planned_starts(mission=mission, actor=request.user)
        return Response(planned_starts_json(starts))
