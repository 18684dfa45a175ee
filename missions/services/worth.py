"""What one finished plan is worth beside another for the same request."""

from collections.abc import Sequence
from dataclasses import dataclass

from missions.routing.problem import Objective, Priority
from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.requests import PlanRequest


@dataclass(frozen=True, order=True)
class Worth:
    """Less is better: targets left out, the high priorities first; then what the objective counts, in its own unit.

    Ways away from infrastructure count as they do in the choice of ways: a short cut across country is not the better plan.
    """

    left_out: tuple[int, ...]
    value: float


def worth_of(request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute]) -> Worth:
    left_out = [request.targets[item.target].priority for item in found.left_out]
    by_priority = tuple(sum(priority is level for priority in left_out) for level in sorted(Priority, reverse=True))
    values = [_value(request.objective, route) * weight for route, weight in zip(routes, found.weights(request), strict=True)]
    return Worth(by_priority, max(values, default=0.0) if request.objective is Objective.MAKESPAN else sum(values))


def _value(objective: Objective, route: PlannedRoute) -> float:
    if objective is Objective.TOTAL:
        return route.length_m
    if objective is Objective.MAKESPAN:
        return route.departs_s + route.duration_s
    return route.duration_s
