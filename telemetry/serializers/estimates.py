"""Estimates as the API has them."""

from typing import Any

from rest_framework import serializers

from missions.serializers.uavs import PointSerializer
from telemetry.exports.logged_record import time_text
from telemetry.models import PositionEstimate

FIGURES = (
    "altitude_amsl_m", "altitude_relative_m", "speed_mps", "heading_deg", "bound_along_m", "bound_across_m", "bound_bearing_deg",
    "bound_height_m", "bound_speed_mps",
)  # fmt: skip


class EstimatePropertiesSerializer(serializers.Serializer):
    """Bounds hold 95 of 100 times: an ellipse around the position, with semi-axes along a bearing and across it, heights and speed ±."""

    uav = serializers.IntegerField()
    estimated_for = serializers.DateTimeField(help_text="the moment that it speaks of")
    made_at = serializers.DateTimeField(help_text="by the server's clock")
    report_at = serializers.DateTimeField(allow_null=True, help_text="when the last report that it rests on was measured")
    replaced_at = serializers.DateTimeField(allow_null=True, help_text="since when there is a measurement of that second")
    waypoint_sequence = serializers.IntegerField(allow_null=True, help_text="of the approved route that it flew to, or was at")
    is_lost = serializers.BooleanField(help_text="past what the estimator vouches for")

    def get_fields(self) -> dict[str, serializers.Field]:
        known = {"altitude_amsl_m", "altitude_relative_m", "heading_deg"}
        return super().get_fields() | {name: serializers.FloatField(allow_null=name in known) for name in FIGURES}


class EstimateFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = PointSerializer()
    properties = EstimatePropertiesSerializer()


class EstimateCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = EstimateFeatureSerializer(many=True)
    every_s = serializers.FloatField(allow_null=True, help_text="how far apart the estimates of a UAV were chosen; null: all of them")
    next = serializers.CharField(allow_null=True, help_text="path and query of the next page")


def estimate_feature(estimate: PositionEstimate) -> dict[str, Any]:
    times = {name: getattr(estimate, name) for name in ("estimated_for", "made_at", "report_at", "replaced_at")}
    return {
        "type": "Feature",
        "id": estimate.pk,
        "geometry": {"type": "Point", "coordinates": [estimate.position.x, estimate.position.y]},
        "properties": {
            "uav": estimate.uav_id,
            **{name: None if at is None else time_text(at) for name, at in times.items()},
            "waypoint_sequence": estimate.waypoint_sequence,
            "is_lost": estimate.is_lost,
            **{name: getattr(estimate, name) for name in FIGURES},
        },
    }
