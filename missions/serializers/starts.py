"""Planned starts, and RTL behaviour of autopilots, in the shapes of the API."""

from collections.abc import Sequence
from typing import Any

from missions.models import PlannedStarts, Route, StartsEnd
from missions.services.commands.planned_starts import StartState
from missions.services.commands.rtl_check import ReturnState
from workspace.api import strict_serializers as serializers


class PlannedStartSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    name = serializers.CharField()
    place = serializers.IntegerField(help_text="the UAV's in the mission")
    due_at = serializers.DateTimeField()
    state = serializers.ChoiceField(choices=[state.value for state in StartState])
    command = serializers.UUIDField(allow_null=True, help_text="the start that it was given")
    why = serializers.CharField(allow_blank=True, help_text="what it waits for after its time, or why it was refused")


class StartsInputSerializer(serializers.Serializer):
    uavs = serializers.ListField(
        child=serializers.IntegerField(), allow_empty=False, required=False,
        help_text="ids of those to start, the others wait on the ground; each is checked once more as GET …/preflight does. Absent: all",
    )  # fmt: skip
    pilot_checked = serializers.BooleanField(
        default=False, help_text="who starts them says that what only a pilot can see was looked at; it stays in the history"
    )


class PlannedStartsSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    mission = serializers.UUIDField()
    mission_name = serializers.CharField()
    created_by = serializers.CharField(allow_null=True)
    created_at = serializers.DateTimeField()
    ended_at = serializers.DateTimeField(allow_null=True)
    end = serializers.ChoiceField(choices=StartsEnd.choices, allow_blank=True, help_text="why it ended; empty: it goes on")
    ended_by = serializers.CharField(allow_null=True)
    uavs = PlannedStartSerializer(many=True)


class PlannedStartsListSerializer(serializers.Serializer):
    server_time = serializers.DateTimeField()
    results = PlannedStartsSerializer(many=True, help_text="that go on or ended within five minutes")


class WaitingStartSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    name = serializers.CharField()
    place = serializers.IntegerField(help_text="the UAV's in the mission")
    after_s = serializers.FloatField(help_text="after the first one, by the plan")


class MissionStartsSerializer(serializers.Serializer):
    server_time = serializers.DateTimeField()
    starts = PlannedStartsSerializer(allow_null=True, help_text="the newest; null: there were none")
    waiting = WaitingStartSerializer(many=True, help_text="UAVs that would be started in planned order now")


class ReturnCheckSerializer(serializers.Serializer):
    place = serializers.IntegerField(help_text="the UAV's in the mission")
    name = serializers.CharField()
    uav = serializers.IntegerField(allow_null=True)
    state = serializers.ChoiceField(choices=[state.value for state in ReturnState])
    warnings = serializers.ListField(child=serializers.CharField(), help_text="what an operator must know; none where all is clear")
    parameter = serializers.CharField(allow_null=True, help_text="of the vehicle, that sets the height")
    height_m = serializers.FloatField(allow_null=True, help_text="above the take-off, as that parameter was read")
    safe_height_m = serializers.FloatField(allow_null=True, help_text="at which nothing would be in the way; null: none, or it is clear")
    read_at = serializers.DateTimeField(allow_null=True)
    fence_warning = serializers.CharField(
        allow_blank=True,
        help_text="that its autopilot ignores the fence of the mission; empty: it does not, or is not known to",
    )
    detail = serializers.CharField(
        allow_blank=True, help_text="parameters of the autopilot that were not read, for the technician who sets it up; empty: none"
    )


class ReturnChecksSerializer(serializers.Serializer):
    results = ReturnCheckSerializer(many=True)


def waiting_json(routes: Sequence[Route]) -> list[dict[str, Any]]:
    return [
        {
            "uav": route.mission_uav.uav_id,
            "name": route.mission_uav.name,
            "place": route.mission_uav.sequence,
            "after_s": route.departs_s - routes[0].departs_s,
        }
        for route in routes
    ]


def planned_starts_json(starts: PlannedStarts) -> dict[str, Any]:
    return {
        "id": str(starts.pk),
        "mission": str(starts.mission_id),
        "mission_name": starts.mission.name,
        "created_by": None if starts.created_by is None else starts.created_by.username,
        "created_at": starts.created_at,
        "ended_at": starts.ended_at,
        "end": starts.end,
        "ended_by": None if starts.ended_by is None else starts.ended_by.username,
        "uavs": starts.uavs,
    }
