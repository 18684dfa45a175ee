"""Stored routes of a mission in the planner's types, and where the lost-link action could not be done on them."""

from typing import Any

import numpy as np

from inspection.geodesy import LonLat
from inspection.selectors.planning import planning_read
from missions.models import Mission, Route, Waypoint
from missions.selectors.planning_context import planning_context
from planning.checks.lost_link import lost_link_check
from planning.plan import PlannedRoute
from planning.request import PlanRequest
from planning.task import task_from_json
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints


def stored_routes(mission: Mission) -> list[PlannedRoute] | None:
    """Return the routes in the order of the mission's UAVs, without lines; heights, times and Wh have the stored precision.

    Points of one target share its key: what is attached to a target may be passed near there. Returns None without a plan, or for an old
    plan without times.
    """
    found = list(mission.routes.select_related("mission_uav").prefetch_related("waypoints"))
    if not found or any(waypoint.arrival_s is None for route in found for waypoint in route.waypoints.all()):
        return None
    return [_stored(route) for route in found]


def speeds_of_targets(mission: Mission) -> dict[int, float]:
    """Return the inspection speeds [m/s] of the targets that have one, by their places in the mission."""
    found = {target.sequence: (target.task or {}).get("speed_mps") for target in mission.targets.all()}
    return {place: speed_mps for place, speed_mps in found.items() if speed_mps is not None}


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
    """Return the timing, with charged energy subtracted from the energy used: the stored percentages are too coarse."""
    arrival_s = np.array([row.arrival_s for row in rows], dtype=np.float64) - route.departs_s
    used_wh = _column(rows, "used_wh")
    if used_wh is not None:
        for stop in route.charging:
            used_wh[stop["waypoint"] + 1 :] -= stop["charged_wh"]
    return Timing(arrival_s, used_wh, None, route.duration_s, route.energy_wh, route.battery_percent)


def _column(rows: list[Waypoint], name: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]] | None:
    """Return a column of the waypoints; None where a waypoint has no value."""
    values = [getattr(row, name) for row in rows]
    return None if any(value is None for value in values) else np.array(values, dtype=np.float64)


def lost_link_of_stored(mission: Mission, request: PlanRequest) -> dict[str, Any] | None:
    """Return the check of a mission's stored routes with the current zones; None where it has no routes or their times are unknown.

    request: the mission's stored request. Raises NoGraph.
    """
    routes = stored_routes(mission)
    if routes is None:
        return None
    return lost_link_check(request, routes, planning_context(request, planning_read().ground()))
