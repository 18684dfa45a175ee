"""Whether finished routes keep to their batteries."""

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

from missions.flight_plan.heights import GroundHeights
from missions.flight_plan.sorties import wh_of_sorties
from missions.services.attempts import Attempt
from missions.services.least_lacks import LeastLacks, lack_wh
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import LeftOut
from missions.services.requests import PlanRequest

JUST_BELOW = 1e-3
MOST_TRIED = 40  # targets of a route that are left out of it one by one
BEYOND_ENERGY = "beyond_energy"
KEPT_BACK = "As drawn, over the ground and what stands tall, all routes that were tried with it take more than the battery may give."


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


def not_lasting_for(
    request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute], over: Collection[int], ground: GroundHeights | None
) -> dict[int, frozenset[int]]:
    """Of UAVs whose route takes more than their battery gives, by their numbers: targets to be kept from them, by their places in the
    request.

    These are the targets that could not even be flown to alone. Where each could, and no charging suffices for the route, it is the one
    without which it does for the others: of several the least wanted, then the one that saves most; without charging there is none. A UAV
    with locked targets is not in the answer.
    """
    barred = {}
    locked = {lock.uav for lock in request.locks}
    for number in over:
        if request.uavs[number].name not in locked and len(routes[number].targets) <= MOST_TRIED:
            barred[number] = _too_much_for(number, request, found, ground, charges=routes[number].lacks_wh > 0.0)
    return {uav: targets for uav, targets in barred.items() if targets}


def _too_much_for(uav: int, request: PlanRequest, found: Attempt, ground: GroundHeights | None, *, charges: bool) -> frozenset[int]:
    start = found.uavs.index(uav)
    order = [visit for sortie in found.solution.sorties[start] for visit in sortie]

    def drawn(visits: Sequence[int]) -> PlannedRoute | None:
        return found.drawn_alone(uav, visits, ground)

    def has_way(visits: Sequence[int]) -> bool:
        """Some targets are come to from others only."""
        return math.isfinite(found.problem.route_length_m(start, visits))

    target_of = {visit: found.drawing.places[found.problem.visits[visit].target].target for visit in order}
    lacks = LeastLacks(request, found, ground)
    least = {target: lacks.of_battery(target, only=uav) for target in target_of.values()}
    hopeless = frozenset(target for target, lack in least.items() if lack is not None and lack.missing > 0.0)
    if hopeless or not charges:
        return hopeless
    rests = [(visit, [other for other in order if other != visit]) for visit in order]
    without = [(visit, drawn(rest)) for visit, rest in rests if has_way(rest)]
    if not without:
        return frozenset(target_of.values())

    def merit(one: tuple[int, PlannedRoute | None]) -> tuple[bool, int, float]:
        visit, rest = one
        rest_wh = 0.0 if rest is None or rest.timing is None or rest.timing.total_wh is None else rest.timing.total_wh
        return lack_wh(request, uav, rest) > 0.0, request.targets[target_of[visit]].priority, rest_wh

    return frozenset([target_of[min(without, key=merit)[0]]])


def without_overruns(
    request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute], over: Collection[int]
) -> tuple[Attempt, list[PlannedRoute]]:
    """The UAVs of these numbers stay on the ground, and what they would have done is left out."""
    left_out = [LeftOut(target, BEYOND_ENERGY, KEPT_BACK) for uav in over for target in routes[uav].targets]
    grounded = [PlannedRoute(end_action=request.end_action(number)) if number in over else route for number, route in enumerate(routes)]
    return replace(found, left_out=[*found.left_out, *left_out]), grounded
