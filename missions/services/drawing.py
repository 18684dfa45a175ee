"""From the visits of one UAV to what it flies: points, heights, length and time."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from inspection.geodesy import LonLat, path_length_m
from inspection.graph.flyable import node_heights_m
from inspection.selectors import ground_heights_m
from inspection.selectors.planning import Edition, has_terrain_at
from missions.flight_plan.duration import duration_s
from missions.flight_plan.heights import inspection_agl_m, pass_agl_m, with_heights
from missions.flight_plan.route_points import PassedNode, TargetPoints, line_of, positions_of, route_points, with_short_legs
from missions.models import EndAction
from missions.routing.problem import Visit
from missions.routing.terminals import Ways
from missions.services.places import Place
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import Scene, place_height_m
from missions.services.requests import BaseRequest, PlanRequest


class Drawing:
    """Turns the visits of one UAV into its waypoints."""

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

    def route(self, uav: int, start: int, order: Sequence[int]) -> PlannedRoute:
        """uav is the UAV's number in the request, start its number among those that fly."""
        flight, asked = self.scene.flight, self.request.uavs[uav]
        action = self.request.end_action(uav)
        legs = [self.ways.out(start, order[0]), *(self.ways.onward(left, right) for left, right in pairwise(order))]
        points = route_points(
            start=asked.position,
            transit_agl_m=flight.transit_agl_m,
            targets=[self._target(visit) for visit in order],
            ways=[self._passed(nodes) for nodes in legs],
            way_home=self._way_home(action, order[-1], start),
            home=self.bases[self.ways.nearest_base[order[-1]]].position if action is EndAction.BASE else None,
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

    def _way_home(self, action: EndAction, last: int, start: int) -> list[PassedNode] | None:
        if action is EndAction.RETURN:
            return self._passed(self.ways.home(last, start))
        return self._passed(self.ways.to_base(last)) if action is EndAction.BASE else None

    def _target(self, visit: int) -> TargetPoints:
        place = self.places[self.visits[visit].target]
        agl_m = inspection_agl_m(place_height_m(place, self.scene), self.scene.flight)
        return TargetPoints(place.target, self.courses[visit], agl_m, place.task, place.asset)

    def _passed(self, nodes: np.ndarray) -> list[PassedNode]:
        graph = self.scene.graph
        passed_m = pass_agl_m(node_heights_m(graph, nodes), self.scene.flight).tolist()
        assets = [asset if asset >= 0 else None for asset in graph.node_asset[nodes].tolist()]
        return list(map(PassedNode, map(LonLat._make, graph.position[nodes].tolist()), passed_m, assets))
