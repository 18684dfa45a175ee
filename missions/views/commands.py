"""Giving, listing and following commands to UAVs."""

from typing import Any
from uuid import UUID

from django.shortcuts import get_object_or_404
from django.urls import reverse
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import CommandKind, UavCommand
from missions.selectors.commands import commands_of_mission, commands_of_organisation, commands_of_uav
from missions.serializers import commands as shapes
from missions.services.commands.batch import Scope, command_missions
from missions.services.commands.steering import command_uav
from missions.views.approvals import REFUSED
from missions.views.missions import mission_or_404
from missions.views.problems import refusals
from missions.views.uavs import uav_or_404
from workspace.api.idempotency import idempotent
from workspace.api.paging import page_of
from workspace.api.permissions import FLYING
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest

NEWEST_FIRST = ("-created_at", "-pk")


def _detail(command: UavCommand) -> dict[str, object]:
    return {
        **shapes.command_json(command),
        "events": shapes.CommandEventSerializer(command.events.all(), many=True).data,
    }


def _batch(request: SignedInRequest, scopes: list[Scope], values: dict[str, Any]) -> Response:
    with refusals():
        answers = command_missions(
            scopes=scopes, kind=CommandKind(values["kind"]), actor=request.user, why=values["why"], ways=values.get("ways")
        )
    return Response({"results": [shapes.batch_answer_json(answer) for answer in answers]})


class MissionCommands(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="list_commands_of_mission",
        summary="What its UAVs were told, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=shapes.CommandPageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        page = page_of(request, commands_of_mission(mission_or_404(request.user, mission_id)), order=NEWEST_FIRST)
        return Response({"results": [shapes.command_json(command) for command in page.rows], "next": page.next})

    @extend_schema(
        operation_id="command_mission",
        summary="Give several UAVs of a mission a command in one request",
        description="Reached are UAVs with a route of this mission sent or in flight; each other one that is named is refused by itself,"
        " as are those on the ground and those that never connected. All are given theirs in one transaction.",
        request=shapes.BatchInputSerializer,
        responses={200: shapes.BatchAnswersSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        body = shapes.BatchInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        return _batch(request, [Scope(mission, body.validated_data.get("uavs"))], body.validated_data)


class MissionsCommands(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="command_missions",
        summary="Give UAVs of several missions a command in one request",
        description="As for one mission; each mission is named.",
        request=shapes.MissionsBatchInputSerializer,
        responses={200: shapes.BatchAnswersSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest) -> Response:
        body = shapes.MissionsBatchInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        asked = body.validated_data["missions"]
        scopes = [Scope(mission_or_404(request.user, entry["mission"]), entry.get("uavs")) for entry in asked]
        return _batch(request, scopes, body.validated_data)


class UavCommands(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="list_commands_of_uav",
        summary="What a UAV was told, the newest first",
        parameters=PAGE_PARAMETERS,
        responses=shapes.CommandPageSerializer,
    )
    def get(self, request: SignedInRequest, uav_id: int) -> Response:
        page = page_of(request, commands_of_uav(uav_or_404(request.user, uav_id)), order=NEWEST_FIRST)
        return Response({"results": [shapes.command_json(command) for command in page.rows], "next": page.next})

    @extend_schema(
        operation_id="command_uav",
        summary="Give a UAV a command",
        description="It waits in the outbox until a gateway has carried it, or nobody wants it any more. An earlier one about the same"
        " thing that is not finished expires; an abort takes the place of all.",
        request=shapes.CommandInputSerializer,
        responses={201: shapes.CommandDetailSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, uav_id: int) -> Response:
        uav = uav_or_404(request.user, uav_id)
        body = shapes.CommandInputSerializer(data=request.data)
        body.is_valid(raise_exception=True)
        values = body.validated_data
        with refusals():
            command = command_uav(
                uav=uav,
                kind=CommandKind(values["kind"]),
                actor=request.user,
                why=values["why"],
                parameters=dict(values.get("parameters", {})),
            )
        command.refresh_from_db()
        return Response(_detail(command), status=201, headers={"Location": reverse("api-command", args=[command.pk])})


class CommandDetail(APIView):
    @extend_schema(operation_id="get_command", summary="A command and its way so far", responses=shapes.CommandDetailSerializer)
    def get(self, request: SignedInRequest, command_id: UUID) -> Response:
        return Response(_detail(get_object_or_404(commands_of_organisation(request.user.organisation), pk=command_id)))
