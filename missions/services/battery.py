"""Whether finished routes keep to their batteries."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from missions.flight_plan.sorties import wh_of_sorties
from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import LeftOut
from missions.services.requests import PlanRequest

JUST_BELOW = 1e-3


def battery_overruns(request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute]) -> dict[int, float]:
    """Of routes with a flight that takes more than their UAV may use, by its number: the share of that with which it is not chosen."""
    over = {}
    for number, route in enumerate(routes):
        usable_wh = request.uavs[number].performance.usable_wh
        if route.lacks_wh > 0.0 and usable_wh is not None:
            over[number] = (1.0 - JUST_BELOW) * found.most_counted_wh(number) / usable_wh  # with charging this may be above 1
            continue
        most_wh = max(wh_of_sorties(route.timing), default=0.0) if route.timing is not None and not route.charging else 0.0
        if usable_wh is not None and most_wh > usable_wh:
            over[number] = (1.0 - JUST_BELOW) * min(1.0, found.most_counted_wh(number) / usable_wh)
    return over


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
