"""UAVs as GeoJSON features, in and out."""

from typing import Any

from django.utils.translation import gettext as _

from missions.fields import AboveZeroField, BetweenField, PositionField
from missions.models import END_ACTIONS, CredentialKind, LinkKind, Uav, UavState
from missions.selectors.fleet import UavWithUse, bases_of_organisation, performance_with, types_of_organisation
from missions.serializers.inputs import MAX_RANGE_M, MAX_SPEED_MPS
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.serializers.performance import fault_words
from planning.energy.performance import (
    AIRSPEEDS_MPS,
    BATTERIES_WH,
    MASSES_KG,
    OWN_PERFORMANCE_KEYS,
    RESERVES_PERCENT,
    InvalidPerformance,
)
from workspace.api import strict_serializers as serializers
from workspace.api.external_data import AttributesField, ExternalIdField
from workspace.api.fields import FiniteFloatField

OWN = (
    "name", "base_name", "state", "serial_number", "mavlink_system_id", "link", "is_simulated", "allows_unsigned", "heading_deg",
    "battery_percent", "sensor", "end_action", "external_id", "attributes",
)  # fmt: skip
FEATURE = {"type", "id", "geometry", "properties", "bbox"}  # RFC 7946
FROM_TYPE = ("max_range_m", "cruise_speed_mps", *OWN_PERFORMANCE_KEYS)


class UavPropertiesSerializer(KnownFieldsSerializer):
    """Range, speed, battery, mass, reserve and airspeed are the UAV's own. Where one is `null`, the response has its type's value, and

    `from_type` names it.
    """

    name = serializers.CharField(max_length=100)
    type = serializers.IntegerField(allow_null=True, required=False, min_value=1, max_value=2**63 - 1)
    base = serializers.IntegerField(allow_null=True, required=False, min_value=1, max_value=2**63 - 1)
    base_name = serializers.CharField(
        max_length=100, allow_blank=True, required=False, help_text="without `base`: the base of this name, if there is one, else a text"
    )
    state = serializers.ChoiceField(choices=UavState.choices, required=False)
    serial_number = serializers.CharField(max_length=100, allow_blank=True, required=False)
    mavlink_system_id = serializers.IntegerField(allow_null=True, required=False, min_value=1, max_value=254, help_text="one vehicle each")
    link = serializers.ChoiceField(choices=LinkKind.choices, required=False, help_text="the door by which it is told what to do")
    is_simulated = serializers.BooleanField(
        required=False, help_text="no real aircraft: may fly without terrain data; changed by administrators alone"
    )
    allows_unsigned = serializers.BooleanField(
        required=False, help_text="MAVLink without a signature is taken for its own; changed by administrators alone"
    )
    max_range_m = AboveZeroField(
        allow_null=True, required=False, max_value=MAX_RANGE_M, help_text="metres on one battery; null: the type's"
    )
    cruise_speed_mps = AboveZeroField(
        allow_null=True, required=False, max_value=MAX_SPEED_MPS, help_text="null: the type's, else the usual"
    )
    battery_wh = BetweenField(BATTERIES_WH, allow_null=True, required=False, help_text="watt-hours of a full battery; null: the type's")
    mass_kg = BetweenField(MASSES_KG, allow_null=True, required=False, help_text="kilograms at take-off; null: the type's")
    reserve_percent = BetweenField(RESERVES_PERCENT, allow_null=True, required=False, help_text="that no plan uses; null: the type's")
    max_airspeed_mps = BetweenField(
        AIRSPEEDS_MPS, allow_null=True, required=False, help_text="through the air; null: the type's, else its cruise speed"
    )
    heading_deg = FiniteFloatField(
        allow_null=True, required=False, min_value=0, max_value=359.999999, help_text="degrees from true north, clockwise; null: not known"
    )
    battery_percent = FiniteFloatField(allow_null=True, required=False, min_value=0, max_value=100)
    sensor = serializers.CharField(max_length=100, allow_blank=True, required=False, help_text="besides those of its type")
    end_action = serializers.ChoiceField(choices=END_ACTIONS, required=False)
    external_id = ExternalIdField(help_text="another system's id of it, one UAV each; empty: none")
    attributes = AttributesField(help_text="of other systems; a change replaces all of them")
    missing = serializers.ListField(
        child=serializers.ChoiceField(choices=["type", "range"]),
        read_only=True,
        help_text="what must be stated before it is planned, approved or started; empty: complete",
    )
    twin_of = serializers.IntegerField(read_only=True, allow_null=True, help_text="the UAV that it is the simulated twin of")
    type_name = serializers.CharField(read_only=True)
    sensors = serializers.ListField(child=serializers.CharField(), read_only=True, help_text="its own and its type's")
    from_type = serializers.ListField(child=serializers.CharField(), read_only=True, help_text="which values are the type's")
    located_at = serializers.DateTimeField(read_only=True, allow_null=True, help_text="when the position was set or reported")
    mission_count = serializers.IntegerField(read_only=True)
    credentials = serializers.ListField(
        child=serializers.ChoiceField(choices=CredentialKind.choices), read_only=True, help_text="what it can prove itself with"
    )
    revision = serializers.IntegerField(read_only=True, help_text="the ETag")
    updated_at = serializers.DateTimeField(read_only=True)


