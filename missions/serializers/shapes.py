"""Response shapes: plans and missions."""

from rest_framework import serializers

from missions.fields import ColoursField, PositionField
from missions.models import END_ACTIONS, OBJECTIVES, WAYPOINT_KINDS, MissionState, TargetPriority, TargetState
from missions.selectors.fleet import FIGURES
from missions.serializers.changes import StaleCauseSerializer, UavChangeSerializer
from missions.serializers.commands import MissionApprovalSerializer
from missions.serializers.view_plans import TaskOutputSerializer
from planning.clearance.lost_link import LostLink, ReturnTrouble
from workspace.api.external_data import AttributesField
from workspace.api.fields import WhySerializer
from workspace.jobs.serializers import Declared


class LineSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["LineString"])
    coordinates = serializers.ListField(child=PositionField())


class WaypointSerializer(serializers.Serializer):
    position = PositionField()
    kind = serializers.ChoiceField(choices=WAYPOINT_KINDS)
    asset = serializers.IntegerField(allow_null=True)
    target = serializers.IntegerField(allow_null=True, help_text="index of the target; a stretch's further vertices carry it too")
    task = TaskOutputSerializer(allow_null=True)
    altitude_agl_m = serializers.FloatField(help_text="above ground")
    altitude_amsl_m = serializers.FloatField(allow_null=True, help_text="above sea level; null without terrain data")
    altitude_relative_m = serializers.FloatField(help_text="above the take-off point")


class ChargingSerializer(serializers.Serializer):
    waypoint = serializers.IntegerField(help_text="its place in the route; what is done there comes after")
    charging_s = serializers.FloatField()
    charged_wh = serializers.FloatField()
    stopped_s = serializers.FloatField(help_text="with the way down to the tower and up again")


class HandSpeedSerializer(serializers.Serializer):
    waypoint = serializers.IntegerField(help_text="its place in the route; the leg that leads to it")
    speed_mps = serializers.FloatField(help_text="over ground")


class StraightSerializer(serializers.Serializer):
    """Summary of a route's explanation; the full one comes from `GET /missions/{id}/explanation` and `POST /plans/why-route`."""

    straight_m = serializers.FloatField(help_text="from target to target as the crow flies, stretches along the line")
    more_m = serializers.FloatField(help_text="what is flown beyond that: along the lines, round zones and what stands tall")


class RouteSerializer(serializers.Serializer):
    """One UAV's part, in the order of the request's UAVs."""

    uav = serializers.CharField(help_text="name")
    uav_id = serializers.IntegerField(allow_null=True)
    end_action = serializers.ChoiceField(choices=END_ACTIONS)
    base = serializers.CharField(allow_null=True, help_text="the base at which it lands, where it ends at one")
    length_m = serializers.FloatField(help_text="metres flown")
    duration_s = serializers.FloatField(help_text="from its own take-off")
    departs_s = serializers.FloatField(help_text="seconds after the plan's departure at which it takes off")
    energy_wh = serializers.FloatField(allow_null=True, help_text="null without a battery")
    battery_percent = serializers.FloatField(allow_null=True, help_text="left at the end; null without a battery")
    arrival_s = serializers.ListField(
        child=serializers.FloatField(allow_null=True),
        help_text="for each waypoint the seconds after the plan's departure at which it is reached; null in plans of before",
    )
    used_wh = serializers.ListField(
        child=serializers.FloatField(), allow_null=True, help_text="for each waypoint, since take-off; null without a battery"
    )
    battery_left_percent = serializers.ListField(child=serializers.FloatField(), allow_null=True, help_text="for each waypoint")
    charging = ChargingSerializer(many=True, help_text="stops at towers on the way")
    by_hand = serializers.ListField(
        child=serializers.IntegerField(), help_text="the waypoints, by their places, that a person put in, moved or has flown otherwise"
    )
    speeds_by_hand = HandSpeedSerializer(many=True, help_text="all other legs are flown as the UAV does")
    hand_steps = serializers.IntegerField(help_text="how many changes by hand can be taken back, the last one first")
    targets = serializers.ListField(child=serializers.IntegerField(), help_text="indices in the order of the visits")
    locked = serializers.ListField(child=serializers.IntegerField(), help_text="those of them that were locked to this UAV")
    explanation = StraightSerializer(allow_null=True, help_text="null when the UAV is not used")
    geometry = LineSerializer(allow_null=True, help_text="null when the UAV is not used")
    waypoints = WaypointSerializer(many=True)


