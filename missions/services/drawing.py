"""From the visits of one UAV to what it flies: points, heights, length and time."""

from collections.abc import Sequence
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.graph.flyable import node_heights_m
from inspection.selectors import ground_heights_m
from inspection.selectors.planning import Edition, has_terrain_at
from missions.flight_plan.duration import duration_s
from missions.flight_plan.heights import inspection_agl_m, pass_agl_m, with_heights
from missions.flight_plan.route_points import PassedNodes, TargetPoints, line_of, repeats, route_points, with_short_legs
from missions.models import EndAction
from missions.routing.problem import Visit
from missions.routing.terminals import Ways
from missions.services.places import Place
from missions.services.plan_json import PlannedRoute
from missions.services.refusals import Scene, place_height_m
from missions.services.requests import BaseRequest, PlanRequest

IntArray = NDArray[np.int64]


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
        way_home = self._way_home(action, order[-1], start)
        base = self.bases[self.ways.nearest_base[order[-1]]] if action is EndAction.BASE else None
        passed = self._passed(legs if way_home is None else [*legs, way_home])
        points = route_points(
            start=asked.position,
            transit_agl_m=flight.transit_agl_m,
            targets=[self._target(visit) for visit in order],
            ways=passed[: len(legs)],
            way_home=None if way_home is None else passed[-1],
            home=None if base is None else base.position,
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

    def _way_home(self, action: EndAction, last: int, start: int) -> IntArray | None:
        if action is EndAction.RETURN:
            return self.ways.home(last, start)
        return self.ways.to_base(last) if action is EndAction.BASE else None

    def _target(self, visit: int) -> TargetPoints:
        place = self.places[self.visits[visit].target]
        agl_m = inspection_agl_m(place_height_m(place, self.scene), self.scene.flight)
        return TargetPoints(place.target, self.courses[visit], agl_m, place.task, place.asset)

    def _passed(self, ways: Sequence[IntArray]) -> list[PassedNodes]:
        """What is passed on each of the ways, looked up for all of them at once."""
        graph = self.scene.graph
        nodes, ends = np.concatenate(ways), list(accumulate(map(len, ways)))
        where = graph.position[nodes]
        position, has_repeats = where.tolist(), repeats(where, ends)
        agl_m = pass_agl_m(node_heights_m(graph, nodes), self.scene.flight).tolist()
        asset = [asset if asset >= 0 else None for asset in graph.node_asset[nodes].tolist()]
        spans = [slice(first, end) for first, end in pairwise([0, *ends])]
        return [PassedNodes(position[span], agl_m[span], asset[span], has_repeats) for span in spans]
