"""How many Wh are missing for what no battery lasts for: as the best route to it alone is drawn, over the ground and what stands tall."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from missions.flight_plan.heights import GroundHeights
from missions.routing.least_route import LeastRoutes
from missions.routing.problem import End, Reason
from missions.routing.quantities import Kind
from missions.services.assignment import route_end
from missions.services.attempts import Attempt
from missions.services.battery import KEPT_BACK, lack_wh
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import LeftOut
from missions.services.requests import PlanRequest
from missions.services.unreached import LOCKED
from missions.services.wishes import may_do

MOST_DRAWN = 300  # routes of one plan: beyond that, what is counted on the network is told
ALONE = "It is within what the battery may give alone, but not within what is left after the other targets."
_THERE = {End.OPEN: "there", End.RETURN: "there and back", End.ANY_BASE: "there and on to the nearest base"}


def with_lacks(request: PlanRequest, found: Attempt, ground: GroundHeights | None) -> list[LeftOut]:
    """The targets left out, with the Wh that are missing for those for which no battery lasts. Locked runs keep their reasons."""
    told = list(found.left_out)
    rows = [row for row, item in enumerate(told) if item.reason == Reason.BEYOND_ENERGY.value and not item.message.endswith(LOCKED)]
    if rows and found.problem.wh is not None:
        lacks = _Lacks(request, found, ground)
        for row in rows:
            told[row] = lacks.told(told[row])
    return told


def least_missing(plan: Sequence[LeftOut], other: Sequence[LeftOut]) -> list[LeftOut]:
    """What another plan leaves out as out of reach, too, may lack less on its ways; who has the range on one way lacks the battery."""
    theirs = {item.target: item for item in other if item.missing is not None}

    def least(item: LeftOut) -> LeftOut:
        same = theirs.get(item.target)
        if same is None or item.missing is None:
            return item
        if item.reason != same.reason:
            return item if item.reason == Reason.BEYOND_ENERGY.value else same
        return item if item.missing <= same.missing else same

    return [least(item) for item in plan]


class _Lacks:
    """Of one attempt."""

    def __init__(self, request: PlanRequest, found: Attempt, ground: GroundHeights | None) -> None:
        self.request, self.found, self.ground = request, found, ground
        free = replace(found.problem, allowed=None)  # whatever was kept from a UAV while routes were looked for
        self._wh, self._metres = LeastRoutes(free, Kind.WH), LeastRoutes(free, Kind.METRES)
        self._visits = found.problem.visits_of_target()
        self._number = {place.target: number for number, place in enumerate(found.drawing.places)}
        self._drawn = 0

    def told(self, item: LeftOut) -> LeftOut:
        best: tuple[float, int, PlannedRoute] | None = None
        for counted_wh, uav, order in sorted(self._ways(item.target)):
            if (best is not None and counted_wh >= best[0]) or self._drawn >= MOST_DRAWN:
                break
            self._drawn += 1
            route = self.found.drawn_alone(uav, order, self.ground)
            missing_wh = lack_wh(self.request, uav, route)
            if route is not None and (best is None or missing_wh < best[0]):
                best = missing_wh, uav, route
        if best is None:
            return item
        if best[0] <= 0.0:
            return replace(item, message=item.message if item.message == KEPT_BACK else ALONE, missing=0.0)
        return replace(item, message=self._message(*best), missing=best[0])

    def _ways(self, target: int) -> list[tuple[float, int, tuple[int, ...]]]:
        """For each UAV that has the range, by its number in the request, the visits of the least route; and what it is counted to lack.

        Of one that charges on the way no lack is counted.
        """
        ways = []
        for start, uav in enumerate(self.found.uavs):
            asked = self.request.uavs[uav]
            if not may_do(asked, self.request.targets[target]):
                continue
            limit_m = self.found.problem.uavs[start].limit_m
            for visit in self._visits[self._number[target]]:
                for routes in (self._wh, self._metres):
                    order = routes.route(start, visit).order
                    if self._metres_of(start, order) <= limit_m:
                        break
                else:
                    continue
                counted_wh = self.found.problem.route_wh(start, order)
                if counted_wh is None or not np.isfinite(counted_wh):
                    continue
                charges = self.request.charging_w is not None and asked.sorties == 1
                usable_wh = asked.performance.usable_wh
                ways.append((-math.inf if charges or usable_wh is None else counted_wh - usable_wh, uav, order))
        return ways

    def _metres_of(self, start: int, order: tuple[int, ...]) -> float:
        return self.found.problem.route_length_m(start, order)

    def _message(self, missing_wh: float, uav: int, route: PlannedRoute) -> str:
        name = self.request.uavs[uav].name
        more = f"{missing_wh:,.1f} Wh more than the battery of {name} may give."
        if route.lacks_wh > 0.0:
            return f"However {name} charges on the way, it takes {more}"
        needed_wh = missing_wh + (self.request.uavs[uav].performance.usable_wh or 0.0)
        return (
            f"As drawn, over the ground and what stands tall, it takes {needed_wh:,.1f} Wh {_THERE[route_end(self.request, uav)]}, {more}"
        )
