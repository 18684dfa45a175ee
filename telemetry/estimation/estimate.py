"""The estimate of one UAV at one moment, and how far a report is from it. Times are Unix seconds; bounds hold with 95 %."""

import math
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame


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


@dataclass(frozen=True, slots=True)
class Innovation:
    """`is_within`: inside the 95 % bound."""

    error_m: float
    is_within: bool


def innovation(estimate: Estimate, reported: LonLat) -> Innovation:
    """Return the innovation between the estimate and the reported position of the same moment."""
    frame = LocalFrame.around(estimate.position.lon, estimate.position.lat)
    east_m, north_m = (float(value) for value in frame.to_metres(np.array([[reported.lon, reported.lat]]))[0])
    bearing_rad = math.radians(estimate.bound.bearing_deg)
    along_m = east_m * math.sin(bearing_rad) + north_m * math.cos(bearing_rad)
    across_m = east_m * math.cos(bearing_rad) - north_m * math.sin(bearing_rad)
    bound = estimate.bound
    outside = (along_m / max(bound.along_m, 1e-6)) ** 2 + (across_m / max(bound.across_m, 1e-6)) ** 2
    return Innovation(math.hypot(east_m, north_m), outside <= 1.0)
