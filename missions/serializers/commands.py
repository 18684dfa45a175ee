"""Approvals and commands to UAVs in the shapes of the API."""

from typing import Any

from drf_spectacular.utils import extend_schema_field

from missions.models import Approval, CommandKind, CommandState, LinkKind, UavCommand
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.serializers.limits import MAX_LEG_M, MIN_LEG_M
from missions.services.closing import MAX_REASON_LENGTH
from missions.services.commands.batch import BATCH_KINDS, UavAnswer
from missions.services.commands.steering import MAX_WAIT_S
from workspace.api import strict_serializers as serializers
from workspace.api.fields import WhySerializer
from workspace.reason_texts import column_text, reasons_of_column

MAX_FLIGHTS = 100
MAX_UAVS = 1_000
PAUSE_IS_DEPRECATED = "pause is deprecated: hold does the same, and resume goes on from both"
PRIORITIES = ("safety", "pause", "mission", "parameter")


class ApprovalSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    content_sha256 = serializers.CharField(help_text="of the document in its canonical form: what is flown is what has this hash")
    approved_by = serializers.CharField(allow_null=True)
    approved_at = serializers.DateTimeField()
    failed_rehearsal_reason = serializers.CharField(help_text="why it was approved without a passed rehearsal")
    revoke_requested_at = serializers.DateTimeField(allow_null=True, help_text="since when UAVs are being rid of it")
    revoke_requested_by = serializers.CharField(allow_null=True)
    revoke_reason = serializers.CharField()


class FlightsSerializer(serializers.Serializer):
    uav = serializers.IntegerField(help_text="its place in the mission")
    flights = serializers.IntegerField(help_text="in how many it flies its route")
    flown = serializers.IntegerField()
    has_failed = serializers.BooleanField(help_text="a flight of it failed: it is not set in motion again in this mission")


class MissionApprovalSerializer(ApprovalSerializer):
    flights = FlightsSerializer(many=True)


class ApprovalDocumentSerializer(ApprovalSerializer):
    document = serializers.JSONField(
        help_text="routes with their flights and items, zones, conditions, ground, lost link, separation, figures of UAVs: as approved"
    )


class ApproveInputSerializer(KnownFieldsSerializer):
    longest_leg_m = serializers.FloatField(
        required=False,
        allow_null=True,
        default=None,
        min_value=MIN_LEG_M,
        max_value=MAX_LEG_M,
        help_text="autopilots are given points on each leg that is longer, on the same line; without it: legs as planned",
    )
    acknowledges_failed_rehearsal = serializers.CharField(
        required=False,
        allow_blank=True,
        default="",
        max_length=MAX_REASON_LENGTH,
        help_text="why it is approved although the rehearsal of this plan failed, which is refused otherwise; kept with the approval",
    )


class ReasonInputSerializer(KnownFieldsSerializer):
    reason = serializers.CharField(max_length=MAX_REASON_LENGTH, help_text="kept in the mission's history")


class WhyInputSerializer(KnownFieldsSerializer):
    why = serializers.CharField(max_length=MAX_REASON_LENGTH, required=False, allow_blank=True, default="")


class DispatchInputSerializer(WhyInputSerializer):
    uav = serializers.IntegerField(
        required=False, min_value=0, max_value=10_000, help_text="its place in the mission; without it: all that have nothing yet"
    )
    flight = serializers.IntegerField(required=False, min_value=1, max_value=MAX_FLIGHTS, help_text="of this UAV, from 1 on")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if "flight" in attrs and "uav" not in attrs:
            raise serializers.ValidationError({"uav": "A flight is one UAV's."})
        return attrs


class CommandParametersSerializer(KnownFieldsSerializer):
    speed_mps = serializers.FloatField(required=False, help_text="over ground; of change-speed")
    height_m = serializers.FloatField(
        required=False, help_text="above the take-off; of set-return-height, and of a return that is to set it before"
    )
    then_return = serializers.BooleanField(required=False, help_text="of set-return-height: the UAV returns once it is set")
    wait_s = serializers.FloatField(required=False, help_text="of return: it holds for so long, and returns then")
    along_route = serializers.BooleanField(
        required=False,
        help_text="of return: not straight, but by the rest of its approved route, from the waypoint on from which that is clear",
    )
    altitude_relative_m = serializers.FloatField(required=False, help_text="above the place of take-off; of take-off")
    out_of_slot = serializers.BooleanField(
        required=False, help_text="of start, after 409 `start_slot`: take off although others in the air come near its route"
    )


