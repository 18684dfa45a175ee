"""What the estimator says of one UAV at one moment. Times are Unix seconds, bounds hold 95 of 100 times."""

from dataclasses import dataclass

from inspection.geodesy import LonLat


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Around the position: semi-axes along a bearing [degrees from true north, clockwise] and across it [m]."""

    along_m: float
    across_m: float
    bearing_deg: float


@dataclass(frozen=True, slots=True)
class Arrival:
    """When a waypoint of the approved route will be reached, at the earliest and at the latest."""

    waypoint_sequence: int
    target: int | None
    at_s: float
    earliest_s: float
    latest_s: float


@dataclass(frozen=True, slots=True)
class Estimate:
    """A UAV at `at_s`. `is_measured`: a report speaks of this moment; `is_lost`: past what the estimator vouches for.

    `report_s` is when the last report was measured, None before the first. Heights are None where their reference is not known.
    `along_route_m` and `to_go_m` are lengths of the approved route flown and still to fly; None off a route. `report_interval_s` is how far
    apart its reports come, as the last few did; None before there were two.
    """

    at_s: float
    position: LonLat
    altitude_relative_m: float | None
    altitude_amsl_m: float | None
    speed_mps: float
    heading_deg: float | None
    bound: Ellipse
    bound_height_m: float
    bound_speed_mps: float
    report_s: float | None
    is_measured: bool
    is_lost: bool
    waypoint_sequence: int | None = None
    along_route_m: float | None = None
    to_go_m: float | None = None
    arrivals: tuple[Arrival, ...] = ()
    ends_at_s: float | None = None
    contact_expected_s: float | None = None
    report_interval_s: float | None = None
