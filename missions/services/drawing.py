"""From the visits of each UAV to what it flies: points, heights, length and time."""

from collections.abc import Mapping, Sequence
from itertools import accumulate, chain, pairwise

import numpy as np

from inspection.geodesy import LonLat
from inspection.graph.flyable import node_heights_m
from inspection.graph.ways import BEND
from missions.flight_plan.heights import GroundHeights, pass_agl_m, with_heights
from missions.flight_plan.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs
from missions.flight_plan.timing import timing
from missions.flight_plan.waypoints import NONE
from missions.models import EndAction
from missions.routing.problem import Routes, Visit
from missions.routing.terminals import Ways
from missions.services.assignment import route_end
from missions.services.places import Place
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import Scene
from missions.services.requests import BaseRequest, PlanRequest


class Drawing:
    """Turns the visits of UAVs into their waypoints. agl_m: the height above ground at which each place is inspected."""

    def __init__(
        self,
        request: PlanRequest,
        scene: Scene,
        places: Sequence[Place],
        agl_m: Sequence[float],
        visits: Sequence[Visit],
        courses: Sequence[tuple[LonLat, ...]],
        ways: Ways,
        bases: Sequence[BaseRequest],
    ) -> None:
        self.request = request
        self.scene = scene
        self.places = places
        self.agl_m = agl_m
        self.visits = visits
        self.courses = courses
        self.ways = ways
        self.bases = bases

    def routes(self, uavs: Sequence[int], orders: Routes, ground: GroundHeights | None) -> Mapping[int, PlannedRoute]:
        """What each UAV that has visits flies, by its number in the request; uavs are the numbers of those that fly.

        ground: the terrain model's heights; None: there is none.
        """
        flying = [(start, uav, order) for start, (uav, order) in enumerate(zip(uavs, orders, strict=True)) if order]
        ways = [self.ways.of_route(start, order, route_end(self.request, uav)) for start, uav, order in flying]
        passed = self._passed(ways)
        return {uav: self._route(uav, order, nodes, ground) for (_, uav, order), nodes in zip(flying, passed, strict=True)}

    def weight(self, start: int, uav: int, order: Sequence[int]) -> float:
        """What a route's ways cost for each metre, stretches included; `start` is the UAV's number in the ways."""
        source, sink = np.array(self.ways.of_route(start, order, route_end(self.request, uav))).T
        along_m = sum(self.visits[visit].length_m for visit in order)
        length_m = float(self.ways.travel.length_m[source, sink].sum()) + along_m
        return (float(self.ways.travel.cost[source, sink].sum()) + along_m) / length_m if length_m else 1.0

    def _route(self, uav: int, order: Sequence[int], passed: PassedNodes, ground: GroundHeights | None) -> PlannedRoute:
        flight, asked = self.scene.flight, self.request.uavs[uav]
        action = self.request.end_action(uav)
        base = self.bases[self.ways.nearest_base[order[-1]]] if action is EndAction.BASE else None
        points = route_points(
            start=asked.position,
            transit_agl_m=flight.transit_agl_m,
            targets=[self._target(visit) for visit in order],
            ways=passed,
            home=asked.position if action is EndAction.RETURN else None if base is None else base.position,
        )
        points, length_m = with_short_legs(points, flight.longest_leg_m)
        waypoints, is_flat = with_heights(points, ground, flight)
        lands = action is not EndAction.HOVER
        clock = timing(
            waypoints,
            cruise_speed_mps=asked.cruise_speed_mps,
            performance=asked.performance,
            conditions=self.request.conditions,
            lands=lands,
            rules=flight,
        )
        return PlannedRoute(
            targets=tuple(self.places[self.visits[visit].target].target for visit in order),
            waypoints=waypoints,
            line=line_of(waypoints.points),
            length_m=length_m,
            duration_s=clock.total_s,
            end_action=action,
            base=None if base is None else base.name,
            is_flat=is_flat,
            timing=clock,
        )

    def _target(self, visit: int) -> TargetPoints:
        place = self.places[self.visits[visit].target]
        return TargetPoints(place.target, self.courses[visit], self.agl_m[self.visits[visit].target], place.task, place.asset)

    def _passed(self, ways: Sequence[Sequence[tuple[int, int]]]) -> list[PassedNodes]:
        """What is passed on the ways of each route, looked up for all of them at once."""
        if not ways:
            return []
        graph, flight = self.scene.graph, self.scene.flight
        told = self.ways.travel.passed(np.array(list(chain.from_iterable(ways)), dtype=np.int64), graph.position)
        is_node = told.node != BEND
        nodes = told.node[is_node]
        asset, agl_m = np.full(len(told.node), NONE, dtype=np.int64), np.full(len(told.node), flight.transit_agl_m)
        asset[is_node], agl_m[is_node] = graph.node_asset[nodes], pass_agl_m(node_heights_m(graph, nodes), flight)
        passed = []
        for begin, end in pairwise([0, *accumulate(map(len, ways))]):
            own = slice(told.first[begin], told.first[end])
            passed.append(PassedNodes(told.position[own], agl_m[own], asset[own], told.first[begin : end + 1] - told.first[begin]))
        return passed
