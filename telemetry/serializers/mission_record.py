"""The mission report, for the OpenAPI document."""

from rest_framework import serializers

from missions.fields import ColoursField
from missions.models import WAYPOINT_KINDS, MissionState, TargetState
from telemetry.mission_report.outcomes import IncidentKind, Result
from workspace.api.external_data import AttributesField
from workspace.jobs.serializers import Declared


class RecordApprovalSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    content_sha256 = serializers.CharField(help_text="of what was approved, and flown")
    approved_at = serializers.DateTimeField()
    approved_by = serializers.CharField(allow_null=True)
    failed_rehearsal_reason = serializers.CharField(help_text="why it was approved without a passed rehearsal")
    revoked_at = serializers.DateTimeField(allow_null=True)


class RecordMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    external_id = serializers.CharField(help_text="another system's id; may be empty")
    attributes = AttributesField(required=True, help_text="of other systems")
    colours = ColoursField()
    state = serializers.ChoiceField(choices=MissionState.choices)
    departs_at = serializers.DateTimeField(allow_null=True)
    started_at = serializers.DateTimeField(allow_null=True, help_text="when its first UAV began to fly")
    ended_at = serializers.DateTimeField(allow_null=True)
    continues = serializers.UUIDField(allow_null=True, help_text="the mission whose rest this one flies")
    continued_by = serializers.UUIDField(allow_null=True, help_text="the mission that flies the rest of this one")
    approval = RecordApprovalSerializer(allow_null=True)


class RecordTargetCountsSerializer(serializers.Serializer):
    all = serializers.IntegerField()

    def get_fields(self) -> dict[str, serializers.Field]:
        return super().get_fields() | {state.value: serializers.IntegerField() for state in TargetState}


class RecordResultCountsSerializer(serializers.Serializer):
    all = serializers.IntegerField()

    def get_fields(self) -> dict[str, serializers.Field]:
        return super().get_fields() | {result.value: serializers.IntegerField() for result in Result}


class AlertCountsSerializer(serializers.Serializer):
    critical = serializers.IntegerField()
    warning = serializers.IntegerField()
    advisory = serializers.IntegerField()


class TotalsSerializer(serializers.Serializer):
    length_m = serializers.FloatField()
    duration_s = serializers.FloatField(allow_null=True, help_text="from the first take-off to the last landing, by the UAVs' clocks")
    energy_wh = serializers.FloatField(allow_null=True, help_text="null where a battery is not known")


class FlownTotalsSerializer(TotalsSerializer):
    unreported_s = serializers.FloatField(help_text="in the air without reports, of all UAVs together")
    unreported_m = serializers.FloatField(help_text="of the routes, flown then: not in length_m")


class EstimatesSerializer(serializers.Serializer):
    """Quality of the estimates between reports, compared with measurements of the same moments."""

    compared = serializers.IntegerField(help_text="estimates that a measurement tells of")
    untold = serializers.IntegerField(help_text="those that none tells of")
    share_inside = serializers.FloatField(allow_null=True, help_text="of positions within their bounds, 0 to 1; they are to hold 0.95")
    rms_m = serializers.FloatField(allow_null=True)
    largest_m = serializers.FloatField(allow_null=True)
    height_share_inside = serializers.FloatField(allow_null=True)
    height_rms_m = serializers.FloatField(allow_null=True)


class RecordSummarySerializer(serializers.Serializer):
    targets = RecordTargetCountsSerializer()
    results = RecordResultCountsSerializer()
    alerts = AlertCountsSerializer()
    planned = TotalsSerializer()
    flown = FlownTotalsSerializer()
    clock_rate = serializers.FloatField(help_text="seconds of the UAVs' clocks in one of ours: over 1 in a simulation that is faster")
    across_rms_m = serializers.FloatField(allow_null=True, help_text="off the route, sideways")
    height_rms_m = serializers.FloatField(allow_null=True, help_text="outside of the heights that the plan has there")
    lowest_battery_percent = serializers.FloatField(allow_null=True, help_text="in the air")
    estimates = EstimatesSerializer()


class FlownSerializer(serializers.Serializer):
    reports = serializers.IntegerField(help_text="in the air, with a position")
    began_at = serializers.DateTimeField(allow_null=True)
    ended_at = serializers.DateTimeField(allow_null=True)
    across_rms_m = serializers.FloatField(allow_null=True)
    across_max_m = serializers.FloatField(allow_null=True)
    height_rms_m = serializers.FloatField(allow_null=True)
    height_max_m = serializers.FloatField(allow_null=True)


class FlownLegSerializer(FlownSerializer):
    from_sequence = serializers.IntegerField(help_text="waypoint of the approved route")
    to_sequence = serializers.IntegerField()
    length_m = serializers.FloatField()


class FlownStageSerializer(FlownLegSerializer):
    """All legs from a target, or the take-off, to the next."""

    flight = serializers.IntegerField(help_text="from 1")
    target = serializers.IntegerField(allow_null=True, help_text="its place in the mission; null: the way back, or down")


class FlownGapSerializer(serializers.Serializer):
    """A time in the air without reports for over 60 s. It is not included in other values."""

    began_at = serializers.DateTimeField()
    ended_at = serializers.DateTimeField()
    length_m = serializers.FloatField(help_text="of the route between its ends")


