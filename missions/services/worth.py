"""What one finished plan is worth beside another for the same request."""

from collections.abc import Sequence
from dataclasses import dataclass

from missions.routing.problem import Objective, Priority
from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.requests import PlanRequest


@dataclass(frozen=True, order=True)
class Worth:
    """Less is better: targets left out, the high priorities first; then what the objective counts, in its own unit."""

    left_out: tuple[int, ...]
    value: float


def worth_of(request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute]) -> Worth:
    left_out = [request.targets[item.target].priority for item in found.left_out]
    by_priority = tuple(sum(priority is level for priority in left_out) for level in sorted(Priority, reverse=True))
    return Worth(by_priority, value_of(request.objective, routes))


def value_of(objective: Objective, routes: Sequence[PlannedRoute]) -> float:
    """Metres, seconds or watt-hours of finished routes."""
    if objective is Objective.MAKESPAN:
        return max((route.departs_s + route.duration_s for route in routes), default=0.0)
    return sum(route.length_m for route in routes)
