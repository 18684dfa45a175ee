"""Whether finished routes keep to their batteries."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from operation.reasons import Reason
from planning.assignment.candidate_plan import CandidatePlan
from planning.checks.least_shortfall import LeastShortfalls, shortfall_wh
from planning.plan import PlannedRoute, UnassignedTarget
from planning.trajectory.sorties import wh_of_sorties

JUST_BELOW = 1e-3
LEFT = 0.999  # of a share: what is counted is rounded
MAX_TRIED = 40  # targets of a route that are left out of it one by one
BEYOND_ENERGY = "beyond_energy"
IN_EVERY_ROUTE = Reason("beyond_battery_in_every_route")


def battery_overruns(found: CandidatePlan, routes: Sequence[PlannedRoute]) -> dict[int, float]:
    """Of routes with a flight that takes more than their UAV may use, by its number: the share of that with which it is not chosen."""
    request, over = found.request, {}
    for number, route in enumerate(routes):
        usable_wh = request.uavs[number].performance.usable_wh
        if route.shortfall_wh > 0.0 and usable_wh is not None:
            over[number] = (1.0 - JUST_BELOW) * found.most_counted_wh(number) / usable_wh  # with charging this may be above 1
            continue
        most_wh = max(wh_of_sorties(route.timing), default=0.0) if route.timing is not None and not route.charging else 0.0
        if usable_wh is not None and most_wh > usable_wh:
            over[number] = (1.0 - JUST_BELOW) * min(1.0, found.most_counted_wh(number) / usable_wh)
    return over


def not_lasting_for(found: CandidatePlan, routes: Sequence[PlannedRoute], over: Mapping[int, float]) -> dict[int, frozenset[int]]:
    """Of UAVs whose route takes more than their battery gives, by their numbers: targets to be kept from them, by their places in the
    request.

    These are the targets that could not even be flown to alone. Where each could, it is the one without which the battery does for the
    others: of several the least wanted, then the one that saves most. It is none where counting on the share of the battery that `over`
    tells is enough; with that share, no target of the route may be out of reach, and no charging is counted. A UAV with locked targets is
    not in the answer.
    """
    request, barred = found.request, {}
    locked = {lock.uav for lock in request.locks}
    shortfalls = LeastShortfalls(found)
    for uav, share in over.items():
        if request.uavs[uav].name not in locked and len(routes[uav].targets) <= MAX_TRIED:
            barred[uav] = _too_much_for(uav, shortfalls, None if routes[uav].shortfall_wh > 0.0 else share)
    return {uav: targets for uav, targets in barred.items() if targets}


def _too_much_for(uav: int, shortfalls: LeastShortfalls, share: float | None) -> frozenset[int]:
    """share: None where it charges on the way."""
    found, request, start = shortfalls.found, shortfalls.request, shortfalls.found.uavs.index(uav)
    flights = found.solution.sorties[start]
    target_of = {visit: found.drawing.targets[found.problem.visits[visit].target].target for order in flights for visit in order}
    least = {target: shortfalls.of_battery(target, only=uav) for target in target_of.values()}
    hopeless = frozenset(target for target, shortfall in least.items() if shortfall is not None and shortfall.missing > 0.0)
    if hopeless or (share is not None and _is_enough(uav, found, share)):
        return hopeless

    def shortfall(visits: Sequence[int]) -> float:
        """Some targets are come to from others only."""
        has_path = math.isfinite(found.problem.route_length_m(start, visits))
        return shortfall_wh(request, uav, found.drawn_alone(uav, visits)) if has_path else math.inf

    order = max(flights, key=shortfall)
    most_wanted = max(request.targets[target_of[visit]].priority for visit in order)
    alike = all(request.targets[target_of[visit]].priority == most_wanted for visit in order)

    def merit(visit: int) -> tuple[bool, bool, bool, int, float]:
        rest = [other for other in order if other != visit]
        rest_wh = shortfall(rest) if rest else math.inf
        priority = request.targets[target_of[visit]].priority
        return math.isinf(rest_wh), not alike and priority == most_wanted, rest_wh > 0.0, priority, rest_wh

    return frozenset([target_of[min(order, key=merit)]])


def _is_enough(uav: int, found: CandidatePlan, share: float) -> bool:
    """Whether each target of its route is still in reach alone if the search counts on this share of its battery."""
    start, usable_wh = found.uavs.index(uav), found.request.uavs[uav].performance.usable_wh or 0.0
    flights = found.solution.sorties[start]
    return all((found.problem.route_wh(start, [visit]) or 0.0) < share * usable_wh * LEFT for order in flights for visit in order)


def without_overruns(
    found: CandidatePlan, routes: Sequence[PlannedRoute], over: Collection[int]
) -> tuple[CandidatePlan, list[PlannedRoute]]:
    """The UAVs of these numbers stay on the ground, and what they would have done is left out."""
    left_out = [UnassignedTarget(target, BEYOND_ENERGY, (IN_EVERY_ROUTE,), uavs=(uav,)) for uav in over for target in routes[uav].targets]
    grounded = [
        PlannedRoute(end_action=found.request.end_action(number)) if number in over else route for number, route in enumerate(routes)
    ]
    return replace(found, left_out=[*found.left_out, *left_out]), grounded
