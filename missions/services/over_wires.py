"""Routes that would have to be flown over what they cannot be flown over, and what becomes of them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from django.conf import settings

from inspection.geodesy import distance_m
from inspection.graph.network import Network
from inspection.graph.spans import BESIDE_M, spans_of
from inspection.graph.walls import index_of_walls, walls_along
from inspection.graph.zone_index import ZoneIndex
from missions.flight_plan.heights import GroundHeights
from missions.flight_plan.tall_clearance import spans_too_near
from missions.routing.problem import Reason
from missions.services.attempts import Attempt
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import LeftOut
from missions.services.requests import PlanRequest

NO_PATH = Reason.NO_PATH.value
FREE_AT_ENDS_M = 2.0 * BESIDE_M  # the towers at the ends of a wire that hangs too high between them can be flown to


def spans_in_the_way(routes: Sequence[PlannedRoute], network: Network, ground: GroundHeights | None) -> dict[int, frozenset[int]]:
    """Of the UAVs by their numbers whose routes may not be flown so: spans that they would have to pass too high, or pass too near."""
    spans, found = spans_of(network), {}
    for number, route in enumerate(routes):
        if route.waypoints is None:
            continue
        barring = {*route.blocked_by, *spans_too_near(route.waypoints, spans, None if route.is_flat else ground, settings.FLIGHT_RULES)}
        if barring:
            found[number] = frozenset(barring)
    return found


def walls_of_spans(network: Network, numbers: Collection[int]) -> ZoneIndex:
    """Around wires but for their ends; around all of what is too short for that."""
    spans, rows = spans_of(network), np.array(sorted(numbers), dtype=np.int64)
    start, end = spans.start[rows], spans.end[rows]
    length_m = np.maximum(distance_m(start, end), 1e-3)
    cut = np.where(length_m > 3.0 * FREE_AT_ENDS_M, FREE_AT_ENDS_M / length_m, 0.0)[:, None]
    is_round = np.broadcast_to(cut == 0.0, (len(rows), 2))
    return index_of_walls(walls_along(start + cut * (end - start), end - cut * (end - start), is_round))


def targets_barred(
    found: Attempt, in_the_way: Collection[int], network: Network, ground: GroundHeights | None
) -> dict[int, frozenset[int]]:
    """Of these UAVs, by their numbers: targets to which, alone, there is no way but past what cannot be flown over."""
    barred = {}
    for uav in in_the_way:
        visits = [visit for order in found.solution.sorties[found.uavs.index(uav)] for visit in order]
        alone = [(visit, found.drawn_alone(uav, [visit], ground)) for visit in visits]
        barred[uav] = frozenset(
            found.drawing.places[found.problem.visits[visit].target].target
            for visit, route in alone
            if route is not None and spans_in_the_way([route], network, ground)
        )
    return {uav: targets for uav, targets in barred.items() if targets}


def told_of_wires(request: PlanRequest, left_out: Sequence[LeftOut], barred: Mapping[int, Collection[int]]) -> list[LeftOut]:
    """The reasons for what was kept from UAVs so, unless others lack the range for it."""
    names = {target: request.uavs[uav].name for uav, targets in barred.items() for target in targets}
    return [
        LeftOut(item.target, NO_PATH, barred_text(names[item.target]))
        if item.target in names and item.reason == Reason.BEYOND_ENERGY.value
        else item
        for item in left_out
    ]


def barred_text(uav: str) -> str:
    """Why a target is left out to which that UAV could fly but for wires."""
    return f"{uav} would have to pass a mast or wires that cannot be flown over."


def without_routes_barred(
    request: PlanRequest, found: Attempt, routes: Sequence[PlannedRoute], barred: Mapping[int, Collection[int]]
) -> tuple[Attempt, list[PlannedRoute]]:
    """The UAVs of these numbers stay on the ground, and what they would have done is left out."""
    left_out = [LeftOut(target, NO_PATH, barred_text(request.uavs[uav].name)) for uav in barred for target in routes[uav].targets]
    grounded = [PlannedRoute(end_action=request.end_action(number)) if number in barred else route for number, route in enumerate(routes)]
    return replace(found, left_out=[*found.left_out, *left_out]), grounded
