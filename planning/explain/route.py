"""Why a UAV flies its route: how far it is straight, what keeping to the lines and going round zones costs, and what another would fly."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from inspection.geodesy import LonLat, distance_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.zones.zone_index import ZoneIndex
from operation.reasons import Reason
from planning.airspace import Airspace, airspace_on, zone_at
from planning.assignment.refusals import target_height_m
from planning.assignment.routing_input import RoutingInput, costs_of_flying, visits_of_targets
from planning.connection_points import TargetPaths, Terminal, paths_between
from planning.context import ResolvedTarget
from planning.energy.assignment_costs import FlightCosts
from planning.problem import Objective, Resources
from planning.request import CALM, EndAction, InvalidRequest, PlanRequest
from planning.trajectory.heights import inspection_agl_m

NEARLY = 0.9  # of a limit: no other target fits
NOTICEABLE = 1.05  # times as long as in calm air
MAX_VISITS = 150  # beyond, only the route itself is looked at, not what others would fly instead
BOX_MARGIN_DEG = 0.03  # about 3 km: the way that a zone bars is looked for so far around the route
MIN_DETOUR_M = 20.0


def what_binds(
    request: PlanRequest,
    airspace: Airspace,
    targets: Sequence[ResolvedTarget],
    ways: TargetPaths,
    orders: Mapping[int, Sequence[int]],
    uav: int,
    *,
    length_m: float,
    is_round_zones: bool,
) -> dict[str, Any]:
    """orders: the visits of each UAV of the request that flies, by its number; uav is the one that is asked about."""
    flying = [number for number, asked in enumerate(request.uavs) if zone_at(asked.position, airspace) is None]
    costs = _costs(request, airspace, targets, ways, flying)
    seconds_s = {number: _of_route(costs, "seconds", flying.index(number), order) for number, order in orders.items() if number in flying}
    calm = replace(request, conditions=replace(CALM, temperature_c=request.conditions.temperature_c))
    calm_s = _of_route(_costs(calm, airspace, targets, ways, flying), "seconds", flying.index(uav), orders[uav])
    asked = request.uavs[uav]
    usable_wh = asked.performance.usable_wh
    used_wh = None if usable_wh is None else _of_route(costs, "wh", flying.index(uav), orders[uav])
    binds = {
        "battery": usable_wh is not None and used_wh is not None and used_wh >= NEARLY * usable_wh * asked.sorties,
        "range": asked.max_range_m is not None and length_m >= NEARLY * asked.max_range_m * asked.sorties,
        "most_targets": asked.most_targets is not None and len(orders[uav]) >= asked.most_targets,
        "zone": is_round_zones,
        "wind": seconds_s[uav] >= NOTICEABLE * calm_s,
        "balance": request.objective is Objective.MAKESPAN and len(seconds_s) > 1 and seconds_s[uav] < max(seconds_s.values()),
    }
    return {
        "used_wh": used_wh,
        "usable_wh": None if usable_wh is None else usable_wh * asked.sorties,
        "flown_s": seconds_s[uav],
        "wind_s": seconds_s[uav] - calm_s,
        "binds": [what for what, is_so in binds.items() if is_so],
    }


def _costs(
    request: PlanRequest, airspace: Airspace, targets: Sequence[ResolvedTarget], ways: TargetPaths, flying: Sequence[int]
) -> FlightCosts:
    visits, courses = visits_of_targets(targets)
    agl_m = [inspection_agl_m(target_height_m(target, airspace), airspace.flight) for target in targets]
    bases = [base for base in request.bases if zone_at(base.position, airspace) is None]
    return costs_of_flying(RoutingInput(request, airspace, targets, agl_m, visits, courses, ways, bases), flying)


def _of_route(costs: FlightCosts, quantity: str, number: int, order: Sequence[int]) -> float:
    resources = Resources(**vars(getattr(costs, quantity)))
    return float(resources.of_route(number, costs.class_of[number], order))


@dataclass(frozen=True)
class _Field:
    """The ways of a plan again: visits as the planner numbers them, and the targets that they do."""

    targets: list[ResolvedTarget]
    ways: TargetPaths
    courses: list[tuple[LonLat, ...]]
    along_m: list[float]
    visits_of: dict[int, list[int]]  # by the request's number of the target
    uav_of: dict[int, int]  # from the request's number of the UAV to that of the ways
    bases: list[LonLat]


def explain_route(airspace: Airspace, request: PlanRequest, routes: Sequence[Sequence[int]], uav: int) -> dict[str, Any]:
    """Return what the route of a UAV is made up of, in the shape of the API.

    routes: for each UAV of the request its targets in order. Raises InvalidRequest.
    """
    if not routes[uav]:
        raise InvalidRequest({"uav": Reason("uav_flies_no_route")})
    wanted = {target for route in routes for target in route} if sum(map(len, routes)) <= MAX_VISITS else set(routes[uav])
    field = _field(request, wanted, airspace, airspace.graph, airspace.leg_zones)
    order = _best_order(request, field, uav, routes[uav])
    legs_m = _legs_m(request, field, uav, order)
    along_m = sum(field.along_m[visit] for visit in order)
    length_m = sum(legs_m) + along_m
    if not np.isfinite(length_m):
        raise InvalidRequest({"routes": Reason("target_unreachable")})
    straight_m = _straight_m(request, field, uav, order)
    end = _end(request, field, uav, order[-1])
    detours = _detours(request, airspace, uav, routes[uav], legs_m, [] if end is None else [end[0]])
    round_zones_m = None if detours is None else sum(extra_m for extra_m, _ in detours)
    return {
        "uav": uav,
        "length_m": length_m,
        "straight_m": sum(straight_m) + along_m,
        "on_lines_m": max(0.0, length_m - sum(straight_m) - along_m - (round_zones_m or 0.0)),
        "round_zones_m": round_zones_m,
        "zones": _zones_met(detours or []),
        "heaviest": _heaviest(request, field, uav, order, legs_m),
        "alternative": _alternative(request, field, routes, uav, order) if len(wanted) == sum(map(len, routes)) else None,
        **what_binds(
            request,
            airspace,
            field.targets,
            field.ways,
            _orders(request, field, routes, uav, order),
            uav,
            length_m=length_m,
            is_round_zones=bool(round_zones_m),
        ),
    }


def _orders(
    request: PlanRequest, field: _Field, routes: Sequence[Sequence[int]], uav: int, order: Sequence[int]
) -> dict[int, Sequence[int]]:
    """The visits of each UAV whose targets are all looked at."""
    others = {
        other: _best_order(request, field, other, targets)
        for other, targets in enumerate(routes)
        if targets and other != uav and other in field.uav_of and all(target in field.visits_of for target in targets)
    }
    return {uav: order} | others


def _field(request: PlanRequest, wanted: set[int], airspace: Airspace, graph: InspectionGraph, zones: ZoneIndex) -> _Field:
    targets = [target for target in airspace.context.targets if target.target in wanted]
    visits, courses = visits_of_targets(targets)
    bases = [base.position for base in request.bases if zone_at(base.position, airspace) is None]
    flying = [number for number, asked in enumerate(request.uavs) if zone_at(asked.position, airspace) is None]
    ways = paths_between(
        graph,
        zones,
        starts=[Terminal(request.uavs[number].position) for number in flying],
        entries=[Terminal(course[0], targets[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        exits=[Terminal(course[-1], targets[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        rules=airspace.access,
        bases=[Terminal(base) for base in bases],
        homes=[Terminal(request.uavs[number].returns_to) for number in flying],
    )
    visits_of: dict[int, list[int]] = {}
    for number, visit in enumerate(visits):
        visits_of.setdefault(targets[visit.target].target, []).append(number)
    return _Field(
        targets, ways, courses, [visit.length_m for visit in visits], visits_of, {uav: place for place, uav in enumerate(flying)}, bases
    )


def _best_order(request: PlanRequest, field: _Field, uav: int, targets: Sequence[int]) -> list[int]:
    """The visits that do the targets in this order with the fewest metres: a stretch can be flown from either end."""
    start = _start(field, uav)
    if any(target not in field.visits_of for target in targets):
        raise InvalidRequest({"routes": Reason("target_deleted")})
    best = {visit: (float(field.ways.from_start_m[start, visit]), [visit]) for visit in field.visits_of[targets[0]]}
    for target in targets[1:]:
        best = {
            visit: min((metres + float(field.ways.between_m[last, visit]), [*order, visit]) for last, (metres, order) in best.items())
            for visit in field.visits_of[target]
        }
    end_m = _end_m(request, field, uav)
    return min((metres + (0.0 if end_m is None else float(end_m[last])), order) for last, (metres, order) in best.items())[1]


def _start(field: _Field, uav: int) -> int:
    if uav not in field.uav_of:
        raise InvalidRequest({"uav": Reason("uav_now_inside_zone")})
    return field.uav_of[uav]


def _end_m(request: PlanRequest, field: _Field, uav: int) -> np.ndarray | None:
    """Metres from the end of each visit to where the UAV's route ends; None if it ends over its last target."""
    action = request.end_action(uav)
    if action is EndAction.RETURN:
        return field.ways.to_start_m[:, _start(field, uav)]
    return field.ways.to_base_m if action is EndAction.BASE else None


