"""Results of targets in the API."""

from datetime import timedelta
from typing import Any

from django.urls import reverse
from rest_framework import serializers

from inspection.models import AssetReference
from missions.fields import PositionField
from missions.models import MissionState, TargetState
from missions.serializers.view_plans import TaskOutputSerializer
from workspace.api.external_data import AttributesField
from workspace.jobs.serializers import Declared
from workspace.reason_texts import column_text

STATES = [state for state in TargetState.choices if state[0] != TargetState.PENDING]


class ResultMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    external_id = serializers.CharField(help_text="may be empty")
    state = serializers.ChoiceField(choices=MissionState.choices)
    record = serializers.CharField(help_text="address of its record: how near each UAV came, and how long it held")


class ResultAssetSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    kind = serializers.CharField()
    external_id = serializers.CharField(help_text="your organisation's id of it; may be empty")


class ResultPlanSerializer(serializers.Serializer):
    uav = serializers.IntegerField(allow_null=True)
    uav_name = serializers.CharField()
    waypoint_sequence = serializers.IntegerField()
    at = serializers.DateTimeField(allow_null=True, help_text="null where the mission has no departure")


class ReportedResultSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    uav_name = serializers.CharField()
    outcome = serializers.CharField(help_text="complete, skipped or failed")
    note = serializers.CharField()
    values = serializers.DictField(help_text="as the payload measured them")
    measured_at = serializers.DateTimeField()
    received_at = serializers.DateTimeField()


class ResultSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    mission = ResultMissionSerializer()
    place = serializers.IntegerField(help_text="of the target in its mission, from 0")
    label: Declared = serializers.CharField()
    external_id = serializers.CharField(help_text="the target's; may be empty")
    attributes = AttributesField(required=True, help_text="the target's")
    asset = ResultAssetSerializer(allow_null=True)
    position = PositionField(allow_null=True, help_text="as picked, else the asset's centre")
    task = TaskOutputSerializer(help_text="as planned")
    planned = ResultPlanSerializer(allow_null=True, help_text="null where no route reached it")
    state = serializers.ChoiceField(choices=STATES)
    state_at = serializers.DateTimeField(help_text="since when")
    state_reason = serializers.CharField(help_text="why it was skipped or failed; may be empty")
    reached_at = serializers.DateTimeField(
        allow_null=True, help_text="by the log, some seconds after it was flown; null while not known, and where it was not reached"
    )
    held_s = serializers.FloatField(allow_null=True, help_text="the longest that the UAV can have stayed; null while not known")
    reported = ReportedResultSerializer(many=True, help_text="what UAVs reported of it, by time")


class ResultPageSerializer(serializers.Serializer):
    results = ResultSerializer(many=True)
    next = serializers.CharField(allow_null=True)


def result_json(target: Any, reference: AssetReference | None) -> dict[str, Any]:
    """Return a result. `target` is a row of selectors.results, `reference` the organisation's reference to its asset."""
    mission, asset = target.mission, target.asset
    at = target.place
    return {
        "id": target.pk,
        "mission": {
            "id": str(mission.pk),
            "name": mission.name,
            "external_id": mission.external_id,
            "state": mission.state,
            "record": reverse("api-mission-record", args=[mission.pk]),
        },
        "place": target.sequence,
        "label": target.label,
        "external_id": target.external_id,
        "attributes": target.attributes,
        "asset": None if asset is None else {"id": asset.pk, "kind": asset.kind, "external_id": reference.external_id if reference else ""},
        "position": None if at is None else list(at.coords),
        "task": target.task,
        "planned": _planned(target),
        "state": target.state,
        "state_at": target.state_at,
        "state_reason": column_text(target.state_why, target.state_reason),
        "reached_at": target.reached_at,
        "held_s": target.held_s,
        "reported": [
            {
                "uav": row.uav_id,
                "uav_name": row.uav.name,
                "outcome": row.outcome,
                "note": row.note,
                "values": row.values,
                "measured_at": row.measured_at,
                "received_at": row.received_at,
            }
            for row in target.reported_results
        ],
    }


def _planned(target: Any) -> dict[str, Any] | None:
    if not target.planned_waypoints:
        return None
    waypoint = target.planned_waypoints[0]
    uav, departs_at = waypoint.route.mission_uav, target.mission.departs_at
    known = departs_at is not None and waypoint.arrival_s is not None
    return {
        "uav": uav.uav_id,
        "uav_name": uav.name,
        "waypoint_sequence": waypoint.sequence,
        "at": departs_at + timedelta(seconds=waypoint.arrival_s) if known else None,
    }
