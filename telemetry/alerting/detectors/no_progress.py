"""It is to fly its list and does not come on."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.finding import WARNING, Finding
from telemetry.alerting.memory import Progress
from telemetry.alerting.situation import Situation

CODE = "no-progress"
WORDS = "%(uav)s flies its route, but has not come on for %(seconds)s s."
STEP_M, CLIMB_STEP_M = 5.0, 2.0  # what counts as coming on
AT_END_M = 15.0
SLACK = 1.2  # of a planned stay, which autopilots round up


def detect(situation: Situation) -> list[Finding] | None:
    memory, place, model, fresh = situation.memory, situation.place, situation.model, situation.fresh
    if not situation.flies_mission:
        memory.progress = None
        return []
    if place is None or model is None or fresh is None:
        return None
    height_m = fresh.measurement.altitude_relative_m
    before = memory.progress
    if before is None or place.along_m >= before.along_m + STEP_M or _has_climbed(before.height_m, height_m):
        memory.progress = Progress(max(place.along_m, before.along_m if before else 0.0), height_m, fresh.received_s)
        return []
    if model.line.length_m - place.along_m <= AT_END_M:
        return []
    stood_s = situation.now_s - before.at_s
    if stood_s < situation.limits.no_progress_s + SLACK * model.line.planned_hold_s(place.along_m):
        return []
    values = {"uav": situation.uav.name, "seconds": round(stood_s)}
    return [Finding(CODE, WARNING, WORDS, values, details={"stood_s": round(stood_s), "along_m": round(place.along_m, 1)})]


def _has_climbed(before_m: float | None, height_m: float | None) -> bool:
    return before_m is not None and height_m is not None and abs(height_m - before_m) >= CLIMB_STEP_M


DETECTOR = Detector(CODE, detect, raise_after_s=0.0, clear_after_s=2.0, hidden_by=("link-lost", "off-route", "mode-changed"))