def _end(request: PlanRequest, field: _Field, uav: int, last: int) -> tuple[LonLat, np.ndarray] | None:
    """Where the route ends and the nodes on the way there from its last visit; None if it ends over its last target."""
    action = request.end_action(uav)
    if action is EndAction.RETURN:
        return request.uavs[uav].position, field.ways.home(last, _start(field, uav))
    return (field.bases[field.ways.nearest_base[last]], field.ways.to_base(last)) if action is EndAction.BASE else None


def _legs_m(request: PlanRequest, field: _Field, uav: int, order: Sequence[int]) -> list[float]:
    """Metres of each leg without the stretches: to each visit, and on to where the route ends."""
    start = _start(field, uav)
    legs_m = [float(field.ways.from_start_m[start, order[0]])]
    legs_m += [float(field.ways.between_m[left, right]) for left, right in pairwise(order)]
    end_m = _end_m(request, field, uav)
    return legs_m if end_m is None else [*legs_m, float(end_m[order[-1]])]


def _straight_m(request: PlanRequest, field: _Field, uav: int, order: Sequence[int]) -> list[float]:
    end = _end(request, field, uav, order[-1])
    froms = [request.uavs[uav].position, *(field.courses[visit][-1] for visit in order)]
    tos = [*(field.courses[visit][0] for visit in order), *([] if end is None else [end[0]])]
    legs_m: list[float] = distance_m(np.array(froms[: len(tos)]), np.array(tos)).tolist()
    return legs_m


