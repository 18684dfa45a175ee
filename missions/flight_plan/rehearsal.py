"""The compiled parts of drawing and of keeping apart run once, so that they are compiled, or loaded, before somebody waits for it."""

import numpy as np

from inspection.geodesy import LonLat
from missions.flight_plan.route_points import PassedNodes, TargetPoints, line_of, route_points, with_short_legs
from missions.flight_plan.rules import SeparationRules
from missions.flight_plan.separation import TimedRoute, keep_apart
from missions.routing.problem import Task, TaskKind


def rehearse() -> None:
    """Draw a route over one node to one target, with a leg that has to be divided; keep two that hover over one place apart."""
    ways = PassedNodes(np.array([[9.0, 47.0]]), np.array([60.0]), np.array([7]), np.array([0, 1]))
    target = TargetPoints(0, (LonLat(9.1, 47.0),), 60.0, Task(TaskKind.LOOK, 5.0), 8)
    points = route_points(start=LonLat(9.0, 47.001), transit_agl_m=60.0, targets=[target], ways=ways, home=None)
    line_of(with_short_legs(points, 900.0)[0])
    hovering = TimedRoute("", np.array([[9.0, 47.0], [9.1, 47.0]]), np.full(2, 60.0), np.array([0.0, 600.0]), np.zeros(2), take_off_m=60.0)
    keep_apart([hovering, hovering], rules=SeparationRules())
