"""Limits that a plan keeps: heights, speeds, turns, separation, targets and time."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class RoutingRules:
    access_leg_m: float = 10_000.0  # the farthest that a UAV or a bare position may stand from the network
    direct_leg_m: float = 5_000.0  # the longest leg straight from target to target, as the article's longest link
    small_plan_targets: int = 12  # up to here solved in the request, above by a task
    large_plan_search_s: float = 10.0  # how long a task searches for a better plan
    max_targets: int = 500
    max_uavs: int = 50


@dataclass(frozen=True)
class Manoeuvres:
    """What no speed tells: how a UAV leaves the ground, stops, goes on and comes down; as simulated flights do (decision 0039).

    acceleration_mps2   along its way: PX4's MPC_ACC_HOR is 3, ArduCopter's WPNAV_ACCEL 2.5, neither from the first moment on
    corner_mps2         across its way, in a turn: ArduCopter's is 5, twice WPNAV_ACCEL; PX4's MPC_ACC_HOR is 3, in wider turns, which
                        begin 10 m before the waypoint (NAV_ACC_RAD); simulated airframes have 2.5 and 5
    settle_s            from coming to a stand until it counts as standing
    lift_s              from the motors' start until it climbs at its speed
    landing_mps         how fast it comes down below slow_below_m: PX4's MPC_LAND_SPEED; ArduCopter's is 0.5
    """

    acceleration_mps2: float = 2.0
    corner_mps2: float = 4.0
    settle_s: float = 1.5
    lift_s: float = 1.5
    landing_mps: float = 0.7
    slow_below_m: float = 8.0

    def __post_init__(self) -> None:
        above_0 = self.acceleration_mps2, self.corner_mps2, self.landing_mps
        if not (min(above_0) > 0 and min(self.settle_s, self.lift_s, self.slow_below_m) >= 0):
            raise ValueError("acceleration_mps2, corner_mps2 and landing_mps must be above 0, the others not below")


AT_ONCE = Manoeuvres(acceleration_mps2=math.inf, settle_s=0.0, lift_s=0.0, landing_mps=math.inf, slow_below_m=0.0)  # a UAV without mass


@dataclass(frozen=True)
class FlightRules:
    clearance_m: float = 15.0  # above the asset
    transit_agl_m: float = 60.0  # least height between targets: a common 380 kV tower (45 m) plus clearance
    max_agl_m: float = 120.0  # EASA open category, Regulation (EU) 2019/947, UAS.OPEN.010
    cruise_speed_mps: float = 12.0
    climb_speed_mps: float = 2.5
    longest_flight_s: float = 14_400.0  # zones that come into force later than that after the departure are left to the last look
    turnaround_s: float = 600.0  # from the landing of one flight to the take-off of the next, with another battery
    longest_leg_m: float = 900.0  # PX4's MIS_DIST_WPS; the geodesic then keeps to the drawn line within 0.1 m
    terrain_tolerance_m: float = 10.0  # by which legs may be higher above ground than planned before a waypoint is put in
    manoeuvres: Manoeuvres = Manoeuvres()

    def __post_init__(self) -> None:
        if not 0 < self.transit_agl_m <= self.max_agl_m:
            raise ValueError(f"transit_agl_m ({self.transit_agl_m}) must be above 0 and not above max_agl_m ({self.max_agl_m})")

    @property
    def tallest_m(self) -> float:
        """An asset that is higher cannot be flown over with clearance."""
        return self.max_agl_m - self.clearance_m


@dataclass(frozen=True)
class SeparationRules:
    """How far apart UAVs are kept: at a place that two pass within both limits of metres, their times lie at least time_s apart.

    A place is passed within the limits where the one, whenever it is there, and the other, whenever it is there, are less than lateral_m
    apart across the ground and less than vertical_m in height. So a UAV may be up to time_s late, or the one ahead of it, and they still
    do not meet.
    """

    lateral_m: float = 30.0  # position errors and wind on two UAVs, several times over
    vertical_m: float = 15.0  # what barometers of two UAVs may disagree by in a flight, and the climb of one that levels off late
    time_s: float = 60.0

    def __post_init__(self) -> None:
        if not (self.lateral_m > 0 and self.vertical_m > 0 and self.time_s >= 0):
            raise ValueError(
                f"lateral_m ({self.lateral_m}) and vertical_m ({self.vertical_m}) must be above 0, time_s ({self.time_s}) not below"
            )
