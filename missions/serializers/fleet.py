"""UAV types, bases and credentials, in and out."""

from typing import Any

from django.utils.translation import gettext as _

from missions.fields import AboveZeroField, BetweenField, PositionField
from missions.models import Base, CredentialKind, UavCredential, UavType
from missions.serializers.inputs import MAX_RANGE_M, MAX_SPEED_MPS
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.serializers.limits import MAX_POWER_W
from missions.serializers.performance import fault_words
from missions.serializers.view_plans import CameraSerializer
from planning.energy.performance import (
    AIRSPEEDS_MPS,
    BATTERIES_WH,
    MASSES_KG,
    PERFORMANCE_KEYS,
    RESERVES_PERCENT,
    ROTOR_DISKS_M2,
    InvalidPerformance,
    performance_from_json,
)
from workspace.api import strict_serializers as serializers

MAX_SENSORS = 12
MAX_CAMERAS = 6


class UavTypeSerializer(KnownFieldsSerializer):
    """Values common to UAVs of one make. A UAV's own values override them."""

    id = serializers.IntegerField(read_only=True)
    name = serializers.CharField(max_length=100)
    max_range_m = AboveZeroField(allow_null=True, required=False, max_value=MAX_RANGE_M, help_text="metres on one battery")
    range_unlimited = serializers.BooleanField(
        required=False, help_text="chosen on purpose, without `max_range_m`: else UAVs without a range or battery are not planned"
    )
    cruise_speed_mps = AboveZeroField(required=False, max_value=MAX_SPEED_MPS)
    battery_wh = BetweenField(BATTERIES_WH, allow_null=True, required=False, help_text="watt-hours of a full battery")
    mass_kg = BetweenField(MASSES_KG, allow_null=True, required=False, help_text="kilograms at take-off")
    reserve_percent = BetweenField(RESERVES_PERCENT, required=False, help_text="that no plan uses")
    max_airspeed_mps = BetweenField(AIRSPEEDS_MPS, allow_null=True, required=False, help_text="null: its cruise speed")
    rotor_disk_m2 = BetweenField(ROTOR_DISKS_M2, allow_null=True, required=False, help_text="area swept by all rotors; null: the Iris's")
    hover_power_w = AboveZeroField(
        allow_null=True, required=False, max_value=MAX_POWER_W, help_text="in a calm hover, as measured; null: worked out"
    )
    sensors = serializers.ListField(child=serializers.CharField(max_length=50), required=False, max_length=MAX_SENSORS)
    cameras = CameraSerializer(many=True, required=False, help_text="that its UAVs carry, at most six; with different names")
    uav_count = serializers.IntegerField(read_only=True)
    revision = serializers.IntegerField(read_only=True, help_text="the ETag")
    updated_at = serializers.DateTimeField(read_only=True)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        """Check values that depend on each other: the range and its absence, the hover power, and the mass and rotors that it supports."""
        range_m, is_unlimited = (attrs.get(name, getattr(self.instance, name, None)) for name in ("max_range_m", "range_unlimited"))
        if is_unlimited and range_m is not None:
            raise serializers.ValidationError({"range_unlimited": _("State a range or choose unlimited range, not both.")})
        stored = {} if self.instance is None else {key: getattr(self.instance, key) for key in PERFORMANCE_KEYS}
        figures = stored | {key: attrs[key] for key in PERFORMANCE_KEYS if key in attrs}
        if figures.get("battery_wh") and not figures.get("mass_kg") and not {"battery_wh", "mass_kg"}.isdisjoint(attrs):
            raise serializers.ValidationError({"mass_kg": _("With a battery its mass is needed: what a flight takes follows from it.")})
        try:
            performance_from_json(figures)
        except InvalidPerformance as error:
            raise serializers.ValidationError({error.place: fault_words(error)}) from error
        return attrs

    def validate_sensors(self, value: list[str]) -> list[str]:
        return list(dict.fromkeys(value))

    def validate_cameras(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        if len(value) > MAX_CAMERAS:
            raise serializers.ValidationError(_("A type has at most %(most)s cameras.") % {"most": MAX_CAMERAS})
        if len({camera["name"].casefold() for camera in value}) < len(value):
            raise serializers.ValidationError(_("Two cameras have the same name."))
        return value


class BaseSerializer(KnownFieldsSerializer):
    """A place where UAVs stand and take off."""

    id = serializers.IntegerField(read_only=True)
    name = serializers.CharField(max_length=100)
    position = PositionField()
    note = serializers.CharField(max_length=300, allow_blank=True, required=False)
    uav_count = serializers.IntegerField(read_only=True)
    revision = serializers.IntegerField(read_only=True, help_text="the ETag")
    updated_at = serializers.DateTimeField(read_only=True)


class UavTypePageSerializer(serializers.Serializer):
    results = UavTypeSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class BasePageSerializer(serializers.Serializer):
    results = BaseSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class InsistSerializer(serializers.Serializer):
    insist_reason = serializers.CharField(
        max_length=300,
        required=False,
        help_text="administrators alone: why it is done although the UAV flies or something is on its way to it",
    )


class CredentialInputSerializer(InsistSerializer, KnownFieldsSerializer):
    kind = serializers.ChoiceField(choices=CredentialKind.choices)


class CredentialSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    kind = serializers.ChoiceField(choices=CredentialKind.choices)
    created_at = serializers.DateTimeField()
    created_by = serializers.CharField(allow_null=True)
    last_used_at = serializers.DateTimeField(allow_null=True)
    replaced_at = serializers.DateTimeField(allow_null=True, help_text="a newer one was made; it counts until that was used")
    revoked_at = serializers.DateTimeField(allow_null=True)


class NewCredentialSerializer(CredentialSerializer):
    secret = serializers.CharField(help_text="the token, or the 32 bytes of the key in hexadecimal; it cannot be read again")
    secret_qr = serializers.ListField(
        child=serializers.CharField(), help_text="its QR code without quiet zone: a row of modules each, 1 is dark"
    )


class CredentialPageSerializer(serializers.Serializer):
    results = CredentialSerializer(many=True)
    next = serializers.CharField(allow_null=True)


class UavMissionSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    name = serializers.CharField()
    state = serializers.CharField()
    updated_at = serializers.DateTimeField()


class UavMissionPageSerializer(serializers.Serializer):
    results = UavMissionSerializer(many=True)
    next = serializers.CharField(allow_null=True)


def uav_type_json(row: UavType) -> dict[str, Any]:
    names = (
        "name", "max_range_m", "range_unlimited", "cruise_speed_mps", "battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps",
        "rotor_disk_m2", "hover_power_w", "sensors", "cameras", "uav_count", "revision", "updated_at",
    )  # fmt: skip
    return {"id": row.pk} | {name: getattr(row, name) for name in names}


def base_json(row: Base) -> dict[str, Any]:
    names = ("name", "note", "uav_count", "revision", "updated_at")
    return {"id": row.pk, "position": list(row.location.coords)} | {name: getattr(row, name) for name in names}


def credential_json(row: UavCredential) -> dict[str, Any]:
    names = ("kind", "created_at", "last_used_at", "replaced_at", "revoked_at")
    return {"id": row.pk, "created_by": row.created_by.username if row.created_by else None} | {name: getattr(row, name) for name in names}