def _detours(
    request: PlanRequest, airspace: Airspace, uav: int, targets: Sequence[int], legs_m: Sequence[float], ends: Sequence[LonLat]
) -> list[tuple[float, list[tuple[int, str]]]] | None:
    """For each leg the metres that zones cost it, and the zones that bar its shorter way; None where that cannot be worked out."""
    positions = [
        request.uavs[uav].position,
        *ends,
        *(at for target in airspace.context.targets if target.target in targets for at in target.course),
    ]
    (west, south), (east, north) = np.min(positions, axis=0) - BOX_MARGIN_DEG, np.max(positions, axis=0) + BOX_MARGIN_DEG
    if not shapely.intersects(airspace.zones.polygons, shapely.box(west, south, east, north)).any():
        return [(0.0, []) for _ in legs_m]
    no_zones = np.zeros(len(airspace.context.zones), dtype=bool)
    free = airspace_on(airspace.context, no_zones, is_by_length=airspace.is_by_length)
    graph = free.graph
    own = replace(request, uavs=(request.uavs[uav],), locks=())
    field = _field(own, set(targets), airspace, graph, free.leg_zones)
    order = _best_order(own, field, 0, targets)
    free_m = _legs_m(own, field, 0, order)
    if not np.isfinite(sum(free_m)):
        return None
    froms = [request.uavs[uav].position, *(field.courses[visit][-1] for visit in order)]
    tos = [field.courses[visit][0] for visit in order]
    nodes = [field.ways.out(0, order[0]), *(field.ways.onward(left, right) for left, right in pairwise(order))]
    end = _end(own, field, 0, order[-1])
    if end is not None:
        tos.append(end[0])
        nodes.append(end[1])
    found: list[tuple[float, list[tuple[int, str]]]] = []
    for flown_m, least_m, left, right, passed in zip(legs_m, free_m, froms, tos, nodes, strict=False):
        extra_m = flown_m - least_m
        if not (np.isfinite(extra_m) and extra_m >= MIN_DETOUR_M):
            found.append((0.0, []))
            continue
        line = np.concatenate([np.array([left]), graph.position[passed], np.array([right])])
        met = airspace.zones.meets(line[:-1], line[1:])
        barring = {airspace.zones.first_met(LonLat(*line[leg]), LonLat(*line[leg + 1])) for leg in np.flatnonzero(met).tolist()}
        found.append((extra_m, sorted(zone for zone in barring if zone is not None)))
    return found


