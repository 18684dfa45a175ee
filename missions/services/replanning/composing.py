"""One UAV's continued route: the part of the old route until it leaves it, and the new plan from there."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from django.conf import settings

from inspection.geodesy import LonLat, path_length_m
from missions.services.replanning.leaving import CannotLeave, Leaving
from missions.services.stored_routes import speeds_of_targets
from operation.reasons import Reason
from planning.energy.conditions import Conditions
from planning.energy.power import NoHeadway
from planning.plan import PlannedRoute
from planning.request import EndAction
from planning.task import task_from_json
from planning.trajectory.leg_speeds import inspection_speeds
from planning.trajectory.photo_flights import photo_legs_of
from planning.trajectory.route_points import line_of
from planning.trajectory.sorties import timing_of_route
from planning.trajectory.timing import Timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from planning.views.photo_flight import SPEED_MPS


@dataclass(frozen=True, eq=False)
class Continued:
    """A route as stored by the continuing mission; `order` are its targets by their places in the flying mission."""

    leaving: Leaving
    route: PlannedRoute
    order: tuple[int, ...]
    begun_by: int


def continued_route(leaving: Leaving, planned: Mapping[str, Any], order: tuple[int, ...], conditions: Conditions) -> Continued:
    """Compose the continued route. Raises CannotLeave.

    `planned`: the route in the shape of the API, whose targets are already places in `order`'s mission.
    """
    rows = planned["waypoints"]
    begun_by = len(leaving.prefix) - 1
    skipped = 1 if abs(rows[0]["altitude_agl_m"] - leaving.prefix[-1].agl_m) < 0.01 else 0  # the prefix ends there
    points = RoutePoints.of([*leaving.prefix, *(_point(row) for row in rows[skipped:])])
    speed_of, cruise_mps = speeds_of_targets(leaving.rest.route.mission), leaving.stored.cruise_speed_mps
    points.speed_mps |= inspection_speeds(points.target.tolist(), speed_of, cruise_mps, begins_in_air=True)
    points.speed_mps |= dict.fromkeys(np.flatnonzero(photo_legs_of(points)).tolist(), SPEED_MPS)
    heights = [row["altitude_amsl_m"] for row in rows[skipped:]]
    home_m = leaving.rest.take_off_amsl_m
    if leaving.amsl_m is None or home_m is None or any(height_m is None for height_m in heights):
        waypoints = Waypoints(points, None, points.agl_m)
    else:
        amsl_m = np.array([*leaving.amsl_m, *heights], dtype=np.float64)
        waypoints = Waypoints(points, amsl_m, amsl_m - home_m)
    if (waypoints.relative_m <= 0.0).any():
        raise CannotLeave(Reason("below_take_off", {"uav": leaving.rest.name}))
    clock = _clock(leaving, waypoints, EndAction(planned["end_action"]), conditions)
    route = PlannedRoute(
        targets=order,
        waypoints=waypoints,
        line=line_of(points),
        length_m=path_length_m(points.position),
        duration_s=clock.total_s,
        end_action=EndAction(planned["end_action"]),
        base=planned["base"],
        is_flat=waypoints.amsl_m is None,
        timing=clock,
    )
    return Continued(leaving, route, order, begun_by)


def _point(row: Mapping[str, Any]) -> RoutePoint:
    kind = WaypointKind.PASS if row["kind"] == WaypointKind.START else WaypointKind(row["kind"])
    return RoutePoint(LonLat(*row["position"]), kind, row["altitude_agl_m"], row["asset"], row["target"], task_from_json(row["task"]))


def _clock(leaving: Leaving, waypoints: Waypoints, action: EndAction, conditions: Conditions) -> Timing:
    """Return the timing from the first waypoint on, which the UAV has reached, with its current battery level."""
    performance = leaving.stored.performance
    try:
        clock = timing_of_route(
            waypoints,
            cruise_speed_mps=leaving.stored.cruise_speed_mps,
            performance=performance,
            conditions=conditions,
            lands=action is not EndAction.HOVER,
            rules=settings.FLIGHT_RULES,
        )
    except NoHeadway as error:
        raise CannotLeave(Reason("wind_too_strong_on_route", {"uav": leaving.rest.name})) from error
    climb_s = float(clock.arrival_s[0])
    clock = replace(clock, arrival_s=clock.arrival_s - climb_s, total_s=clock.total_s - climb_s)
    if clock.used_wh is None or clock.total_wh is None or performance.battery_wh is None:
        return clock
    climb_wh = float(clock.used_wh[0])
    used_wh, total_wh = clock.used_wh - climb_wh, clock.total_wh - climb_wh
    usable_wh = performance.usable_wh
    if usable_wh is not None and total_wh > usable_wh:
        raise CannotLeave(Reason("battery_does_not_last", {"uav": leaving.rest.name}))
    now_percent = leaving.rest.battery_percent or 0.0
    left = now_percent - 100.0 * used_wh / performance.battery_wh
    end_percent = now_percent - 100.0 * total_wh / performance.battery_wh
    return replace(clock, used_wh=used_wh, total_wh=total_wh, battery_left_percent=left, end_percent=end_percent)
