"""The route to one target alone for which a UAV lacks least of its battery, as it is drawn over the ground and what stands tall."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import permutations, product
from typing import NamedTuple

from planning.assignment.assignment import COUNTED_CLOSE
from planning.assignment.candidate_plan import CandidatePlan
from planning.assignment.options import may_do
from planning.checks.wires import barring_spans
from planning.plan import PlannedRoute
from planning.problem import RANGE_RESERVE
from planning.request import PlanRequest
from planning.solver.cheapest_route import LeastRoutes
from planning.solver.cost_matrices import NO_PATH_M, QuantityKind
from planning.trajectory.sorties import wh_of_sorties

IsClear = Callable[[PlannedRoute], bool]

MAX_DRAWN = 300  # routes of one plan
MAX_LISTED = 4  # targets of which each order is looked at


class RouteShortfall(NamedTuple):
    """missing: metres or Wh, below 0 for what is left; uav by its number in the request."""

    missing: float
    uav: int
    route: PlannedRoute


def shortfall_wh(request: PlanRequest, uav: int, route: PlannedRoute | None) -> float:
    """Wh by which a drawn route takes more than the battery of its UAV may give, below 0 what is left; inf where it cannot be flown."""
    usable_wh = request.uavs[uav].performance.usable_wh
    if route is None:
        return math.inf
    if usable_wh is None or route.timing is None:
        return -math.inf
    if route.charging or route.shortfall_wh > 0.0:
        return route.shortfall_wh
    return max(wh_of_sorties(route.timing), default=0.0) - usable_wh


class LeastShortfalls:
    """Of one attempt, whatever it keeps from UAVs. Other targets may lie on the way: a place between two networks can join them.

    is_clear: whether a drawn route keeps clear of all zones, where the attempt stands on fewer: a way that does not is none.
    """

    def __init__(self, found: CandidatePlan, is_clear: IsClear | None = None) -> None:
        self.request, self.found, self.is_clear = found.request, found, is_clear
        free = replace(found.problem, allowed=None)
        self._metres = LeastRoutes(free, QuantityKind.METRES)
        self._wh = self._metres if found.problem.wh is None else LeastRoutes(free, QuantityKind.WH)
        self._visits = found.problem.visits_of_target()
        self._number = {one.target: number for number, one in enumerate(found.drawing.targets)}
        self._drawn = 0
        self.barred: set[tuple[int, int]] = set()  # targets and UAVs: a way that was drawn passes what cannot be flown over

    def of_battery(self, target: int, only: int | None = None) -> RouteShortfall | None:
        """Of all UAVs, or one of them; None where there is no way, or MAX_DRAWN are drawn already."""
        best: RouteShortfall | None = None
        for counted_wh, uav, order in sorted(self._paths(target)):
            if best is not None and (counted_wh >= best.missing or best.missing <= 0.0):
                break
            if self._drawn >= MAX_DRAWN or only not in (None, uav):
                continue
            self._drawn += 1
            route = self.found.drawn_alone(uav, order)
            if route is not None and barring_spans([route], self.found.airspace.context):
                self.barred.add((target, uav))
                continue
            missing_wh = max(counted_wh, shortfall_wh(self.request, uav, route))  # who is refused by the one is not helped by the other
            if route is not None and (best is None or missing_wh < best.missing) and (self.is_clear is None or self.is_clear(route)):
                best = RouteShortfall(missing_wh, uav, route)
        return best

    def of_range(self, target: int) -> RouteShortfall | None:
        missing_m, uav, order = min(self._shortest(target), default=(0.0, -1, ()))
        route = self.found.drawn_alone(uav, order) if order else None
        if route is None or not (self.is_clear is None or self.is_clear(route)):
            return None
        return RouteShortfall(missing_m, uav, route)

    def _shortest(self, target: int) -> list[tuple[float, int, tuple[int, ...]]]:
        """For each UAV that may do it, by its number in the request, the visits of the shortest route, and the metres that it lacks."""
        ways = []
        for start, uav in enumerate(self.found.uavs):
            if may_do(self.request.uavs[uav], self.request.targets[target]):
                routes = [self._metres.route(start, visit) for visit in self._visits[self._number[target]]]
                ways += [(one.amount - self.found.problem.uavs[start].limit_m, uav, one.order) for one in routes if one.amount < math.inf]
        return ways

    def _paths(self, target: int) -> list[tuple[float, int, tuple[int, ...]]]:
        """For each UAV that has the range, by its number in the request, the visits of routes that may be the least; and what each is
        counted to lack.

        Of one that charges on the way no lack is counted, and it comes by others only where it has to; of one without a battery none is.
        """
        ways = []
        for start, uav in enumerate(self.found.uavs):
            asked = self.request.uavs[uav]
            if not may_do(asked, self.request.targets[target]):
                continue
            limit_m, usable_wh = self.found.problem.uavs[start].limit_m, asked.performance.usable_wh
            charges = self.request.may_charge(uav)
            for visit in self._visits[self._number[target]]:
                if usable_wh is None:
                    shortest = self._metres.route(start, visit)
                    ways += [(-math.inf, uav, shortest.order)] if shortest.amount <= min(limit_m, NO_PATH_M) else []
                    continue
                least = (routes.route(start, visit).order for routes in (self._wh, self._metres))
                orders = ((visit,), *least) if charges else (*least, *self._orders_of_few(visit))
                within = [order for order in dict.fromkeys(orders) if self._metres_of(start, order) <= min(limit_m, NO_PATH_M)]
                for order in within[:1] if charges else within:
                    counted_wh = self.found.problem.route_wh(start, order)
                    if counted_wh is not None and math.isfinite(counted_wh):
                        shortfall_wh = counted_wh / (1.0 - COUNTED_CLOSE - RANGE_RESERVE) - usable_wh
                        ways.append((-math.inf if charges else shortfall_wh, uav, order))
        return ways

    def _orders_of_few(self, visit: int) -> Iterator[tuple[int, ...]]:
        """Every order over the visit, where targets are few: what is counted least may, as it is drawn, take more than another."""
        own = self.found.problem.visits[visit].target
        others = [number for number in range(len(self._visits)) if number != own]
        if len(others) >= MAX_LISTED:
            return
        for count in range(len(others) + 1):
            for targets in permutations(others, count):
                for visits in product(*(self._visits[target] for target in targets)):
                    for place in range(count + 1):
                        yield (*visits[:place], visit, *visits[place:])

    def _metres_of(self, start: int, order: tuple[int, ...]) -> float:
        return self.found.problem.route_length_m(start, order)
