"""Limits of planning."""

from dataclasses import dataclass


@dataclass(frozen=True)
class RoutingRules:
    access_leg_m: float = 10_000.0  # the farthest that a UAV or a bare position may stand from the network
    direct_leg_m: float = 5_000.0  # the longest leg straight from target to target, as the article's longest link
    small_plan_targets: int = 12  # up to here solved in the request, above by a task
    large_plan_search_s: float = 10.0  # how long a task searches for a better plan
    max_targets: int = 500
    max_uavs: int = 50
