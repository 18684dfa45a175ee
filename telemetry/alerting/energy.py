"""Energy that an approved flight uses, by progress along it."""

from dataclasses import dataclass

import numpy as np

from mavlink.approved_route import HOVER, Flight
from planning.energy.conditions import Conditions
from planning.energy.performance import Performance
from planning.energy.power import NoHeadway
from planning.rules import FlightRules
from planning.trajectory.timing import timing
from planning.trajectory.waypoints import RoutePoint, RoutePoints, Waypoints
from telemetry.alerting.route_line import NEAR_VERTEX_M, RoutePlace


@dataclass(frozen=True, slots=True)
class EnergyPlan:
    """Energy of one flight.

    `used_percent` of the full battery at each waypoint. `until_percent`: for each waypoint, what will have been used at the end of the
    flight or at the next charging stop.
    """

    used_percent: tuple[float, ...]
    until_percent: tuple[float, ...]
    reserve_percent: float

    def used_at(self, place: RoutePlace, climbed_share: float = 1.0) -> float:
        """Return the percentage used at a place. climbed_share: share of the climb from the ground to the first waypoint."""
        if place.along_m <= NEAR_VERTEX_M and climbed_share < 1.0:
            return self.used_percent[0] * climbed_share
        end = min(place.leg + 1, len(self.used_percent) - 1)
        start_percent = self.used_percent[place.leg]
        return start_percent + place.share * (self.used_percent[end] - start_percent)

    def rest_at(self, place: RoutePlace, used_percent: float) -> float:
        """Return the percentage still to be used, to the end of the flight or the next charging stop."""
        end = min(place.leg + 1, len(self.used_percent) - 1)
        return max(0.0, self.until_percent[end] - used_percent)


def energy_plan(
    flight: Flight, *, cruise_speed_mps: float, performance: Performance, conditions: Conditions, rules: FlightRules,
    charging: tuple[int, ...] = (),
) -> EnergyPlan | None:  # fmt: skip
    """Return the plan; None if the battery's energy is unknown or the planned wind leaves no headway."""
    points = RoutePoints.of(
        [
            RoutePoint(waypoint.position, waypoint.kind, waypoint.altitude_agl_m, None, waypoint.target, waypoint.task, waypoint.speed_mps)
            for waypoint in flight.waypoints
        ]
    )
    heights = [waypoint.altitude_amsl_m for waypoint in flight.waypoints]
    amsl_m = None if any(height is None for height in heights) else np.array(heights, dtype=np.float64)
    relative_m = np.array([waypoint.altitude_relative_m for waypoint in flight.waypoints], dtype=np.float64)
    try:
        timed = timing(
            Waypoints(points, amsl_m, relative_m), cruise_speed_mps=cruise_speed_mps, performance=performance, conditions=conditions,
            lands=flight.end_action != HOVER, rules=rules,
        )  # fmt: skip
    except NoHeadway:
        return None
    if timed.used_wh is None or timed.end_percent is None or performance.battery_wh is None:
        return None
    used = tuple(float(value) * 100.0 / performance.battery_wh for value in timed.used_wh)
    until, nearest = [], 100.0 - timed.end_percent
    for waypoint, used_percent in zip(reversed(flight.waypoints), reversed(used), strict=True):
        nearest = used_percent if waypoint.sequence in charging else nearest
        until.append(nearest)
    return EnergyPlan(used, tuple(reversed(until)), performance.reserve_percent)
