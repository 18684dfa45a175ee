"""Heights and speeds that a plan keeps."""

from dataclasses import dataclass


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
    terrain_tolerance_m: float = 10.0  # how far the height above ground may stray between waypoints before one is put in

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
