"""Questions about a plan, and their answers."""

from typing import Any

from django.utils.translation import gettext as _

from missions.fields import PositionField
from missions.serializers.inputs import PlanInputSerializer
from workspace.api import strict_serializers as serializers


class WhyTargetInputSerializer(PlanInputSerializer):
    target = serializers.IntegerField(min_value=0, help_text="index of the target")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        attrs = super().validate(attrs)
        if attrs["target"] >= len(attrs["targets"]):
            raise serializers.ValidationError({"target": _("There is no such target.")})
        return attrs


class WhyRouteInputSerializer(PlanInputSerializer):
    routes = serializers.ListField(
        child=serializers.ListField(child=serializers.IntegerField(min_value=0)),
        help_text="for each UAV the indices of its targets in the order of the visits",
    )
    uav = serializers.IntegerField(min_value=0, help_text="index of the UAV")
    shortest_ways = serializers.BooleanField(default=False, help_text="the plan warns that it takes the shortest ways")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        attrs = super().validate(attrs)
        visits = [target for route in attrs["routes"] for target in route]
        if len(attrs["routes"]) != len(attrs["uavs"]) or attrs["uav"] >= len(attrs["uavs"]):
            raise serializers.ValidationError({"routes": _("One list for each UAV is needed.")})
        if len(set(visits)) != len(visits) or any(target >= len(attrs["targets"]) for target in visits):
            raise serializers.ValidationError({"routes": _("Each target can be visited once.")})
        return attrs


class ZoneNameSerializer(serializers.Serializer):
    id = serializers.IntegerField(allow_null=True, help_text="null: no zone, but what cannot be flown over")
    name = serializers.CharField()


class ReachSerializer(serializers.Serializer):
    """Whether one UAV alone could serve the target."""

    name = serializers.CharField()
    uav_id = serializers.IntegerField(allow_null=True)
    is_in_mission = serializers.BooleanField(help_text="false: another UAV of the fleet")
    is_grounded = serializers.BooleanField(help_text="it stands inside a zone, is retired or in maintenance")
    is_allowed = serializers.BooleanField(help_text="the target is tied to no other UAV, and this one has its sensor")
    most_targets = serializers.IntegerField(allow_null=True, help_text="that it may do at most")
    needed_m = serializers.FloatField(allow_null=True, help_text="the range it needs; null: there is no way")
    max_range_m = serializers.FloatField(allow_null=True)
    is_enough = serializers.BooleanField()


class TargetExplanationSerializer(serializers.Serializer):
    target = serializers.IntegerField()
    reason = serializers.ChoiceField(
        choices=[
            "asset_gone", "inside_zone", "above_height_limit", "too_far_from_network", "no_path", "beyond_range", "not_with_the_others",
            "not_allowed", "beyond_energy", "wind", "most_targets", "no_photos",
        ]
    )  # fmt: skip
    message = serializers.CharField(allow_blank=True, help_text="as a plan of this target alone tells it; empty where the figures do")
    zones = ZoneNameSerializer(many=True, help_text="that hold it, or that bar the ways to it")
    stretches = serializers.ListField(
        child=serializers.ListField(child=PositionField(), min_length=2, max_length=2),
        help_text="parts of a line that keep clear of every zone",
    )
    network_m = serializers.FloatField(allow_null=True, help_text="to the nearest place of the network")
    access_limit_m = serializers.FloatField(help_text="how far off the network is flown")
    height_m = serializers.FloatField(allow_null=True)
    needed_height_m = serializers.FloatField(allow_null=True, help_text="above ground, to inspect it")
    height_limit_m = serializers.FloatField()
    tied_to = serializers.CharField(allow_null=True, help_text="name of the only UAV that may do it")
    sensor = serializers.CharField(help_text="that its UAV must have; may be empty")
    uavs = ReachSerializer(many=True)


class ZoneDetourSerializer(ZoneNameSerializer):
    extra_m = serializers.FloatField(help_text="its part in the detour")


class HeaviestSerializer(serializers.Serializer):
    target = serializers.IntegerField()
    saves_m = serializers.FloatField(help_text="how much less the route would be without it, in the same order")


class AlternativeSerializer(serializers.Serializer):
    """The smallest change to another assignment: one target of this route on the route of another UAV."""

    target = serializers.IntegerField()
    uav = serializers.IntegerField(help_text="index of the other UAV")
    other_length_m = serializers.FloatField(help_text="what it would fly then")
    total_change_m = serializers.FloatField(help_text="of both routes together")
    max_range_m = serializers.FloatField(allow_null=True)
    is_beyond_range = serializers.BooleanField()


class RouteExplanationSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    length_m = serializers.FloatField()
    straight_m = serializers.FloatField(help_text="from target to target as the crow flies, stretches along the line")
    on_lines_m = serializers.FloatField(help_text="more, because it keeps to the network")
    round_zones_m = serializers.FloatField(allow_null=True, help_text="more, because of zones; null: too much to work out")
    zones = ZoneDetourSerializer(many=True)
    heaviest = HeaviestSerializer(allow_null=True)
    alternative = AlternativeSerializer(allow_null=True)
    used_wh = serializers.FloatField(allow_null=True, help_text="of the battery; null without one")
    usable_wh = serializers.FloatField(allow_null=True, help_text="of all flights together, the reserve taken off")
    flown_s = serializers.FloatField(help_text="from take-off to the end")
    wind_s = serializers.FloatField(help_text="how much longer than in calm air; below 0: the wind helps")
    binds = serializers.ListField(
        child=serializers.ChoiceField(choices=["battery", "range", "most_targets", "zone", "wind", "balance"]),
        help_text="what keeps the route from more targets, or from being quicker; balance: another UAV's route is the longest",
    )


class ExplainedRouteSerializer(serializers.Serializer):
    uav = serializers.IntegerField(help_text="index of the UAV")
    fault = serializers.CharField(allow_blank=True, help_text="why it cannot be explained any more; empty where it is")
    explanation = RouteExplanationSerializer(allow_null=True)


class MissionExplanationSerializer(serializers.Serializer):
    routes = ExplainedRouteSerializer(many=True, help_text="that are flown")
    targets = TargetExplanationSerializer(many=True, help_text="that no route visits")
    more_routes = serializers.IntegerField(help_text="that are flown, too: ask for them by `uav`")
    more_targets = serializers.IntegerField(help_text="that no route visits, either: ask for them by `target`")


class PlanTotalsSerializer(serializers.Serializer):
    left_out = serializers.IntegerField(help_text="targets")
    total_length_m = serializers.FloatField()
    done_s = serializers.FloatField(help_text="from the departure until the last UAV has ended its route")
    total_duration_s = serializers.FloatField(help_text="of all routes together")
    total_energy_wh = serializers.FloatField(allow_null=True)


class LaterDepartureSerializer(serializers.Serializer):
    departs_at = serializers.DateTimeField(
        allow_null=True, help_text="the first departure looked at with which fewer targets are left out, or the objective has less by 1 %"
    )
    looked_until = serializers.DateTimeField(
        allow_null=True, help_text="the last departure looked at: one after each end of a zone near; null: none ends in the next 48 hours"
    )
    before = PlanTotalsSerializer(help_text="of the plan as it is asked for")
    then = PlanTotalsSerializer(allow_null=True, help_text="of the plan with that departure")
