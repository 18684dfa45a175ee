"""Rehearsals in API requests and in the OpenAPI document."""

from missions.serializers.shapes import WindLayerOutputSerializer
from simulation.models import AssessmentLevel
from simulation.rehearsing.weather_scenario import Named
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared, JobErrorField
from workspace.models import JobState

MAX_CONDITIONS = 8
LEVELS = AssessmentLevel.choices


class RehearsalInputSerializer(serializers.Serializer):
    conditions = serializers.ListField(
        child=serializers.JSONField(),
        min_length=1,
        max_length=MAX_CONDITIONS,
        required=False,
        help_text=(
            "each flown by itself: calm, as-planned, strong-wind, weak-battery, or an object with own figures: name, wind and "
            "temperature_c as in a mission's conditions, gusts_mps, turbulence_mps_at_20ft, battery_percent; what is left out is as planned"
        ),
    )
    seed = serializers.IntegerField(min_value=0, max_value=1_000_000, default=7, help_text="of gusts: the same seed, the same flight")
    afresh = serializers.BooleanField(default=False, help_text="fly also what was flown alike within a day")


class RehearsalConditionsSerializer(serializers.Serializer):
    code = serializers.ChoiceField(choices=[(str(code), str(code)) for code in Named])
    name = serializers.CharField(allow_blank=True)
    wind = WindLayerOutputSerializer(many=True, help_text="layers, as in a mission's conditions")
    temperature_c = serializers.FloatField()
    gusts_mps = serializers.FloatField(help_text="standard deviation, across each axis")
    turbulence_mps_at_20ft = serializers.FloatField(help_text="wind at 20 feet that Dryden turbulence is made by; 0: none")
    battery_percent = serializers.FloatField(help_text="of its rated energy that a battery holds at take-off")


class FindingSerializer(serializers.Serializer):
    level = serializers.ChoiceField(choices=LEVELS)
    code = serializers.CharField(help_text="for programs: stays the same")
    uav = serializers.IntegerField(help_text="place in the mission")
    target = serializers.IntegerField(allow_null=True, help_text="place in the mission, from 0")
    reason = serializers.CharField()
    message = serializers.CharField(help_text="the reason after what it is about")
    waypoint = serializers.IntegerField(allow_null=True, help_text="near which it is, by its place in the route; null: none")
    short_percent = serializers.FloatField(allow_null=True, help_text="of the battery that are missing at the end of a flight")


class FlightEnergySerializer(serializers.Serializer):
    flight = serializers.IntegerField()
    used_wh = serializers.FloatField()
    left_percent = serializers.FloatField(help_text="at its end")
    lowest_percent = serializers.FloatField()


class ErrorOfLineSerializer(serializers.Serializer):
    rms_m = serializers.FloatField(allow_null=True)
    max_m = serializers.FloatField(allow_null=True)


class ZoneApproachSerializer(serializers.Serializer):
    zone = serializers.IntegerField()
    name = serializers.CharField()
    beside_m = serializers.FloatField(help_text="across the ground; 0 over, under or in it")
    height_m = serializers.FloatField(help_text="below or above its limits; 0 within them")
    at_s = serializers.FloatField(help_text="after the mission's departure")
    waypoint = serializers.IntegerField(allow_null=True, help_text="that was flown to")


class ApproachSerializer(serializers.Serializer):
    away_m = serializers.FloatField()
    at_s = serializers.FloatField(help_text="after the mission's departure")
    waypoint = serializers.IntegerField(allow_null=True, help_text="that was flown to")
    position = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="longitude, latitude [deg]")
    is_column = serializers.BooleanField(help_text="over where the UAV takes off or lands")


class RehearsedTargetSerializer(serializers.Serializer):
    target = serializers.IntegerField(help_text="place in the mission, from 0")
    label: Declared = serializers.CharField()
    level = serializers.ChoiceField(choices=LEVELS)
    is_reached = serializers.BooleanField()
    closest_m = serializers.FloatField(allow_null=True, help_text="to its waypoint, the worst of several")
    at_s = serializers.FloatField(allow_null=True, help_text="after the mission's departure")
    late_s = serializers.FloatField(allow_null=True, help_text="after the planned time")
    held_s = serializers.FloatField()
    planned_hold_s = serializers.FloatField()
    battery_percent = serializers.FloatField(allow_null=True, help_text="when it was reached")
    reasons = serializers.ListField(child=serializers.CharField())