class CommandInputSerializer(WhyInputSerializer):
    kind = serializers.ChoiceField(choices=CommandKind.choices, help_text=PAUSE_IS_DEPRECATED)
    parameters = CommandParametersSerializer(required=False)


class GivenParametersSerializer(serializers.Serializer):
    """Parameters of the command's kind only."""

    speed_mps = serializers.FloatField(required=False)
    height_m = serializers.FloatField(required=False)
    then_return = serializers.BooleanField(required=False, help_text="it is followed by a return")
    wait_s = serializers.FloatField(
        required=False, help_text="of a hold: the return follows so long after it was given; of a return: it waits"
    )
    along_route = serializers.BooleanField(required=False, help_text="of a return: by the rest of its approved route")
    altitude_relative_m = serializers.FloatField(required=False)
    flight = serializers.IntegerField(required=False, help_text="number of the flight whose mission is sent, from 1")
    out_of_slot = serializers.BooleanField(required=False, help_text="it was asked for although others in the air come near its route")


@extend_schema_field(GivenParametersSerializer)
class CommandParametersField(serializers.JSONField):
    """A command's parameters as they are stored."""


class CommandUavSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    is_simulated = serializers.BooleanField(help_text="no real aircraft")


class ProgressSerializer(serializers.Serializer):
    done = serializers.IntegerField()
    total = serializers.IntegerField()


class CommandSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    uav = CommandUavSerializer()
    mission = serializers.UUIDField(allow_null=True)
    approval = serializers.UUIDField(allow_null=True)
    sequence = serializers.IntegerField(help_text="of the UAV's commands, in the order in which they were given")
    kind = serializers.ChoiceField(choices=CommandKind.choices)
    priority = serializers.ChoiceField(choices=PRIORITIES)
    parameters = CommandParametersField()
    state = serializers.ChoiceField(choices=CommandState.choices)
    link = serializers.ChoiceField(choices=LinkKind.choices)
    created_by = serializers.CharField(allow_null=True)
    why = serializers.CharField()
    created_at = serializers.DateTimeField()
    expires_at = serializers.DateTimeField(allow_null=True, help_text="until when it is wanted; null: until a later one takes its place")
    attempts = serializers.IntegerField()
    sent_at = serializers.DateTimeField(allow_null=True)
    acknowledged_at = serializers.DateTimeField(allow_null=True)
    finished_at = serializers.DateTimeField(allow_null=True)
    progress = ProgressSerializer(allow_null=True)
    outcome_code = serializers.CharField()
    outcome = serializers.CharField(help_text="why it failed or expired; of one that is applied: what to beware of")
    outcome_why = WhySerializer(many=True, help_text="the same for programs; empty where only a text is known")


class CommandEventSerializer(serializers.Serializer):
    state = serializers.ChoiceField(choices=CommandState.choices)
    attempt = serializers.IntegerField()
    holder = serializers.CharField(help_text="the gateway that carried it")
    note = serializers.CharField()
    recorded_at = serializers.DateTimeField()


class CommandDetailSerializer(CommandSerializer):
    events = CommandEventSerializer(many=True)


class CommandPageSerializer(serializers.Serializer):
    results = CommandSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class ReturnWaySerializer(KnownFieldsSerializer):
    """Return of a UAV: after a hold, at a height set before, both in this order, or along its route. Empty: straight, at once."""

    height_m = serializers.FloatField(required=False, help_text="above the take-off: set on the UAV and read back before it returns")
    wait_s = serializers.FloatField(required=False, min_value=0.0, max_value=MAX_WAIT_S, help_text="for which it holds before")
    along_route = serializers.BooleanField(required=False, help_text="by the rest of its approved route; with nothing else")


class _BatchSerializer(WhyInputSerializer):
    kind = serializers.ChoiceField(choices=sorted(BATCH_KINDS), help_text=PAUSE_IS_DEPRECATED)
    ways = serializers.DictField(
        child=ReturnWaySerializer(),
        required=False,
        help_text="of return: how UAVs, by their ids, return, so that they keep apart; the others straight and at once",
    )

    def validate_ways(self, ways: dict[str, dict[str, Any]]) -> dict[int, dict[str, Any]]:
        if not all(uav.isascii() and uav.isdigit() and len(uav) < 19 for uav in ways):
            raise serializers.ValidationError("The names are ids of UAVs.")
        return {int(uav): dict(way) for uav, way in ways.items()}


