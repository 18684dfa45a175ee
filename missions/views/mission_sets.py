"""Several missions at once, copies, and presence of users."""

from collections.abc import Callable
from uuid import UUID

from django.http import Http404
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from inspection.selectors import ground_revision
from missions import services
from missions.models import Mission
from missions.presence import report_presence
from missions.selectors import missions
from missions.selectors.mission_list import choices_of_filters
from missions.selectors.uav_changes import uav_change_json, uav_changes
from missions.serializers import inputs, shapes
from missions.serializers.changes import UavChangeSerializer
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.services.mission_copies import draft_follow_up
from missions.views.approvals import REFUSED
from missions.views.missions import answer_mission, mission_or_404
from missions.views.problems import api_problems, refusals
from workspace.api import strict_serializers as serializers
from workspace.api.errors import ApiProblem
from workspace.api.idempotency import idempotent
from workspace.api.signed_in import SignedInRequest
from workspace.models import Role


class PresentSerializer(serializers.Serializer):
    name = serializers.CharField()
    is_me = serializers.BooleanField(help_text="oneself, in another window")
    is_planning = serializers.BooleanField(help_text="their page has a plan of the mission made at present")


class PresenceSerializer(serializers.Serializer):
    others = PresentSerializer(many=True)
    ground_revision = serializers.IntegerField(help_text="of assets, zones and terrain: a plan of an older one is stale")
    uav_changes = UavChangeSerializer(many=True)


class PresenceInputSerializer(KnownFieldsSerializer):
    editor = serializers.RegexField(r"^[A-Za-z0-9.-]{1,64}$", help_text="a name that the page made up for itself")
    here = serializers.BooleanField(required=False, default=True, help_text="false: the page is being left")
    planning = serializers.BooleanField(required=False, default=False, help_text="the page has a plan of the mission made at present")


class MissionFilterChoices(APIView):
    @extend_schema(
        operation_id="list_mission_filters",
        summary="Authors and UAVs that the list of missions can be filtered by",
        responses=shapes.MissionFiltersSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return Response(choices_of_filters(request.user.organisation))


class MissionDuplicate(APIView):
    @extend_schema(
        operation_id="duplicate_mission",
        summary="A copy of a mission, with its plan",
        request=inputs.MissionCopySerializer,
        responses={201: shapes.MissionSerializer},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        serializer = inputs.MissionCopySerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        copy = services.duplicate_mission(mission=mission, author=request.user, name=serializer.validated_data.get("name", ""))
        return answer_mission(request.user, copy.pk, status=201)


class MissionFollowUp(APIView):
    @extend_schema(
        operation_id="draft_follow_up",
        summary="A draft with the targets that a mission missed",
        description="With its UAVs and wishes, and no departure. Only of a mission that is over; what another one took over stays there. "
        "`targets` flies others again, such as those of which photos are missing (/missions/{id}/coverage).",
        request=inputs.FollowUpSerializer,
        responses={201: shapes.MissionSerializer, **REFUSED},
    )
    @idempotent
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        mission = mission_or_404(request.user, mission_id)
        serializer = inputs.FollowUpSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        with api_problems(), refusals():
            draft = draft_follow_up(mission=mission, author=request.user, **serializer.validated_data)
        return answer_mission(request.user, draft.pk, status=201)


def _each(request: SignedInRequest, do: Callable[[Mission], object], *, deleted: bool) -> Response:
    """Apply an action to each mission separately; the response lists what was done, and each refusal with its reason."""
    serializer = inputs.MissionsInputSerializer(data=request.data)
    serializer.is_valid(raise_exception=True)
    done, refused = [], []
    for mission_id in dict.fromkeys(serializer.validated_data["missions"]):
        try:
            with api_problems():
                do(mission_or_404(request.user, mission_id, deleted=deleted))
            done.append(str(mission_id))
        except ApiProblem as problem:
            refused.append({"id": str(mission_id), "code": problem.code, "message": str(problem.message)})
        except Http404:
            refused.append({"id": str(mission_id), "code": "not_found", "message": "There is no such mission."})
    return Response({"done": done, "refused": refused})


class MissionsDelete(APIView):
    @extend_schema(
        operation_id="delete_missions",
        summary="Delete several missions; they can be brought back",
        request=inputs.MissionsInputSerializer,
        responses=shapes.MissionsDoneSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        return _each(request, lambda mission: services.delete_mission(mission=mission, actor=request.user), deleted=False)


class MissionsRestore(APIView):
    @extend_schema(
        operation_id="restore_missions",
        summary="Bring several deleted missions back",
        request=inputs.MissionsInputSerializer,
        responses=shapes.MissionsDoneSerializer,
    )
    def post(self, request: SignedInRequest) -> Response:
        return _each(request, lambda mission: services.restore_mission(mission=mission, actor=request.user), deleted=True)


class MissionPresence(APIView):
    """Presence of users at a mission; every user who may see it takes part."""

    write_roles = frozenset(Role)

    @extend_schema(
        operation_id="report_presence",
        summary="Say that a page has the mission open, and hear who else has",
        request=PresenceInputSerializer,
        responses=PresenceSerializer,
    )
    def post(self, request: SignedInRequest, mission_id: UUID) -> Response:
        user = request.user
        if missions.revision_of_mission(user.organisation_id, mission_id) is None:
            raise Http404
        serializer = PresenceInputSerializer(data=request.data)
        serializer.is_valid(raise_exception=True)
        reported = serializer.validated_data
        others = report_presence(
            mission_id=mission_id, user=user, editor=reported["editor"], is_here=reported["here"], is_planning=reported["planning"]
        )
        return Response({
            "others": [{"name": other.name, "is_me": other.user == user.pk, "is_planning": other.is_planning} for other in others],
            "ground_revision": ground_revision(),
            "uav_changes": [uav_change_json(change) for change in uav_changes(mission_id)],
        })  # fmt: skip
