"""Request shapes: UAVs, targets, options, plans and missions."""

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from django.conf import settings
from django.utils import timezone
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from missions.fields import AboveZeroField, BetweenField, PositionField
from missions.models import END_ACTIONS, OBJECTIVES, TargetPriority, Uav
from missions.reason_texts import fault_texts
from missions.selectors.fleet import FIGURES, figures_of, uavs_of_organisation
from missions.serializers.known_fields import KnownFieldsSerializer
from missions.serializers.limits import (
    MAX_DAYS_AHEAD,
    MAX_KEY,
    MAX_POWER_W,
    MAX_RALLY_POINTS,
    MAX_RANGE_M,
    MAX_SENSOR_LENGTH,
    MAX_SENSORS_OF_UAV,
    MAX_SORTIES,
    MAX_SPEED_MPS,
    MAX_TARGETS,
    MAX_UAV_NAME_LENGTH,
    MAX_WIND_LAYERS,
    MAX_WIND_M,
    MAX_WIND_MPS,
    MIN_CHARGING_W,
)
from missions.serializers.performance import fault_words
from missions.serializers.view_plans import TaskSerializer, views_request
from missions.services import (
    CALM,
    InvalidRequest,
    LockRequest,
    PlanRequest,
    TargetRequest,
    UavRequest,
    priority_from_json,
    refuse_contradictions,
    with_bases,
)
from planning.clearance.lost_link import LostLink
from planning.energy.conditions import Conditions, InvalidConditions, conditions_from_json
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
from planning.problem import Objective
from planning.request import GO_ON, EndAction, LostLinkRequest, lost_link_from_json
from planning.task import DEFAULT_HOLD_S, MAX_HOLD_S, VIEWS_HOLD_S, Task, TaskKind
from workspace.api import strict_serializers as serializers
from workspace.api.external_data import AttributesField, ExternalIdField
from workspace.api.fields import FiniteFloatField
from workspace.models import Organisation


class WindLayerSerializer(KnownFieldsSerializer):
    """Wind at a height above ground: interpolated between two heights, constant beyond them."""

    altitude_agl_m = FiniteFloatField(min_value=0, max_value=MAX_WIND_M)
    speed_mps = FiniteFloatField(min_value=0, max_value=MAX_WIND_MPS)
    from_deg = FiniteFloatField(min_value=0, max_value=359.999999, help_text="where it blows from, degrees from true north, clockwise")


class ConditionsSerializer(KnownFieldsSerializer):
    """Wind and temperature during the flight; without wind it is calm."""

    wind = WindLayerSerializer(many=True, required=False)
    temperature_c = FiniteFloatField(min_value=-60, max_value=60, required=False, help_text="near the ground; missing: 15")

    def to_internal_value(self, data: Any) -> Conditions:
        if isinstance(data, dict) and isinstance(data.get("wind"), list):
            _no_more_than(MAX_WIND_LAYERS, data["wind"], "heights of wind")
        try:
            return conditions_from_json(super().to_internal_value(data))
        except InvalidConditions as error:
            raise serializers.ValidationError({error.place: [error.message]}) from error


class PerformanceFieldsSerializer(KnownFieldsSerializer):
    """Battery, mass and airspeed; where missing, the stored UAV's type supplies them."""

    battery_wh = BetweenField(BATTERIES_WH, required=False, allow_null=True, help_text="of a full battery; null: its energy is not counted")
    mass_kg = BetweenField(MASSES_KG, required=False, allow_null=True, help_text="at take-off; null: the Iris's")
    reserve_percent = BetweenField(RESERVES_PERCENT, required=False, help_text="of the battery, that no plan uses")
    max_airspeed_mps = BetweenField(AIRSPEEDS_MPS, required=False, allow_null=True, help_text="null: its cruise speed")
    rotor_disk_m2 = BetweenField(ROTOR_DISKS_M2, required=False, allow_null=True, help_text="null: the Iris's")
    hover_power_w = AboveZeroField(required=False, allow_null=True, max_value=MAX_POWER_W, help_text="as measured; null: worked out")