class UnassignedSerializer(serializers.Serializer):
    target = serializers.IntegerField()
    reason = serializers.ChoiceField(
        choices=[
            "no_path", "inside_zone", "beyond_range", "too_far_from_network", "above_height_limit", "asset_gone", "not_allowed",
            "beyond_energy", "wind", "most_targets", "no_photos",
        ]
    )  # fmt: skip
    message = serializers.CharField(help_text="with what is missing, where that has a number, and the minutes of flight that it is")
    why = WhySerializer(many=True, help_text="the same for programs: the reason first, then what belongs to it")
    missing_m = serializers.FloatField(allow_null=True, help_text="of range, for the UAV that comes nearest to it")
    missing_wh = serializers.FloatField(allow_null=True, help_text="of the battery, for the UAV that comes nearest to it")
    missing_s = serializers.FloatField(
        allow_null=True, help_text="these as seconds of level flight of that UAV at its speed, in calm air of 1.225 kg/m3"
    )


class WarningSerializer(serializers.Serializer):
    code = serializers.ChoiceField(
        choices=["uav_inside_zone", "uav_out_of_service", "uav_incomplete", "airspeed_not_stated", "shortest_ways", "by_hand_not_kept"]
    )
    uav = serializers.IntegerField(allow_null=True, help_text="index of the UAV; null: of the whole plan")
    message = serializers.CharField()
    why = WhySerializer(many=True, help_text="the same for programs")


class PlanLockSerializer(serializers.Serializer):
    """A locked run, as requested."""

    uav = serializers.CharField(help_text="name")
    targets = serializers.ListField(child=serializers.IntegerField(), help_text="indices in the order flown")
    at_start = serializers.BooleanField()
    at_end = serializers.BooleanField()


class WishSerializer(serializers.Serializer):
    """Cost of the locks: this plan less the plan without them."""

    cost_m = serializers.FloatField(allow_null=True, help_text="of all routes; null where the two plans do not reach as many targets")
    cost_s = serializers.FloatField(allow_null=True, help_text="of the longest route in time, level flight and tasks; null as before")
    free_total_m = serializers.FloatField(help_text="of all routes without the locks")
    free_longest_s = serializers.FloatField(help_text="of the longest route in time without the locks, level flight and tasks")
    left_out = serializers.IntegerField(help_text="how many targets fewer are reached because of the locks")


class QualitySerializer(serializers.Serializer):
    """Quality of a plan: a bound that no plan can be better than, and this plan's gap above it."""

    lower_bound_m = serializers.FloatField(allow_null=True, help_text="of the total; null where the longest route counts")
    lower_bound_s = serializers.FloatField(allow_null=True, help_text="of the longest route or of all flying time, whichever counts")
    lower_bound_wh = serializers.FloatField(allow_null=True, help_text="of the energy of all; null where it does not count")
    gap = serializers.FloatField(allow_null=True, help_text="the share of the plan's value above the bound, 0 to 1; null: not known")
    is_proven = serializers.BooleanField(help_text="no plan is better")
    gap_of = serializers.ChoiceField(
        choices=["all_plans", "without_timed_zones"],
        required=False,
        help_text="the plans of which bound and gap speak; without_timed_zones: those that keep clear only of zones in force all the time "
        "of the longest flight, along the ways preferred there; not there in plans of before",
    )
    method = serializers.CharField(help_text="how it was found; empty: not known")
    proof = serializers.UUIDField(required=False, help_text="of a stored plan: the job that looks for a better one, if one has")
    wish = WishSerializer(allow_null=True, help_text="null where nothing is locked")


class WindLayerOutputSerializer(serializers.Serializer):
    altitude_agl_m = serializers.FloatField()
    speed_mps = serializers.FloatField()
    from_deg = serializers.FloatField()


class ConditionsOutputSerializer(serializers.Serializer):
    """Wind and temperature during the flight; without wind it is calm."""

    wind = WindLayerOutputSerializer(many=True)
    temperature_c = serializers.FloatField()


class NearestSerializer(serializers.Serializer):
    """The closest approach of two UAVs."""

    metres = serializers.FloatField()
    vertical_m = serializers.FloatField(allow_null=True, help_text="null: a height is not known")
    seconds = serializers.FloatField()
    uavs = serializers.ListField(child=serializers.CharField(), min_length=2, max_length=2)
    position = PositionField()


