"""Whether finished routes keep to their batteries."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from missions.flight_plan.sorties import wh_of_sorties
from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import LeftOut
from missions.services.requests import PlanRequest

NO_CHARGING = 1e-3  # off what may be used: the search then does without charging


def battery_overruns(request: PlanRequest, routes: Sequence[PlannedRoute]) -> dict[int, float]:
    """Of routes with a flight that takes more than their UAV may use, by its number: the share of what it takes that is too much."""
    found = {}
    for number, route in enumerate(routes):
        usable_wh = request.uavs[number].performance.usable_wh
        if route.lacks_wh > 0.0:
            found[number] = NO_CHARGING
            continue
        if route.charging:
            continue
        most_wh = max(wh_of_sorties(route.timing), default=0.0) if route.timing is not None else 0.0
        if usable_wh is not None and most_wh > usable_wh:
            found[number] = 1.0 - usable_wh / most_wh
    return found


def without_overruns(
    request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute], over: Collection[int]
) -> tuple[Attempt, list[PlannedRoute]]:
    """The UAVs of these numbers stay on the ground, and what they would have done is left out."""
    left_out = [
        LeftOut(target, "beyond_energy", f"Over these hills the battery of {request.uavs[uav].name} does not last for it.")
        for uav in over
        for target in routes[uav].targets
    ]
    grounded = [PlannedRoute(end_action=request.end_action(number)) if number in over else route for number, route in enumerate(routes)]
    return replace(found, left_out=[*found.left_out, *left_out]), grounded
