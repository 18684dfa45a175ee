"""One plan from request to answer: places, ways, assignment, waypoints, heights, and the last look at the zones."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from django.conf import settings

from inspection.geodesy import LonLat, path_length_m
from inspection.graph.flyable import node_heights_m
from inspection.selectors import ground_heights_m, ground_revision, terrain_edition
from inspection.selectors.graph import zones_of_edition
from inspection.selectors.planning import Edition, edition_now, has_terrain_at, planning_ground
from missions.flight_plan.clearance import RouteMeetsZone, refuse_legs_in_zones
from missions.flight_plan.duration import duration_s
from missions.flight_plan.flyable_graph import flyable_graph
from missions.flight_plan.heights import inspection_agl_m, pass_agl_m, with_heights
from missions.flight_plan.route_points import PassedNode, TargetPoints, line_of, positions_of, route_points, with_short_legs
from missions.models import EndAction
from missions.routing.problem import End, Problem, UavStart, Visit
from missions.routing.progress import OnProgress, Progress
from missions.routing.solver import Stop, never, solve
from missions.routing.terminals import AccessRules, Terminal, Ways, ways_between
from missions.services.best_so_far import OnPlanProgress, PlanProgress, Sketch, unheard
from missions.services.places import Place, places_of
from missions.services.plan_json import PlannedRoute, plan_to_json
from missions.services.refusals import Scene, asset_gone, groundings, place_height_m, refused_place, unreached_place
from missions.services.requests import PlanRequest


class GraphOutdated(Exception):
    """A zone is in force that the graph does not know yet, and a route would meet it. A new graph is seconds away."""

    def __init__(self, zone_name: str) -> None:
        super().__init__(f"{zone_name} has just changed, and the network is being rebuilt for it. Plan again in a moment.")


def make_plan(
    *, request: PlanRequest, stop: Stop = never, on_progress: OnPlanProgress = unheard, seed: int = 7, search_s: float = 0.0
) -> dict[str, Any]:
    """The plan in the shape of the API. Raises InvalidRequest, NoGraph or GraphOutdated."""
    on_progress(PlanProgress(0.0, "Looking up the targets"))
    every_place, gone = places_of(request.targets)
    scene = current_scene()
    refusals = {place.target: refused_place(place, scene) for place in every_place}
    left_out = [asset_gone(target) for target in gone] + [refusal for refusal in refusals.values() if refusal is not None]
    places = [place for place in every_place if refusals[place.target] is None]
    grounded = groundings(request.uavs, scene)
    uavs = [number for number in range(len(request.uavs)) if number not in grounded]

    on_progress(PlanProgress(0.05, "Measuring the ways between the targets"))
    visits, courses = visits_of_places(places)
    ways = ways_between(
        scene.graph,
        scene.zones,
        starts=[Terminal(request.uavs[uav].position) for uav in uavs],
        entries=[Terminal(course[0], places[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        exits=[Terminal(course[-1], places[visit.target].asset) for visit, course in zip(visits, courses, strict=True)],
        rules=scene.access,
    )
    problem = Problem(
        uavs=tuple(UavStart(request.uavs[uav].max_range_m, route_end(request, uav), request.uavs[uav].cruise_speed_mps) for uav in uavs),
        visits=tuple(visits),
        target_count=len(places),
        from_start_m=ways.from_start_m,
        between_m=ways.between_m,
        to_start_m=ways.to_start_m,
        objective=request.objective,
    )
    sketch = Sketch(problem, ways, scene.graph, [request.uavs[uav].position for uav in uavs], uavs, courses)
    solution = solve(problem, stop=stop, on_progress=_passed_on(sketch, on_progress), seed=seed, search_s=search_s)
    visits_of = problem.visits_of_target()
    left_out += [unreached_place(places[item.target], item, visits_of[item.target], ways, scene) for item in solution.unassigned]

    on_progress(PlanProgress(0.95, "Working out heights and checking every leg"))
    edition = scene.edition
    while True:
        ground_before = terrain_edition() if edition != scene.edition else None
        drawing = _Drawing(request, scene, places, visits, courses, ways, edition)
        flown = {uav: drawing.route(uav, number, solution.routes[number]) for number, uav in enumerate(uavs) if solution.routes[number]}
        routes = [flown.get(uav, PlannedRoute(end_action=end_action(request, uav))) for uav in range(len(request.uavs))]
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
    )


def _passed_on(sketch: Sketch, on_progress: OnPlanProgress) -> OnProgress:
    """What the solver says of the search, in the words of the whole plan."""

    def hear(told: Progress) -> None:
        draw = None if told.best_routes is None else lambda: sketch.of(told)
        on_progress(PlanProgress(0.1 + 0.85 * told.share, told.message, draw))

    return hear


def current_scene() -> Scene:
    linking, routing, flight = settings.GRAPH_RULES, settings.ROUTING_RULES, settings.FLIGHT_RULES
    ground = planning_ground()
    access = AccessRules(
        access_leg_m=routing.access_leg_m,
        direct_leg_m=routing.direct_leg_m,
        on_asset_m=linking.railway_spacing_m,
        off_network_factor=linking.off_network_factor,
        zone_clearance_m=linking.zone_clearance_m,
    )
    return Scene(ground.graph, flyable_graph(ground.graph, flight), ground.zones, access, flight, ground.edition)


def end_action(request: PlanRequest, uav: int) -> EndAction:
    return EndAction.RETURN if request.return_to_start else request.uavs[uav].end_action


def route_end(request: PlanRequest, uav: int) -> End:
    return End.RETURN if end_action(request, uav) is EndAction.RETURN else End.OPEN


def visits_of_places(places: Sequence[Place]) -> tuple[list[Visit], list[tuple[LonLat, ...]]]:
    """The ways of doing each place, with the course of each: a stretch can be flown from either end."""
    visits, courses = [], []
    for number, place in enumerate(places):
        length_m = path_length_m(np.array(place.course))
        visits.append(Visit(number, is_reversed=False, length_m=length_m, service_s=place.task.hold_s))
        courses.append(place.course)
        if place.is_stretch:
            visits.append(Visit(number, is_reversed=True, length_m=length_m, service_s=place.task.hold_s))
            courses.append(tuple(reversed(place.course)))
    return visits, courses


class _Drawing:
    """Turns the visits of one UAV into its waypoints."""

    def __init__(
        self,
        request: PlanRequest,
        scene: Scene,
        places: Sequence[Place],
        visits: Sequence[Visit],
        courses: Sequence[tuple[LonLat, ...]],
        ways: Ways,
        edition: Edition,
    ) -> None:
        self.request = request
        self.scene = scene
        self.places = places
        self.visits = visits
        self.courses = courses
        self.ways = ways
        self.ground = ground_heights_m if has_terrain_at(edition) else None

    def route(self, uav: int, start: int, order: Sequence[int]) -> PlannedRoute:
        """uav is the UAV's number in the request, start its number among those that fly."""
        flight, asked = self.scene.flight, self.request.uavs[uav]
        action = end_action(self.request, uav)
        legs = [self.ways.out(start, order[0]), *(self.ways.onward(left, right) for left, right in pairwise(order))]
        points = route_points(
            start=asked.position,
            transit_agl_m=flight.transit_agl_m,
            targets=[self._target(visit) for visit in order],
            ways=[self._passed(nodes) for nodes in legs],
            way_home=self._passed(self.ways.home(order[-1], start)) if action is EndAction.RETURN else None,
        )
        points = with_short_legs(points, flight.longest_leg_m)
        waypoints, is_flat = with_heights(points, self.ground, flight)
        length_m = path_length_m(positions_of(points))
        return PlannedRoute(
            targets=tuple(self.places[self.visits[visit].target].target for visit in order),
            waypoints=waypoints,
            line=line_of([waypoint.point for waypoint in waypoints]),
            length_m=length_m,
            duration_s=duration_s(
                waypoints,
                length_m=length_m,
                cruise_speed_mps=asked.cruise_speed_mps,
                lands=action is not EndAction.HOVER,
                rules=flight,
            ),
            end_action=action,
            is_flat=is_flat,
        )

    def _target(self, visit: int) -> TargetPoints:
        place = self.places[self.visits[visit].target]
        agl_m = inspection_agl_m(place_height_m(place, self.scene), self.scene.flight)
        return TargetPoints(place.target, self.courses[visit], agl_m, place.task, place.asset)

    def _passed(self, nodes: np.ndarray) -> list[PassedNode]:
        graph = self.scene.graph
        passed_m = pass_agl_m(node_heights_m(graph, nodes), self.scene.flight).tolist()
        assets = [asset if asset >= 0 else None for asset in graph.node_asset[nodes].tolist()]
        return list(map(PassedNode, map(LonLat._make, graph.position[nodes].tolist()), passed_m, assets))


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
