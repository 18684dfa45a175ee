"""Objects of live pages in the API; telemetry/live reads and composes them."""

from drf_spectacular.utils import extend_schema_field
from rest_framework import serializers

from missions.fields import ColoursField, PositionField
from missions.models import LinkKind, MissionState, OfferState, TargetState
from missions.serializers.commands import CommandSerializer
from telemetry.serializers.alerts import AlertSerializer
from workspace.api.fields import WhySerializer
from workspace.jobs.serializers import Declared


class LoadedSerializer(serializers.Serializer):
    approval = serializers.UUIDField(allow_null=True)
    flight = serializers.IntegerField(allow_null=True)
    read_at = serializers.DateTimeField(allow_null=True, help_text="when it was last read back")
    doubt = serializers.CharField(allow_blank=True, help_text="why the UAV may hold something else by now")


class LiveLinkSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=LinkKind.choices)
    last_message_at = serializers.DateTimeField(allow_null=True)
    mode = serializers.CharField(allow_blank=True)
    is_armed = serializers.BooleanField(allow_null=True)
    is_in_air = serializers.BooleanField(allow_null=True)
    autopilot = serializers.CharField(allow_blank=True)
    loaded = LoadedSerializer(allow_null=True, help_text="the approved mission found on it by reading back; null: none")
    waypoint_sequence = serializers.IntegerField(allow_null=True, help_text="of its approved route")
    clock_rate = serializers.FloatField(
        allow_null=True, help_text="its seconds a second: a simulated UAV may fly faster than real time; null: not known, as ours"
    )


class MeasuredAtSerializer(serializers.Serializer):
    """When each group of values was measured; null: never."""

    position = serializers.DateTimeField(allow_null=True)
    height = serializers.DateTimeField(allow_null=True)
    speed = serializers.DateTimeField(allow_null=True)
    attitude = serializers.DateTimeField(allow_null=True)
    battery = serializers.DateTimeField(allow_null=True)
    state = serializers.DateTimeField(allow_null=True, help_text="mode, armed, in the air")
    link = serializers.DateTimeField(allow_null=True)
    gps = serializers.DateTimeField(allow_null=True)
    wind = serializers.DateTimeField(allow_null=True)
    waypoint = serializers.DateTimeField(allow_null=True)


class MeasuredSerializer(serializers.Serializer):
    measured_at = serializers.DateTimeField(help_text="of the newest report; never one from the future")
    received_at = serializers.DateTimeField()
    position = PositionField(allow_null=True)
    altitude_relative_m = serializers.FloatField(allow_null=True, help_text="above take-off")
    altitude_amsl_m = serializers.FloatField(allow_null=True)
    altitude_agl_m = serializers.FloatField(allow_null=True)
    speed_mps = serializers.FloatField(allow_null=True, help_text="over ground")
    climb_mps = serializers.FloatField(allow_null=True)
    heading_deg = serializers.FloatField(allow_null=True)
    roll_deg = serializers.FloatField(allow_null=True, help_text="right side down")
    pitch_deg = serializers.FloatField(allow_null=True, help_text="nose up")
    battery_percent = serializers.FloatField(allow_null=True)
    mode = serializers.CharField(allow_null=True)
    is_armed = serializers.BooleanField(allow_null=True)
    is_in_air = serializers.BooleanField(allow_null=True)
    gps_fix = serializers.IntegerField(allow_null=True)
    satellites = serializers.IntegerField(allow_null=True)
    hdop = serializers.FloatField(allow_null=True)
    link_quality_percent = serializers.FloatField(allow_null=True)
    wind_speed_mps = serializers.FloatField(allow_null=True)
    wind_from_deg = serializers.FloatField(allow_null=True)
    waypoint_sequence = serializers.IntegerField(allow_null=True)
    measured_at_of = MeasuredAtSerializer(help_text="values that the newest report does not have are those of an earlier one")


class RhythmSerializer(serializers.Serializer):
    """Interval of a UAV's reports, and the ages at which the newest counts as late and as silent."""

    interval_s = serializers.FloatField(help_text="as the last few came; until then as its link usually has it")
    late_after_s = serializers.FloatField(help_text="as the alert link-lost has it, by the limits of its type and mission")
    silent_after_s = serializers.FloatField(help_text="from which age on it counts as silent")


class EstimateBoundSerializer(serializers.Serializer):
    """Semi-axes of the 95 % ellipse of the UAV's position, and bounds of height and speed."""

    along_m = serializers.FloatField()
    across_m = serializers.FloatField()
    bearing_deg = serializers.FloatField(help_text="of the half axis `along`")
    height_m = serializers.FloatField()
    speed_mps = serializers.FloatField()


class EstimateArrivalSerializer(serializers.Serializer):
    waypoint_sequence = serializers.IntegerField()
    target = serializers.IntegerField(allow_null=True, help_text="place in the mission")
    at = serializers.DateTimeField(allow_null=True)
    earliest = serializers.DateTimeField(allow_null=True)
    latest = serializers.DateTimeField(allow_null=True)


