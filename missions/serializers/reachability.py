"""Request and response of which assets can be inspected."""

from typing import Any

from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from missions.reason_texts import fault_texts
from missions.selectors.fleet import bases_of_organisation
from missions.serializers.inputs import OptionsSerializer, UavInputSerializer, plan_request
from missions.services import BaseRequest, InvalidRequest, with_bases
from missions.services.planning.reachability import CODES, NO_UAV
from workspace.api import strict_serializers as serializers
from workspace.api.fields import FiniteFloatField
from workspace.jobs.serializers import Declared

MAX_FLIGHTS = 100  # a UAV from one base is one flight


class ReachabilityInputSerializer(OptionsSerializer):
    """UAVs at their positions, or each of them from each of some bases; with departure, end action and wind."""

    uavs = UavInputSerializer(many=True, allow_empty=False)
    bases = serializers.ListField(
        child=serializers.IntegerField(min_value=1), required=False, max_length=MAX_FLIGHTS, help_text="ids of bases to start from"
    )
    box = serializers.ListField(
        child=FiniteFloatField(),
        min_length=4,
        max_length=4,
        required=False,
        allow_null=True,
        help_text="west, south, east, north in degrees of what is asked about; west > east crosses the 180th meridian; null: everything",
    )
    targets: Declared = None
    locks: Declared = None
    objective: Declared = None

    def validate_box(self, value: list[float] | None) -> tuple[float, ...] | None:
        if value is None:
            return None
        west, south, east, north = value
        if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south <= north <= 90):
            raise serializers.ValidationError(_("Longitudes go from -180 to 180, latitudes from -90 to 90, and south is not above north."))
        return west, south, east, north

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        attrs = super().validate(attrs)
        asked = list(dict.fromkeys(attrs.pop("bases", [])))
        rows = {row.pk: row for row in bases_of_organisation(self.context["organisation"]).filter(pk__in=asked)} if asked else {}
        if missing := [base for base in asked if base not in rows]:
            raise serializers.ValidationError({"bases": [_("There is no base %(base)s.") % {"base": missing[0]}]})
        if len(attrs["uavs"]) * max(1, len(asked)) > MAX_FLIGHTS:
            raise serializers.ValidationError(
                {"bases": [_("At most %(most)s flights, each UAV from each base, are looked at.") % {"most": MAX_FLIGHTS}]}
            )
        attrs["starts"] = tuple(BaseRequest(rows[base].name, LonLat(*rows[base].location.coords)) for base in asked)
        try:
            attrs["request"] = with_bases(plan_request(attrs), self.context["organisation"])
        except InvalidRequest as error:
            raise serializers.ValidationError({place: [fault] for place, fault in fault_texts(error).items()}) from error
        return attrs


class ReachableFlightSerializer(serializers.Serializer):
    uav = serializers.IntegerField(help_text="index of the UAV")
    base = serializers.CharField(allow_null=True, help_text="the base that it starts from; null: where it stands")


class GroundedFlightSerializer(ReachableFlightSerializer):
    code = serializers.CharField()
    message = serializers.CharField()


class ReachabilityReasonSerializer(serializers.Serializer):
    code = serializers.ChoiceField(choices=[*dict.fromkeys(CODES.values()), NO_UAV])
    message = serializers.CharField()
    count = serializers.IntegerField(help_text="assets")


class ReachableAssetsSerializer(serializers.Serializer):
    """Columns of equal length, sorted by id: for 200,000 assets a map reads five lists of small numbers instead of objects."""

    ids = serializers.ListField(child=serializers.IntegerField())
    code = serializers.ListField(child=serializers.IntegerField(), help_text="0: can be inspected; n: the n-th of the reasons, from 1 on")
    flight = serializers.ListField(
        child=serializers.IntegerField(), help_text="index of the flight that flies least for it; -1: none, or several for a line"
    )
    missing_m = serializers.ListField(child=serializers.IntegerField(), help_text="metres of range that are missing at best; else 0")
    missing_wh = serializers.ListField(child=serializers.IntegerField(), help_text="Wh of battery that are missing at best; else 0")


class ReachabilitySerializer(serializers.Serializer):
    reachable = serializers.IntegerField()
    of = serializers.IntegerField()
    flights = ReachableFlightSerializer(many=True)
    grounded = GroundedFlightSerializer(many=True)
    reasons = ReachabilityReasonSerializer(many=True)
    not_counted = serializers.ListField(
        child=serializers.CharField(), help_text="what was asked for but no asset is said to be in reach by: `charging` on the way"
    )
    assets = ReachableAssetsSerializer()
    graph_version = serializers.IntegerField()
    ground_revision = serializers.IntegerField()
