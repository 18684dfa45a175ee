"""Detects a UAV that should fly its mission but makes no progress."""

from telemetry.alerting.detection import WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.detector_state import RouteProgress

CODE = "no-progress"
WORDS = "%(uav)s flies its route, but has not come on for %(seconds)s s."
STEP_M, CLIMB_STEP_M = 10.0, 6.0  # minimum progress: more than GPS noise
CLEAR_STEPS = 2.0  # progress that clears an open alert
AT_END_M = 15.0
SLACK = 1.2  # factor on a planned stay, which autopilots round up


def detect(inputs: DetectorInput) -> list[Detection] | None:
    detector_state, place, model, fresh = inputs.detector_state, inputs.place, inputs.model, inputs.fresh
    if not inputs.flies_mission or not inputs.is_in_flight:
        detector_state.progress.clear()
        return []
    if place is None or model is None or fresh is None or inputs.has_just_jumped:
        return None
    here = RouteProgress(fresh.received_s, place.along_m, fresh.measurement.altitude_relative_m)
    if not detector_state.progress or detector_state.progress[-1].at_s < here.at_s:
        detector_state.progress.append(here)
    longest_s = (inputs.limits.no_progress_s + SLACK * model.line.planned_hold_s(place.along_m)) / inputs.link.clock_rate
    while len(detector_state.progress) > 1 and detector_state.progress[1].at_s <= inputs.now_s - longest_s:
        detector_state.progress.popleft()
    before = detector_state.progress[0]
    stood_s = inputs.now_s - before.at_s
    step_m = STEP_M * (CLEAR_STEPS if inputs.is_open(CODE) else 1.0)
    if stood_s < longest_s or place.along_m - before.along_m >= step_m or _has_climbed(before.height_m, here.height_m):
        return []
    if model.line.length_m - place.along_m <= AT_END_M:
        return []
    values = {"uav": inputs.uav.name, "seconds": round(stood_s)}
    return [Detection(CODE, WARNING, WORDS, values, details={"stood_s": round(stood_s), "along_m": round(place.along_m, 1)})]


def _has_climbed(before_m: float | None, height_m: float | None) -> bool:
    return before_m is not None and height_m is not None and abs(height_m - before_m) >= CLIMB_STEP_M


DETECTOR = Detector(
    CODE, detect, raise_after_s=0.0, clear_after_s=2.0, suppressed_by=("link-lost", "off-route", "mode-changed"),
    own_delay_s=lambda limits, _interval_s: limits.no_progress_s,
)  # fmt: skip
