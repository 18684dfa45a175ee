"""Approving missions, revoking approvals, sending missions to UAVs, aborting and closing them."""

from typing import Any
from uuid import UUID

from django.http import Http404
from drf_spectacular.utils import OpenApiResponse, extend_schema
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.models import UavCommand
from missions.selectors import missions
from missions.selectors.commands import commands_of_organisation
from missions.selectors.zones import nearest_zone_of_mission
from missions.serializers import commands as shapes
from missions.serializers.shapes import MissionSerializer
from missions.services.approval.approval import approve_mission, revoke_approval
from missions.services.closing import close_mission
from missions.services.commands.dispatch import abort_mission, dispatch_mission
from missions.views.missions import IF_MATCH, IF_MATCH_OPTIONAL, answer_mission, expected_revision, mission_or_404, stated_revision
from missions.views.problems import api_problems, refusals
from workspace.api.idempotency import idempotent
from workspace.api.permissions import FLYING
from workspace.api.signed_in import SignedInRequest
from workspace.models import User

REFUSED = {
    409: OpenApiResponse(description="It cannot be done: `details.reasons` has each reason; or somebody else was faster."),
    412: OpenApiResponse(description="The mission has changed since."),
}
REFUSED_UNSEEN = REFUSED | {428: OpenApiResponse(description="If-Match is missing.")}


def _body(serializer: type, request: Request) -> dict[str, Any]:
    body = serializer(data=request.data)
    body.is_valid(raise_exception=True)
    return dict(body.validated_data)


def _sent(user: User, mission_id: UUID, commands: list[UavCommand]) -> Response:
    mission = mission_or_404(user, mission_id)
    rows = commands_of_organisation(user.organisation).filter(pk__in=[command.pk for command in commands]).order_by("uav_id", "sequence")
    body = {
        "mission": str(mission.pk),
        "state": mission.state,
        "revision": mission.revision,
        "commands": [shapes.command_json(command) for command in rows],
    }
    return Response(body, headers={"ETag": f'"{mission.revision}"'})


class MissionApproval(APIView):
    @extend_schema(
        operation_id="get_mission_approval", summary="What was approved, word for word", responses=shapes.ApprovalDocumentSerializer
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        approval = missions.approval_in_force(mission_or_404(request.user, mission_id))
        if approval is None:
            raise Http404
        return Response(
            {**(shapes.approval_json(approval) or {}), "document": approval.document}, headers={"ETag": f'"{approval.content_sha256}"'}
        )


class MissionNearestZone(APIView):
    @extend_schema(
        operation_id="get_nearest_zone",
        summary="The no-fly zone that a planned mission comes nearest to",
        description="Of the zones in force while it is flown, at heights that it has, within 5 km; without a departure of all zones.",
        responses=shapes.NearestZoneAnswerSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        nearest = nearest_zone_of_mission(mission_or_404(request.user, mission_id))
        found = None if nearest is None else {"id": nearest.zone, "name": nearest.name, "metres": round(nearest.metres, 1)}
        return Response({"nearest": found})


class MissionApprove(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="approve_mission",
        summary="Approve a planned mission: from now on it is frozen",
        parameters=[IF_MATCH],
        request=shapes.ApproveInputSerializer,
        responses={200: MissionSerializer, **REFUSED_UNSEEN},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        values = _body(shapes.ApproveInputSerializer, request)
        with api_problems(has_precondition=expected is not None), refusals():
            approve_mission(
                mission=mission,
                actor=request.user,
                expected_revision=expected,
                longest_leg_m=values["longest_leg_m"],
                failed_rehearsal_reason=values["acknowledges_failed_rehearsal"],
            )
        return answer_mission(request.user, mission_id)


class MissionRevoke(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="revoke_mission",
        summary="Take an approval back: the mission can be changed again",
        description="If it may be on UAVs, each is told to drop it, and the mission is planned again once all were seen without it.",
        parameters=[IF_MATCH_OPTIONAL],
        request=shapes.ReasonInputSerializer,
        responses={200: MissionSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = stated_revision(request)
        mission = mission_or_404(request.user, mission_id)
        values = _body(shapes.ReasonInputSerializer, request)
        with api_problems(has_precondition=expected is not None), refusals():
            revoke_approval(mission=mission, actor=request.user, reason=values["reason"], expected_revision=expected)
        return answer_mission(request.user, mission_id)


class MissionDispatch(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="dispatch_mission",
        summary="Send an approved mission to its UAVs",
        description="Each UAV is given the first flight of its route; with `uav` one of them, with `flight` a later flight of it.",
        parameters=[IF_MATCH],
        request=shapes.DispatchInputSerializer,
        responses={200: shapes.SentSerializer, **REFUSED_UNSEEN},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = expected_revision(request)
        mission = mission_or_404(request.user, mission_id)
        values = _body(shapes.DispatchInputSerializer, request)
        with api_problems(has_precondition=expected is not None), refusals():
            sent = dispatch_mission(
                mission=mission,
                actor=request.user,
                expected_revision=expected,
                place=values.get("uav"),
                flight=values.get("flight", 1),
                why=values["why"],
            )
        return _sent(request.user, mission_id, sent)


class MissionAbort(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="abort_mission",
        summary="Abort a mission that is on its way",
        description="Works without If-Match: whatever was changed since, the UAVs are told to stop flying it.",
        parameters=[IF_MATCH_OPTIONAL],
        request=shapes.WhyInputSerializer,
        responses={200: shapes.SentSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = stated_revision(request)
        mission = mission_or_404(request.user, mission_id)
        values = _body(shapes.WhyInputSerializer, request)
        with api_problems(has_precondition=expected is not None), refusals():
            reported = abort_mission(mission=mission, actor=request.user, why=values["why"], expected_revision=expected)
        return _sent(request.user, mission_id, reported)


class MissionClose(APIView):
    write_scopes = FLYING

    @extend_schema(
        operation_id="close_mission",
        summary="Close a mission, with a reason for each open target",
        description=(
            "Also of one that was aborted or has failed. Open targets are skipped for their reasons; then the record is whole, and a "
            "follow-up can be planned. Refused while a UAV of the mission is in the air. Works without If-Match."
        ),
        parameters=[IF_MATCH_OPTIONAL],
        request=shapes.CloseInputSerializer,
        responses={200: shapes.SentSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        expected = stated_revision(request)
        mission = mission_or_404(request.user, mission_id)
        reasons = {row["target"]: row["reason"] for row in _body(shapes.CloseInputSerializer, request)["reasons"]}
        with api_problems(has_precondition=expected is not None), refusals():
            close_mission(mission=mission, actor=request.user, reasons=reasons, expected_revision=expected)
        return _sent(request.user, mission_id, [])
