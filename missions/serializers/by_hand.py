"""Waypoints changed by hand, and legs that are looked at while they are dragged."""

from typing import Any

from rest_framework import serializers

from missions.fields import FiniteFloatField, PositionField
from missions.services.by_hand import MOST_WAYPOINTS, HandPoint

MOST_LEGS = 200
HIGHEST_AGL_M = 10_000.0


class HandPointSerializer(serializers.Serializer):
    """A waypoint as it is wished."""

    position = PositionField()
    altitude_agl_m = FiniteFloatField(min_value=0, max_value=HIGHEST_AGL_M)
    was = serializers.IntegerField(
        allow_null=True, required=False, min_value=0, help_text="its place in the route until now; null: it is put in"
    )


class HandRouteSerializer(serializers.Serializer):
    waypoints = HandPointSerializer(many=True, allow_empty=False)

    def validate_waypoints(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        if len(value) > MOST_WAYPOINTS:
            raise serializers.ValidationError(f"At most {MOST_WAYPOINTS} waypoints.")
        return value

    def points(self) -> list[HandPoint]:
        return [HandPoint(point["position"], point["altitude_agl_m"], point.get("was")) for point in self.validated_data["waypoints"]]


class LegEndSerializer(serializers.Serializer):
    position = PositionField()
    altitude_agl_m = FiniteFloatField(min_value=0, max_value=HIGHEST_AGL_M)
    arrival_s = FiniteFloatField(required=False, allow_null=True, help_text="seconds after the departure; null: at any time of the flight")


class LegSerializer(serializers.Serializer):
    start = LegEndSerializer()
    end = LegEndSerializer()


class LegChecksInputSerializer(serializers.Serializer):
    legs = LegSerializer(many=True, allow_empty=False)
    departs_at = serializers.DateTimeField(required=False, allow_null=True, help_text="null: at any time")

    def validate_legs(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        if len(value) > MOST_LEGS:
            raise serializers.ValidationError(f"At most {MOST_LEGS} legs.")
        return value


class LegCheckSerializer(serializers.Serializer):
    is_clear = serializers.BooleanField()
    zone = serializers.IntegerField(allow_null=True, help_text="the zone that the leg meets first")
    message = serializers.CharField(help_text="what is wrong; empty where nothing is")


class LegChecksSerializer(serializers.Serializer):
    legs = LegCheckSerializer(many=True)
