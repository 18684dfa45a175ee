"""What flying takes in seconds and watt-hours, where that does not follow from the metres alone."""

from collections.abc import Sequence

import numpy as np

from inspection.geodesy import LonLat
from inspection.selectors.node_ground import node_ground_m
from inspection.selectors.planning import heights_at, terrain_at
from missions.models import EndAction
from missions.services.planning.requests import PlanRequest
from missions.services.targets.assignment import route_end
from missions.services.targets.planning_context import LaidOut
from missions.services.targets.refusals import Scene
from planning.energy.assignment_costs import Finish, FlightCosts, flight_costs
from planning.energy.path_cost import FlightClass, NodeGround
from planning.problem import Objective

_NEED_THEM = {Objective.TIME, Objective.ENERGY}


def needs_counting(request: PlanRequest) -> bool:
    """Whether wind, a battery, a limit of airspeed or the objective make metres not enough to plan by."""
    return (
        not request.conditions.is_calm
        or request.objective in _NEED_THEM
        or any(uav.performance.battery_wh is not None or uav.performance.max_airspeed_mps is not None for uav in request.uavs)
    )


def counted(laid_out: LaidOut, uavs: Sequence[int]) -> FlightCosts:
    """For the UAVs that fly, by their numbers in the request, and the visits."""
    request, scene = laid_out.request, laid_out.scene
    asked = [request.uavs[uav] for uav in uavs]
    starts = [uav.position for uav in asked]
    return flight_costs(
        scene.graph,
        laid_out.ways,
        classes=[FlightClass(uav.performance, uav.cruise_speed_mps) for uav in asked],
        finishes=[Finish(route_end(request, uav), request.end_action(uav) is not EndAction.HOVER) for uav in uavs],
        starts=starts,
        homes=[uav.returns_to for uav in asked],
        bases=[base.position for base in laid_out.bases],
        courses=laid_out.courses,
        agl_m=[laid_out.agl_m[visit.target] for visit in laid_out.visits],
        hold_s=[laid_out.places[visit.target].task.hold_s for visit in laid_out.visits],
        conditions=request.conditions,
        rules=scene.flight,
        ground=_ground(scene, starts, [uav.returns_to for uav in asked], laid_out),
    )


def _ground(scene: Scene, starts: Sequence[LonLat], homes: Sequence[LonLat], laid_out: LaidOut) -> NodeGround | None:
    """Under the network, and under the sources and sinks of the ways in their order; None where no terrain model is."""
    heights = heights_at(scene.edition)
    if heights is None:
        return None
    entries, exits = [course[0] for course in laid_out.courses], [course[-1] for course in laid_out.courses]
    sources = [*starts, *exits]
    sinks = [*entries, *homes, *(base.position for base in laid_out.bases)]
    heights_m = heights(np.array([*sources, *sinks], dtype=np.float64).reshape(-1, 2))
    return NodeGround(node_ground_m(scene.graph, terrain_at(scene.edition)), heights_m[: len(sources)], heights_m[len(sources) :])
