"""Detects two UAVs that come too near each other. The pair has one alert, on the UAV with the smaller key; the subject is the other."""

from typing import Any

from telemetry.alerting.conflicts import FAR_HEIGHT_M, FAR_M
from telemetry.alerting.detection import ACTS, CRITICAL, HOLD, WARNING, Detection, acts
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.surroundings import Conflict

CODE = "converging"
WORDS = (
    "%(uav)s and %(other)s: %(metres)s m apart, %(height)s m in height, closing at %(speed)s m/s (±%(bound)s m), closest in %(seconds)s s."
    " Hold %(hold)s: %(why)s."
)
NOW = "%(uav)s and %(other)s: %(metres)s m apart, %(height)s m in height (±%(bound)s m). Hold %(hold)s: %(why)s."
CLEAR_SHARE = 1.3
CRITICAL_WITHIN_S = 12.0


def detect(inputs: DetectorInput) -> list[Detection]:
    limits = inputs.limits
    found: dict[str, Detection] = {}
    for conflict in inputs.conflicts:
        subject = str(conflict.other_id)
        share = CLEAR_SHARE if inputs.is_open(CODE, subject) else 1.0
        lateral_m, height_m = limits.separation_m * share, limits.separation_height_m * share
        if conflict.in_s > limits.converging_s or conflict.least_lateral_m >= lateral_m or conflict.least_height_m >= height_m:
            continue
        is_near = conflict.lateral_m < limits.separation_m and conflict.height_m < limits.separation_height_m
        level = CRITICAL if is_near and conflict.in_s <= CRITICAL_WITHIN_S else WARNING
        if subject in found and (level == WARNING or found[subject].level == CRITICAL):
            continue
        found[subject] = _detection(inputs, conflict, level)
    return list(found.values())


def _detection(inputs: DetectorInput, conflict: Conflict, level: str) -> Detection:
    """Return the detection with the distance at this moment, regardless of its bound."""
    in_s = conflict.in_s / inputs.link.clock_rate  # server seconds, as users see them
    values: dict[str, Any] = {
        "uav": inputs.uav.name, "other": conflict.other_name, "metres": round(conflict.now_lateral_m),
        "height": "–" if conflict.now_height_m is None else round(conflict.now_height_m), "bound": round(conflict.bound_m),
        "hold": conflict.yields_name, "why": str(conflict.why),
    }  # fmt: skip
    is_ahead = in_s >= 1.0 and conflict.closing_mps > 0.0
    if is_ahead:
        values |= {"seconds": round(in_s), "speed": round(conflict.closing_mps)}
    details = {
        "other": conflict.other_id, "in_s": round(in_s, 1), "distance_m": round(conflict.now_lateral_m, 1),
        "height_difference_m": None if conflict.now_height_m is None else round(conflict.now_height_m, 1),
        "closing_mps": round(conflict.closing_mps, 1), "bound_m": round(conflict.bound_m, 1), "lateral_m": round(conflict.lateral_m, 1),
        "height_m": round(conflict.height_m, 1), "least_lateral_m": round(conflict.least_lateral_m, 1),
        ACTS: acts(HOLD, uav_id=conflict.yields_id),
    }  # fmt: skip
    nearness = -max(conflict.now_lateral_m / FAR_M, (conflict.now_height_m or 0.0) / FAR_HEIGHT_M)
    words = WORDS if is_ahead else NOW
    return Detection(CODE, level, words, values, subject=str(conflict.other_id), details=details, severity=nearness)


DETECTOR = Detector(CODE, detect, raise_after_s=2.0, clear_after_s=5.0)
