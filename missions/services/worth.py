"""What one finished plan is worth beside another for the same request."""

from collections.abc import Sequence
from dataclasses import dataclass

from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.requests import PlanRequest
from planning.problem import Objective, Priority


@dataclass(frozen=True, order=True)
class Worth:
    """Less is better: targets left out, the high priorities first; then ways near infrastructure before the shortest; then the value.

    That is what the objective counts, in its own unit.

    Ways away from infrastructure count as they do in the choice of ways: a short cut across country is not the better plan.
    """

    left_out: tuple[int, ...]
    is_by_length: bool
    value: float


def worth_of(request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute]) -> Worth:
    left_out = [request.targets[item.target].priority for item in found.left_out]
    by_priority = tuple(sum(priority is level for priority in left_out) for level in sorted(Priority, reverse=True))
    return Worth(by_priority, found.scene.is_by_length, value_of(request.objective, routes, found.weights(request)))


def value_of(objective: Objective, routes: Sequence[PlannedRoute], weights: Sequence[float] | None = None) -> float:
    """Metres, seconds or Wh of finished routes, each times its weight; to finish soonest, what a route is put off by counts as well."""
    values = [_value(objective, route) for route in routes]
    if weights is not None:
        values = [value * weight for value, weight in zip(values, weights, strict=True)]
    return max(values, default=0.0) if objective is Objective.MAKESPAN else sum(values)


def _value(objective: Objective, route: PlannedRoute) -> float:
    if objective is Objective.TOTAL:
        return route.length_m
    if objective is Objective.MAKESPAN and route.waypoints is not None:
        return route.departs_s + route.duration_s
    if objective is Objective.ENERGY:
        return 0.0 if route.timing is None or route.timing.total_wh is None else route.timing.total_wh
    return route.duration_s
