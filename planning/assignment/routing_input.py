"""A request in one airspace: its targets as visits, the paths between all of them, and what flying these takes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat, path_length_m
from planning.airspace import Airspace
from planning.connection_points import TargetPaths
from planning.context import ResolvedTarget
from planning.energy.assignment_costs import Finish, FlightCosts, FlownVisits, FlyingFleet, flight_costs
from planning.energy.path_cost import FlightClass, NodeGround
from planning.problem import Objective, Visit
from planning.request import BaseRequest, EndAction, PlanRequest

_COUNTED = {Objective.TIME, Objective.ENERGY}


@dataclass(frozen=True, eq=False)
class RoutingInput:
    """agl_m: the height above ground at which each target is inspected; visits are of the targets, by their numbers, with their courses."""

    request: PlanRequest
    airspace: Airspace
    targets: Sequence[ResolvedTarget]
    agl_m: Sequence[float]
    visits: Sequence[Visit]
    courses: Sequence[tuple[LonLat, ...]]
    ways: TargetPaths
    bases: Sequence[BaseRequest]


def visits_of_targets(
    targets: Sequence[ResolvedTarget], takes_s: Sequence[float] | None = None
) -> tuple[list[Visit], list[tuple[LonLat, ...]]]:
    """Return the visits with the course of each: one of a point, two of a stretch, which can be flown from either end.

    takes_s: as `target_s` tells, in the order of the targets.
    """
    visits, courses = [], []
    for number, target in enumerate(targets):
        service_s = 0.0 if takes_s is None else takes_s[number]
        length_m = path_length_m(np.array(target.course)) if target.is_stretch else 0.0
        if target.photos is not None:
            length_m = target.photos.length_m
        visits.append(Visit(number, is_reversed=False, length_m=length_m, service_s=service_s))
        courses.append(target.course)
        if target.is_stretch:
            visits.append(Visit(number, is_reversed=True, length_m=length_m, service_s=service_s))
            courses.append(tuple(reversed(target.course)))
    return visits, courses


def needs_flight_costs(request: PlanRequest) -> bool:
    """Whether wind, a battery, a limit of airspeed, an inspection speed or the objective make metres not enough to plan by."""
    return (
        not request.conditions.is_calm
        or request.objective in _COUNTED
        or any(target.task is not None and target.task.speed_mps is not None for target in request.targets)
        or any(uav.performance.battery_wh is not None or uav.performance.max_airspeed_mps is not None for uav in request.uavs)
    )


def costs_of_flying(routing: RoutingInput, uavs: Sequence[int]) -> FlightCosts:
    """Return seconds and watt-hours for the UAVs that fly, by their numbers in the request, and the visits."""
    request, airspace = routing.request, routing.airspace
    asked = [request.uavs[uav] for uav in uavs]
    starts, homes = [uav.position for uav in asked], [uav.returns_to for uav in asked]
    return flight_costs(
        airspace.graph,
        routing.ways,
        fleet=FlyingFleet(
            [FlightClass(uav.performance, uav.cruise_speed_mps) for uav in asked],
            [Finish(request.route_end(uav), request.end_action(uav) is not EndAction.HOVER) for uav in uavs],
            starts,
            homes,
        ),
        bases=[base.position for base in routing.bases],
        visits=FlownVisits(
            routing.courses,
            [routing.agl_m[visit.target] for visit in routing.visits],
            [routing.targets[visit.target].stays_s for visit in routing.visits],
            [routing.targets[visit.target].task.speed_mps or math.inf for visit in routing.visits],
        ),
        conditions=request.conditions,
        rules=airspace.flight,
        ground=_node_ground(routing, starts, homes),
    )


def _node_ground(routing: RoutingInput, starts: Sequence[LonLat], homes: Sequence[LonLat]) -> NodeGround | None:
    """Under the network, and under the sources and sinks of the paths in their order; None where no terrain model is."""
    terrain = routing.airspace.context.terrain
    if terrain is None:
        return None
    entries, exits = [course[0] for course in routing.courses], [course[-1] for course in routing.courses]
    sources = [*starts, *exits]
    sinks = [*entries, *homes, *(base.position for base in routing.bases)]
    heights_m = terrain.heights_m(np.array([*sources, *sinks], dtype=np.float64).reshape(-1, 2))
    return NodeGround(terrain.of_nodes_m(routing.airspace.graph), heights_m[: len(sources)], heights_m[len(sources) :])
