"""From the visits of each UAV to what it flies: points, heights, length and time."""

from collections.abc import Mapping, Sequence
from itertools import accumulate, chain, pairwise

import numpy as np

from inspection.geodesy import LonLat
from inspection.graph.flyable import node_heights_m
from inspection.graph.passed import BEND, passed_on
from inspection.selectors import ground_heights_m
from inspection.selectors.planning import Edition, has_terrain_at
from missions.flight_plan.duration import duration_s
from missions.flight_plan.heights import inspection_agl_m, pass_agl_m, with_heights
from missions.flight_plan.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs
from missions.flight_plan.waypoints import NONE
from missions.models import EndAction
from missions.routing.problem import Routes, Visit
from missions.routing.terminals import Ways
from missions.services.assignment import route_end
from missions.services.places import Place
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import Scene, place_height_m
from missions.services.requests import BaseRequest, PlanRequest


class Drawing:
    """Turns the visits of UAVs into their waypoints."""

    def __init__(
        self,
        request: PlanRequest,
        scene: Scene,
        places: Sequence[Place],
        visits: Sequence[Visit],
        courses: Sequence[tuple[LonLat, ...]],
        ways: Ways,
        bases: Sequence[BaseRequest],
        edition: Edition,
    ) -> None:
        self.request = request
        self.scene = scene
        self.places = places
        self.visits = visits
        self.courses = courses
        self.ways = ways
        self.bases = bases
        self.ground = ground_heights_m if has_terrain_at(edition) else None

    def routes(self, uavs: Sequence[int], orders: Routes) -> Mapping[int, PlannedRoute]:
        """What each UAV that has visits flies, by its number in the request; uavs are the numbers of those that fly."""
        flying = [(start, uav, order) for start, (uav, order) in enumerate(zip(uavs, orders, strict=True)) if order]
        ways = [self.ways.of_route(start, order, route_end(self.request, uav)) for start, uav, order in flying]
        passed = self._passed(ways)
        return {uav: self._route(uav, order, nodes) for (_, uav, order), nodes in zip(flying, passed, strict=True)}

    def _route(self, uav: int, order: Sequence[int], passed: PassedNodes) -> PlannedRoute:
        flight, asked = self.scene.flight, self.request.uavs[uav]
        action = self.request.end_action(uav)
        base = self.bases[self.ways.nearest_base[order[-1]]] if action is EndAction.BASE else None
        points = route_points(
            start=asked.position,
            transit_agl_m=flight.transit_agl_m,
            targets=[self._target(visit) for visit in order],
            ways=passed,
            home=self._home(action, uav, base),
        )
        points, length_m = with_short_legs(points, flight.longest_leg_m)
        waypoints, is_flat = with_heights(points, self.ground, flight)
        return PlannedRoute(
            targets=tuple(self.places[self.visits[visit].target].target for visit in order),
            waypoints=waypoints,
            line=line_of(waypoints.points),
            length_m=length_m,
            duration_s=duration_s(
                waypoints,
                length_m=length_m,
                cruise_speed_mps=asked.cruise_speed_mps,
                lands=action is not EndAction.HOVER,
                rules=flight,
            ),
            end_action=action,
            base=None if base is None else base.name,
            is_flat=is_flat,
        )

    def _home(self, action: EndAction, uav: int, base: BaseRequest | None) -> LonLat | None:
        """Where a route leads on to from its last visit."""
        if action is EndAction.RETURN:
            return self.request.uavs[uav].position
        return None if base is None else base.position

    def _target(self, visit: int) -> TargetPoints:
        place = self.places[self.visits[visit].target]
        agl_m = inspection_agl_m(place_height_m(place, self.scene), self.scene.flight)
        return TargetPoints(place.target, self.courses[visit], agl_m, place.task, place.asset)

    def _passed(self, ways: Sequence[Sequence[tuple[int, int]]]) -> list[PassedNodes]:
        """What is passed on the ways of each route, looked up for all of them at once."""
        if not ways:
            return []
        graph, flight = self.scene.graph, self.scene.flight
        told = passed_on(self.ways.travel, np.array(list(chain.from_iterable(ways)), dtype=np.int64), graph.position)
        is_node = told.node != BEND
        nodes = told.node[is_node]
        asset, agl_m = np.full(len(told.node), NONE, dtype=np.int64), np.full(len(told.node), flight.transit_agl_m)
        asset[is_node], agl_m[is_node] = graph.node_asset[nodes], pass_agl_m(node_heights_m(graph, nodes), flight)
        passed = []
        for begin, end in pairwise([0, *accumulate(map(len, ways))]):
            own = slice(told.first[begin], told.first[end])
            passed.append(PassedNodes(told.position[own], agl_m[own], asset[own], told.first[begin : end + 1] - told.first[begin]))
        return passed
