"""The parts of a route's time beside its level flight, as an assignment counts them where neither wind nor battery is said."""

from collections.abc import Sequence

from planning.energy.leg_cost import speeds
from planning.energy.performance import Performance
from planning.rules import FlightRules

_UNSTATED = Performance()


def target_s(agl_m: float, hold_s: float, cruise_speed_mps: float, rules: FlightRules) -> float:
    """Seconds that a target at this height takes beyond the level flight to it: down from transit height, the task, and up again.

    With the stop that it is for a UAV of this speed; a slower one stops sooner.
    """
    own = speeds(_UNSTATED, cruise_speed_mps, rules)
    stops_s = 2.0 * own.brake_s + own.settle_s if hold_s > 0.0 else 0.0
    return hold_s + stops_s + 2.0 * _below_transit_m(agl_m, rules) / rules.climb_speed_mps


def ready_s(targets_agl_m: Sequence[float], *, lands: bool, ends_at_target: bool, cruise_speed_mps: float, rules: FlightRules) -> float:
    """Seconds of a route beyond its level flight and its targets: the climb after take-off, and how it ends.

    A route that ends at its last target does not climb from it again. Where targets differ in height this is the least, so that no
    route takes less than is counted; what passes over tall assets and hills takes is not counted.
    """
    own = speeds(_UNSTATED, cruise_speed_mps, rules)
    besides_s = own.lift_s + own.brake_s + (own.brake_s + own.settle_s + own.touch_s if lands else 0.0)
    vertical_m = rules.transit_agl_m
    if ends_at_target:
        vertical_m += min(((agl_m if lands else 0.0) - _below_transit_m(agl_m, rules) for agl_m in targets_agl_m), default=0.0)
    elif lands:
        vertical_m += rules.transit_agl_m
    return besides_s + vertical_m / rules.climb_speed_mps


def _below_transit_m(agl_m: float, rules: FlightRules) -> float:
    return max(0.0, rules.transit_agl_m - agl_m)
