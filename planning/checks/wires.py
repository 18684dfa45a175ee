"""Routes that would have to be flown over what they cannot be flown over, and what becomes of them."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from inspection.network.build.network import Network
from inspection.network.build.obstacles import obstacle_index_of, obstacles_along
from inspection.network.spans import BESIDE_M, NO_BRIDGE, spans_of
from inspection.network.zones.zone_index import ZoneIndex
from operation.reasons import Reason
from planning.assignment.candidate_plan import CandidatePlan
from planning.clearance.obstacle_clearance import spans_too_near
from planning.context import PlanningContext
from planning.plan import PlannedRoute, UnassignedTarget
from planning.problem import UnassignedReason
from planning.rules import FlightRules
from planning.trajectory.heights import GroundHeights
from planning.trajectory.waypoints import FloatArray

NO_PATH = UnassignedReason.NO_PATH.value
FREE_AT_ENDS_M = 2.0 * BESIDE_M  # the towers at the ends of a wire that hangs too high between them can be flown to


def spans_in_the_way(
    routes: Sequence[PlannedRoute], network: Network, heights_m: GroundHeights | None, rules: FlightRules
) -> dict[int, frozenset[int]]:
    """Of the UAVs by their numbers whose routes may not be flown so: spans that they would have to pass too high, or pass too near."""
    spans, found = spans_of(network), {}
    for number, route in enumerate(routes):
        if route.waypoints is None:
            continue
        barring = {*route.blocked_by, *spans_too_near(route.waypoints, spans, None if route.is_flat else heights_m, rules)}
        if barring:
            found[number] = frozenset(barring)
    return found


def barring_spans(routes: Sequence[PlannedRoute], context: PlanningContext) -> dict[int, frozenset[int]]:
    """The same on the map of a plan."""
    return spans_in_the_way(routes, context.network, context.heights_m, context.rules.flight)


def walls_of_spans(network: Network, numbers: Collection[int], closed: Collection[int], terminals: Sequence[LonLat]) -> ZoneIndex:
    """Around wires but for their ends; around all of what is too short for that, of `closed` but for ends at a terminal, and of bridges."""
    spans = spans_of(network)
    barring = np.array(sorted(numbers), dtype=np.int64)
    on_same_bridge = np.isin(spans.bridge, spans.bridge[barring]) & (spans.bridge != NO_BRIDGE)
    rows = np.union1d(barring, np.flatnonzero(on_same_bridge))
    start, end = spans.start[rows], spans.end[rows]
    length_m = np.maximum(distance_m(start, end), 1e-3)
    has_free_ends = (length_m > 3.0 * FREE_AT_ENDS_M) & (spans.bridge[rows] == NO_BRIDGE)
    cut = np.where(has_free_ends, FREE_AT_ENDS_M / length_m, 0.0)[:, None].repeat(2, axis=1)
    is_closed = np.isin(rows, sorted(closed))
    for side, place in enumerate((start, end)):
        cut[is_closed & ~_near_any(place, np.array(terminals)), side] = 0.0
    obstacles = obstacles_along(start + cut[:, :1] * (end - start), end - cut[:, 1:] * (end - start), cut == 0.0)
    return obstacle_index_of(obstacles)


def _near_any(places: FloatArray, terminals: FloatArray) -> NDArray[np.bool_]:
    """(k,): whether a terminal, (n, 2), is within FREE_AT_ENDS_M of each place, (k, 2)."""
    away_m = distance_m(places.repeat(len(terminals), axis=0), np.tile(terminals, (len(places), 1)))
    return np.asarray((away_m.reshape(len(places), -1) <= FREE_AT_ENDS_M).any(axis=1))


def targets_barred(found: CandidatePlan, in_the_way: Collection[int]) -> dict[int, frozenset[int]]:
    """Of these UAVs, by their numbers: targets to which, alone, there is no way but past what cannot be flown over."""

    def barred(uav: int, order: Sequence[int]) -> list[int]:
        return [visit for visit in order if _is_barred(found, uav, [visit])]

    return _targets_of(found, in_the_way, barred)


def targets_barred_after_others(found: CandidatePlan, in_the_way: Collection[int]) -> dict[int, frozenset[int]]:
    """Of these UAVs: targets to which there is no other way than that from those before them on the flight, without what is barred so."""

    def barred(uav: int, order: Sequence[int]) -> list[int]:
        kept: list[int] = []
        for visit in order:
            if not _is_barred(found, uav, [*kept, visit]):
                kept.append(visit)
        return [visit for visit in order if visit not in kept]

    return _targets_of(found, in_the_way, barred)


def _targets_of(
    found: CandidatePlan, uavs: Collection[int], barred: Callable[[int, Sequence[int]], list[int]]
) -> dict[int, frozenset[int]]:
    visits = {uav: [visit for order in found.solution.sorties[found.uavs.index(uav)] for visit in barred(uav, order)] for uav in uavs}
    target_of = {visit: found.drawing.targets[found.problem.visits[visit].target].target for own in visits.values() for visit in own}
    return {uav: frozenset(target_of[visit] for visit in own) for uav, own in visits.items() if own}


def _is_barred(found: CandidatePlan, uav: int, order: Sequence[int]) -> bool:
    route = found.drawn_alone(uav, order)
    return route is not None and bool(barring_spans([route], found.airspace.context))


def with_wires(left_out: Sequence[UnassignedTarget], why: Mapping[int, tuple[int, Reason]]) -> list[UnassignedTarget]:
    """With the reasons for what was kept from UAVs, by their numbers, for wires, unless others lack the range for it."""
    return [
        UnassignedTarget(item.target, NO_PATH, (why[item.target][1],), uavs=(why[item.target][0],))
        if item.target in why and item.reason == UnassignedReason.BEYOND_ENERGY.value
        else item
        for item in left_out
    ]


def wires_in_the_way(uav: str) -> Reason:
    """Why a target is left out to which that UAV could fly but for wires."""
    return Reason("wires_in_the_way", {"uav": uav})


def wires_after_others(uav: str) -> Reason:
    """The same where the UAV could fly to it alone."""
    return Reason("wires_after_others", {"uav": uav})


def without_routes_barred(
    found: CandidatePlan, routes: Sequence[PlannedRoute], barred: Mapping[int, Collection[int]]
) -> tuple[CandidatePlan, list[PlannedRoute]]:
    """The UAVs of these numbers stay on the ground, and what they would have done is left out."""
    request = found.request
    left_out = [
        UnassignedTarget(target, NO_PATH, (wires_in_the_way(request.uavs[uav].name),), uavs=(uav,))
        for uav in barred
        for target in routes[uav].targets
    ]
    grounded = [PlannedRoute(end_action=request.end_action(number)) if number in barred else route for number, route in enumerate(routes)]
    return replace(found, left_out=[*found.left_out, *left_out]), grounded