class BatchInputSerializer(_BatchSerializer):
    uavs = serializers.ListField(
        child=serializers.IntegerField(),
        required=False,
        allow_empty=False,
        max_length=MAX_UAVS,
        help_text="ids; without it: all with a route of the mission sent or in flight",
    )


class ScopeSerializer(KnownFieldsSerializer):
    mission = serializers.UUIDField()
    uavs = serializers.ListField(
        child=serializers.IntegerField(),
        required=False,
        allow_empty=False,
        max_length=MAX_UAVS,
        help_text="ids; without it: all with a route of the mission sent or in flight",
    )


class MissionsBatchInputSerializer(_BatchSerializer):
    missions = ScopeSerializer(many=True, allow_empty=False)


class RefusedReasonSerializer(serializers.Serializer):
    code = serializers.CharField()
    message = serializers.CharField()


class BatchAnswerSerializer(serializers.Serializer):
    """Outcome of a batch for one UAV."""

    mission = serializers.UUIDField()
    uav = serializers.IntegerField()
    name = serializers.CharField(allow_blank=True, help_text="empty for a UAV that is not known here")
    place = serializers.IntegerField(allow_null=True, help_text="the UAV's in the mission; null: it flies nothing of it")
    is_accepted = serializers.BooleanField()
    command = CommandSerializer(allow_null=True)
    reasons = RefusedReasonSerializer(many=True, help_text="why it was given no command")


class BatchAnswersSerializer(serializers.Serializer):
    results = BatchAnswerSerializer(many=True)


class OpenTargetReasonSerializer(KnownFieldsSerializer):
    target = serializers.IntegerField(min_value=0, help_text="its place in the mission")
    reason = serializers.CharField(max_length=MAX_REASON_LENGTH)


class CloseInputSerializer(KnownFieldsSerializer):
    reasons = OpenTargetReasonSerializer(many=True, required=False, default=list, help_text="why each target that is still open is left")


class SentSerializer(serializers.Serializer):
    """Outcome of sending, aborting or closing a mission."""

    mission = serializers.UUIDField()
    state = serializers.CharField()
    revision = serializers.IntegerField(help_text="the ETag")
    commands = CommandSerializer(many=True)


class NearestZoneSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    metres = serializers.FloatField(help_text="across the ground; 0 inside, above or below the zone")


class NearestZoneAnswerSerializer(serializers.Serializer):
    nearest = NearestZoneSerializer(allow_null=True, help_text="null: none within 5 km")


def approval_json(approval: Approval | None) -> dict[str, Any] | None:
    if approval is None:
        return None
    return {
        "id": str(approval.pk),
        "content_sha256": approval.content_sha256,
        "approved_by": approval.approved_by.username if approval.approved_by else None,
        "approved_at": approval.approved_at,
        "failed_rehearsal_reason": approval.failed_rehearsal_reason,
        "revoke_requested_at": approval.revoke_requested_at,
        "revoke_requested_by": approval.revoked_by.username if approval.revoked_by else None,
        "revoke_reason": approval.revoke_reason,
    }


def command_json(command: UavCommand) -> dict[str, Any]:
    return {
        "id": str(command.pk),
        "uav": {"id": command.uav_id, "name": command.uav.name, "is_simulated": command.uav.is_simulated},
        "mission": None if command.mission_id is None else str(command.mission_id),
        "approval": None if command.approval_id is None else str(command.approval_id),
        "sequence": command.sequence,
        "kind": command.kind,
        "priority": PRIORITIES[command.priority],
        "parameters": command.parameters,
        "state": command.state,
        "link": command.link,
        "created_by": command.created_by.username if command.created_by else None,
        "why": command.why,
        "created_at": command.created_at,
        "expires_at": command.expires_at,
        "attempts": command.attempts,
        "sent_at": command.sent_at,
        "acknowledged_at": command.acknowledged_at,
        "finished_at": command.finished_at,
        "progress": command.progress,
        "outcome_code": command.outcome_code,
        "outcome": column_text(command.outcome_why, command.outcome),
        "outcome_why": reasons_of_column(command.outcome_why, command.outcome),
    }


def batch_answer_json(answer: UavAnswer) -> dict[str, Any]:
    return {
        "mission": str(answer.mission),
        "uav": answer.uav,
        "name": answer.name,
        "place": answer.place,
        "is_accepted": answer.is_accepted,
        "command": None if answer.command is None else command_json(answer.command),
        "reasons": [{"code": reason.code, "message": reason.message} for reason in answer.reasons],
    }
