"""Changes since a mission was planned, and users who changed it."""

from drf_spectacular.utils import extend_schema_field
from rest_framework import serializers

from missions.fields import PositionField
from missions.models import UavState
from missions.selectors.fleet import FIGURES


class StaleCauseSerializer(serializers.Serializer):
    """One change since the mission was planned, and the part of the mission it affects."""

    what = serializers.ChoiceField(choices=["zone", "uav", "base", "asset", "terrain", "elsewhere"])
    message = serializers.CharField()
    uav = serializers.IntegerField(allow_null=True, help_text="index of the UAV")
    target = serializers.IntegerField(allow_null=True, help_text="index of the target")
    leg = serializers.ListField(
        child=serializers.CharField(allow_blank=True), allow_null=True, help_text="between which targets; empty for a flight's start or end"
    )
    position = PositionField(allow_null=True)
    agl_m = serializers.ListField(
        child=serializers.FloatField(), allow_null=True, help_text="where a zone is met: lowest and highest planned height above ground"
    )
    to = serializers.DateTimeField(allow_null=True)

    def get_fields(self) -> dict[str, serializers.Field]:
        return super().get_fields() | {
            "from": serializers.DateTimeField(allow_null=True, help_text="when a zone is met; null: at any time")
        }


@extend_schema_field({"oneOf": [{"type": "number"}, {"type": "array", "items": {"type": "string"}}]})
class FigureField(serializers.JSONField):
    """A UAV's value, or the names of its sensors."""


class FigureChangeSerializer(serializers.Serializer):
    name = serializers.ChoiceField(choices=FIGURES)
    kept = FigureField(allow_null=True, help_text="as the mission plans with it")
    now = FigureField(allow_null=True, help_text="as it is in the fleet")


class SaidFigureSerializer(serializers.Serializer):
    name = serializers.ChoiceField(choices=FIGURES)
    said = FigureField(allow_null=True, help_text="for this mission alone")
    then = FigureField(allow_null=True, help_text="in the fleet when that was said")
    now = FigureField(allow_null=True, help_text="in the fleet now")


class UavChangeSerializer(serializers.Serializer):
    """A UAV that differs from the mission's copy. Sent again in `uavs` without its values, the mission takes the current ones."""

    uav = serializers.IntegerField(help_text="index of the UAV")
    id = serializers.IntegerField(help_text="of the stored UAV")
    name = serializers.CharField(help_text="in the mission")
    figures = FigureChangeSerializer(many=True, help_text="without those of `own_figures`, and sensors that no target needs")
    state = serializers.ChoiceField(
        choices=UavState.choices, allow_null=True, help_text="its present one, where the plan counts on another"
    )
    said = SaidFigureSerializer(many=True, help_text="own figures of which the fleet's have changed; the plan stands all the same")
    message = serializers.CharField()


class HistoryEntrySerializer(serializers.Serializer):
    action = serializers.CharField()
    actor = serializers.CharField(allow_null=True, source="actor.username", default=None)
    recorded_at = serializers.DateTimeField()
    before = serializers.JSONField(allow_null=True)
    after = serializers.JSONField(allow_null=True)


class HistoryPageSerializer(serializers.Serializer):
    results = HistoryEntrySerializer(many=True)
    next = serializers.CharField(allow_null=True)
