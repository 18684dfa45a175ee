"""No-fly zones as GeoJSON features."""

import json
from datetime import datetime
from typing import Any

import shapely
from django.utils import timezone
from django.utils.formats import date_format
from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema_field
from rest_framework import serializers

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.models import HeightReference
from inspection.selectors.assets import DrawnZone
from inspection.selectors.register.zones import activity_of
from inspection.serializers.features import SourceSerializer, collection_serializer, feature_serializer, source_json
from inspection.zones.schedule import DAYS, EVENTS, Schedule, checked_schedule
from workspace.jobs.serializers import Declared


def schedule_sentence(schedule: Schedule | None) -> str:
    """Return a text such as "Mon to Fri 08:00 to 18:00 UTC, until 31 Dec 2026"."""
    if schedule is None:
        return _("Always")
    return "; ".join(_period_words(period) for period in schedule)


def _period_words(period: dict[str, Any]) -> str:
    times = ", ".join(_entry_words(entry) for entry in period["schedule"])
    if not times:
        return _dates_words(period["startDateTime"], period["endDateTime"])
    values = {"times": times, "start": _date_words(period["startDateTime"]), "end": _date_words(period["endDateTime"])}
    if values["start"] and values["end"]:
        return _("%(times)s, from %(start)s to %(end)s") % values
    if values["start"]:
        return _("%(times)s, from %(start)s") % values
    return _("%(times)s, until %(end)s") % values if values["end"] else times


def _dates_words(start: str | None, end: str | None) -> str:
    """Return "21 Nov 2026, 14:00 to 17:00 UTC" for a few hours of one day."""
    values = {"start": _date_words(start), "end": _date_words(end)}
    if start and end:
        if start[:10] == end[:10]:
            return _("%(day)s, %(start)s to %(end)s UTC") % {"day": _day_words(start), "start": start[11:16], "end": end[11:16]}
        return _("from %(start)s to %(end)s") % values
    if start:
        return _("from %(start)s on") % values
    return _("until %(end)s") % values if end else _("all the time")


def _entry_words(entry: dict[str, Any]) -> str:
    values = {"days": _days_words(entry["day"]), "start": _side_words(entry, "start"), "end": _side_words(entry, "end")}
    if not values["start"] and not values["end"]:
        return _("%(days)s all day") % values
    values["start"] = values["start"] or _("the day begins")
    values["end"] = values["end"] or _("the day ends")
    words = _("%(days)s %(start)s to %(end)s") % values
    return f"{words} UTC" if entry["startTime"] or entry["endTime"] else words


def _side_words(entry: dict[str, Any], side: str) -> str:
    if event := entry[f"{side}Event"]:
        return _events()[event]
    return (entry[f"{side}Time"] or "")[:5]


def _events() -> dict[str, str]:
    return {
        "BMCT": _("morning civil twilight"),
        "SR": _("sunrise"),
        "SS": _("sunset"),
        "EECT": _("the end of evening civil twilight"),
    }


def _days_words(days: list[str]) -> str:
    if days == ["ANY"]:
        return _("daily")
    short = dict(zip(DAYS, (_("Mon"), _("Tue"), _("Wed"), _("Thu"), _("Fri"), _("Sat"), _("Sun")), strict=True))
    numbers = [DAYS.index(day) for day in days]
    if len(numbers) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return _("%(first)s to %(last)s") % {"first": short[days[0]], "last": short[days[-1]]}
    return ", ".join(short[day] for day in days)


def _date_words(moment: str | None) -> str:
    if moment is None:
        return ""
    clock = "" if moment[11:16] in {"00:00", "23:59"} else f" {moment[11:16]} UTC"
    return f"{_day_words(moment)}{clock}"


def _day_words(moment: str) -> str:
    return date_format(datetime.fromisoformat(moment.replace("Z", "+00:00")), "j M Y")


class ScheduleEntrySerializer(serializers.Serializer):
    """Hours on some days of the week, UTC. Each end is a time, an event of the sun, or neither for the whole day."""

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
    """Times when a zone applies, as stored: see inspection/zones/schedule.py."""


class CircleSerializer(serializers.Serializer):
    centre = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="lon, lat [deg]")
    radius_m = serializers.FloatField()


@extend_schema_field(CircleSerializer(allow_null=True))
class CircleField(serializers.DictField):
    """A circle as stored."""


class LimitSerializer(serializers.Serializer):
    value_m = serializers.FloatField()
    reference = serializers.ChoiceField(choices=HeightReference.choices, allow_blank=True, help_text="empty when not stated")


class ZonePropertiesSerializer(serializers.Serializer):
    """Facts as the source states them; null means "not stated"."""

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
    is_active = serializers.BooleanField(help_text="it applies now, in UTC and without the margins of planning")
    changes_at = serializers.DateTimeField(allow_null=True, help_text="when it ends or begins to apply; null: not in the next 8 days")
    revision = serializers.IntegerField(help_text="the ETag")
    updated_at = serializers.DateTimeField()
    source: Declared = SourceSerializer(allow_null=True)


class ZoneDetailPropertiesSerializer(ZonePropertiesSerializer):
    is_edited = serializers.BooleanField(help_text="changed by a curator")
    properties = serializers.DictField(help_text="everything else that the source says")


ZoneFeatureSerializer = feature_serializer("ZoneFeature", ZonePropertiesSerializer)
ZoneDetailFeatureSerializer = feature_serializer("ZoneDetailFeature", ZoneDetailPropertiesSerializer)
ZoneCollectionSerializer = collection_serializer("ZoneCollection", ZoneFeatureSerializer)


def zone_properties(zone: DrawnZone) -> dict[str, Any]:
    box = (-180.0, -90.0, 180.0, 90.0) if zone.schedule is None else shapely.from_geojson(zone.geometry_json).bounds
    activity = activity_of(zone.schedule, box, timezone.now())
    return {
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
        "is_active": activity.is_active,
        "changes_at": activity.changes_at,
        "revision": zone.revision,
        "updated_at": zone.updated_at,
        "source": source_json(zone.zone_set.data_import if zone.zone_set else None),
    }


def zone_feature(zone: DrawnZone) -> dict[str, Any]:
    return {"type": "Feature", "id": zone.pk, "geometry": json.loads(zone.geometry_json), "properties": zone_properties(zone)}


def zone_detail_feature(zone: DrawnZone) -> dict[str, Any]:
    feature = zone_feature(zone)
    feature["properties"] |= {"properties": zone.properties, "is_edited": zone.is_edited}
    return feature


def limit_json(value_m: float | None, reference: str) -> dict[str, Any] | None:
    return None if value_m is None else {"value_m": value_m, "reference": reference}


def schedule_words(schedule: Any) -> str:
    """Return the schedule as text; one stored before there was a common form gets a general text."""
    try:
        return schedule_sentence(checked_schedule(schedule, "schedule"))
    except GeometryFault:
        return "As its source says"
