"""Checks of a return or a landing from the present position, in the API."""

from dataclasses import asdict
from datetime import datetime
from typing import Any

from missions.fields import PositionField
from missions.serializers.starts import ReturnCheckSerializer
from telemetry.selectors.present import PresentPosition
from telemetry.services.returns.landing_here import LandingHere
from telemetry.services.returns.present_returns import PresentReturn
from workspace.api import strict_serializers as serializers


class PresentPositionSerializer(serializers.Serializer):
    position = PositionField()
    altitude_relative_m = serializers.FloatField(allow_null=True, help_text="above take-off")
    is_measured = serializers.BooleanField(help_text="false: estimated")
    age_s = serializers.FloatField(help_text="of the last report of a position")
    uncertainty_m = serializers.FloatField(help_text="within which it is, 95 of 100 times; the check is of all that lies within")


class BatteryAtLandingSerializer(serializers.Serializer):
    """Percentages of the full battery."""

    left_percent = serializers.FloatField(allow_null=True)
    home_percent = serializers.FloatField(allow_null=True, help_text="that the way home and the landing take")
    landing_percent = serializers.FloatField(allow_null=True, help_text="left at the landing; null: not known, see `unknown`")
    reserve_percent = serializers.FloatField(allow_null=True)
    hold_s = serializers.FloatField(allow_null=True, help_text="that it can stay where it is and still land at home with its reserve")
    unknown = serializers.CharField(allow_blank=True, help_text="why it is not known what is left at the landing; empty where it is")


class MetOnReturnSerializer(serializers.Serializer):
    uav = serializers.IntegerField()
    name = serializers.CharField()
    metres = serializers.FloatField(help_text="across the ground, at the closest")
    vertical_m = serializers.FloatField(allow_null=True, help_text="then; null: heights are not known, and count as the same")
    in_s = serializers.FloatField(help_text="from now")
    is_returning = serializers.BooleanField(help_text="whether the other one returns, too")


class AlongRouteSerializer(serializers.Serializer):
    waypoint = serializers.IntegerField(help_text="of the approved route, to which it flies straight; the rest is flown as approved")
    length_m = serializers.FloatField()
    duration_s = serializers.FloatField(help_text="to the landing, with what is done at targets on the way")
    targets = serializers.IntegerField(help_text="number of targets that are still visited")
    landing_percent = serializers.FloatField(allow_null=True, help_text="of its battery, left at the landing; null: not known")


class SafeReturnSerializer(serializers.Serializer):
    height_m = serializers.FloatField(allow_null=True, help_text="set before it returns; null: as it is")
    wait_s = serializers.FloatField(help_text="for which it holds before")
    along_route = serializers.BooleanField()


class PresentReturnSerializer(ReturnCheckSerializer):
    place = serializers.IntegerField(allow_null=True, help_text="the UAV's in its mission; null: it flies none")
    mission = serializers.UUIDField(allow_null=True)
    is_clear = serializers.BooleanField(help_text="nothing in the way, nobody met, and the reserve is kept as far as that is known")
    present = PresentPositionSerializer(allow_null=True, help_text="whence it was checked; null: where it is now is not known")
    distance_m = serializers.FloatField(allow_null=True, help_text="of the way home")
    duration_s = serializers.FloatField(allow_null=True, help_text="to the landing")
    level_m = serializers.FloatField(allow_null=True, help_text="above the take-off, at which it would fly home from here")
    battery = BatteryAtLandingSerializer()
    met = MetOnReturnSerializer(many=True, help_text="UAVs that it comes near on its way home, the first one first")
    along = AlongRouteSerializer(allow_null=True, help_text="home by the rest of its approved route; null: not clear, or not known")
    safest = SafeReturnSerializer(
        allow_null=True, help_text="parameters of a return in which nothing is in the way and none comes near another; null: there is none"
    )


class PresentReturnsSerializer(serializers.Serializer):
    at = serializers.DateTimeField()
    results = PresentReturnSerializer(many=True)


class NearAssetSerializer(serializers.Serializer):
    asset = serializers.IntegerField(help_text="id of the asset")
    kind = serializers.CharField()
    name = serializers.CharField()
    distance_m = serializers.FloatField(help_text="from straight below the UAV, across the ground")


class LandingHereSerializer(serializers.Serializer):
    at = serializers.DateTimeField()
    present = PresentPositionSerializer(allow_null=True, help_text="above what it was looked at; null: not known")
    altitude_agl_m = serializers.FloatField(allow_null=True, help_text="above the ground, as measured, else by the terrain model")
    slope_deg = serializers.FloatField(allow_null=True, help_text="of the terrain model, the steepest to any side; null: not known")
    assets = NearAssetSerializer(many=True, help_text="lines, towers, railways and bridges below and beside it, the nearest first")
    zones = serializers.ListField(child=serializers.CharField(), help_text="names of zones in force that it comes down through")
    warnings = serializers.ListField(child=serializers.CharField(), help_text="what is in the way of a landing here, in sentences")
    facts = serializers.ListField(child=serializers.CharField(), help_text="what else is known of the place, and what is not")


def landing_here_json(found: LandingHere, at: datetime) -> dict[str, Any]:
    """Return the data of LandingHereSerializer."""
    return {
        "at": at,
        "present": _present_json(found.present),
        **{name: getattr(found, name) for name in ("altitude_agl_m", "slope_deg", "assets", "zones", "warnings", "facts")},
    }


def present_return_json(found: PresentReturn) -> dict[str, Any]:
    """Return the data of PresentReturnSerializer."""
    check, battery = found.check, found.battery
    return {
        "place": check.place,
        "name": check.name,
        "uav": check.uav,
        "mission": found.mission,
        "state": check.state,
        "warnings": check.warnings,
        "parameter": check.parameter,
        "height_m": check.height_m,
        "safe_height_m": check.safe_height_m,
        "read_at": check.read_at,
        "fence_warning": check.fence_warning,
        "detail": check.detail,
        "is_clear": found.is_clear,
        "present": _present_json(found.present),
        "distance_m": _rounded(found.distance_m),
        "duration_s": _rounded(found.duration_s),
        "level_m": _rounded(found.level_m),
        "battery": asdict(battery),
        "met": found.met,
        "along": _along_json(found),
        "safest": None if found.safest is None else asdict(found.safest),
    }


def _present_json(present: PresentPosition | None) -> dict[str, Any] | None:
    if present is None:
        return None
    return {
        "position": present.position,
        "altitude_relative_m": _rounded(present.altitude_relative_m),
        "is_measured": present.is_measured,
        "age_s": _rounded(present.age_s),
        "uncertainty_m": _rounded(present.uncertainty_m),
    }


def _along_json(found: PresentReturn) -> dict[str, Any] | None:
    if found.along is None:
        return None
    path = found.along.path
    return {
        "waypoint": path.sequence,
        "length_m": _rounded(path.length_m),
        "duration_s": _rounded(path.duration_s),
        "targets": len(path.targets),
        "landing_percent": found.along_percent,
    }


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 1)