class UavInputSerializer(PerformanceFieldsSerializer):
    """A UAV: a stored one by `id`, whose values the others override, or a new one by name and position."""

    id = serializers.IntegerField(required=False, allow_null=True)
    is_simulated = serializers.BooleanField(read_only=True, help_text="of the stored UAV; sent again it says nothing")
    name = serializers.CharField(max_length=MAX_UAV_NAME_LENGTH, required=False)
    position = PositionField(required=False)
    max_range_m = AboveZeroField(required=False, allow_null=True, max_value=MAX_RANGE_M, help_text="null or missing: not limited")
    cruise_speed_mps = AboveZeroField(required=False, max_value=MAX_SPEED_MPS)
    end_action = serializers.ChoiceField(choices=END_ACTIONS, required=False)
    most_targets = serializers.IntegerField(
        required=False, allow_null=True, min_value=1, max_value=MAX_TARGETS, help_text="null or missing: not limited"
    )
    sorties = serializers.IntegerField(
        required=False,
        min_value=1,
        max_value=MAX_SORTIES,
        help_text="flights that it makes at most, each on a full battery; more than one only for a UAV that returns to its start",
    )
    sensors = serializers.ListField(
        child=serializers.CharField(max_length=MAX_SENSOR_LENGTH),
        required=False,
        max_length=MAX_SENSORS_OF_UAV,
        help_text="missing: the stored UAV's",
    )
    own_figures = serializers.ListField(
        child=serializers.ChoiceField(choices=FIGURES),
        required=False,
        max_length=len(FIGURES),
        help_text="which figures are meant for this mission alone, whatever becomes of the stored UAV; missing: those that differ from its",
    )

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        missing = [field for field in ("name", "position") if field not in attrs]
        if attrs.get("id") is None and missing:
            raise serializers.ValidationError(dict.fromkeys(missing, _("This field is required for a UAV without an id.")))
        return attrs


class TargetInputSerializer(KnownFieldsSerializer):
    """An asset, a point (`position`) or `stretch` on one, or a bare `position`."""

    asset = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=MAX_KEY)
    position = PositionField(required=False, allow_null=True)
    stretch = serializers.ListField(child=PositionField(), min_length=2, max_length=2, required=False, allow_null=True)
    task = TaskSerializer(required=False, allow_null=True)
    priority = serializers.ChoiceField(
        choices=TargetPriority.choices, required=False, help_text="a high one is never left out for any number of lower ones"
    )
    uav = serializers.CharField(
        max_length=MAX_UAV_NAME_LENGTH, required=False, allow_null=True, help_text="name of the only UAV of the request that may do it"
    )
    sensor = serializers.CharField(
        max_length=MAX_SENSOR_LENGTH, required=False, allow_null=True, allow_blank=True, help_text="only UAVs that have it may do it"
    )
    external_id = ExternalIdField(help_text="another system's id, such as a work item's; empty: none")
    attributes = AttributesField(help_text="of other systems")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if attrs.get("asset") is None and attrs.get("position") is None:
            raise serializers.ValidationError({"asset": _("A target needs an asset or a position.")})
        if attrs.get("stretch") and (attrs.get("asset") is None or attrs.get("position") is not None):
            raise serializers.ValidationError({"stretch": _("A stretch needs an asset and no position.")})
        views = (attrs.get("task") or {}).get("views")
        if (attrs.get("task") or {}).get("speed_mps") is not None and (attrs.get("asset") is None or attrs.get("position") is not None):
            raise serializers.ValidationError({"task": _("Only a look along a line has a speed.")})
        if views and (attrs.get("asset") is None or attrs.get("stretch")):
            raise serializers.ValidationError({"task": _("Photos are planned of power towers that carry a line.")})
        if views and (attrs.get("sensor") or "").strip().casefold() not in {"", views["camera"].name.strip().casefold()}:
            message = _("The photos are planned for the camera %(camera)s: leave the sensor empty.")
            raise serializers.ValidationError({"sensor": message % {"camera": views["camera"].name}})
        return attrs


