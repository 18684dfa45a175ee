"""When a mission or a plan may depart: request and response."""

from datetime import UTC, datetime
from typing import Any

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _
from drf_spectacular.utils import extend_schema_field

from inspection.serializers.zones import ScheduleField, schedule_sentence
from inspection.zones.activity import TimeSpan
from missions.fields import PositionField
from missions.models import END_ACTIONS
from missions.selectors.zones import LegalWindows
from missions.serializers.known_fields import KnownFieldsSerializer
from planning.clearance.zone_clearance import FlownRoute
from planning.request import EndAction
from workspace.api import strict_serializers as serializers

MAX_WAYPOINTS = 20_000
MAX_ROUTES = 50


class TimedWaypointSerializer(serializers.Serializer):
    position = PositionField()
    altitude_agl_m = serializers.FloatField()
    altitude_amsl_m = serializers.FloatField(allow_null=True, required=False)


class TimedRouteSerializer(serializers.Serializer):
    """A plan's route; further fields are accepted and ignored."""

    end_action = serializers.ChoiceField(choices=END_ACTIONS)
    departs_s = serializers.FloatField(required=False)
    duration_s = serializers.FloatField()
    arrival_s = serializers.ListField(
        child=serializers.FloatField(allow_null=True), help_text="for each waypoint; empty: each leg may be flown at any time of the route"
    )
    waypoints = TimedWaypointSerializer(many=True)


@extend_schema_field(TimedRouteSerializer)
class TimedRouteField(serializers.Field):
    """A plan's route as arrays, with times in seconds after the plan's departure."""

    default_error_messages = {"shape": "A route is as plans have it: end_action, departs_s, duration_s, arrival_s and waypoints."}

    def to_internal_value(self, data: Any) -> FlownRoute:
        try:
            return self._route(data)
        except (KeyError, TypeError, ValueError, OverflowError):
            self.fail("shape")

    def to_representation(self, value: FlownRoute) -> Any:
        raise NotImplementedError("routes are only read")

    def _route(self, data: dict[str, Any]) -> FlownRoute:
        waypoints = data["waypoints"]
        departs_s, duration_s = _number(data.get("departs_s") or 0.0), _number(data["duration_s"])
        arrival_s = _column(data["arrival_s"] or [], may_lack=True)
        position = np.array([_position(waypoint["position"]) for waypoint in waypoints], dtype=np.float64).reshape(-1, 2)
        if len(arrival_s) not in {0, len(position)} or departs_s < 0 or duration_s < 0 or (arrival_s < 0).any():
            raise ValueError("times that are not the waypoints'")
        return FlownRoute(
            position=position,
            agl_m=_column([waypoint["altitude_agl_m"] for waypoint in waypoints]),
            amsl_m=_column([waypoint.get("altitude_amsl_m") for waypoint in waypoints], may_lack=True),
            arrival_s=arrival_s if len(arrival_s) else None,
            departs_s=departs_s,
            ends_s=departs_s + duration_s,
            lands=EndAction(data["end_action"]) != EndAction.HOVER,
        )


class LegalWindowsInputSerializer(KnownFieldsSerializer):
    routes = serializers.ListField(
        child=TimedRouteField(), allow_empty=False, max_length=MAX_ROUTES, help_text="of a plan, as it was answered"
    )

    def get_fields(self) -> dict[str, serializers.Field]:
        begin = serializers.DateTimeField(required=False, allow_null=True, help_text="the first departure that is asked about; else now")
        return super().get_fields() | {"from": begin}

    def validate_routes(self, routes: list[FlownRoute]) -> list[FlownRoute]:
        if sum(len(route.position) for route in routes) > MAX_WAYPOINTS:
            raise serializers.ValidationError(_("At most %(count)d waypoints can be looked at.") % {"count": MAX_WAYPOINTS})
        return routes


class TimeSpanSerializer(serializers.Serializer):
    """A time span; its end is excluded."""

    to = serializers.DateTimeField()

    def get_fields(self) -> dict[str, serializers.Field]:
        return {"from": serializers.DateTimeField()} | super().get_fields()


class MetLegSerializer(serializers.Serializer):
    uav = serializers.IntegerField(help_text="index of the UAV")
    leg = serializers.IntegerField(help_text="index of the waypoint at which it begins; -1 is the climb to the first one")


class BlockingZoneSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()
    blocked = TimeSpanSerializer(many=True, help_text="departures at which the mission would meet it")
    legs = MetLegSerializer(many=True, help_text="that meet it in space and height")
    schedule = ScheduleField(allow_null=True, help_text="as stored, in UTC; null: always")
    schedule_in_words = serializers.CharField(help_text="the same for people, in UTC")


class LegalWindowsSerializer(TimeSpanSerializer):
    """Permitted departures between two moments, with the routes flown as planned."""

    margin_s = serializers.FloatField(help_text="by so much before and after its times a zone counts")
    height_margin_m = serializers.FloatField(help_text="by so much below and above its limits a zone counts")
    windows = TimeSpanSerializer(many=True, help_text="departures at which no zone is met")
    zones = BlockingZoneSerializer(many=True, help_text="that the routes meet in space and height, at whatever time")


def legal_windows_json(found: LegalWindows, span: TimeSpan, uavs: list[int]) -> dict[str, Any]:
    """Return legal windows as JSON. uavs: for each route the index of its UAV."""
    return _span_json(span) | {
        "margin_s": settings.ZONE_RULES.time_margin_s,
        "height_margin_m": settings.ZONE_RULES.height_margin_m,
        "windows": [_span_json(window) for window in found.windows],
        "zones": [
            {
                "id": zone.zone,
                "name": zone.name,
                "blocked": [_span_json(blocked) for blocked in zone.blocked],
                "legs": [{"uav": uavs[route], "leg": leg} for route, leg in zone.legs],
                "schedule": zone.schedule,
                "schedule_in_words": schedule_sentence(zone.schedule),
            }
            for zone in found.zones
        ],
    }


def _span_json(span: TimeSpan) -> dict[str, datetime]:
    return {"from": datetime.fromtimestamp(span.from_s, UTC), "to": datetime.fromtimestamp(span.to_s, UTC)}


def _number(value: Any) -> float:
    if type(value) not in {int, float}:
        raise TypeError("no number")
    number = float(value)
    if not np.isfinite(number):
        raise ValueError("not finite")
    return number


def _column(values: list[Any], *, may_lack: bool = False) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([np.nan if may_lack and value is None else _number(value) for value in values], dtype=np.float64)


def _position(value: Any) -> tuple[float, float]:
    lon, lat = value
    position = _number(lon), _number(lat)
    if not (abs(position[0]) <= 180 and abs(position[1]) <= 90):
        raise ValueError("no place")
    return position
