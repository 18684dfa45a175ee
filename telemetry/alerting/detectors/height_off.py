"""Detects a UAV that flies its mission higher or lower than approved."""

from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput

CODE = "height-off"
ABOVE = "%(uav)s flies %(metres)s m above the height of its route; %(limit)s m are allowed."
BELOW = "%(uav)s flies %(metres)s m below the height of its route; %(limit)s m are allowed."
CLEAR_SHARE = 0.8


def detect(inputs: DetectorInput) -> list[Detection] | None:
    if not inputs.flies_mission:
        return []
    place, fresh, model, limits = inputs.place, inputs.fresh, inputs.model, inputs.limits
    if place is None or fresh is None or model is None or fresh.measurement.altitude_relative_m is None:
        return None
    if place.across_m > limits.off_route_critical_m:
        return None  # its leg is unknown
    if place.leg in model.line.clearances_m:
        return []  # beside wires: off_route
    low_m, high_m = model.line.heights_at(place)
    height_m = fresh.measurement.altitude_relative_m
    off_m = max(height_m - high_m, low_m - height_m)
    if off_m <= limits.height_off_m * (CLEAR_SHARE if inputs.is_open(CODE) else 1.0):
        return []
    level = CRITICAL if off_m > limits.height_off_critical_m else WARNING
    values = {"uav": inputs.uav.name, "metres": round(off_m), "limit": round(limits.height_off_m)}
    details = {"altitude_relative_m": round(height_m, 1), "planned_from_m": round(low_m, 1), "planned_to_m": round(high_m, 1)}
    return [Detection(CODE, level, ABOVE if height_m > high_m else BELOW, values, details=details)]


DETECTOR = Detector(CODE, detect, raise_after_s=3.0, clear_after_s=5.0)
