"""How long a route takes."""

import numpy as np

from missions.flight_plan.rules import FlightRules
from missions.flight_plan.waypoints import Waypoints


def duration_s(waypoints: Waypoints, *, length_m: float, cruise_speed_mps: float, lands: bool, rules: FlightRules) -> float:
    """Seconds from take-off to landing, or to the hover at the end: level flight, then every climb, then every hold.

    Climbs are added to the level flight although a UAV does both at once: this errs on the long side. Descents between waypoints are
    as quick as climbs and cost as much; the first climb starts on the ground at the start, the last descent ends on the ground.
    """
    if not waypoints:
        return 0.0
    relative_m, agl_m = waypoints.relative_m, waypoints.points.agl_m
    vertical_m = float(agl_m[0]) + float(np.abs(relative_m[1:] - relative_m[:-1]).sum())
    if lands:
        vertical_m += float(agl_m[-1])
    hold_s = sum(task.hold_s for task in waypoints.points.task.values())
    return length_m / cruise_speed_mps + vertical_m / rules.climb_speed_mps + hold_s