class LostLinkSerializer(KnownFieldsSerializer):
    """Action of UAVs with a lost link: go on, hold for a while and return, or return to their start or the nearest rally point."""

    behaviour = serializers.ChoiceField(choices=[(one.value, one.value) for one in LostLink])
    rally_points = serializers.ListField(child=PositionField(), required=False, max_length=MAX_RALLY_POINTS)
    hold_s = FiniteFloatField(required=False, min_value=0, max_value=MAX_HOLD_S, help_text="before it returns; only with hold")


class LockListSerializer(serializers.ListSerializer):
    """List of locks. It checks the count before the items: a target can be locked once, so a plan has at most as many locks."""

    def to_internal_value(self, data: Any) -> list[dict[str, Any]]:
        most = settings.ROUTING_RULES.max_targets
        if isinstance(data, list):
            _no_more_than(most, data, "locks")
            targets = [lock.get("targets") for lock in data if isinstance(lock, dict)]
            _no_more_than(most, [target for listed in targets if isinstance(listed, list) for target in listed], "locked targets")
        found: list[dict[str, Any]] = super().to_internal_value(data)
        return found


class LockSerializer(KnownFieldsSerializer):
    """Targets that one UAV flies in this order without others between, optionally as the first or the last of its route."""

    uav = serializers.CharField(max_length=MAX_UAV_NAME_LENGTH, help_text="name of a UAV of the request")
    targets = serializers.ListField(
        child=serializers.IntegerField(min_value=0), allow_empty=False, help_text="indices of the targets, in the order flown"
    )
    at_start = serializers.BooleanField(required=False, default=False)
    at_end = serializers.BooleanField(required=False, default=False)

    class Meta:
        list_serializer_class = LockListSerializer


OBJECTIVES_IN_WORDS = "total: fewest metres; makespan: finish soonest; time: least flying time of all together; energy: least Wh"