class RehearsedRouteSerializer(serializers.Serializer):
    uav = serializers.IntegerField(help_text="place in the mission")
    name = serializers.CharField()
    level = serializers.ChoiceField(choices=LEVELS)
    endings = serializers.ListField(child=serializers.CharField(allow_null=True), help_text="of its flights; null: not begun")
    across = ErrorOfLineSerializer(help_text="off the line between waypoints")
    height = ErrorOfLineSerializer(help_text="off the height between waypoints")
    energy = FlightEnergySerializer(many=True, help_text="of each flight")
    used_wh = serializers.FloatField()
    planned_wh = serializers.FloatField(allow_null=True)
    reserve_percent = serializers.FloatField(help_text="that its plan leaves: the limit")
    flown_s = serializers.FloatField()
    planned_s = serializers.FloatField(allow_null=True)
    zones = ZoneApproachSerializer(many=True, help_text="the nearest zones while they are in force")
    lowest = ApproachSerializer(allow_null=True, help_text="above the ground")
    obstacle = ApproachSerializer(allow_null=True, help_text="to a tower or wire within 60 m")
    widest_waypoint_m = serializers.FloatField(allow_null=True, help_text="the farthest at which a waypoint was passed")
    targets = RehearsedTargetSerializer(many=True)
    reasons = serializers.ListField(child=serializers.CharField())


class ClosestApproachSerializer(serializers.Serializer):
    uavs = serializers.ListField(child=serializers.IntegerField(), min_length=2, max_length=2, help_text="places in the mission")
    beside_m = serializers.FloatField()
    height_m = serializers.FloatField()
    at_s = serializers.FloatField(help_text="after the mission's departure")


class AssessmentSerializer(serializers.Serializer):
    level = serializers.ChoiceField(choices=LEVELS)
    findings = FindingSerializer(many=True)
    routes = RehearsedRouteSerializer(many=True)
    meetings = ClosestApproachSerializer(many=True, help_text="the nearest that two UAVs came to each other in the air")


class RehearsalRunSerializer(serializers.Serializer):
    sequence = serializers.IntegerField()
    conditions = RehearsalConditionsSerializer()
    words = serializers.CharField(help_text="what the conditions are called")
    level = serializers.ChoiceField(choices=LEVELS, allow_blank=True, help_text="empty until it has been flown")
    took_s = serializers.FloatField(allow_null=True, help_text="of the worker's time")
    finished_at = serializers.DateTimeField(allow_null=True, help_text="when it was flown")
    is_reused = serializers.BooleanField(help_text="it was flown for an earlier rehearsal of the same plan in the same air")


class RehearsalRunWithAssessmentSerializer(RehearsalRunSerializer):
    assessment = AssessmentSerializer(allow_null=True)


class RehearsalUavSerializer(serializers.Serializer):
    uav = serializers.IntegerField(help_text="place in the mission")
    name = serializers.CharField()
    airframe = serializers.CharField()
    airframe_name = serializers.CharField()
    why = serializers.ChoiceField(choices=["chosen", "nearest"])
    battery_wh = serializers.FloatField()
    has_own_battery = serializers.BooleanField(help_text="whether the UAV's own battery is flown with, not the airframe's")
    words = serializers.CharField()


class RehearsalLimitSerializer(serializers.Serializer):
    name = serializers.CharField()
    value = serializers.FloatField()
    source: Declared = serializers.CharField()
    words = serializers.CharField()


class RehearsalSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    mission = serializers.UUIDField()
    job = serializers.UUIDField(help_text="GET /jobs/{id}, or /ws/jobs/{id}")
    state = serializers.ChoiceField(choices=JobState.choices)
    progress = serializers.FloatField()
    message = serializers.CharField()
    error = JobErrorField(allow_null=True)
    is_simulated = serializers.BooleanField(help_text="always true: nothing of this was flown by an aircraft")
    level = serializers.ChoiceField(choices=LEVELS, allow_blank=True, help_text="the worst of its runs; empty until they are done")
    is_outdated = serializers.BooleanField(help_text="the plan, its UAVs or their airframes have changed since")
    content_sha256 = serializers.CharField(help_text="of what was flown")
    mission_revision = serializers.IntegerField()
    ground_revision = serializers.IntegerField()
    ground_changed = serializers.BooleanField(help_text="zones, assets or terrain have changed somewhere since")
    seed = serializers.IntegerField()
    uavs = RehearsalUavSerializer(many=True)
    created_at = serializers.DateTimeField()
    created_by = serializers.CharField(allow_null=True)
    runs = RehearsalRunSerializer(many=True)


