"""Whether the air of a rehearsal can be flown in at all."""

import math

from mavlink.approved_route import FrozenRoute
from planning.energy.conditions import Conditions
from simulation.verdict.finding import Finding, Level


def wind_finding(uav: int, route: FrozenRoute, conditions: Conditions, max_airspeed_mps: float) -> Finding | None:
    """The strongest mean wind at the heights of a route, where it is more than can be flown: it is said before all that follows."""
    heights_m = {waypoint.altitude_agl_m for waypoint in route.waypoints}
    speed_mps, agl_m = max(((math.hypot(*conditions.wind_at(agl_m)), agl_m) for agl_m in heights_m), default=(0.0, 0.0))
    if speed_mps <= max_airspeed_mps:
        return None
    facts: dict[str, float | int | str | None] = {"wind_mps": speed_mps, "agl_m": agl_m, "limit_mps": max_airspeed_mps}
    return Finding(Level.FAIL, "wind", uav, facts=facts)
