"""Whether finished routes keep to their batteries."""

from collections.abc import Sequence

from missions.services.plan_json import PlannedRoute
from missions.services.requests import PlanRequest


def battery_overruns(request: PlanRequest, routes: Sequence[PlannedRoute]) -> dict[int, float]:
    """Of routes that take more than their UAV may use, by its number: the share of what they take that is too much."""
    found = {}
    for number, route in enumerate(routes):
        usable_wh = request.uavs[number].performance.usable_wh
        taken_wh = None if route.timing is None else route.timing.total_wh
        if usable_wh is not None and taken_wh is not None and taken_wh > usable_wh:
            found[number] = 1.0 - usable_wh / taken_wh
    return found
