"""What keeps each other UAV of a request from a target that is left out, beside the one of which the reason speaks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum

import numpy as np

from operation.reasons import Reason
from planning.assignment.assignment import allowed_visits
from planning.assignment.candidate_plan import CandidatePlan
from planning.assignment.options import has_sensor
from planning.assignment.unassigned import LOCKED, WIND, in_calm
from planning.checks.least_shortfall import LeastShortfalls
from planning.plan import UnassignedTarget
from planning.problem import BoolArray, UnassignedReason
from planning.request import PlanRequest
from planning.solver.reach import least_needs, needed_range_m

NO_PATH = "no_path"  # the code of the reason that no UAV has a path


class UavLimit(StrEnum):
    """In the order in which they are listed; codes of reasons."""

    GROUNDED = "cannot_take_off"
    NO_SENSOR = "without_sensor"
    NO_PATH = "no_permitted_route"
    WIND = "wind_too_strong_for"
    RANGE = "range_too_short"
    BATTERY = "battery_too_small_of"
    WIRES = "wires_for"


_OWN_LIMIT = {UnassignedReason.NO_PATH.value: UavLimit.NO_PATH, WIND: UavLimit.WIND}
_EXPLAINED = {
    UnassignedReason.BEYOND_RANGE.value,
    UnassignedReason.BEYOND_ENERGY.value,
    UnassignedReason.MAX_TARGETS.value,
    UnassignedReason.NO_PATH.value,
    WIND,
}


def with_other_limits(found: CandidatePlan) -> list[UnassignedTarget]:
    """The targets left out, each with what keeps the other UAVs from it; a target that only one UAV may do has no others."""
    request = found.request
    if len(request.uavs) < 2:
        return list(found.left_out)
    locked = {target for lock in request.locks for target in lock.targets}
    asked = [
        item
        for item in found.left_out
        if item.reason in _EXPLAINED
        and (item.uavs or item.is_for(NO_PATH) or item.reason == WIND)
        and item.target not in locked
        and not request.targets[item.target].uav
        and not item.is_for(LOCKED.code)
    ]
    if not asked:
        return list(found.left_out)
    limits = _Limits(found, [item.target for item in asked])
    reported = {item.target: _reported(item, request, limits) for item in asked}
    return [reported.get(item.target, item) for item in found.left_out]


def _reported(item: UnassignedTarget, request: PlanRequest, limits: "_Limits") -> UnassignedTarget:
    of_kind: dict[UavLimit, list[str]] = {}
    for uav in range(len(request.uavs)):
        limit = None if uav in item.uavs else limits.of(uav, item.target)
        if limit is not None:
            of_kind.setdefault(limit, []).append(request.uavs[uav].name)
    own = None if item.uavs else of_kind.pop(_OWN_LIMIT[item.reason], None)
    if not of_kind:
        return item
    why = item.why
    if own is not None and item.is_for(NO_PATH):  # it is not so of every UAV
        why = (Reason("no_path_for_uavs", {"uavs": own}),)
    others = [Reason(limit.value, {"uavs": of_kind[limit]}) for limit in UavLimit if limit in of_kind]
    return replace(item, why=(*why, Reason("other_uavs", {"limits": others})))


class _Limits:
    """Of the UAVs of a request for some of its targets, on the ways of an attempt, whatever it keeps from them."""

    def __init__(self, found: CandidatePlan, targets: Sequence[int]) -> None:
        self.request, self.found = found.request, found
        self._lacks = LeastShortfalls(found)
        routed = found.drawing.targets
        self._free = replace(found.problem, allowed=allowed_visits(found.request, found.uavs, routed, found.problem.visits))
        of_number = found.problem.visits_of_target()
        self._visits: Mapping[int, list[int]] = {
            one.target: of_number[number] for number, one in enumerate(routed) if one.target in targets
        }
        visits = [visit for own in self._visits.values() for visit in own]
        self._needed_m, self._used_wh = least_needs(self._free, needed_range_m(self._free), visits)
        self._in_calm: BoolArray | None = None

    def of(self, uav: int, target: int) -> UavLimit | None:
        """None where it could do the target alone."""
        return next(self._limits(uav, target), None)

    def _limits(self, uav: int, target: int) -> Iterator[UavLimit]:
        if uav in self.found.grounded:
            yield UavLimit.GROUNDED
        elif not has_sensor(self.request.uavs[uav], self.request.targets[target].sensor):
            yield UavLimit.NO_SENSOR
        if uav not in self.found.uavs or target not in self._visits:
            return
        start, visits = self.found.uavs.index(uav), self._visits[target]
        limits, needed_m = self.found.problem.uavs[start], self._needed_m[start, visits]
        if not np.isfinite(needed_m).any():
            yield UavLimit.WIND if self._is_in_reach_in_calm(start, visits) else UavLimit.NO_PATH
        within = needed_m <= limits.limit_m
        if not within.any():
            yield UavLimit.RANGE
        usable_wh = self.request.uavs[uav].performance.usable_wh
        if self._used_wh is not None and usable_wh is not None and not (self._used_wh[start, visits][within] <= limits.limit_wh).any():
            yield UavLimit.BATTERY
        allowed = self.found.problem.allowed
        if allowed is not None and not allowed[start, visits].any():  # kept from it, as its route was drawn
            shortfall = self._lacks.of_battery(target, only=uav)
            if (target, uav) in self._lacks.barred and shortfall is None:
                yield UavLimit.WIRES
            if shortfall is not None and shortfall.missing > 0.0:
                yield UavLimit.BATTERY

    def _is_in_reach_in_calm(self, start: int, visits: Sequence[int]) -> bool:
        if self._free.seconds is None:
            return False
        if self._in_calm is None:
            self._in_calm = np.isfinite(needed_range_m(in_calm(self._free)))
        return bool(self._in_calm[start, visits].any())