class RehearsalDetailSerializer(RehearsalSerializer):
    runs = RehearsalRunWithAssessmentSerializer(many=True)
    limits = RehearsalLimitSerializer(many=True)


class RehearsalPageSerializer(serializers.Serializer):
    results = RehearsalSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class FlownPhotoSerializer(serializers.Serializer):
    """A photo with the true pose of its lens."""

    t_s = serializers.FloatField(help_text="after the mission's departure")
    position = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="longitude, latitude [deg]")
    altitude_amsl_m = serializers.FloatField()
    altitude_relative_m = serializers.FloatField(help_text="above where this flight took off")
    yaw_deg = serializers.FloatField(help_text="from true north, clockwise")
    pitch_deg = serializers.FloatField(help_text="from the horizon; -90 is straight down")
    roll_deg = serializers.FloatField(help_text="right side down")
    waypoint = serializers.IntegerField(allow_null=True, help_text="that it belongs to")
    item = serializers.IntegerField(allow_null=True, help_text="that asked for it, in the flight's list from 0")
    sequence = serializers.IntegerField(allow_null=True, help_text="of the request, as the item numbers it")


class TrackFlightSerializer(serializers.Serializer):
    ending = serializers.CharField()
    t_s = serializers.ListField(child=serializers.FloatField(), help_text="after the mission's departure")
    position = serializers.ListField(child=serializers.ListField(child=serializers.FloatField()), help_text="longitude, latitude [deg]")
    altitude_amsl_m = serializers.ListField(child=serializers.FloatField())
    altitude_relative_m = serializers.ListField(child=serializers.FloatField(), help_text="above where this flight took off")
    battery_percent = serializers.ListField(child=serializers.FloatField())
    used_wh = serializers.ListField(child=serializers.FloatField())
    roll_deg = serializers.ListField(child=serializers.FloatField(), required=False, help_text="right side down; not in tracks of before")
    pitch_deg = serializers.ListField(child=serializers.FloatField(), required=False, help_text="nose up; not in tracks of before")
    heading_deg = serializers.ListField(child=serializers.FloatField(), required=False, help_text="from north; not in tracks of before")
    waypoint = serializers.ListField(child=serializers.IntegerField(allow_null=True), help_text="that was flown to")
    photos = FlownPhotoSerializer(many=True, required=False, help_text="at most 5,000; not in tracks of before")


class PlannedPointSerializer(serializers.Serializer):
    waypoint = serializers.IntegerField()
    position = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2)
    altitude_amsl_m = serializers.FloatField(allow_null=True)
    altitude_relative_m = serializers.FloatField(help_text="above the route's first take-off")
    at_s = serializers.FloatField(allow_null=True)
    target = serializers.IntegerField(allow_null=True)
    battery_percent = serializers.FloatField(allow_null=True)


class RouteTrackSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    name = serializers.CharField()
    flights = TrackFlightSerializer(many=True)
    planned = PlannedPointSerializer(many=True, help_text="the mission's present plan; empty where it is another one by now")


class RehearsalTrackSerializer(serializers.Serializer):
    run = serializers.IntegerField()
    is_simulated = serializers.BooleanField()
    routes = RouteTrackSerializer(many=True)


class AirframeSerializer(serializers.Serializer):
    code = serializers.CharField()
    name = serializers.CharField()
    mass_kg = serializers.FloatField()
    battery_wh = serializers.FloatField()
    max_airspeed_mps = serializers.FloatField()
    hover_min = serializers.FloatField(help_text="minutes of hover on its own battery")


class AirframeListSerializer(serializers.Serializer):
    results = AirframeSerializer(many=True)


class TypeAirframeSerializer(serializers.Serializer):
    airframe = serializers.CharField(allow_null=True, help_text="code of what was chosen; null: the nearest by speed, mass and endurance")
    flown = serializers.CharField(read_only=True, help_text="code of what flies")


class RehearsalRuleSerializer(serializers.Serializer):
    requires_green = serializers.BooleanField(help_text="missions are approved only after a rehearsal of the very plan that did not fail")
