"""How long a route takes, and the parts of it that an assignment can count before the route is drawn."""

from collections.abc import Sequence

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


def target_s(agl_m: float, hold_s: float, rules: FlightRules) -> float:
    """Seconds that a target at this height takes beyond the level flight to it: down from transit height, the task, and up again."""
    return hold_s + 2.0 * _below_transit_m(agl_m, rules) / rules.climb_speed_mps


def ready_s(targets_agl_m: Sequence[float], *, lands: bool, ends_at_target: bool, rules: FlightRules) -> float:
    """Seconds of a route beyond its level flight and its targets: the climb after take-off, and how it ends.

    A route that ends at its last target does not climb from it again. Where targets differ in height this is the least, so that no
    route takes less than is counted; what passes over tall assets and hills take is not counted.
    """
    vertical_m = rules.transit_agl_m
    if ends_at_target:
        vertical_m += min(((agl_m if lands else 0.0) - _below_transit_m(agl_m, rules) for agl_m in targets_agl_m), default=0.0)
    elif lands:
        vertical_m += rules.transit_agl_m
    return vertical_m / rules.climb_speed_mps


def _below_transit_m(agl_m: float, rules: FlightRules) -> float:
    return max(0.0, rules.transit_agl_m - agl_m)
