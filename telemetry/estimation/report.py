"""One report of a UAV, the input of the estimator."""

import math
from dataclasses import dataclass, replace

from mavlink.decoding.measurement import Measurement, believable

FUTURE_S = 2.0  # a measurement later than its receipt by more than clock errors is invalid


@dataclass(frozen=True, slots=True)
class VehicleBoot:
    """Reading of the vehicle's own clock since boot; the stream identifies the boot."""

    stream: int
    clock_s: float


@dataclass(frozen=True, slots=True)
class Report:
    """Values measured at a time by the server's clock, as far as known [Unix seconds].

    `boot` is the same time by the vehicle's own clock, if reported.
    """

    measured_s: float
    received_s: float
    measurement: Measurement
    boot: VehicleBoot | None = None

    @property
    def has_position(self) -> bool:
        return self.measurement.longitude_deg is not None and self.measurement.latitude_deg is not None


def sound(report: Report) -> Report | None:
    """Return the report without impossible values; None if its time is impossible, such as later than its receipt."""
    if not (math.isfinite(report.measured_s) and math.isfinite(report.received_s)):
        return None
    if report.measured_s > report.received_s + FUTURE_S:
        return None
    return replace(report, measurement=believable(report.measurement))