class UnresolvedSerializer(serializers.Serializer):
    """Two flights that could not be separated. With `times_not_known` one belongs to another mission whose times are unknown."""

    code = serializers.CharField(help_text="too_near, hovers_in_the_way or times_not_known; the latter has uavs and missions alone")
    uavs = serializers.ListField(child=serializers.CharField())
    missions = serializers.ListField(child=serializers.CharField(allow_null=True), help_text="null: this one")
    metres = serializers.FloatField(required=False)
    vertical_m = serializers.FloatField(allow_null=True, required=False)
    seconds = serializers.FloatField(required=False)
    legs = serializers.ListField(child=serializers.IntegerField(), required=False)
    at_s = serializers.ListField(child=serializers.FloatField(), required=False)
    position = PositionField(required=False)


class SeparationSerializer(serializers.Serializer):
    """Separation of the routes: the smallest distance of two UAVs at the same time."""

    lateral_m = serializers.FloatField()
    vertical_m = serializers.FloatField()
    time_s = serializers.FloatField()
    delays = serializers.ListField(child=serializers.FloatField(), help_text="of each route's departure [s]")
    layers = serializers.ListField(child=serializers.FloatField(), help_text="by which each route flies higher than it would alone [m]")
    closest = NearestSerializer(allow_null=True)
    unresolved = UnresolvedSerializer(many=True, help_text="conflicts that could not be solved")


class FailedReturnSerializer(serializers.Serializer):
    """A waypoint from which a UAV with a lost link cannot return as requested."""

    route = serializers.IntegerField(help_text="index of the UAV")
    waypoint = serializers.IntegerField(help_text="its place in the route")
    return_point = serializers.IntegerField(help_text="where it would return to: 0 its start, n the n-th rally point")
    trouble = serializers.ChoiceField(choices=[(one.value, one.value) for one in ReturnTrouble])
    missing_wh = serializers.FloatField(allow_null=True)
    zone = serializers.CharField(allow_null=True, help_text="name of the zone in the way")
    zone_id = serializers.IntegerField(allow_null=True, required=False, help_text="its id; not there in checks of before")
    over_m = serializers.FloatField(allow_null=True, help_text="by how much it would fly above the limit")


class LostLinkOutputSerializer(serializers.Serializer):
    behaviour = serializers.ChoiceField(choices=[(one.value, one.value) for one in LostLink])
    rally_points = serializers.ListField(child=PositionField())
    hold_s = serializers.FloatField()


class RallyPointInZoneSerializer(serializers.Serializer):
    rally_point = serializers.IntegerField(help_text="n: the n-th")
    zone = serializers.CharField(allow_blank=True, help_text="its name; empty: it lies in the margin round one")


class LostLinkCheckSerializer(LostLinkOutputSerializer):
    failed = FailedReturnSerializer(many=True)
    rally_points_in_zones = RallyPointInZoneSerializer(
        many=True, required=False, help_text="in which nothing may land, whether a UAV would now return to them or not"
    )
    highest_m = serializers.ListField(
        child=serializers.FloatField(allow_null=True),
        required=False,
        help_text="for each route the height above its start at which the UAV returns where it returns highest; null where it does not "
        "or the ground is not known; not there in checks of before",
    )


class PlanSerializer(QualitySerializer):
    objective = serializers.ChoiceField(choices=OBJECTIVES)
    return_to_start = serializers.BooleanField()
    total_length_m = serializers.FloatField()
    longest_route_m = serializers.FloatField()
    total_duration_s = serializers.FloatField(help_text="of all routes together")
    total_energy_wh = serializers.FloatField(allow_null=True, help_text="of all UAVs with a battery; null if none has one")
    departs_at = serializers.DateTimeField(allow_null=True, help_text="null: the plan keeps clear of zones at any time")
    conditions = ConditionsOutputSerializer()
    separation = SeparationSerializer(allow_null=True, help_text="null in plans of before")
    lost_link = LostLinkCheckSerializer(allow_null=True, help_text="null in plans of before")
    graph_version = serializers.IntegerField()
    ground_revision = serializers.IntegerField()
    flat_ground_assumed = serializers.BooleanField()
    terrain = serializers.ChoiceField(choices=["flat ground assumed", "terrain model"])
    locks = PlanLockSerializer(many=True)
    warnings = WarningSerializer(many=True)
    routes = RouteSerializer(many=True)
    unassigned = UnassignedSerializer(many=True)


class LastTargetSerializer(serializers.Serializer):
    """A target as it was picked."""

    asset = serializers.IntegerField(allow_null=True)
    position = PositionField(allow_null=True)
    stretch = serializers.ListField(child=PositionField(), allow_null=True)
    label: Declared = serializers.CharField()


