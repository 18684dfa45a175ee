"""Curators' requests: assets, zones, and geometry to be checked."""

from typing import Any

from django.utils.translation import gettext as _

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.models import AssetKind, HeightReference
from inspection.services.imports.geometry import asset_shape, bridge_stored, stored, zone_shape
from inspection.zones.schedule import checked_schedule
from workspace.api import strict_serializers as serializers
from workspace.api.errors import ApiProblem
from workspace.api.external_data import AttributesField, ExternalIdField

HIGHEST_VOLTAGE_V = 2_000_000  # the highest line in service has 1,150 kV
MAX_VOLTAGES = 12
MAX_TAGS = 250
MAX_LIMIT_M = 100_000


def geometry_problem(fault: GeometryFault) -> ApiProblem:
    position = list(fault.position) if fault.position else None
    return ApiProblem(400, "invalid_geometry", str(fault), details={"place": fault.place, "message": fault.message, "position": position})


def _stated(value: Any, place: str) -> Any:
    if isinstance(value, str) and ("\0" in value or any("\ud800" <= character <= "\udfff" for character in value)):
        raise serializers.ValidationError({place: [_("The text has characters that are none.")]})
    return value


class AssetInputSerializer(serializers.Serializer):
    """An asset that a user draws or corrects. Lengths in metres, voltages in volts."""

    kind = serializers.ChoiceField(choices=AssetKind.choices)
    geometry = serializers.JSONField(help_text="GeoJSON: a Point for a tower, a LineString for a line or railway, a Polygon for a bridge")
    name = serializers.CharField(max_length=255, allow_blank=True, required=False)
    ref = serializers.CharField(max_length=255, allow_blank=True, required=False)
    operator = serializers.CharField(max_length=255, allow_blank=True, required=False)
    subtype = serializers.CharField(max_length=40, allow_blank=True, required=False)
    voltages_v = serializers.ListField(
        child=serializers.IntegerField(min_value=1, max_value=HIGHEST_VOLTAGE_V), max_length=MAX_VOLTAGES, required=False
    )
    circuits = serializers.IntegerField(min_value=1, max_value=100, allow_null=True, required=False)
    height_m = serializers.FloatField(min_value=0.1, max_value=1_000, allow_null=True, required=False)
    is_flyable = serializers.BooleanField(required=False)
    tags = serializers.DictField(child=serializers.CharField(max_length=2_000, allow_blank=True), required=False)
    external_id = ExternalIdField(help_text="your organisation's id of it, of one asset each; empty: none")
    attributes = AttributesField(help_text="your organisation's own; a change replaces all of them")

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        if self.instance is not None:
            self.fields["kind"].read_only = True

    def validate_tags(self, tags: dict[str, str]) -> dict[str, str]:
        if len(tags) > MAX_TAGS or any(len(key) > 255 for key in tags):
            raise serializers.ValidationError(
                _("At most %(most_tags)s tags, with keys of at most 255 characters.") % {"most_tags": MAX_TAGS}
            )
        for key, value in tags.items():
            _stated(key, "tags")
            _stated(value, f"tags.{key}")
        return tags

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        kind = AssetKind(values["kind"] if self.instance is None else values.get("kind") or self.instance.kind)
        if "geometry" in values:
            try:
                shape = asset_shape(kind, values["geometry"])
            except GeometryFault as fault:
                raise geometry_problem(fault) from fault
            values["geometry"] = bridge_stored(shape) if kind == AssetKind.BRIDGE else stored(shape)
        return values


class LimitInputSerializer(serializers.Serializer):
    """A height with its reference."""

    value_m = serializers.FloatField(min_value=-1_000, max_value=MAX_LIMIT_M)
    reference = serializers.ChoiceField(choices=HeightReference.choices)


class ZoneFactsSerializer(serializers.Serializer):
    restriction = serializers.CharField(max_length=100, allow_blank=True, required=False)
    reason = serializers.CharField(max_length=255, allow_blank=True, required=False)
    lower_limit = LimitInputSerializer(required=False, allow_null=True)
    upper_limit = LimitInputSerializer(required=False, allow_null=True)
    schedule = serializers.JSONField(required=False, allow_null=True, help_text="periods as ED-318's limitedApplicability; null = always")

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if "schedule" in values:
            try:
                values["schedule"] = checked_schedule(values["schedule"], "schedule")
            except GeometryFault as fault:
                raise geometry_problem(fault) from fault
        for side in ("lower", "upper"):
            if f"{side}_limit" in values:
                limit = values.pop(f"{side}_limit")
                values[f"{side}_limit_m"] = limit and limit["value_m"]
                values[f"{side}_reference"] = limit["reference"] if limit else ""
        self._check_upright(values)
        return values

    def _check_upright(self, values: dict[str, Any]) -> None:
        def of(name: str) -> Any:
            return values[name] if name in values else getattr(self.instance, name, None)

        lower, upper = of("lower_limit_m"), of("upper_limit_m")
        if lower is not None and upper is not None and of("lower_reference") == of("upper_reference") and upper < lower:
            raise serializers.ValidationError({"upper_limit": [_("The upper limit lies below the lower one.")]})


class ZoneInputSerializer(ZoneFactsSerializer):
    """A zone that a user draws or corrects. A limit that is null is not stated, which differs from 0."""

    name = serializers.CharField(max_length=255)
    geometry = serializers.JSONField(required=False, allow_null=True, help_text="GeoJSON Polygon or MultiPolygon")
    circle = serializers.JSONField(required=False, allow_null=True, help_text="instead of geometry: centre [lon, lat] and radius_m")

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        try:
            if values.get("circle") is not None or values.get("geometry") is not None:
                shape, values["circle"] = zone_shape(values.get("geometry"), values.get("circle"))
                values["geometry"] = stored(shape)
            elif self.instance is None:
                raise serializers.ValidationError({"geometry": [_("A zone needs an area or a circle.")]})
            else:
                values.pop("circle", None)
                values.pop("geometry", None)
        except GeometryFault as fault:
            raise geometry_problem(fault) from fault
        return super().validate(values)


class GeometryCheckSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=[*AssetKind.values, "zone"])
    geometry = serializers.JSONField(required=False)
    circle = serializers.JSONField(required=False, allow_null=True)


class FaultSerializer(serializers.Serializer):
    place = serializers.CharField()
    message = serializers.CharField()
    position = serializers.ListField(child=serializers.FloatField(), allow_null=True, help_text="lon, lat")


class GeometryCheckResultSerializer(serializers.Serializer):
    valid = serializers.BooleanField()
    fault = FaultSerializer(allow_null=True)
    geometry = serializers.JSONField(allow_null=True, help_text="as it would be stored: cut at the antimeridian, a circle as its polygon")
    length_m = serializers.FloatField(allow_null=True)
    area_m2 = serializers.FloatField(allow_null=True)
