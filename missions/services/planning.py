"""One plan from request to answer: places, ways, assignment, waypoints, heights, and the last look at the zones."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from django.conf import settings

from inspection.geodesy import LonLat, path_length_m
from inspection.selectors import ground_revision, terrain_edition
from inspection.selectors.graph import zones_of_edition
from inspection.selectors.planning import Edition, PlanningGround, edition_now, planning_read
from missions.flight_plan.clearance import RouteMeetsZone, refuse_legs_in_zones
from missions.flight_plan.duration import target_s
from missions.flight_plan.flyable_graph import flyable_graph
from missions.flight_plan.heights import inspection_agl_m
from missions.routing.problem import Visit
from missions.routing.progress import OnProgress, Progress
from missions.routing.solver import Stop, never
from missions.routing.terminals import AccessRules, Terminal, ways_between
from missions.services.assignment import assignment, least_ready_s, quality_of, solve_assignment
from missions.services.best_so_far import OnPlanProgress, PlanProgress, Sketch, unheard
from missions.services.drawing import Drawing
from missions.services.places import Place, places_of, whole_assets
from missions.services.plan_json import PlannedRoute, plan_to_json
from missions.services.refusals import Scene, asset_gone, groundings, place_height_m, refused_place, zone_at
from missions.services.requests import PlanRequest
from missions.services.unreached import unreached_places


class GraphOutdated(Exception):
    """A zone is in force that the graph does not know yet, and a route would meet it. A new graph is seconds away."""

    def __init__(self, zone_name: str) -> None:
        super().__init__(f"{zone_name} has just changed, and the network is being rebuilt for it. Plan again in a moment.")


def make_plan(
    *,
    request: PlanRequest,
    stop: Stop = never,
    on_progress: OnPlanProgress = unheard,
    seed: int = 7,
    search_s: float = 0.0,
    as_text: bool = False,
) -> dict[str, Any]:
    """The plan in the shape of the API, on demand with parts of it `as_text` (see plan_to_json).

    Raises InvalidRequest, NoGraph or GraphOutdated.
    """
    on_progress(PlanProgress(0.0, "Looking up the targets"))
    read = planning_read(whole_assets(request.targets))
    every_place, gone = places_of(request.targets, read.points)
    scene = _scene_on(read.ground())
    refusals = {place.target: refused_place(place, scene) for place in every_place}
    left_out = [asset_gone(target) for target in gone] + [refusal for refusal in refusals.values() if refusal is not None]
    places = [place for place in every_place if refusals[place.target] is None]
    grounded = groundings(request.uavs, scene)
    uavs = [number for number in range(len(request.uavs)) if number not in grounded]

    bases = [base for base in request.bases if zone_at(base.position, scene) is None]

    on_progress(PlanProgress(0.05, "Measuring the ways between the targets"))
    agl_m = [inspection_agl_m(place_height_m(place, scene), scene.flight) for place in places]
    takes_s = [target_s(height_m, place.task.hold_s, scene.flight) for place, height_m in zip(places, agl_m, strict=True)]
    visits, courses = visits_of_places(places, takes_s)
    ways = ways_between(
        scene.graph,
        scene.zones,
        starts=[Terminal(request.uavs[uav].position) for uav in uavs],
        entries=[Terminal(course[0], places[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        exits=[Terminal(course[-1], places[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        rules=scene.access,
        bases=[Terminal(base.position) for base in bases],
    )
    ready = [least_ready_s(request.end_action(uav), agl_m, scene.flight) for uav in uavs]
    asked = assignment(request, uavs, places, visits, ways, grounded, ready)
    sketch = Sketch(
        asked.problem, ways, scene.graph, [request.uavs[uav].position for uav in uavs], [base.position for base in bases], uavs, courses
    )
    solution, lock_cost = solve_assignment(asked, stop=stop, on_progress=_passed_on(sketch, on_progress), seed=seed, search_s=search_s)
    left_out += unreached_places(solution.unassigned, request, asked, places, ways, scene)

    on_progress(PlanProgress(0.95, "Working out heights and checking every leg"))
    edition = scene.edition
    while True:
        ground_before = terrain_edition() if edition != scene.edition else None
        drawing = Drawing(request, scene, places, agl_m, visits, courses, ways, bases, edition)
        flown = drawing.routes(uavs, solution.routes)
        routes = [flown.get(uav, PlannedRoute(end_action=request.end_action(uav))) for uav in range(len(request.uavs))]
        now = _look_at_zones_again(routes, scene)
        if now == edition or (ground_before is not None and terrain_edition() == ground_before):
            break  # else the heights belong to another ground than the revision says
        edition = now
    return plan_to_json(
        request,
        routes,
        left_out,
        [{"code": why.code, "uav": number, "message": why.message} for number, why in grounded.items()],
        graph_version=scene.graph.version,
        ground_revision=now[0],
        has_terrain=drawing.ground is not None,
        quality=quality_of(
            solution,
            lock_cost,
            request.objective,
            total_m=sum(route.length_m for route in routes),
            longest_s=max(route.duration_s for route in routes),
        ),
        as_text=as_text,
    )


def _passed_on(sketch: Sketch, on_progress: OnPlanProgress) -> OnProgress:
    """What the solver says of the search, in the words of the whole plan."""

    def hear(told: Progress) -> None:
        draw = None if told.best_routes is None else lambda: sketch.of(told)
        on_progress(PlanProgress(0.1 + 0.85 * told.share, told.message, draw))

    return hear


def current_scene() -> Scene:
    """Raises NoGraph."""
    return _scene_on(planning_read().ground())


def _scene_on(ground: PlanningGround) -> Scene:
    linking, routing, flight = settings.GRAPH_RULES, settings.ROUTING_RULES, settings.FLIGHT_RULES
    access = AccessRules(
        access_leg_m=routing.access_leg_m,
        direct_leg_m=routing.direct_leg_m,
        on_asset_m=linking.railway_spacing_m,
        off_network_factor=linking.off_network_factor,
        zone_clearance_m=linking.zone_clearance_m,
    )
    return Scene(ground.graph, flyable_graph(ground.graph, flight), ground.zones, access, flight, ground.edition)


def visits_of_places(places: Sequence[Place], takes_s: Sequence[float] | None = None) -> tuple[list[Visit], list[tuple[LonLat, ...]]]:
    """The ways of doing each place, with the course of each: a stretch can be flown from either end. takes_s as `target_s` tells."""
    visits, courses = [], []
    for number, place in enumerate(places):
        service_s = 0.0 if takes_s is None else takes_s[number]
        length_m = path_length_m(np.array(place.course)) if place.is_stretch else 0.0
        visits.append(Visit(number, is_reversed=False, length_m=length_m, service_s=service_s))
        courses.append(place.course)
        if place.is_stretch:
            visits.append(Visit(number, is_reversed=True, length_m=length_m, service_s=service_s))
            courses.append(tuple(reversed(place.course)))
    return visits, courses


def _look_at_zones_again(routes: Sequence[PlannedRoute], scene: Scene) -> Edition:
    """Check every leg against the zones in force at this moment; returns the ground's edition that they belong to."""
    now = edition_now()
    zones = zones_of_edition(now)
    for route in routes:
        if route.line is None:
            continue
        try:
            refuse_legs_in_zones(route.line, zones.polygons)
        except RouteMeetsZone as error:
            if scene.graph.ground_revision < ground_revision():  # asked anew: the zones may be younger than `now`
                raise GraphOutdated(zones.names[error.zone]) from error
            raise
    return now
