"""What comes in: UAVs, targets, options, plans and missions."""

from typing import Any

from django.conf import settings
from django.utils.translation import gettext as _
from rest_framework import serializers

from missions.fields import FiniteFloatField, PositionField
from missions.fleet_selectors import uavs_of_organisation
from missions.models import EndAction, Objective, TargetPriority, Uav
from missions.routing.problem import DEFAULT_HOLD_S, MAX_HOLD_S, Task, TaskKind
from missions.routing.problem import Objective as RoutingObjective
from missions.serializers.limits import (
    FARTHEST_RANGE_M,
    FASTEST_MPS,
    LARGEST_KEY,
    LONGEST_SENSOR,
    LONGEST_UAV_NAME,
    MOST_SENSORS_OF_UAV,
    MOST_TARGETS,
)
from missions.services import (
    InvalidRequest,
    LockRequest,
    PlanRequest,
    TargetRequest,
    UavRequest,
    priority_from_json,
    refuse_contradictions,
    with_bases,
)


class TaskSerializer(serializers.Serializer):
    """What is done at a target. Without `hold_s` the kind's own: 5 s to look, 10 s for photos, 30 s to hold."""

    kind = serializers.ChoiceField(choices=[(kind.value, kind.value) for kind in TaskKind])
    hold_s = FiniteFloatField(min_value=0, max_value=MAX_HOLD_S, required=False)

    def to_task(self, value: dict[str, Any]) -> Task:
        kind = TaskKind(value["kind"])
        return Task(kind, value.get("hold_s", DEFAULT_HOLD_S[kind]))


class UavInputSerializer(serializers.Serializer):
    """A UAV where it stands: a stored one by `id`, whose values the others override, or a new one by name and position."""

    id = serializers.IntegerField(required=False, allow_null=True)
    name = serializers.CharField(max_length=LONGEST_UAV_NAME, required=False)
    position = PositionField(required=False)
    max_range_m = FiniteFloatField(required=False, allow_null=True, max_value=FARTHEST_RANGE_M, help_text="null or missing: not limited")
    cruise_speed_mps = FiniteFloatField(required=False, max_value=FASTEST_MPS)
    end_action = serializers.ChoiceField(choices=EndAction.choices, required=False)
    most_targets = serializers.IntegerField(
        required=False, allow_null=True, min_value=1, max_value=MOST_TARGETS, help_text="null or missing: not limited"
    )
    sensors = serializers.ListField(
        child=serializers.CharField(max_length=LONGEST_SENSOR),
        required=False,
        max_length=MOST_SENSORS_OF_UAV,
        help_text="missing: the stored UAV's",
    )

    def validate_max_range_m(self, value: float | None) -> float | None:
        return above_zero(value)

    def validate_cruise_speed_mps(self, value: float) -> float | None:
        return above_zero(value)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        missing = [field for field in ("name", "position") if field not in attrs]
        if attrs.get("id") is None and missing:
            raise serializers.ValidationError(dict.fromkeys(missing, _("This field is required for a UAV without an id.")))
        return attrs


def above_zero(value: float | None) -> float | None:
    if value is not None and value <= 0:
        raise serializers.ValidationError(_("This must be above 0."))
    return value


class TargetInputSerializer(serializers.Serializer):
    """An asset, a point (`position`) or `stretch` on one, or a bare `position`."""

    asset = serializers.IntegerField(required=False, allow_null=True, min_value=1, max_value=LARGEST_KEY)
    position = PositionField(required=False, allow_null=True)
    stretch = serializers.ListField(child=PositionField(), min_length=2, max_length=2, required=False, allow_null=True)
    task = TaskSerializer(required=False, allow_null=True)
    priority = serializers.ChoiceField(
        choices=TargetPriority.choices, required=False, help_text="a high one is never left out for any number of lower ones"
    )
    uav = serializers.CharField(
        max_length=LONGEST_UAV_NAME, required=False, allow_null=True, help_text="name of the only UAV of the request that may do it"
    )
    sensor = serializers.CharField(
        max_length=LONGEST_SENSOR, required=False, allow_null=True, allow_blank=True, help_text="only UAVs that have it may do it"
    )

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if attrs.get("asset") is None and attrs.get("position") is None:
            raise serializers.ValidationError({"asset": _("A target needs an asset or a position.")})
        if attrs.get("stretch") and (attrs.get("asset") is None or attrs.get("position") is not None):
            raise serializers.ValidationError({"stretch": _("A stretch needs an asset and no position.")})
        return attrs


class LockListSerializer(serializers.ListSerializer):
    """Counts before it looks at each: a target can be locked once, so that more than a plan may have are too many."""

    def to_internal_value(self, data: Any) -> list[dict[str, Any]]:
        most = settings.ROUTING_RULES.max_targets
        if isinstance(data, list):
            _no_more_than(most, data, "locks")
            targets = [lock.get("targets") for lock in data if isinstance(lock, dict)]
            _no_more_than(most, [target for listed in targets if isinstance(listed, list) for target in listed], "locked targets")
        found: list[dict[str, Any]] = super().to_internal_value(data)
        return found


