"""The compiled parts of drawing and of keeping apart run once, so that they are compiled, or loaded, before somebody waits for it."""

import numpy as np

from inspection.geodesy import LonLat
from inspection.network.spans import spans_between
from inspection.network.warm_up import graph_to_rehearse_on
from inspection.network.zones.zone_index import ZoneIndex
from inspection.terrain.heights import HeightGrid
from inspection.terrain.profile import ground_profile
from inspection.terrain.tiled_terrain import TiledTerrain
from planning.clearance.obstacle_clearance import spans_too_near
from planning.connection_points import AccessRules, Terminal, paths_between
from planning.energy.assignment_costs import Finish, FlownVisits, FlyingFleet, flight_costs
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import FlightClass
from planning.energy.performance import Performance
from planning.problem import End
from planning.rules import FlightRules, SeparationRules
from planning.separation.separation import TimedRoute, keep_apart
from planning.task import Task, TaskKind
from planning.trajectory.heights import GroundModel, with_heights
from planning.trajectory.obstacles import highest_agl_m, rising_over
from planning.trajectory.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs
from planning.trajectory.timing import timing
from planning.trajectory.waypoints import RoutePoints, Waypoints


def rehearse() -> None:
    """Draw a route over a node to a target, with a leg that has to be divided and to rise; keep two that hover over one place apart."""
    ways = PassedNodes(np.array([[9.0, 47.0]]), np.array([60.0]), np.array([7]), np.array([0, 1]))
    target = TargetPoints(0, (LonLat(9.1, 47.0),), 60.0, Task(TaskKind.LOOK, 5.0), 8)
    points = route_points(start=LonLat(9.0, 47.001), transit_agl_m=60.0, targets=[target], ways=ways, home=None)
    points = with_short_legs(points, 900.0)[0]
    line_of(points)
    _rehearse_rising(points)
    _rehearse_terrain(points)
    _rehearse_time_and_energy(points)
    hovering = TimedRoute("", np.array([[9.0, 47.0], [9.1, 47.0]]), np.full(2, 60.0), np.array([0.0, 600.0]), np.zeros(2), take_off_m=60.0)
    keep_apart([hovering, hovering], rules=SeparationRules())


def _rehearse_rising(points: RoutePoints) -> None:
    """Over a wire across the last leg."""
    across = spans_between(np.array([[9.05, 46.999]]), np.array([[9.05, 47.001]]), np.array([80.0]), np.array([90.0]))
    waypoints = Waypoints(points, None, points.agl_m)
    rising_over(waypoints, across, None, FlightRules())
    spans_too_near(waypoints, across, None, FlightRules())


def _rehearse_terrain(points: RoutePoints) -> None:
    """Over a hill under the first leg."""
    hill_m = np.zeros((3, 3), dtype=np.float32)
    hill_m[1, 1] = 200.0
    grid = HeightGrid(8.5, 47.5, 0.5, 0.5, hill_m)
    tiles = TiledTerrain(
        np.array([1]), np.array([1]), np.array([[8.5, 47.5, 0.5, 0.5]]), np.array([[3, 3]]), lambda keys, number, wanted: grid
    )
    ground = GroundModel(lambda positions: tiles.heights_at(positions).heights_m, lambda start, end: ground_profile(tiles, start, end))
    waypoints, _is_flat = with_heights(points, ground, FlightRules())
    highest_agl_m(waypoints, ground)


def _rehearse_time_and_energy(points: RoutePoints) -> None:
    """Of the points, and of a plan on the graph of the other rehearsal: one UAV, one target."""
    rules, conditions, performance = FlightRules(), Conditions((WindLayer(10.0, 5.0, 90.0),)), Performance(battery_wh=50.0)
    timing(
        Waypoints(points, points.agl_m, points.agl_m),
        cruise_speed_mps=10.0,
        performance=performance,
        conditions=conditions,
        lands=True,
        rules=rules,
    )
    graph, place = graph_to_rehearse_on(), LonLat(9.001, 47.001)
    access = AccessRules(access_leg_m=1_000.0, direct_leg_m=100.0, on_asset_m=100.0, off_network_factor=2.0, zone_clearance_m=5.0)
    ends = [Terminal(place)]
    flight_costs(
        graph,
        paths_between(graph, ZoneIndex([], [], []), ends, ends, ends, access),
        fleet=FlyingFleet([FlightClass(performance, 10.0)], [Finish(End.RETURN, lands=True)], [place]),
        bases=[],
        visits=FlownVisits([[place]], [45.0], [5.0], [1.0]),
        conditions=conditions,
        rules=rules,
    )