class LastStopSerializer(LastTargetSerializer):
    at_m = serializers.FloatField(help_text="metres flown until there")


class LastRouteSerializer(serializers.Serializer):
    uav = serializers.CharField(help_text="name")
    uav_id = serializers.IntegerField(allow_null=True)
    start = PositionField(required=False, help_text="missing, as end_action and base, in what was remembered before these were")
    end_action = serializers.ChoiceField(choices=END_ACTIONS, required=False)
    base = serializers.CharField(required=False, allow_null=True, help_text="the base at which it lands, where it ends at one")
    length_m = serializers.FloatField()
    duration_s = serializers.FloatField()
    stops = LastStopSerializer(many=True)
    off_network = serializers.ListField(
        child=serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2),
        help_text="stretches [from, to] of the route away from the network [m]",
    )


class LastPlanSerializer(serializers.Serializer):
    """The plan that the current one replaced, for comparison."""

    planned_at = serializers.DateTimeField()
    objective = serializers.ChoiceField(choices=OBJECTIVES)
    return_to_start = serializers.BooleanField()
    total_length_m = serializers.FloatField()
    duration_s = serializers.FloatField(help_text="from the departure until the last UAV has ended its route")
    locks = serializers.IntegerField(required=False, help_text="how many runs were locked")
    quality = QualitySerializer(required=False, allow_null=True)
    routes = LastRouteSerializer(many=True)
    unassigned = LastTargetSerializer(many=True)


class JobLinkSerializer(serializers.Serializer):
    job = serializers.UUIDField(help_text="its state: GET the address in Location")
    mission = serializers.UUIDField(required=False)


class MissionUavSerializer(serializers.Serializer):
    id = serializers.IntegerField(allow_null=True, help_text="of the stored UAV")
    name = serializers.CharField()
    position = PositionField()
    max_range_m = serializers.FloatField(allow_null=True)
    cruise_speed_mps = serializers.FloatField()
    end_action = serializers.ChoiceField(choices=END_ACTIONS)
    most_targets = serializers.IntegerField(allow_null=True)
    sensors = serializers.ListField(child=serializers.CharField())
    sorties = serializers.IntegerField(help_text="flights that it makes at most")
    is_simulated = serializers.BooleanField(help_text="the stored UAV is no real aircraft")
    battery_wh = serializers.FloatField(allow_null=True, help_text="null: its energy is not counted")
    mass_kg = serializers.FloatField(allow_null=True)
    reserve_percent = serializers.FloatField()
    max_airspeed_mps = serializers.FloatField(allow_null=True)
    rotor_disk_m2 = serializers.FloatField(allow_null=True)
    hover_power_w = serializers.FloatField(allow_null=True)
    own_figures = serializers.ListField(
        child=serializers.ChoiceField(choices=FIGURES), help_text="meant for this mission alone, whatever becomes of the stored UAV"
    )


class MissionTargetSerializer(serializers.Serializer):
    asset = serializers.IntegerField(allow_null=True)
    label: Declared = serializers.CharField()
    detail = serializers.CharField(help_text="the asset's second fact, as in the list of assets; may be empty")
    length_m = serializers.FloatField(allow_null=True, help_text="of the whole asset, where it is a line or a railway")
    kind = serializers.CharField(allow_null=True)
    line = serializers.IntegerField(allow_null=True, help_text="of a support: the line of the highest voltage that it carries")
    position = PositionField(allow_null=True, help_text="as picked, the middle between the ends of a stretch, else the asset's centre")
    stretch = serializers.ListField(child=PositionField(), allow_null=True)
    is_point = serializers.BooleanField(help_text="the operator picked `position`; else it is the whole asset or the stretch")
    task = TaskOutputSerializer()
    priority = serializers.ChoiceField(choices=TargetPriority.choices)
    uav = serializers.CharField(allow_null=True, help_text="name of the only UAV that may do it")
    sensor = serializers.CharField(help_text="that its UAV must have; may be empty")
    external_id = serializers.CharField(help_text="another system's id; may be empty")
    attributes = AttributesField(required=True, help_text="of other systems")
    state = serializers.ChoiceField(choices=TargetState.choices)
    unassigned_reason = serializers.CharField()
    unassigned_message = serializers.CharField()


class MissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    external_id = serializers.CharField(help_text="another system's id, such as a work order's; may be empty")
    attributes = AttributesField(required=True, help_text="of other systems")
    state = serializers.ChoiceField(choices=MissionState.choices)
    author = serializers.CharField(allow_null=True)
    objective = serializers.ChoiceField(choices=OBJECTIVES)
    return_to_start = serializers.BooleanField()
    departs_at = serializers.DateTimeField(allow_null=True, help_text="planned take-off; null: at any time")
    simulates = serializers.UUIDField(allow_null=True, help_text="the mission of which it is a copy that simulated twins fly")
    campaign = serializers.UUIDField(allow_null=True, help_text="that it was planned in")
    conditions = ConditionsOutputSerializer()
    charging_w = serializers.FloatField(allow_null=True)
    lost_link = LostLinkOutputSerializer()
    revision = serializers.IntegerField(help_text="the ETag")
    created_at = serializers.DateTimeField()
    updated_at = serializers.DateTimeField()
    planned_at = serializers.DateTimeField(allow_null=True)
    graph_version = serializers.IntegerField(allow_null=True)
    is_stale = serializers.BooleanField(help_text="the ground, a base to land at or a UAV has changed since the mission was planned")
    stale_reason = serializers.CharField(help_text="the headline and the worst cause; empty where all is as it was")
    stale_causes = StaleCauseSerializer(many=True)
    uav_changes = UavChangeSerializer(many=True, help_text="of a draft, too")
    flat_ground_assumed = serializers.BooleanField(allow_null=True)
    locks = PlanLockSerializer(many=True)
    colours = ColoursField()
    uavs = MissionUavSerializer(many=True)
    targets = MissionTargetSerializer(many=True)
    plan = PlanSerializer(allow_null=True)
    last_plan = LastPlanSerializer(allow_null=True, help_text="the plan before the present one, in short")
    planning_job = serializers.UUIDField(allow_null=True, help_text="the job that is planning it at present")
    approval = MissionApprovalSerializer(allow_null=True, help_text="that freezes it; null: it can be changed")


class MissionSummarySerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    external_id = serializers.CharField(help_text="another system's id; may be empty")
    state = serializers.ChoiceField(choices=MissionState.choices)
    author = serializers.CharField(allow_null=True)
    revision = serializers.IntegerField(help_text="the ETag")
    updated_at = serializers.DateTimeField()
    planned_at = serializers.DateTimeField(allow_null=True)
    deleted_at = serializers.DateTimeField(allow_null=True)
    target_count = serializers.IntegerField()
    unassigned_count = serializers.IntegerField(help_text="of these, how many the plan does not reach")
    uav_count = serializers.IntegerField()
    is_simulated = serializers.BooleanField(help_text="one of its UAVs is no real aircraft")
    is_demo = serializers.BooleanField(help_text="made with the demo data, and goes with them")
    total_length_m = serializers.FloatField(allow_null=True)
    longest_route_m = serializers.FloatField(allow_null=True)
    duration_s = serializers.FloatField(allow_null=True, help_text="from the departure until the last UAV has ended its route")
    is_stale = serializers.BooleanField()
    has_other_uavs = serializers.BooleanField(help_text="it is stale because a UAV is no longer as the plan has it")
    has_failed_rehearsal = serializers.BooleanField(help_text="the newest rehearsal of its present plan failed")
    sketch = serializers.ListField(child=serializers.ListField(child=PositionField()), help_text="the routes, simplified")
    places = serializers.ListField(child=PositionField(), help_text="of the targets, the first 60")
    lines = serializers.ListField(
        child=serializers.ListField(child=PositionField()), help_text="power lines and railways round them, simplified"
    )


class MissionPageSerializer(serializers.Serializer):
    results = MissionSummarySerializer(many=True)
    next = serializers.CharField(allow_null=True)
    total = serializers.IntegerField(help_text="how many missions the filters leave")
    by_state = serializers.DictField(child=serializers.IntegerField(), help_text="how many in each state, whatever state was asked for")
    deleted_count = serializers.IntegerField(help_text="how many deleted missions the other filters leave; `deleted=true` lists them")


class MissionAuthorSerializer(serializers.Serializer):
    name = serializers.CharField()
    missions = serializers.IntegerField()


class MissionFleetSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    missions = serializers.IntegerField()


class MissionFiltersSerializer(serializers.Serializer):
    authors = MissionAuthorSerializer(many=True)
    uavs = MissionFleetSerializer(many=True)


class RefusedMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    code = serializers.CharField()
    message = serializers.CharField()


class MissionsDoneSerializer(serializers.Serializer):
    done = serializers.ListField(child=serializers.UUIDField())
    refused = RefusedMissionSerializer(many=True)
