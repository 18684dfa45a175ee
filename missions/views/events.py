"""The event log of one mission, and of all that live pages show."""

from collections.abc import Collection
from datetime import datetime
from typing import Any
from uuid import UUID

from django.http import Http404
from drf_spectacular.utils import extend_schema
from rest_framework.response import Response
from rest_framework.views import APIView

from missions.hooks.events import EventKind, EventPlace, MissionEvent
from missions.models import Mission
from missions.selectors.events import LoggedEvent, events_of_missions, missions_with_live_events
from missions.selectors.missions import mission_alone
from workspace.api import strict_serializers as serializers
from workspace.api.paging import slice_of
from workspace.api.schema import PAGE_PARAMETERS
from workspace.api.signed_in import SignedInRequest

LEVELS = ("critical", "warning", "advisory")
DESCRIPTION = (
    "Take-offs, landings, crashes, drop-outs, commands step by step, alerts, targets, offers of another plan, and what was done to a "
    "simulation: who and when."
)


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


def event_json(place: EventPlace, event: MissionEvent) -> dict[str, Any]:
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


class MissionEvents(APIView):
    @extend_schema(
        operation_id="list_mission_events",
        summary="What happened in a mission, the newest first",
        description=DESCRIPTION,
        parameters=PAGE_PARAMETERS,
        responses=MissionEventPageSerializer,
    )
    def get(self, request: SignedInRequest, mission_id: UUID) -> Response:
        try:
            mission = mission_alone(request.user.organisation, mission_id)
        except Mission.DoesNotExist as error:
            raise Http404 from error
        return _page(request, [mission.pk])


class LiveEvents(APIView):
    @extend_schema(
        operation_id="list_live_events",
        summary="What happened in missions that are on their way or ended within the hour, the newest first",
        description=DESCRIPTION,
        parameters=PAGE_PARAMETERS,
        responses=MissionEventPageSerializer,
    )
    def get(self, request: SignedInRequest) -> Response:
        return _page(request, missions_with_live_events(request.user.organisation))


def _page(request: SignedInRequest, mission_ids: Collection[UUID]) -> Response:
    def place(logged: LoggedEvent) -> tuple[datetime, str]:
        return logged.place.at, logged.place.key

    page = slice_of(request, lambda before, limit: events_of_missions(mission_ids, before=before, limit=limit), place)
    results = [event_json(logged.place, logged.event) for logged in page.items if logged.event is not None]
    return Response({"results": results, "next": page.next})
