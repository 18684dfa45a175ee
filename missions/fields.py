"""Fields of the planning API: positions, numbers above 0, colours of UAVs."""

from typing import Any

from django.utils.translation import gettext_lazy as _
from drf_spectacular.utils import extend_schema_field
from rest_framework import serializers

from inspection.geodesy import LonLat
from workspace.api.fields import FiniteFloatField, is_number


@extend_schema_field(
    {
        "type": "array",
        "items": {"type": "number", "minimum": -180, "maximum": 180},
        "minItems": 2,
        "maxItems": 2,
        "description": "lon, lat [deg], WGS84",
        "example": [9.52, 47.14],
    }
)
class PositionField(serializers.Field):
    """[lon, lat] in degrees."""

    default_error_messages = {
        "shape": "A position is two numbers: [longitude, latitude].",
        "range": "Longitude goes from -180 to 180 and latitude from -90 to 90; longitude comes first.",
    }

    def to_internal_value(self, data: Any) -> LonLat:
        if not isinstance(data, list) or len(data) != 2 or not all(is_number(part) for part in data):
            self.fail("shape")
        lon, lat = float(data[0]), float(data[1])
        if not (-180 <= lon <= 180 and -90 <= lat <= 90):
            self.fail("range")
        return LonLat(lon, lat)

    def to_representation(self, value: Any) -> list[float]:
        return [float(value[0]), float(value[1])]


class BetweenField(FiniteFloatField):
    """A JSON number from the first to the second bound."""

    def __init__(self, bounds: tuple[float, float], **options: Any) -> None:
        super().__init__(min_value=bounds[0], max_value=bounds[1], **options)


class AboveZeroField(FiniteFloatField):
    """A JSON number greater than 0."""

    above = 0

    default_error_messages = {"above_zero": _("This must be above 0.")}

    def to_internal_value(self, data: Any) -> float:
        value = super().to_internal_value(data)
        if value <= 0:
            self.fail("above_zero")
        return value


class ColoursField(serializers.ListField):
    """Colours of a mission's UAVs on live pages."""

    def __init__(self) -> None:
        super().__init__(
            child=serializers.IntegerField(min_value=1, max_value=8),
            help_text="by the UAV's place, the ninth as the first: numbers of the eight colours that pages draw UAVs with; two UAVs that"
            " live pages show have the same one only where there are more than eight; empty: never sent to UAVs, and by their places",
        )
