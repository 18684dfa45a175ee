"""Terrain: models, the height at a position, the profile along a line."""

from typing import Any

from django.conf import settings
from django.utils.translation import gettext as _

from inspection.selectors.terrain_models import TerrainModel
from inspection.selectors.zones_along import ZoneStretch
from inspection.serializers.features import GeometrySerializer
from inspection.serializers.zones import LimitSerializer, ScheduleField, limit_json
from inspection.services.facts import geojson
from inspection.terrain.heights import REFERENCES
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared

MAX_VERTICES = 2_000
MAX_PLACES = 5_000


class LonLatField(serializers.ListField):
    """Longitude, latitude [deg]."""

    child = serializers.FloatField(min_value=-180.0, max_value=180.0)

    def __init__(self, **options: Any) -> None:
        super().__init__(min_length=2, max_length=2, **options)

    def to_internal_value(self, data: Any) -> list[float]:
        position: list[float] = super().to_internal_value(data)
        if len(position) != 2 or not (-180 <= position[0] <= 180 and -90 <= position[1] <= 90):
            raise serializers.ValidationError(_("A position is longitude, then latitude, in degrees."))
        return position


class ModelPropertiesSerializer(serializers.Serializer):
    file_name = serializers.CharField()
    vertical_datum = serializers.CharField()
    resolution_m = serializers.FloatField(help_text="distance between posts")
    posts = serializers.IntegerField(allow_null=True)
    voids = serializers.IntegerField(allow_null=True, help_text="posts without a height")
    lowest_m = serializers.FloatField(allow_null=True)
    highest_m = serializers.FloatField(allow_null=True)
    attribution = serializers.CharField()
    licence = serializers.CharField()
    source_address = serializers.CharField(help_text="empty for a file that somebody sent")
    is_synthetic = serializers.BooleanField()
    imported_at = serializers.DateTimeField()
    over = serializers.ListField(child=serializers.IntegerField(), help_text="older models that lie under parts of this one")
    other_datums = serializers.ListField(child=serializers.CharField(), help_text="of models that it meets: heights may step there")


class ModelFeatureSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField()
    geometry = GeometrySerializer()
    properties = ModelPropertiesSerializer()


class ModelCollectionSerializer(serializers.Serializer):
    """Models, newest first, in order of precedence where they overlap."""

    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = ModelFeatureSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class GroundHeightSerializer(serializers.Serializer):
    ground_amsl_m = serializers.FloatField(allow_null=True, help_text="null where no model knows the ground")
    vertical_datum = serializers.CharField(allow_null=True)
    source: Declared = serializers.CharField(allow_null=True, help_text="file name of the model that the height is from")


class ProfileInputSerializer(serializers.Serializer):
    line = serializers.ListField(child=LonLatField(), min_length=2, max_length=MAX_VERTICES)
    step_m = serializers.FloatField(
        min_value=1, max_value=100_000, required=False, help_text="no less than half a post's distance, which it is unless told"
    )
    near_m = serializers.FloatField(min_value=0, max_value=5_000, default=0, help_text="zones so near to the line are named too")


class ZoneAlongSerializer(serializers.Serializer):
    """A stretch of the line in a zone, or within the requested distance of it."""

    id = serializers.IntegerField()
    name = serializers.CharField()
    from_m = serializers.FloatField()
    to_m = serializers.FloatField()
    lower_limit = LimitSerializer(allow_null=True, help_text="null: not stated")
    upper_limit = LimitSerializer(allow_null=True, help_text="null: not stated")
    schedule = ScheduleField(allow_null=True, help_text="when it applies, as stored, in UTC; null: always")
    is_crossed = serializers.BooleanField(help_text="false: the line only passes near it there")


class ZoneMarginsSerializer(serializers.Serializer):
    """Margins that plans keep from zones."""

    time_s = serializers.FloatField(help_text="before and after their times")
    height_m = serializers.FloatField(help_text="below and above their limits")
    terrain_m = serializers.FloatField(help_text="by which a height above ground may stray between waypoints")


class ProfileSerializer(serializers.Serializer):
    length_m = serializers.FloatField()
    distance_m = serializers.ListField(child=serializers.FloatField())
    positions = serializers.ListField(child=serializers.ListField(child=serializers.FloatField()))
    ground_amsl_m = serializers.ListField(child=serializers.FloatField(allow_null=True))
    lowest_m = serializers.FloatField(allow_null=True)
    highest_m = serializers.FloatField(allow_null=True)
    unknown = serializers.IntegerField(help_text="places where no model knows the ground")
    step_m = serializers.FloatField(help_text="between neighbouring places at most")
    vertical_datums = serializers.ListField(child=serializers.CharField())
    sources = serializers.ListField(child=serializers.CharField(), help_text="file names of the models that the heights are from")
    zones = ZoneAlongSerializer(many=True)
    zone_margins = ZoneMarginsSerializer()


class HeightsInputSerializer(serializers.Serializer):
    positions = serializers.ListField(child=LonLatField(), min_length=1, max_length=MAX_PLACES)
    heights_m = serializers.ListField(child=serializers.FloatField(min_value=-1_000, max_value=100_000), max_length=MAX_PLACES)
    reference = serializers.ChoiceField(choices=REFERENCES, help_text="from where heights_m count; RELATIVE: above take-off")
    take_off = LonLatField(required=False, help_text="unless told, the first position")

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if len(values["heights_m"]) != len(values["positions"]):
            raise serializers.ValidationError({"heights_m": [_("One height for each position is needed.")]})
        return values


class HeightsSerializer(serializers.Serializer):
    """Heights in each reference; null where the terrain is unknown."""

    ground_amsl_m = serializers.ListField(child=serializers.FloatField(allow_null=True))
    altitude_agl_m = serializers.ListField(child=serializers.FloatField(allow_null=True))
    altitude_amsl_m = serializers.ListField(child=serializers.FloatField(allow_null=True))
    altitude_relative_m = serializers.ListField(child=serializers.FloatField(allow_null=True))


def model_feature(model: TerrainModel) -> dict[str, Any]:
    row, counts = model.data_import, model.data_import.counts
    return {
        "type": "Feature",
        "id": row.pk,
        "geometry": geojson(model.footprint),
        "properties": {
            "file_name": row.file_name,
            "vertical_datum": model.vertical_datum,
            "resolution_m": model.resolution_m,
            **{name: counts.get(name) for name in ("posts", "voids", "lowest_m", "highest_m")},
            "attribution": row.attribution,
            "licence": row.licence,
            "source_address": row.source_address,
            "is_synthetic": row.is_synthetic,
            "imported_at": row.imported_at,
            "over": list(model.over),
            "other_datums": list(model.step_at),
        },
    }


def zone_margins_json() -> dict[str, float]:
    rules = settings.ZONE_RULES
    return {"time_s": rules.time_margin_s, "height_m": rules.height_margin_m, "terrain_m": settings.FLIGHT_RULES.terrain_tolerance_m}


def zone_along_json(stretch: ZoneStretch) -> dict[str, Any]:
    zone = stretch.zone
    return {
        "id": zone.pk, "name": zone.name, "from_m": round(stretch.from_m, 2), "to_m": round(stretch.to_m, 2),
        "lower_limit": limit_json(zone.lower_limit_m, zone.lower_reference),
        "upper_limit": limit_json(zone.upper_limit_m, zone.upper_reference),
        "schedule": zone.schedule, "is_crossed": stretch.is_crossed,
    }  # fmt: skip