class LockSerializer(serializers.Serializer):
    """Targets that one UAV flies in this order with nothing between, if wished as the first or the last of its route."""

    uav = serializers.CharField(max_length=LONGEST_UAV_NAME, help_text="name of a UAV of the request")
    targets = serializers.ListField(
        child=serializers.IntegerField(min_value=0), allow_empty=False, help_text="indices of the targets, in the order flown"
    )
    at_start = serializers.BooleanField(required=False, default=False)
    at_end = serializers.BooleanField(required=False, default=False)

    class Meta:
        list_serializer_class = LockListSerializer


class OptionsSerializer(serializers.Serializer):
    """UAVs, targets and options, all optional: what a mission is made of."""

    uavs = UavInputSerializer(many=True, required=False)
    targets = TargetInputSerializer(many=True, required=False)
    objective = serializers.ChoiceField(choices=Objective.choices, required=False, help_text="total: fly least; makespan: finish soonest")
    return_to_start = serializers.BooleanField(required=False)
    locks = LockSerializer(many=True, required=False)

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
            attrs["objective"] = RoutingObjective(attrs["objective"])
        return attrs

    def _uav_requests(self, uavs: list[dict[str, Any]]) -> tuple[UavRequest, ...]:
        """Stored UAVs are those of the organisation in the serializer's context."""
        ids = [uav["id"] for uav in uavs if uav.get("id") is not None]
        stored = {row.pk: row for row in uavs_of_organisation(self.context["organisation"]).filter(pk__in=ids)} if ids else {}
        faults = {
            str(index): {"id": f"There is no UAV {uav['id']}."}
            for index, uav in enumerate(uavs)
            if uav.get("id") is not None and uav["id"] not in stored
        }
        if faults:
            raise serializers.ValidationError({"uavs": faults})
        return tuple(_uav_request(uav, stored.get(uav.get("id"))) for uav in uavs)


def _no_more_than(limit: int, value: list[Any], what: str) -> list[Any]:
    if len(value) > limit:
        raise serializers.ValidationError(
            _("At most %(limit)s %(what)s; these are %(count)s.") % {"limit": limit, "what": what, "count": len(value)}
        )
    return value


def _uav_request(uav: dict[str, Any], stored: Uav | None) -> UavRequest:
    if stored is None:
        known = {
            "max_range_m": None,
            "cruise_speed_mps": settings.FLIGHT_RULES.cruise_speed_mps,
            "end_action": EndAction.HOVER,
            "sensors": [],
        }
    else:
        known = {
            "name": stored.name,
            "position": stored.location.coords,
            "max_range_m": stored.range_m,
            "cruise_speed_mps": stored.speed_mps,
            "end_action": stored.end_action,
            "sensors": stored.sensors,
        }
    values = known | {field: uav[field] for field in uav if field != "id"}
    return UavRequest(
        name=values["name"],
        position=PositionField().to_internal_value(list(values["position"])),
        max_range_m=values["max_range_m"],
        cruise_speed_mps=values["cruise_speed_mps"],
        end_action=EndAction(values["end_action"]),
        uav=None if stored is None else stored.pk,
        most_targets=values.get("most_targets"),
        sensors=tuple(values["sensors"]),
    )


def _target_request(target: dict[str, Any]) -> TargetRequest:
    task, stretch = target.get("task"), target.get("stretch")
    return TargetRequest(
        asset=target.get("asset"),
        position=target.get("position"),
        stretch=(stretch[0], stretch[1]) if stretch else None,
        task=TaskSerializer().to_task(task) if task else None,
        priority=priority_from_json(target.get("priority", TargetPriority.NORMAL)),
        uav=target.get("uav") or "",
        sensor=target.get("sensor") or "",
    )


class PlanInputSerializer(OptionsSerializer):
    """What is to be planned."""

    uavs = UavInputSerializer(many=True, allow_empty=False)
    targets = TargetInputSerializer(many=True, allow_empty=False)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        """Wishes that contradict each other are refused, and the organisation's bases come in where they are needed."""
        attrs = super().validate(attrs)
        request = plan_request(attrs)
        try:
            refuse_contradictions(request)
            attrs["bases"] = with_bases(request, self.context["organisation"]).bases
        except InvalidRequest as error:
            raise serializers.ValidationError({place: [fault] for place, fault in error.faults.items()}) from error
        return attrs

    def to_request(self) -> PlanRequest:
        return plan_request(self.validated_data)


class MissionInputSerializer(OptionsSerializer):
    name = serializers.CharField(max_length=200)
    plan = serializers.BooleanField(required=False, default=False, help_text="plan it in the same request")
    plan_of = serializers.UUIDField(
        required=False,
        allow_null=True,
        help_text="with `plan`: a done job of POST /plans; its plan is taken if it was asked for just this",
    )


class MissionPatchSerializer(OptionsSerializer):
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
        objective=values.get("objective", RoutingObjective.TOTAL),
        return_to_start=values.get("return_to_start", False),
        locks=values.get("locks", ()),
        bases=values.get("bases", ()),
    )


class MissionCopySerializer(serializers.Serializer):
    name = serializers.CharField(max_length=200, required=False, allow_blank=True, help_text="without one: the name with (copy)")


class MissionsInputSerializer(serializers.Serializer):
    missions = serializers.ListField(child=serializers.UUIDField(), allow_empty=False, max_length=200)


class PresenceInputSerializer(serializers.Serializer):
    editor = serializers.RegexField(r"^[A-Za-z0-9.-]{1,64}$", help_text="a name that the page made up for itself")
    here = serializers.BooleanField(required=False, default=True, help_text="false: the page is being left")
