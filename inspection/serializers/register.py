"""The registers of assets and zones: counts, and edits of many rows."""

from typing import Any

from django.utils.translation import gettext as _

from inspection.serializers.edits import HIGHEST_VOLTAGE_V, MAX_VOLTAGES, ZoneFactsSerializer
from workspace.api import strict_serializers as serializers
from workspace.api.whole_numbers import MAX_NUMBER

MAX_BULK = 5_000


class VoltageCountSerializer(serializers.Serializer):
    voltage_v = serializers.IntegerField()
    count = serializers.IntegerField()


class OperatorCountSerializer(serializers.Serializer):
    operator = serializers.CharField()
    count = serializers.IntegerField()


class AssetCountsSerializer(serializers.Serializer):
    """Numbers of assets. Those of a fact disregard the filter by this fact, so that another value can be chosen."""

    total = serializers.IntegerField(help_text="that match all filters")
    kinds = serializers.DictField(child=serializers.IntegerField(), help_text="by kind")
    voltages = VoltageCountSerializer(many=True, help_text="highest first; an asset of several voltages counts at each")
    operators = OperatorCountSerializer(many=True, help_text="the 200 with most assets")


class ValueCountSerializer(serializers.Serializer):
    value = serializers.CharField(help_text="as the source writes it; empty: not stated")
    count = serializers.IntegerField()


class ZoneSetCountSerializer(serializers.Serializer):
    zone_set = serializers.IntegerField(allow_null=True, help_text="null: drawn in Spanwise")
    name = serializers.CharField()
    count = serializers.IntegerField()


class ZoneCountsSerializer(serializers.Serializer):
    """Numbers of zones. Those of a fact disregard the filter by this fact, so that another value can be chosen."""

    total = serializers.IntegerField(help_text="that match all filters")
    restrictions = ValueCountSerializer(many=True)
    reasons = ValueCountSerializer(many=True, help_text="a zone of several reasons counts at each")
    zone_sets = ZoneSetCountSerializer(many=True)


class BulkValuesSerializer(serializers.Serializer):
    operator = serializers.CharField(max_length=255, allow_blank=True, required=False)
    voltages_v = serializers.ListField(
        child=serializers.IntegerField(min_value=1, max_value=HIGHEST_VOLTAGE_V), max_length=MAX_VOLTAGES, required=False,
        help_text="of supports and power lines",
    )  # fmt: skip
    circuits = serializers.IntegerField(min_value=1, max_value=100, allow_null=True, required=False, help_text="of power lines")
    height_m = serializers.FloatField(min_value=0.1, max_value=1_000, allow_null=True, required=False, help_text="of supports and bridges")
    is_flyable = serializers.BooleanField(required=False)

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if not values:
            raise serializers.ValidationError(_("Name at least one fact to change."))
        return values


class BulkEditSerializer(serializers.Serializer):
    """Either `ids`, or the filters in the address with the number of assets that they find."""

    ids = serializers.ListField(
        child=serializers.IntegerField(min_value=1, max_value=MAX_NUMBER), required=False, min_length=1, max_length=MAX_BULK
    )
    expected = serializers.IntegerField(
        required=False, min_value=1, max_value=MAX_BULK, help_text="of the filters: 409 if they find another number by now"
    )
    values = BulkValuesSerializer()

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if ("ids" in values) == ("expected" in values):
            raise serializers.ValidationError(_("Say one of ids and expected."))
        return values


class ZoneBulkValuesSerializer(ZoneFactsSerializer):
    """Facts of zones that can be the same for many. A limit that is null is not stated, which differs from 0."""

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if not values:
            raise serializers.ValidationError(_("Name at least one fact to change."))
        return super().validate(values)


class ZoneReadSerializer(serializers.Serializer):
    id = serializers.IntegerField(min_value=1, max_value=MAX_NUMBER)
    revision = serializers.IntegerField(min_value=1, max_value=MAX_NUMBER, help_text="with which it was read")


class ZoneBulkEditSerializer(serializers.Serializer):
    """Either `zones`, or the filters in the address with the number of zones that they find."""

    zones = serializers.ListField(child=ZoneReadSerializer(), required=False, min_length=1, max_length=MAX_BULK)
    expected = serializers.IntegerField(
        required=False, min_value=1, max_value=MAX_BULK, help_text="of the filters: 409 if they find another number by now"
    )
    values = ZoneBulkValuesSerializer()

    def validate(self, values: dict[str, Any]) -> dict[str, Any]:
        if ("zones" in values) == ("expected" in values):
            raise serializers.ValidationError(_("Say one of zones and expected."))
        return values


class BulkEditOutputSerializer(serializers.Serializer):
    changed = serializers.IntegerField(help_text="rows that differ now")
    entries = serializers.ListField(child=serializers.IntegerField(), help_text="of the history; with them the edit is undone")


class BulkUndoSerializer(serializers.Serializer):
    entries = serializers.ListField(child=serializers.IntegerField(min_value=1), min_length=1, max_length=MAX_BULK)


class BulkUndoOutputSerializer(serializers.Serializer):
    undone = serializers.IntegerField()
    kept = serializers.IntegerField(help_text="changed again since, or gone")
