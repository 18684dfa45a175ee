"""The event log as it goes over the wire."""

from typing import Any

from missions.event_hooks import EventKind, MissionEvent, Place
from workspace import strict_serializers as serializers

LEVELS = ("critical", "warning", "advisory")


class EventUavSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()


class MissionEventSerializer(serializers.Serializer):
    key = serializers.CharField(help_text="the same whenever it is read")
    at = serializers.DateTimeField()
    mission = serializers.UUIDField()
    kind = serializers.ChoiceField(choices=[kind.value for kind in EventKind])
    uav = EventUavSerializer(allow_null=True)
    who = serializers.CharField(allow_null=True, help_text="the user who did it; null: no user did, or one who has left")
    level = serializers.ChoiceField(choices=LEVELS, allow_null=True)
    is_simulated = serializers.BooleanField(help_text="of a UAV that is no real aircraft, or of a simulation")
    message = serializers.CharField(help_text="in English")
    values = serializers.DictField(child=serializers.JSONField(), help_text="by kind; see docs/live.md")


class MissionEventPageSerializer(serializers.Serializer):
    results = MissionEventSerializer(many=True)
    next = serializers.CharField(allow_null=True)


def event_json(place: Place, event: MissionEvent) -> dict[str, Any]:
    return {
        "key": place.key,
        "at": place.at,
        "mission": str(place.mission_id),
        "kind": event.kind.value,
        "uav": None if event.uav_id is None else {"id": event.uav_id, "name": event.uav_name},
        "who": event.who,
        "level": event.level,
        "is_simulated": event.is_simulated,
        "message": event.message,
        "values": event.values,
    }
