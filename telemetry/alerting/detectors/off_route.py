"""Detects a UAV that flies its mission beside the approved route; beside wires also one above or below it."""

import math

from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import position_of
from telemetry.alerting.route_line import RoutePlace

CODE = "off-route"
WORDS = "%(uav)s is %(metres)s m beside its route; %(limit)s m are allowed."
BESIDE_WIRES = "%(uav)s is %(metres)s m off its route beside wires; %(limit)s m are allowed."
CLEAR_SHARE = 0.8  # of the limit, to clear
WARNING_SHARE, CRITICAL_SHARE = 1 / 3, 1 / 2  # of the clearance on legs through photos


def detect(inputs: DetectorInput) -> list[Detection] | None:
    if not inputs.flies_mission:
        return []
    place, limits = inputs.place, inputs.limits
    if place is None or inputs.has_just_jumped:
        return None
    words, off_m = WORDS, place.across_m
    warning_m, critical_m = limits.off_route_m, limits.off_route_critical_m
    clearance_m = None if inputs.model is None else inputs.model.line.clearances_m.get(place.leg)
    if clearance_m is not None:
        words, off_m = BESIDE_WIRES, _away_m(inputs, place)
        warning_m, critical_m = min(warning_m, clearance_m * WARNING_SHARE), min(critical_m, clearance_m * CRITICAL_SHARE)
    if off_m <= warning_m * (CLEAR_SHARE if inputs.is_open(CODE) else 1.0):
        return []
    level = CRITICAL if off_m > critical_m else WARNING
    values = {"uav": inputs.uav.name, "metres": math.ceil(off_m), "limit": math.floor(warning_m)}
    return [Detection(CODE, level, words, values, details={"across_m": round(place.across_m, 1), "along_m": round(place.along_m, 1)})]


def _away_m(inputs: DetectorInput, place: RoutePlace) -> float:
    """Return the distance in space from the route [m], beside it where the height is not reported."""
    report = inputs.fresh
    position = None if report is None else position_of(report)
    if inputs.model is None or report is None or position is None or report.measurement.altitude_relative_m is None:
        return place.across_m
    return inputs.model.line.away_m(place, position, report.measurement.altitude_relative_m)


DETECTOR = Detector(CODE, detect, raise_after_s=3.0, clear_after_s=5.0)
