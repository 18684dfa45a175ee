"""The body of a small plan, read at once where nothing is wrong with it.

A serializer's fields cost more than the plan. What this reader takes, the serializer would take with the same values; at whatever it
does not know for certain it gives up, and the serializer reads the body, or says what is wrong.
"""

import math
from typing import Any

from django.conf import settings

from inspection.geodesy import LonLat
from missions.serializers.limits import MAX_KEY, MAX_RANGE_M, MAX_SPEED_MPS, MAX_UAV_NAME_LENGTH
from missions.services import PlanRequest, TargetRequest, UavRequest
from planning.problem import DEFAULT_HOLD_S, MAX_HOLD_S, Objective, Task, TaskKind
from planning.request import EndAction

_OBJECTIVES = {objective.value: objective for objective in Objective if objective is not Objective.ENERGY}  # which needs batteries
_END_ACTIONS = {action.value: action for action in EndAction if action is not EndAction.BASE}  # which needs the organisation's bases
_TASK_KINDS = {kind.value: kind for kind in TaskKind}
_BODY = frozenset({"uavs", "targets", "objective", "return_to_start"})
_UAV = frozenset({"name", "position", "max_range_m", "cruise_speed_mps", "end_action"})
_TARGET = frozenset({"asset", "position", "task"})
_TASK = frozenset({"kind", "hold_s"})


class _NotPlain(Exception):
    """Something that this reader leaves to the serializer."""


def plain_request(body: Any) -> PlanRequest | None:
    """The request for UAVs by name and position, and targets that are whole assets or positions; None where the serializer must look."""
    try:
        return _request(body)
    except _NotPlain:
        return None


def _request(body: Any) -> PlanRequest:
    _known(body, _BODY)
    uavs, targets = body.get("uavs"), body.get("targets")
    rules = settings.ROUTING_RULES
    if not (type(uavs) is list and type(targets) is list and 0 < len(uavs) <= rules.max_uavs and 0 < len(targets) <= rules.max_targets):
        raise _NotPlain
    return_to_start = body.get("return_to_start", False)
    if type(return_to_start) is not bool:
        raise _NotPlain
    return PlanRequest(
        uavs=tuple(_uav(uav) for uav in uavs),
        targets=tuple(_target(target) for target in targets),
        objective=_one_of(_OBJECTIVES, body.get("objective", Objective.TOTAL.value)),
        return_to_start=return_to_start,
    )


def _uav(value: Any) -> UavRequest:
    _known(value, _UAV)
    name = value.get("name")
    if (
        type(name) is not str
        or not name
        or len(name) > MAX_UAV_NAME_LENGTH
        or not name.isascii()
        or not name.isprintable()
        or name != name.strip()
    ):
        raise _NotPlain
    range_m = value.get("max_range_m")
    return UavRequest(
        name=name,
        position=_position(value.get("position")),
        max_range_m=None if range_m is None else _above_zero(range_m, MAX_RANGE_M),
        cruise_speed_mps=_above_zero(value.get("cruise_speed_mps", settings.FLIGHT_RULES.cruise_speed_mps), MAX_SPEED_MPS),
        end_action=_one_of(_END_ACTIONS, value.get("end_action", EndAction.HOVER.value)),
    )


def _target(value: Any) -> TargetRequest:
    _known(value, _TARGET)
    asset, position, task = value.get("asset"), value.get("position"), value.get("task")
    if asset is None:
        at = _position(position)
    elif type(asset) is int and 1 <= asset <= MAX_KEY and position is None:
        at = None
    else:
        raise _NotPlain
    return TargetRequest(asset=asset, position=at, task=None if task is None else _task(task))


def _task(value: Any) -> Task:
    _known(value, _TASK)
    kind = _one_of(_TASK_KINDS, value.get("kind"))
    hold_s = value.get("hold_s", DEFAULT_HOLD_S[kind])
    if type(hold_s) not in (int, float) or not 0 <= hold_s <= MAX_HOLD_S:
        raise _NotPlain
    return Task(kind, float(hold_s))


def _known(value: Any, fields: frozenset[str]) -> None:
    if type(value) is not dict or not fields.issuperset(value):
        raise _NotPlain


def _position(value: Any) -> LonLat:
    if type(value) is not list or len(value) != 2:
        raise _NotPlain
    lon, lat = value
    if type(lon) not in (int, float) or type(lat) not in (int, float) or not (-180 <= lon <= 180 and -90 <= lat <= 90):
        raise _NotPlain
    return LonLat(float(lon), float(lat))


def _above_zero(value: Any, most: float) -> float:
    if type(value) not in (int, float) or not (0 < value <= most) or not math.isfinite(value):
        raise _NotPlain
    return float(value)


def _one_of(known: dict[str, Any], value: Any) -> Any:
    if type(value) is not str or value not in known:
        raise _NotPlain
    return known[value]