class UavFlatSerializer(UavPropertiesSerializer):
    """A UAV as one object: its properties and `position`, by default its base's. A GeoJSON Feature is accepted too."""

    position = PositionField(required=False)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        """Resolve `type` and `base` to rows of the organisation in the context."""
        organisation = self.context["organisation"]
        faults: dict[str, str] = {}
        for field, name, rows in (("base", "base", bases_of_organisation), ("type", "uav_type", types_of_organisation)):
            if field in attrs:
                key = attrs.pop(field)
                attrs[name] = None if key is None else rows(organisation).filter(pk=key).first()
                if key is not None and attrs[name] is None:
                    faults[field] = f"There is no {field} {key}."
        if not self.partial and "position" not in attrs and attrs.get("base") is None and not faults:
            faults["position"] = "A UAV needs a position, or a base to stand at."
        faults = faults or self._performance_faults(attrs)
        if faults:
            raise serializers.ValidationError(faults)
        return attrs

    def _performance_faults(self, attrs: dict[str, Any]) -> dict[str, str]:
        """Return the values that are impossible for a UAV of its type."""
        stored = self.instance
        uav_type = attrs["uav_type"] if "uav_type" in attrs else getattr(stored, "uav_type", None)
        own = {name: attrs[name] if name in attrs else getattr(stored, name, None) for name in OWN_PERFORMANCE_KEYS}
        if own["battery_wh"] is not None and own["mass_kg"] is None and getattr(uav_type, "mass_kg", None) is None:
            return {"mass_kg": _("With a battery its mass is needed: what a flight takes follows from it.")}
        try:
            performance_with(uav_type, own)
        except InvalidPerformance as error:
            return {error.place: fault_words(error)}
        return {}


class PointSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Point"])
    coordinates = PositionField()


class UavFeatureSerializer(serializers.Serializer):
    refuses_other_fields = True  # flat_uav does

    type = serializers.ChoiceField(choices=["Feature"])
    id = serializers.IntegerField(read_only=True)
    geometry = PointSerializer()
    properties = UavPropertiesSerializer()


class UavNumbersSerializer(serializers.Serializer):
    active = serializers.IntegerField()
    maintenance = serializers.IntegerField()
    retired = serializers.IntegerField()


class UavCollectionSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["FeatureCollection"])
    features = UavFeatureSerializer(many=True)
    numbers = UavNumbersSerializer(help_text="how many there are in each state, whatever state was asked for")
    next = serializers.CharField(allow_null=True)


def uav_feature(uav: UavWithUse) -> dict[str, Any]:
    """uav: a row with its use, see fleet_selectors.with_use."""
    properties = {field: getattr(uav, field) for field in OWN}
    properties |= {"max_range_m": uav.range_m, "cruise_speed_mps": uav.speed_mps, "type": uav.uav_type_id, "base": uav.base_id}
    properties |= {name: _own_or_of_type(uav, name) for name in OWN_PERFORMANCE_KEYS}
    properties |= {
        "type_name": uav.uav_type.name if uav.uav_type else "",
        "sensors": uav.sensors,
        "from_type": [
            field for field in FROM_TYPE if uav.uav_type and getattr(uav, field) is None and getattr(uav.uav_type, field) is not None
        ],
        "missing": uav.missing,
        "twin_of": uav.twin_of_id,
        "located_at": uav.located_at,
        "mission_count": uav.mission_count,
        "credentials": [credential.kind for credential in uav.credentials_in_force],
        "revision": uav.revision,
        "updated_at": uav.updated_at,
    }
    return {
        "type": "Feature",
        "id": uav.pk,
        "geometry": {"type": "Point", "coordinates": list(uav.location.coords)},
        "properties": properties,
    }


def _own_or_of_type(uav: Uav, name: str) -> float | None:
    own: float | None = getattr(uav, name)
    return getattr(uav.uav_type, name) if own is None and uav.uav_type else own


def flat_uav(data: Any) -> Any:
    """Return a GeoJSON Feature as one flat object, and anything else unchanged for the serializer to validate.

    A response may be sent back as a request. Raises ValidationError for fields that a Feature of a UAV does not have.
    """
    if not isinstance(data, dict) or data.get("type") != "Feature":
        return data
    properties, geometry = data.get("properties"), data.get("geometry")
    faults = {name: [_("A Feature has no such field; what is said of a UAV stands in its properties.")] for name in set(data) - FEATURE}
    if geometry is not None and not (isinstance(geometry, dict) and geometry.get("type") == "Point"):
        faults["position"] = [_("A UAV stands at a Point.")]
    if properties is not None and not isinstance(properties, dict):
        faults["properties"] = [_("An object is needed.")]
    if faults:
        raise serializers.ValidationError(faults)
    position = {} if geometry is None else {"position": geometry.get("coordinates")}
    return dict(properties or {}) | position
