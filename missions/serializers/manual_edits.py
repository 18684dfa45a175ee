"""Manually edited waypoints, and legs checked while they are dragged."""

from typing import Any

from django.utils.translation import gettext as _

from missions.fields import AboveZeroField, PositionField
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.serializers.limits import MAX_SPEED_MPS
from missions.serializers.shapes import WaypointSerializer
from missions.services.manual_edits.checks import ManualEditCheck
from missions.services.manual_edits.points import MAX_WAYPOINTS, EditedPoint
from planning.plan_json import column_to_json, timing_to_json, waypoints_to_json
from workspace.api import strict_serializers as serializers
from workspace.api.fields import FiniteFloatField

MAX_LEGS = 200
MAX_AGL_M = 10_000.0


class HandPointSerializer(KnownFieldsSerializer):
    """A waypoint as requested."""

    position = PositionField()
    altitude_agl_m = FiniteFloatField(min_value=0, max_value=MAX_AGL_M)
    was = serializers.IntegerField(
        allow_null=True, required=False, min_value=0, help_text="its place in the route until now; null: it is put in"
    )
    speed_mps = AboveZeroField(
        allow_null=True, required=False, max_value=MAX_SPEED_MPS, help_text="over ground on the leg that leads here; null: the UAV's own"
    )


class HandRouteSerializer(KnownFieldsSerializer):
    waypoints = HandPointSerializer(many=True, allow_empty=False)

    def validate_waypoints(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        if len(value) > MAX_WAYPOINTS:
            raise serializers.ValidationError(f"At most {MAX_WAYPOINTS} waypoints.")
        return value

    def points(self) -> list[EditedPoint]:
        return [
            EditedPoint(point["position"], point["altitude_agl_m"], point.get("was"), point.get("speed_mps"))
            for point in self.validated_data["waypoints"]
        ]


class HandPointFlownSerializer(serializers.Serializer):
    arrival_s = serializers.FloatField(help_text="seconds after the departure")
    battery_left_percent = serializers.FloatField(allow_null=True, help_text="null without a battery")
    speed_mps = serializers.FloatField(
        allow_null=True, help_text="over ground on the way here, where the wind leaves least; null where no leg leads"
    )


class HandRouteFlownSerializer(serializers.Serializer):
    """Every waypoint of the route as it would be flown, with those added over hills; as in the routes of a plan."""

    waypoints = WaypointSerializer(many=True)
    departs_s = serializers.FloatField()
    energy_wh = serializers.FloatField(allow_null=True)
    battery_percent = serializers.FloatField(allow_null=True)
    arrival_s = serializers.ListField(child=serializers.FloatField())
    used_wh = serializers.ListField(child=serializers.FloatField(), allow_null=True)
    battery_left_percent = serializers.ListField(child=serializers.FloatField(), allow_null=True)


class HandLookSerializer(serializers.Serializer):
    """Result of checking these waypoints without saving them."""

    faults = serializers.DictField(child=serializers.CharField(), help_text="by place, `waypoints.3.altitude_agl_m` or `legs.2`")
    length_m = serializers.FloatField(allow_null=True, help_text="null, as all that follows, where the route cannot be flown at all")
    duration_s = serializers.FloatField(allow_null=True)
    energy_wh = serializers.FloatField(allow_null=True, help_text="null without a battery")
    battery_percent = serializers.FloatField(allow_null=True, help_text="left at the end")
    waypoints = HandPointFlownSerializer(many=True, help_text="one for each that is wished")
    flown = HandRouteFlownSerializer(allow_null=True)


def manual_edit_check_json(check: ManualEditCheck) -> dict[str, Any]:
    flown, clock = check.flown, None if check.flown is None else check.flown.timing
    return {
        "faults": check.faults,
        "length_m": None if flown is None else round(flown.length_m, 3),
        "duration_s": None if flown is None else round(flown.duration_s, 1),
        "energy_wh": None if clock is None or clock.total_wh is None else round(clock.total_wh, 2),
        "battery_percent": None if clock is None or clock.end_percent is None else round(clock.end_percent, 1),
        "waypoints": [
            {
                "arrival_s": round(point.arrival_s, 1),
                "battery_left_percent": None if point.battery_left_percent is None else round(point.battery_left_percent, 1),
                "speed_mps": None if point.speed_mps is None else round(point.speed_mps, 2),
            }
            for point in check.points
        ],
        "flown": None
        if flown is None or flown.waypoints is None
        else {"waypoints": waypoints_to_json(flown.waypoints), **timing_to_json(flown, column_to_json)},
    }


class LegEndSerializer(KnownFieldsSerializer):
    position = PositionField()
    altitude_agl_m = FiniteFloatField(min_value=0, max_value=MAX_AGL_M)
    arrival_s = FiniteFloatField(required=False, allow_null=True, help_text="seconds after the departure; null: at any time of the flight")


class LegSerializer(KnownFieldsSerializer):
    start = LegEndSerializer()
    end = LegEndSerializer()
    speed_mps = AboveZeroField(
        allow_null=True, required=False, max_value=MAX_SPEED_MPS, help_text="over ground; null: the UAV's own. Only with mission and uav"
    )


class LegChecksInputSerializer(KnownFieldsSerializer):
    legs = LegSerializer(many=True, allow_empty=False)
    departs_at = serializers.DateTimeField(required=False, allow_null=True, help_text="null: at any time")
    mission = serializers.UUIDField(required=False, allow_null=True, help_text="whose wind and UAV bound the speeds")
    uav = serializers.IntegerField(required=False, allow_null=True, min_value=0, help_text="its place in that mission")

    def validate_legs(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        if len(value) > MAX_LEGS:
            raise serializers.ValidationError(f"At most {MAX_LEGS} legs.")
        return value

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        missing = [name for name in ("mission", "uav") if attrs.get(name) is None]
        if missing and any(leg.get("speed_mps") is not None for leg in attrs["legs"]):
            raise serializers.ValidationError(dict.fromkeys(missing, _("A speed is checked for a UAV of a mission.")))
        return attrs


class LegCheckSerializer(serializers.Serializer):
    is_clear = serializers.BooleanField()
    zone = serializers.IntegerField(allow_null=True, help_text="the zone that the leg meets first")
    message = serializers.CharField(help_text="what is wrong; empty where nothing is")


class LegChecksSerializer(serializers.Serializer):
    legs = LegCheckSerializer(many=True)
