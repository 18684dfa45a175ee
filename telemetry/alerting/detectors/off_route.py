"""Detects a UAV that flies its mission beside the approved route."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.finding import CRITICAL, WARNING, Finding

CODE = "off-route"
WORDS = "%(uav)s is %(metres)s m beside its route; %(limit)s m are allowed."
CLEAR_SHARE = 0.8  # of the limit, to clear


def detect(inputs: DetectorInput) -> list[Finding] | None:
    if not inputs.flies_mission:
        return []
    place, limits = inputs.place, inputs.limits
    if place is None or inputs.has_just_jumped:
        return None
    if place.across_m <= limits.off_route_m * (CLEAR_SHARE if inputs.is_open(CODE) else 1.0):
        return []
    level = CRITICAL if place.across_m > limits.off_route_critical_m else WARNING
    values = {"uav": inputs.uav.name, "metres": round(place.across_m), "limit": round(limits.off_route_m)}
    return [Finding(CODE, level, WORDS, values, details={"across_m": round(place.across_m, 1), "along_m": round(place.along_m, 1)})]


DETECTOR = Detector(CODE, detect, raise_after_s=3.0, clear_after_s=5.0)
