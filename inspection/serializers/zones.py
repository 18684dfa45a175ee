"""No-fly zones as GeoJSON features."""

import json
from typing import Any

from drf_spectacular.utils import extend_schema_field
from rest_framework import serializers

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.models import HeightReference
from inspection.selectors.assets import DrawnZone
from inspection.serializers.features import SourceSerializer, collection_serializer, feature_serializer, source_json
from inspection.serializers.schedule_words import schedule_sentence
from inspection.zones.schedule import DAYS, EVENTS, checked_schedule
from workspace.jobs.serializers import Declared


class ScheduleEntrySerializer(serializers.Serializer):
    """Hours of some days of the week, UTC. At each end a time, an event of the sun, or neither for the whole day."""

    day = serializers.ListField(child=serializers.ChoiceField(choices=[*DAYS, "ANY"]))
    startTime = serializers.CharField(allow_null=True, help_text="08:00:00Z")  # noqa: N815 - as ED-318 writes it
    startEvent = serializers.ChoiceField(choices=EVENTS, allow_null=True)  # noqa: N815
    endTime = serializers.CharField(allow_null=True)  # noqa: N815
    endEvent = serializers.ChoiceField(choices=EVENTS, allow_null=True)  # noqa: N815


class SchedulePeriodSerializer(serializers.Serializer):
    startDateTime = serializers.DateTimeField(allow_null=True)  # noqa: N815
    endDateTime = serializers.DateTimeField(allow_null=True)  # noqa: N815
    schedule = ScheduleEntrySerializer(many=True, help_text="empty: all the time")


@extend_schema_field(SchedulePeriodSerializer(many=True))
class ScheduleField(serializers.JSONField):
    """When a zone applies, as it is stored: see inspection/zones/schedule.py."""


class CircleSerializer(serializers.Serializer):
    centre = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="lon, lat [deg]")
    radius_m = serializers.FloatField()


@extend_schema_field(CircleSerializer(allow_null=True))
class CircleField(serializers.DictField):
    """A circle as it is stored."""


class LimitSerializer(serializers.Serializer):
    value_m = serializers.FloatField()
    reference = serializers.ChoiceField(choices=HeightReference.choices, allow_blank=True, help_text="empty when not stated")


class ZonePropertiesSerializer(serializers.Serializer):
    """Facts as the source gives them; null is "not stated"."""

    name = serializers.CharField()
    identifier = serializers.CharField()
    layer = serializers.IntegerField()
    zone_set = serializers.CharField(allow_null=True)
    restriction = serializers.CharField()
    reason = serializers.CharField()
    lower_limit = LimitSerializer(allow_null=True)
    upper_limit = LimitSerializer(allow_null=True)
    source_heights = serializers.DictField(help_text="limits, unit and references in the source's own words")
    circle = CircleField(allow_null=True, help_text="centre and radius_m, where the source gives a circle; the polygon encloses it")
    schedule = ScheduleField(allow_null=True, help_text="when it applies: periods as ED-318 writes them; null = always")
    schedule_words = serializers.CharField(help_text="the same for people")
    updated_at = serializers.DateTimeField()
    source: Declared = SourceSerializer(allow_null=True)


class ZoneDetailPropertiesSerializer(ZonePropertiesSerializer):
    revision = serializers.IntegerField(help_text="the ETag")
    is_edited = serializers.BooleanField(help_text="changed by a curator")
    properties = serializers.DictField(help_text="everything else that the source says")


ZoneFeatureSerializer = feature_serializer("ZoneFeature", ZonePropertiesSerializer)
ZoneDetailFeatureSerializer = feature_serializer("ZoneDetailFeature", ZoneDetailPropertiesSerializer)
ZoneCollectionSerializer = collection_serializer("ZoneCollection", ZoneFeatureSerializer)


def zone_feature(zone: DrawnZone) -> dict[str, Any]:
    properties = {
        "name": zone.name,
        "identifier": zone.identifier,
        "layer": zone.layer,
        "zone_set": zone.zone_set.name if zone.zone_set else None,
        "restriction": zone.restriction,
        "reason": zone.reason,
        "lower_limit": limit_json(zone.lower_limit_m, zone.lower_reference),
        "upper_limit": limit_json(zone.upper_limit_m, zone.upper_reference),
        "source_heights": zone.source_heights,
        "circle": zone.circle,
        "schedule": zone.schedule,
        "schedule_words": schedule_words(zone.schedule),
        "updated_at": zone.updated_at,
        "source": source_json(zone.zone_set.data_import if zone.zone_set else None),
    }
    return {"type": "Feature", "id": zone.pk, "geometry": json.loads(zone.geometry_json), "properties": properties}


def zone_detail_feature(zone: DrawnZone) -> dict[str, Any]:
    feature = zone_feature(zone)
    feature["properties"] |= {"properties": zone.properties, "revision": zone.revision, "is_edited": zone.is_edited}
    return feature


def limit_json(value_m: float | None, reference: str) -> dict[str, Any] | None:
    return None if value_m is None else {"value_m": value_m, "reference": reference}


def schedule_words(schedule: Any) -> str:
    """A schedule that was stored before there was one form is told as what it is."""
    try:
        return schedule_sentence(checked_schedule(schedule, "schedule"))
    except GeometryFault:
        return "As its source says"
