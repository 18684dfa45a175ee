"""UAVs as GeoJSON features, in and out."""

from typing import Any

from rest_framework import serializers

from missions.fields import FiniteFloatField, PositionField
from missions.models import EndAction, Uav
from missions.serializers.inputs import FARTHEST_RANGE_M, FASTEST_MPS, above_zero

PROPERTIES = ("name", "base_name", "max_range_m", "cruise_speed_mps", "battery_percent", "sensor", "end_action")


class UavPropertiesSerializer(serializers.Serializer):
    name = serializers.CharField(max_length=100)
    base_name = serializers.CharField(max_length=100, allow_blank=True, required=False)
    max_range_m = FiniteFloatField(
        allow_null=True, required=False, max_value=FARTHEST_RANGE_M, help_text="metres on one battery; null: not limited"
    )
    cruise_speed_mps = FiniteFloatField(required=False, max_value=FASTEST_MPS)
    battery_percent = FiniteFloatField(allow_null=True, required=False, min_value=0, max_value=100)
    sensor = serializers.CharField(max_length=100, allow_blank=True, required=False)
    end_action = serializers.ChoiceField(choices=EndAction.choices, required=False)

    def validate_max_range_m(self, value: float | None) -> float | None:
        return above_zero(value)

    def validate_cruise_speed_mps(self, value: float) -> float | None:
        return above_zero(value)


class UavFlatSerializer(UavPropertiesSerializer):
    """A UAV as one object: its properties and `position`. A GeoJSON Feature is taken as well."""

    position = PositionField()


class PointSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Point"])
    coordinates = PositionField()


class UavFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField(read_only=True)
    geometry = PointSerializer()
    properties = UavPropertiesSerializer()


class UavCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = UavFeatureSerializer(many=True)
    next = serializers.CharField(allow_null=True)


def uav_feature(uav: Uav) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": uav.pk,
        "geometry": {"type": "Point", "coordinates": list(uav.location.coords)},
        "properties": {field: getattr(uav, field) for field in PROPERTIES},
    }


def flat_uav(data: Any) -> Any:
    """A GeoJSON Feature as one flat object; anything else as it is, for the serializer to judge."""
    if not isinstance(data, dict) or data.get("type") != "Feature":
        return data
    properties, geometry = data.get("properties"), data.get("geometry")
    flat = dict(properties) if isinstance(properties, dict) else {}
    if isinstance(geometry, dict) and geometry.get("type") == "Point":
        flat["position"] = geometry.get("coordinates")
    return flat
