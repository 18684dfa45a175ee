"""Innovation: the distance of a report from the estimate for its moment, a measure of the estimator's quality in operation."""

import math
from dataclasses import dataclass

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from telemetry.estimation.estimate import Estimate


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