class BatteryForecastSerializer(serializers.Serializer):
    """Battery forecast of a UAV, by its drain in the same kind of flight; seconds are the UAV's own."""

    level = serializers.ChoiceField(choices=["", "warning", "critical"], help_text="of now; an alert keeps its worst")
    left_percent = serializers.FloatField()
    reserve_percent = serializers.FloatField()
    home_percent = serializers.FloatField(allow_null=True, help_text="takes the straight way home; null: cannot be told, or no headway")
    home_s = serializers.FloatField(allow_null=True)
    reserve_in_s = serializers.FloatField(help_text="until its reserve is reached, flying on as on the way home")
    hold_s = serializers.FloatField(
        allow_null=True, help_text="that it can stay where it is and still return and land with its reserve; null: not known"
    )
    lands_percent = serializers.FloatField(
        allow_null=True,
        help_text="that it has when it is down as it flies now: by its route, home or here; below 0 it does not last; null: not known",
    )


class EstimateShapeSerializer(serializers.Serializer):
    """The estimate that telemetry/services/watches.py stores."""

    at = serializers.DateTimeField()
    report_at = serializers.DateTimeField()
    position = PositionField()
    altitude_relative_m = serializers.FloatField(allow_null=True)
    altitude_amsl_m = serializers.FloatField(allow_null=True)
    speed_mps = serializers.FloatField()
    heading_deg = serializers.FloatField(allow_null=True)
    bound = EstimateBoundSerializer()
    is_measured = serializers.BooleanField()
    is_lost = serializers.BooleanField()
    waypoint_sequence = serializers.IntegerField(allow_null=True)
    along_route_m = serializers.FloatField(allow_null=True)
    to_go_m = serializers.FloatField(allow_null=True)
    arrivals = EstimateArrivalSerializer(many=True)
    ends_at = serializers.DateTimeField(allow_null=True)
    contact_expected_at = serializers.DateTimeField(
        allow_null=True, help_text="worked out once a silence: once it has passed, contact is overdue"
    )
    report_interval_s = serializers.FloatField(allow_null=True)
    battery = BatteryForecastSerializer(allow_null=True, required=False)


@extend_schema_field(EstimateShapeSerializer(allow_null=True))
class EstimateField(serializers.JSONField):
    """An estimate as stored."""


class LiveUavSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    mission = serializers.UUIDField(allow_null=True, help_text="that it flies, or has been sent")
    place = serializers.IntegerField(allow_null=True, help_text="in that mission; it gives its letter")
    colour = serializers.IntegerField(allow_null=True, help_text="its number in that mission, 1 to 8, as `colours` of the mission have it")
    link = LiveLinkSerializer()
    measured = MeasuredSerializer(allow_null=True)
    estimated = EstimateField(allow_null=True, help_text="where it is by now, and how sure that is; null: it flies no mission")
    rhythm = RhythmSerializer()
    is_simulated = serializers.BooleanField()


class MissionPlaceSerializer(serializers.Serializer):
    place = serializers.IntegerField()
    name = serializers.CharField()
    uav = serializers.IntegerField(allow_null=True)


class LiveTargetSerializer(serializers.Serializer):
    place = serializers.IntegerField(help_text="in the mission's list, from 0")
    label: Declared = serializers.CharField()
    state = serializers.ChoiceField(choices=TargetState.choices)
    state_at = serializers.DateTimeField(allow_null=True)
    state_reason = serializers.CharField(allow_blank=True)
    uav = serializers.IntegerField(allow_null=True, help_text="place of the UAV that flies to it")


class LiveTargetCountsSerializer(serializers.Serializer):
    complete = serializers.IntegerField()
    all = serializers.IntegerField()


class LiveMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    call_number = serializers.IntegerField(
        allow_null=True,
        help_text="before the letters of its UAVs on pages of several missions: 2 of 2B; missions on their way have different ones",
    )
    colours = ColoursField()
    state = serializers.ChoiceField(choices=MissionState.choices)
    revision = serializers.IntegerField()
    departs_at = serializers.DateTimeField(allow_null=True)
    started_at = serializers.DateTimeField(allow_null=True)
    ended_at = serializers.DateTimeField(allow_null=True)
    uavs = MissionPlaceSerializer(many=True)
    targets = LiveTargetSerializer(many=True)
    counts = LiveTargetCountsSerializer()


class LiveOfferSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    mission = serializers.UUIDField()
    code = serializers.CharField()
    state = serializers.ChoiceField(choices=OfferState.choices)
    revision = serializers.IntegerField(help_text="its ETag, for If-Match")
    cause = serializers.JSONField()
    difference = serializers.JSONField()
    continuation = serializers.UUIDField(allow_null=True)
    created_at = serializers.DateTimeField()
    decided_by = serializers.CharField(allow_null=True)
    decided_at = serializers.DateTimeField(allow_null=True)
    outcome = serializers.CharField(allow_blank=True)
    outcome_why = WhySerializer(many=True, help_text="the same for programs; empty where only a text is known")


class LiveSerializer(serializers.Serializer):
    uavs = LiveUavSerializer(many=True, help_text="that fly a mission or were heard within a day; the mission's, if one is asked for")
    missions = LiveMissionSerializer(many=True, help_text="on their way, or ended within the hour; the one asked for, whatever its state")
    alerts = AlertSerializer(many=True, help_text="open, and the newest 100 that were closed within the hour")
    commands = CommandSerializer(many=True, help_text="not finished, or finished within ten minutes")
    offers = LiveOfferSerializer(many=True, help_text="of another plan: undecided, or decided within ten minutes")


class LiveAnswerSerializer(serializers.Serializer):
    server_time = serializers.DateTimeField(help_text="ages are counted from it")
    live = LiveSerializer()
