"""The estimate of one UAV at one moment. Times are Unix seconds; bounds hold with 95 %."""

from dataclasses import dataclass

from inspection.geodesy import LonLat


@dataclass(frozen=True, slots=True)
class Ellipse:
    """Ellipse around the position: semi-axes along a bearing [degrees clockwise from true north] and across it [m]."""

    along_m: float
    across_m: float
    bearing_deg: float


@dataclass(frozen=True, slots=True)
class Arrival:
    """Expected arrival at a waypoint of the approved route, with the earliest and latest time."""

    waypoint_sequence: int
    target: int | None
    at_s: float
    earliest_s: float
    latest_s: float


@dataclass(frozen=True, slots=True)
class Estimate:
    """The estimate at `at_s`. `is_measured`: from a report of this moment; `is_lost`: beyond the confidence horizon.

    `report_s` is when the last report was measured; None before the first. Heights are None if their reference is unknown. `along_route_m`
    and `to_go_m` are lengths of the approved route flown and still to fly; None off a route. `report_interval_s` is the interval of the
    last few reports; None before the second.
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
