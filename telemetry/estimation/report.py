"""One report of a UAV, as the estimator takes it."""

import math
from dataclasses import dataclass, replace

from mavlink.decoding.measurement import Measurement, believable

FUTURE_S = 2.0  # a time measured later than it was received by more than clocks differ is no time


@dataclass(frozen=True, slots=True)
class VehicleBoot:
    """What the vehicle's own clock showed since it booted; the stream names the boot."""

    stream: int
    clock_s: float


@dataclass(frozen=True, slots=True)
class Report:
    """What was measured at a time, by the server's clock as far as it is known. Seconds since the epoch.

    `boot` tells the same by the vehicle's own clock, where it has told that.
    """

    measured_s: float
    received_s: float
    measurement: Measurement
    boot: VehicleBoot | None = None

    @property
    def has_position(self) -> bool:
        return self.measurement.longitude_deg is not None and self.measurement.latitude_deg is not None


def sound(report: Report) -> Report | None:
    """The report without what cannot be; None where its time cannot be, as when it was measured after it was received."""
    if not (math.isfinite(report.measured_s) and math.isfinite(report.received_s)):
        return None
    if report.measured_s > report.received_s + FUTURE_S:
        return None
    return replace(report, measurement=believable(report.measurement))
