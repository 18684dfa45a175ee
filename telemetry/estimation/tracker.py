"""One UAV: reports in, an estimate for any moment out."""

import math
from bisect import insort
from dataclasses import dataclass, field

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from telemetry.estimation.estimate import Ellipse, Estimate
from telemetry.estimation.knowledge import Knowledge
from telemetry.estimation.report import Report, sound


@dataclass
class Tracker:
    """`take` reports in any order, as often as they come; `estimate` asks for a moment."""

    knowledge: Knowledge
    _reports: list[Report] = field(default_factory=list)

    def take(self, report: Report) -> None:
        read = sound(report)
        if read is not None and all(known.measured_s != read.measured_s for known in self._reports):
            insort(self._reports, read, key=lambda known: known.measured_s)
            del self._reports[:-60]

    def estimate(self, at_s: float) -> Estimate | None:
        """None before the first position."""
        last = next((report for report in reversed(self._reports) if report.has_position and report.measured_s <= at_s), None)
        if last is None:
            return None
        told, ago_s = last.measurement, at_s - last.measured_s
        if told.longitude_deg is None or told.latitude_deg is None:
            return None
        east_mps, north_mps = told.velocity_east_mps or 0.0, told.velocity_north_mps or 0.0
        frame = LocalFrame.around(told.longitude_deg, told.latitude_deg)
        lon, lat = frame.to_degrees(np.array([[east_mps * ago_s, north_mps * ago_s]]))[0]
        wide_m = 5.0 + 3.0 * ago_s
        return Estimate(
            at_s=at_s, position=LonLat(float(lon), float(lat)), altitude_relative_m=told.altitude_relative_m,
            altitude_amsl_m=told.altitude_amsl_m, speed_mps=math.hypot(east_mps, north_mps), heading_deg=told.heading_deg,
            bound=Ellipse(wide_m, wide_m, 0.0), bound_height_m=5.0 + ago_s, bound_speed_mps=2.0 + 0.2 * ago_s, report_s=last.measured_s,
            is_measured=ago_s < 1.0, is_lost=ago_s > 120.0, waypoint_sequence=told.waypoint_sequence,
        )  # fmt: skip