class OptionsSerializer(KnownFieldsSerializer):
    """UAVs, targets and options of a mission, all optional."""

    uavs = UavInputSerializer(many=True, required=False)
    targets = TargetInputSerializer(many=True, required=False)
    objective = serializers.ChoiceField(
        choices=OBJECTIVES,
        required=False,
        help_text="total: fly least; makespan: finish soonest; time: least flying time of all; energy: least Wh",
    )
    return_to_start = serializers.BooleanField(required=False)
    locks = LockSerializer(many=True, required=False)
    departs_at = serializers.DateTimeField(
        required=False, allow_null=True, default_timezone=UTC, help_text="planned take-off; null: the plan keeps clear of zones at any time"
    )
    conditions = ConditionsSerializer(required=False, allow_null=True)
    charging_w = FiniteFloatField(
        required=False,
        allow_null=True,
        min_value=MIN_CHARGING_W,
        max_value=MAX_POWER_W,
        help_text="power of charging at towers on the way, of UAVs that fly once; null: there is none",
    )

    lost_link = LostLinkSerializer(required=False, allow_null=True)

    def validate_lost_link(self, value: dict[str, Any] | None) -> LostLinkRequest:
        return lost_link_from_json(value or {})

    def validate_departs_at(self, value: datetime | None) -> datetime | None:
        if value is not None and abs((value - timezone.now()).days) > MAX_DAYS_AHEAD:
            raise serializers.ValidationError(_("A departure lies within two years of today."))
        return value

    def validate_conditions(self, value: Conditions | None) -> Conditions:
        return value or CALM

    def validate_uavs(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        return _no_more_than(settings.ROUTING_RULES.max_uavs, value, "UAVs")

    def validate_targets(self, value: list[dict[str, Any]]) -> list[dict[str, Any]]:
        return _no_more_than(settings.ROUTING_RULES.max_targets, value, "targets")

    def validate_locks(self, value: list[dict[str, Any]]) -> tuple[LockRequest, ...]:
        return tuple(LockRequest(lock["uav"], tuple(lock["targets"]), lock["at_start"], lock["at_end"]) for lock in value)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if "uavs" in attrs:
            attrs["uavs"] = self._uav_requests(attrs["uavs"])
        if "targets" in attrs:
            attrs["targets"] = tuple(_target_request(target) for target in attrs["targets"])
        if "objective" in attrs:
            attrs["objective"] = Objective(attrs["objective"])
        return attrs

    def _uav_requests(self, uavs: list[dict[str, Any]]) -> tuple[UavRequest, ...]:
        """Return the UAV requests. Stored UAVs are those of the organisation in the serializer's context."""
        ids = [uav["id"] for uav in uavs if uav.get("id") is not None]
        stored: dict[int | None, Uav] = (
            {row.pk: row for row in uavs_of_organisation(self.context["organisation"]).filter(pk__in=ids)} if ids else {}
        )
        faults = {
            str(index): {"id": f"There is no UAV {uav['id']}."}
            for index, uav in enumerate(uavs)
            if uav.get("id") is not None and uav["id"] not in stored
        }
        if faults:
            raise serializers.ValidationError({"uavs": faults})
        return tuple(_checked_uav(index, uav, stored.get(uav.get("id"))) for index, uav in enumerate(uavs))


def _no_more_than(limit: int, value: list[Any], what: str) -> list[Any]:
    if len(value) > limit:
        raise serializers.ValidationError(
            _("At most %(limit)s %(what)s; these are %(count)s.") % {"limit": limit, "what": what, "count": len(value)}
        )
    return value


def _checked_uav(index: int, uav: dict[str, Any], stored: Uav | None) -> UavRequest:
    try:
        return _uav_request(uav, stored)
    except InvalidPerformance as error:
        raise serializers.ValidationError({"uavs": {str(index): {error.place: [fault_words(error)]}}}) from error


def _uav_request(uav: dict[str, Any], stored: Uav | None) -> UavRequest:
    if stored is None:
        known: dict[str, Any] = {
            "max_range_m": None,
            "cruise_speed_mps": settings.FLIGHT_RULES.cruise_speed_mps,
            "end_action": EndAction.HOVER,
            "sensors": [],
        }
        own: list[str] = []
        figures: dict[str, Any] = {}
    else:
        figures = figures_of(stored)
        known = {"name": stored.name, "position": stored.location.coords, "end_action": stored.end_action} | figures
        own = uav["own_figures"] if "own_figures" in uav else [name for name in FIGURES if name in uav and uav[name] != figures[name]]
    values = known | {field: uav[field] for field in uav if field != "id"}
    return UavRequest(
        name=values["name"],
        position=LonLat(*values["position"]),
        max_range_m=values["max_range_m"],
        cruise_speed_mps=values["cruise_speed_mps"],
        end_action=EndAction(values["end_action"]),
        uav=None if stored is None else stored.pk,
        most_targets=values.get("most_targets"),
        sensors=tuple(values["sensors"]),
        performance=performance_from_json({name: values[name] for name in PERFORMANCE_KEYS if name in values}),
        sorties=values.get("sorties", 1),
        own_figures=tuple(name for name in FIGURES if name in own),
        fleet_figures={name: figures[name] for name in FIGURES if name in own and name in figures},
    )


def _target_request(target: dict[str, Any]) -> TargetRequest:
    stretch = target.get("stretch")
    task = _task(target["task"]) if target.get("task") else None
    return TargetRequest(
        asset=target.get("asset"),
        position=target.get("position"),
        stretch=(stretch[0], stretch[1]) if stretch else None,
        task=task,
        priority=priority_from_json(target.get("priority", TargetPriority.NORMAL)),
        uav=target.get("uav") or "",
        sensor=target.get("sensor") or ("" if task is None or task.views is None else task.views.camera.name),
        external_id=target.get("external_id", ""),
        attributes=target.get("attributes", {}),
    )


def _task(value: dict[str, Any]) -> Task:
    kind, views = TaskKind(value["kind"]), value.get("views")
    hold_s = value.get("hold_s", VIEWS_HOLD_S if views else DEFAULT_HOLD_S[kind])
    return Task(kind, hold_s, views_request(views) if views else None, speed_mps=value.get("speed_mps"))


class PlanInputSerializer(OptionsSerializer):
    """A planning request."""

    uavs = UavInputSerializer(many=True, allow_empty=False)
    targets = TargetInputSerializer(many=True, allow_empty=False)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        """Refuse contradictory constraints, and add the organisation's bases where they are needed."""
        attrs = super().validate(attrs)
        request = plan_request(attrs)
        try:
            refuse_contradictions(request)
            attrs["bases"] = with_bases(request, self.context["organisation"]).bases
        except InvalidRequest as error:
            raise serializers.ValidationError({place: [fault] for place, fault in fault_texts(error).items()}) from error
        return attrs

    @classmethod
    def read_request(cls, body: Any, organisation: Organisation) -> PlanRequest:
        """Return the request of a body. Raises ValidationError.

        A plan with a departure is deconflicted with the organisation's other flights of that time.
        """
        asked = plan_request(cls.read(body, organisation=organisation))
        return asked if asked.departs_at is None else replace(asked, organisation=organisation.pk)


class GivenToMissionSerializer(OptionsSerializer):
    """Data that other systems may store with a mission."""

    external_id = ExternalIdField(help_text="another system's id, such as a work order's; several missions may have one")
    attributes = AttributesField(help_text="of other systems; a change replaces all of them")


class MissionInputSerializer(GivenToMissionSerializer):
    name = serializers.CharField(max_length=200)
    plan = serializers.BooleanField(required=False, default=False, help_text="plan it in the same request")
    plan_of = serializers.UUIDField(
        required=False,
        allow_null=True,
        help_text="with `plan`: a done job of POST /plans; its plan is taken if it was asked for just this",
    )


class MissionPatchSerializer(GivenToMissionSerializer):
    name = serializers.CharField(max_length=200, required=False)
    plan = serializers.BooleanField(required=False, default=False, help_text="plan it in the same request")
    plan_of = serializers.UUIDField(
        required=False,
        allow_null=True,
        help_text="with `plan`: a done job of POST /plans; its plan is taken if it was asked for just this",
    )


def plan_request(values: dict[str, Any]) -> PlanRequest:
    return PlanRequest(
        uavs=values.get("uavs", ()),
        targets=values.get("targets", ()),
        objective=values.get("objective", Objective.TOTAL),
        return_to_start=values.get("return_to_start", False),
        locks=values.get("locks", ()),
        bases=values.get("bases", ()),
        departs_at=values.get("departs_at"),
        conditions=values.get("conditions", CALM),
        charging_w=values.get("charging_w"),
        lost_link=values.get("lost_link", GO_ON),
    )


class MissionCopySerializer(KnownFieldsSerializer):
    name = serializers.CharField(max_length=200, required=False, allow_blank=True, help_text="without one: the name with (copy)")


class FollowUpSerializer(KnownFieldsSerializer):
    name = serializers.CharField(max_length=200, required=False, allow_blank=True, help_text="without one: the name with “follow-up”")
    targets = serializers.ListField(
        child=serializers.IntegerField(min_value=0, max_value=MAX_TARGETS), required=False, allow_empty=False, max_length=MAX_TARGETS,
        help_text="places of the targets to fly again, complete or not; without: those that were missed",
    )  # fmt: skip


class MissionsInputSerializer(KnownFieldsSerializer):
    missions = serializers.ListField(child=serializers.UUIDField(), allow_empty=False, max_length=200)
