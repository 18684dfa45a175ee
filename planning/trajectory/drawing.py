"""From the visits of each UAV to what it flies: points, heights, length and time."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, chain, pairwise

import numpy as np

from inspection.geodesy import LonLat
from inspection.network.build.flyable import node_heights_m
from inspection.network.inspection_graph import NodeKind
from inspection.network.paths.along_paths import BEND, passed_on
from inspection.network.spans import spans_of
from operation.reasons import Reason
from planning.airspace import zone_at
from planning.assignment.routing_input import RoutingInput
from planning.energy.charging import CannotCharge, ChargingStop, charging_stops, places_over, with_stops
from planning.energy.power import NoHeadway
from planning.plan import PlannedRoute
from planning.problem import Routes
from planning.request import BaseRequest, EndAction, InvalidRequest
from planning.trajectory.heights import pass_agl_m, with_heights
from planning.trajectory.leg_speeds import inspection_speeds
from planning.trajectory.obstacles import rising_over
from planning.trajectory.photo_flights import GroundNotKnown, with_photo_flights
from planning.trajectory.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs, without_idle_points
from planning.trajectory.sorties import joined_sorties, timing_of_route
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import NONE, RoutePoints, Waypoints


@dataclass(frozen=True, eq=False)
class _Flight:
    """One flight. is_flat: flat ground had to be assumed; blocked_by: spans, by their numbers, that it would have to rise over too high."""

    waypoints: Waypoints
    length_m: float
    is_flat: bool
    blocked_by: tuple[int, ...]


class TrajectoryBuilder(RoutingInput):
    """Turns the visits of UAVs into their waypoints."""

    def routes(self, uavs: Sequence[int], sorties: Sequence[Routes]) -> Mapping[int, PlannedRoute]:
        """What each UAV that has visits flies, by its number in the request; uavs are the numbers of those that fly.

        sorties: the visits of each in order, flight by flight.
        """
        flying = [(start, uav, order) for start, (uav, orders) in enumerate(zip(uavs, sorties, strict=True)) for order in orders]
        ways = [self.ways.of_route(start, order, self.request.route_end(uav)) for start, uav, order in flying]
        flights: dict[int, list[tuple[Sequence[int], PassedNodes]]] = {}
        for (_start, uav, order), passed in zip(flying, self._passed(ways), strict=True):
            flights.setdefault(uav, []).append((order, passed))
        return {uav: self._route(uav, own) for uav, own in flights.items()}

    def weight(self, start: int, uav: int, orders: Routes) -> float:
        """What a route's ways cost for each metre, stretches included; `start` is the UAV's number in the ways."""
        ways = [way for order in orders for way in self.ways.of_route(start, order, self.request.route_end(uav))]
        source, sink = np.array(ways).T
        along_m = sum(self.visits[visit].length_m for order in orders for visit in order)
        length_m = float(self.ways.travel.length_m[source, sink].sum()) + along_m
        return (float(self.ways.travel.cost[source, sink].sum()) + along_m) / length_m if length_m else 1.0

    def _route(self, uav: int, flights: Sequence[tuple[Sequence[int], PassedNodes]]) -> PlannedRoute:
        flight, asked = self.airspace.flight, self.request.uavs[uav]
        action = self.request.end_action(uav)
        drawn = [self._flight(uav, order, passed) for order, passed in flights]
        waypoints = drawn[0].waypoints if len(drawn) == 1 else joined_sorties([own.waypoints for own in drawn], flight.turnaround_s)
        base = self._base(action, flights[-1][0])
        try:
            clock = timing_of_route(
                waypoints,
                cruise_speed_mps=asked.cruise_speed_mps,
                performance=asked.performance,
                conditions=self.request.conditions,
                lands=action is not EndAction.HOVER,
                rules=flight,
            )
        except NoHeadway as error:  # over hills the wind of another height is met than was counted with
            raise InvalidRequest({"conditions": Reason("wind_too_strong_on_route", {"uav": asked.name})}) from error
        stops: tuple[ChargingStop, ...] = ()
        shortfall_wh = 0.0
        if self.request.may_charge(uav):
            try:
                stops = self._charging(uav, waypoints, clock)
                clock = with_stops(clock, stops, asked.performance.battery_wh or math.inf)
            except CannotCharge as error:
                shortfall_wh = error.missing_wh
        return PlannedRoute(
            targets=tuple(self.targets[self.visits[visit].target].target for order, _passed in flights for visit in order),
            waypoints=waypoints,
            line=line_of(waypoints.points),
            length_m=sum(own.length_m for own in drawn),
            duration_s=clock.total_s,
            end_action=action,
            base=None if base is None else base.name,
            is_flat=any(own.is_flat for own in drawn),
            timing=clock,
            charging=stops,
            shortfall_wh=shortfall_wh,
            blocked_by=tuple(sorted({span for own in drawn for span in own.blocked_by})),
        )

    def _charging(self, uav: int, waypoints: Waypoints, clock: Timing) -> tuple[ChargingStop, ...]:
        """Where the UAV charges at towers that it passes, if it has to. Raises CannotCharge or ChargerTooWeak."""
        tops_m = self._tops_m(waypoints.points)
        places = places_over(waypoints.points, tops_m)
        return charging_stops(
            waypoints,
            clock,
            towers=places,
            tops_m=[tops_m[asset] for asset in waypoints.points.asset[places].tolist()],
            charging_w=self.request.charging_w or 0.0,
            performance=self.request.uavs[uav].performance,
            conditions=self.request.conditions,
            rules=self.airspace.flight,
        )

    def _tops_m(self, points: RoutePoints) -> dict[int, float]:
        """Heights above ground of the towers that are passed and that no zone covers down to there, by their assets."""
        network = self.airspace.network
        nodes = np.flatnonzero(np.isin(network.node_asset, points.asset[points.asset != NONE]) & (network.node_kind == NodeKind.SUPPORT))
        tops_m = zip(nodes.tolist(), node_heights_m(network, nodes).tolist(), strict=True)
        return {
            int(network.node_asset[node]): top_m
            for node, top_m in tops_m
            if zone_at(LonLat(*network.position[node].tolist()), self.airspace, top_m) is None
        }

    def _flight(self, uav: int, order: Sequence[int], passed: PassedNodes) -> "_Flight":
        flight, at, ground = self.airspace.flight, self.request.uavs[uav].position, self.airspace.context.ground
        action = self.request.end_action(uav)
        base = self._base(action, order)
        points = route_points(
            start=at,
            transit_agl_m=flight.transit_agl_m,
            targets=[self._target(visit) for visit in order],
            ways=passed,
            home=self.request.uavs[uav].returns_to if action is EndAction.RETURN else None if base is None else base.position,
        )
        points, length_m = with_short_legs(points, flight.longest_leg_m)
        waypoints, is_flat = with_heights(points, ground, flight)
        waypoints, blocked = rising_over(waypoints, spans_of(self.airspace.network), ground, flight)
        photos = {target.target: target.photos for visit in order if (target := self.targets[self.visits[visit].target]).photos is not None}
        try:
            flown = with_photo_flights(without_idle_points(waypoints), photos)
        except GroundNotKnown as error:
            raise InvalidRequest({f"targets.{error.target}.task": Reason("photos_ground_unknown")}) from error
        length_m += sum(flight.length_m for flight in photos.values())
        tasks = (self.targets[self.visits[visit].target] for visit in order)
        speed_of = {target.target: target.task.speed_mps for target in tasks if target.task.speed_mps is not None}
        flown.points.speed_mps |= inspection_speeds(flown.points.target.tolist(), speed_of, self.request.uavs[uav].cruise_speed_mps)
        return _Flight(flown, length_m, is_flat, blocked)

    def _base(self, action: EndAction, order: Sequence[int]) -> BaseRequest | None:
        return self.bases[self.ways.nearest_base[order[-1]]] if action is EndAction.BASE else None

    def _target(self, visit: int) -> TargetPoints:
        target = self.targets[self.visits[visit].target]
        return TargetPoints(target.target, self.courses[visit], self.agl_m[self.visits[visit].target], target.task, target.asset)

    def _passed(self, ways: Sequence[Sequence[tuple[int, int]]]) -> list[PassedNodes]:
        """What is passed on the ways of each route, looked up for all of them at once."""
        if not ways:
            return []
        graph, flight = self.airspace.graph, self.airspace.flight
        reported = passed_on(self.ways.travel, np.array(list(chain.from_iterable(ways)), dtype=np.int64), graph.position)
        is_node = reported.node != BEND
        nodes = reported.node[is_node]
        asset, agl_m = np.full(len(reported.node), NONE, dtype=np.int64), np.full(len(reported.node), flight.transit_agl_m)
        asset[is_node], agl_m[is_node] = graph.node_asset[nodes], pass_agl_m(node_heights_m(graph, nodes), flight)
        passed = []
        for begin, end in pairwise([0, *accumulate(map(len, ways))]):
            own = slice(reported.first[begin], reported.first[end])
            passed.append(
                PassedNodes(reported.position[own], agl_m[own], asset[own], reported.first[begin : end + 1] - reported.first[begin])
            )
        return passed