class FlownRouteSerializer(FlownSerializer):
    flown_m = serializers.FloatField(help_text="length of the track as it was reported, without gaps")
    gaps = FlownGapSerializer(many=True)
    duration_s = serializers.FloatField(allow_null=True, help_text="from take-off to landing, by the UAV's clock")
    clock_rate = serializers.FloatField(help_text="seconds of its clock in one of ours")
    battery_start_percent = serializers.FloatField(allow_null=True, help_text="at take-off")
    battery_end_percent = serializers.FloatField(allow_null=True, help_text="at landing")
    battery_lowest_percent = serializers.FloatField(allow_null=True, help_text="in the air")
    battery_used_percent = serializers.FloatField(allow_null=True, help_text="of all batteries of the route together")
    energy_wh = serializers.FloatField(allow_null=True)


class PlannedRouteSerializer(serializers.Serializer):
    length_m = serializers.FloatField()
    duration_s = serializers.FloatField()
    energy_wh = serializers.FloatField(allow_null=True)


class RecordWaypointSerializer(serializers.Serializer):
    sequence = serializers.IntegerField()
    kind = serializers.ChoiceField(choices=WAYPOINT_KINDS)
    position = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="longitude, latitude [deg]")
    altitude_relative_m = serializers.FloatField(help_text="above the route's first take-off")
    arrival_s = serializers.FloatField(allow_null=True, help_text="after the mission's departure")
    target = serializers.IntegerField(allow_null=True, help_text="its place in the mission")


class RecordRouteSerializer(serializers.Serializer):
    place = serializers.IntegerField(help_text="of the UAV in the mission")
    uav = serializers.IntegerField(allow_null=True)
    name = serializers.CharField()
    is_simulated = serializers.BooleanField(help_text="no real aircraft")
    photos = serializers.IntegerField(help_text="taken in this mission; their poses: /missions/{id}/captures")
    departs_at = serializers.DateTimeField(allow_null=True)
    planned = PlannedRouteSerializer()
    flown = FlownRouteSerializer()
    legs = FlownLegSerializer(many=True)
    stages = FlownStageSerializer(many=True, help_text="the legs, taken together by target")
    waypoints = RecordWaypointSerializer(many=True)


class RecordReasonSerializer(serializers.Serializer):
    code = serializers.CharField()
    message = serializers.CharField(help_text="part of a sentence, in the reader's language")
    at = serializers.DateTimeField(allow_null=True)


class IncidentSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=[(kind.value, kind.value) for kind in IncidentKind])
    at = serializers.DateTimeField()
    uav = serializers.IntegerField(allow_null=True, help_text="place of the UAV in the mission; null: all of them")
    uav_name = serializers.CharField(allow_blank=True)
    position = serializers.ListField(
        child=serializers.FloatField(), min_length=2, max_length=2, allow_null=True, help_text="longitude, latitude [deg] of the UAV then"
    )
    message = serializers.CharField()


class RecordTargetSerializer(serializers.Serializer):
    place = serializers.IntegerField()
    label: Declared = serializers.CharField()
    asset = serializers.IntegerField(allow_null=True)
    external_id = serializers.CharField(help_text="another system's id; may be empty")
    attributes = AttributesField(required=True, help_text="of other systems")
    state = serializers.ChoiceField(choices=TargetState.choices)
    state_at = serializers.DateTimeField(allow_null=True)
    state_reason = serializers.CharField(allow_blank=True)
    result = serializers.ChoiceField(
        choices=[(result.value, result.value) for result in Result],
        help_text="not-confirmed: complete, and no report shows that the UAV was there; open: the mission is not over",
    )
    reason = RecordReasonSerializer(allow_null=True, help_text="why it was not inspected, or is not confirmed")
    flown_place = serializers.IntegerField(help_text="from 1, in the order in which targets were reached; those that were not after them")
    uav = serializers.IntegerField(allow_null=True, help_text="place of the UAV that was to do it")
    waypoint_sequence = serializers.IntegerField(allow_null=True)
    planned_at = serializers.DateTimeField(allow_null=True)
    reached_at = serializers.DateTimeField(allow_null=True)
    planned_after_s = serializers.FloatField(allow_null=True, help_text="after its UAV's take-off")
    reached_after_s = serializers.FloatField(allow_null=True, help_text="after its UAV's take-off, by the UAV's clock")
    closest_m = serializers.FloatField(allow_null=True, help_text="the nearest that the track of its UAV came")
    planned_hold_s = serializers.FloatField(allow_null=True)
    held_s = serializers.FloatField(allow_null=True, help_text="the longest that it can have stayed")


class RecordResultSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    place = serializers.IntegerField(help_text="of the target in the mission as it was approved")
    uav = serializers.IntegerField()
    uav_name = serializers.CharField()
    outcome = serializers.CharField()
    note = serializers.CharField(allow_blank=True)
    values = serializers.JSONField()
    measured_at = serializers.DateTimeField()
    received_at = serializers.DateTimeField()


class MissionRecordSerializer(serializers.Serializer):
    mission = RecordMissionSerializer()
    summary = RecordSummarySerializer()
    incidents = IncidentSerializer(many=True, help_text="what happened to UAVs, and what they were told, by time")
    routes = RecordRouteSerializer(many=True)
    targets = RecordTargetSerializer(many=True)
    results = RecordResultSerializer(many=True)
