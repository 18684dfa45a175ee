"""Whether finished routes keep to their batteries."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from missions.flight_plan.heights import GroundHeights
from missions.flight_plan.sorties import wh_of_sorties
from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import LeftOut
from missions.services.requests import PlanRequest
from missions.services.unreached import LOCKED

JUST_BELOW = 1e-3
MOST_TRIED = 40  # targets of a route that are left out of it one by one
BEYOND_ENERGY = "beyond_energy"


@dataclass(frozen=True)
class DrawnLack:
    """By how much a route takes more, as it is drawn, than the battery of its UAV may give."""

    uav: str
    missing_wh: float

    @property
    def message(self) -> str:
        drawn = "As drawn, over the ground and what stands tall, a route with it takes"
        return f"{drawn} {self.missing_wh:,.1f} Wh more than the battery of {self.uav} may give."


WITH_THAT_KEPT_BACK = (
    "Drawn over the ground and what stands tall, routes take more than is counted on the network;"
    " with that kept back no battery lasts for it."
)


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


def drawn_lacks(request: PlanRequest, routes: Sequence[PlannedRoute], over: Collection[int]) -> dict[int, DrawnLack]:
    """For each target of the routes that take more than their UAVs may use, what is missing."""
    lacks = {}
    for uav in over:
        route, usable_wh = routes[uav], request.uavs[uav].performance.usable_wh or 0.0
        missing_wh = route.lacks_wh or (max(wh_of_sorties(route.timing), default=0.0) if route.timing else 0.0) - usable_wh
        lacks |= dict.fromkeys(route.targets, DrawnLack(request.uavs[uav].name, missing_wh))
    return lacks


def with_drawn_reasons(left_out: Sequence[LeftOut], lacks: Mapping[int, DrawnLack], told_of: Collection[int]) -> list[LeftOut]:
    """Once the search counts on less of a battery than there is, its own figures are not what is missing: what was drawn says it.

    told_of: targets whose reason is known otherwise.
    """

    def told(one: LeftOut) -> LeftOut:
        if one.reason != BEYOND_ENERGY or one.target in told_of:
            return one
        lack = lacks.get(one.target)
        message = WITH_THAT_KEPT_BACK if lack is None else lack.message
        message += LOCKED if one.message.endswith(LOCKED) else ""
        return replace(one, message=message, missing_wh=None if lack is None else lack.missing_wh)

    return [told(one) for one in left_out]


def not_charged_for(
    request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute], ground: GroundHeights | None
) -> dict[int, frozenset[int]]:
    """Of UAVs for whose route no charging suffices, by their numbers: targets to be kept from them, by their places in the request.

    These are the targets that could not even be flown to alone. Where each could, it is the one without which charging suffices for the
    others: of several the least wanted, then the one that saves most. A UAV with locked targets is not in the answer.
    """
    barred = {}
    locked = {lock.uav for lock in request.locks}
    for number, route in enumerate(routes):
        if route.lacks_wh > 0.0 and request.uavs[number].name not in locked and len(route.targets) <= MOST_TRIED:
            barred[number] = _too_much_for(number, request, found, ground)
    return barred


def _too_much_for(uav: int, request: PlanRequest, found: Attempt, ground: GroundHeights | None) -> frozenset[int]:
    start = found.uavs.index(uav)
    (order,) = found.solution.sorties[start]

    def drawn(visits: Sequence[int]) -> PlannedRoute:
        alone = [[] if other != start else [visits] for other in range(len(found.uavs))]
        return found.drawing.routes(found.uavs, alone, ground)[uav]

    def has_way(visits: Sequence[int]) -> bool:
        """Some targets are come to from others only."""
        return math.isfinite(found.problem.route_length_m(start, visits))

    target_of = {visit: found.drawing.places[found.problem.visits[visit].target].target for visit in order}
    hopeless = frozenset(target_of[visit] for visit in order if has_way([visit]) and drawn([visit]).lacks_wh > 0.0)
    if hopeless:
        return hopeless
    rests = [(visit, [other for other in order if other != visit]) for visit in order]
    without = [(visit, drawn(rest)) for visit, rest in rests if has_way(rest)]
    if not without:
        return frozenset(target_of.values())

    def merit(one: tuple[int, PlannedRoute]) -> tuple[bool, int, float]:
        visit, rest = one
        rest_wh = 0.0 if rest.timing is None or rest.timing.total_wh is None else rest.timing.total_wh
        return rest.lacks_wh > 0.0, request.targets[target_of[visit]].priority, rest_wh

    return frozenset([target_of[min(without, key=merit)[0]]])


def without_overruns(
    request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute], over: Collection[int]
) -> tuple[Attempt, list[PlannedRoute]]:
    """The UAVs of these numbers stay on the ground, and what they would have done is left out."""
    left_out = [LeftOut(target, BEYOND_ENERGY, lack.message) for target, lack in drawn_lacks(request, routes, over).items()]
    grounded = [PlannedRoute(end_action=request.end_action(number)) if number in over else route for number, route in enumerate(routes)]
    return replace(found, left_out=[*found.left_out, *left_out]), grounded
