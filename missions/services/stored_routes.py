"""The stored routes of a mission as the planner has them before they are stored."""

import numpy as np

from inspection.geodesy import LonLat
from missions.models import Mission, Route, Waypoint
from planning.plan import PlannedRoute
from planning.request import task_from_json
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints


def stored_routes(mission: Mission) -> list[PlannedRoute] | None:
    """In the order of the mission's UAVs, with heights, times and Wh to the digits that are stored; without their lines. Points of
    one target share its key: what hangs at a target may be passed near there.

    None where it has no plan, or one of before there were times.
    """
    found = list(mission.routes.select_related("mission_uav").prefetch_related("waypoints"))
    if not found or any(waypoint.arrival_s is None for route in found for waypoint in route.waypoints.all()):
        return None
    return [_stored(route) for route in found]


def _stored(route: Route) -> PlannedRoute:
    rows = list(route.waypoints.all())
    if not rows:
        return PlannedRoute()
    points = RoutePoints.of([
        RoutePoint(
            LonLat(*row.position.coords[:2]), WaypointKind(row.kind), row.altitude_agl_m, target=row.target_id,
            task=task_from_json(row.task),
        )
        for row in rows
    ])  # fmt: skip
    amsl_m = _column(rows, "altitude_amsl_m")
    waypoints = Waypoints(points, amsl_m, np.array([row.altitude_relative_m for row in rows], dtype=np.float64))
    return PlannedRoute(
        waypoints=waypoints,
        length_m=route.length_m,
        duration_s=route.duration_s,
        is_flat=amsl_m is None,
        departs_s=route.departs_s,
        timing=_timing(route, rows),
    )


def _timing(route: Route, rows: list[Waypoint]) -> Timing:
    """With what was charged on the way taken off what was used: the stored percentages are too coarse to reckon with."""
    arrival_s = np.array([row.arrival_s for row in rows], dtype=np.float64) - route.departs_s
    used_wh = _column(rows, "used_wh")
    if used_wh is not None:
        for stop in route.charging:
            used_wh[stop["waypoint"] + 1 :] -= stop["charged_wh"]
    return Timing(arrival_s, used_wh, None, route.duration_s, route.energy_wh, route.battery_percent)


def _column(rows: list[Waypoint], name: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]] | None:
    """None where a waypoint has no figure."""
    values = [getattr(row, name) for row in rows]
    return None if any(value is None for value in values) else np.array(values, dtype=np.float64)
