"""Detects wind above the limit of the UAV or the mission."""

import math

from mavlink.decoding.measurement import Measurement
from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput

CODE = "weather"
WORDS = "Wind %(wind)s m/s at %(uav)s (limit %(limit)s m/s)."
CLEAR_SHARE = 0.85


def detect(inputs: DetectorInput) -> list[Detection] | None:
    fresh, limits, model = inputs.fresh, inputs.limits, inputs.model
    wind_mps = None if fresh is None else wind_of(fresh.measurement)
    if wind_mps is None:
        return None
    airspeed_mps = math.inf if model is None else model.max_airspeed_mps
    limit_mps = min(airspeed_mps * limits.wind_share_percent / 100.0, limits.wind_mps or math.inf)
    if wind_mps <= limit_mps * (CLEAR_SHARE if inputs.is_open(CODE) else 1.0):
        return []
    level = CRITICAL if wind_mps >= airspeed_mps else WARNING
    values = {"uav": inputs.uav.name, "wind": f"{wind_mps:.0f}", "limit": f"{limit_mps:.0f}"}
    return [Detection(CODE, level, WORDS, values, details={"wind_mps": round(wind_mps, 1), "limit_mps": round(limit_mps, 1)})]


def wind_of(reported: Measurement) -> float | None:
    """Return the measured wind, else its lower bound by airspeed and ground speed [m/s]; None if neither is reported."""
    if reported.wind_north_mps is not None and reported.wind_east_mps is not None:
        return math.hypot(reported.wind_north_mps, reported.wind_east_mps)
    if reported.airspeed_mps is None or reported.velocity_north_mps is None or reported.velocity_east_mps is None:
        return None
    return abs(reported.airspeed_mps - math.hypot(reported.velocity_north_mps, reported.velocity_east_mps))


DETECTOR = Detector(CODE, detect, raise_after_s=10.0, clear_after_s=20.0)