def _zones_met(detours: Sequence[tuple[float, list[tuple[int, str]]]]) -> list[dict[str, Any]]:
    """Each zone once, with the legs' detours that it has a part in."""
    extra_m: dict[tuple[int, str], float] = {}
    for metres, zones in detours:
        for zone in zones:
            extra_m[zone] = extra_m.get(zone, 0.0) + metres / len(zones)
    return [{"id": pk, "name": name, "extra_m": metres} for (pk, name), metres in sorted(extra_m.items(), key=lambda item: -item[1])]


def _heaviest(request: PlanRequest, field: _Field, uav: int, order: Sequence[int], legs_m: Sequence[float]) -> dict[str, Any] | None:
    """The target without which the others, in the same order, are the fewest metres."""
    if len(order) < 2:
        return None
    whole_m = sum(legs_m) + sum(field.along_m[visit] for visit in order)
    rests_m = []
    for number in range(len(order)):
        rest = [*order[:number], *order[number + 1 :]]
        rests_m.append(sum(_legs_m(request, field, uav, rest)) + sum(field.along_m[visit] for visit in rest))
    least = int(np.argmin(rests_m))
    return {"target": _target(field, order[least]), "saves_m": whole_m - rests_m[least]} if np.isfinite(rests_m[least]) else None


def _target(field: _Field, visit: int) -> int:
    return next(target for target, visits in field.visits_of.items() if visit in visits)


def _alternative(
    request: PlanRequest, field: _Field, routes: Sequence[Sequence[int]], uav: int, order: Sequence[int]
) -> dict[str, Any] | None:
    """The target of this route and the other UAV for which handing it over would cost the fewest metres in all."""
    own_m = _route_m(request, field, uav, order)
    best: dict[str, Any] | None = None
    for other in field.uav_of:
        if other == uav:
            continue
        theirs = _best_order(request, field, other, routes[other]) if routes[other] else []
        before_m = own_m + _route_m(request, field, other, theirs)
        for number, moved in enumerate(order):
            rest = [*order[:number], *order[number + 1 :]]
            target = _target(field, moved)
            with_m = min(
                _route_m(request, field, other, [*theirs[:place], visit, *theirs[place:]])
                for place in range(len(theirs) + 1)
                for visit in field.visits_of[target]
            )
            change_m = with_m + _route_m(request, field, uav, rest) - before_m
            if np.isfinite(change_m) and (best is None or change_m < best["total_change_m"]):
                limit_m = request.uavs[other].max_range_m
                best = {
                    "target": target,
                    "uav": other,
                    "other_length_m": with_m,
                    "total_change_m": change_m,
                    "max_range_m": limit_m,
                    "is_beyond_range": limit_m is not None and with_m > limit_m,
                }
    return best


def _route_m(request: PlanRequest, field: _Field, uav: int, order: Sequence[int]) -> float:
    return sum(_legs_m(request, field, uav, order)) + sum(field.along_m[visit] for visit in order) if order else 0.0
