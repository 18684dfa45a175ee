"""It is to fly its list and does not come on."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import Situation
from telemetry.alerting.detector_state import Progress
from telemetry.alerting.finding import WARNING, Finding

CODE = "no-progress"
WORDS = "%(uav)s flies its route, but has not come on for %(seconds)s s."
STEP_M, CLIMB_STEP_M = 10.0, 6.0  # what counts as coming on: more than receivers stray
CLEAR_STEPS = 2.0  # that it has to come on, once it has been told
AT_END_M = 15.0
SLACK = 1.2  # of a planned stay, which autopilots round up


def detect(situation: Situation) -> list[Finding] | None:
    memory, place, model, fresh = situation.memory, situation.place, situation.model, situation.fresh
    if not situation.flies_mission or not situation.is_in_flight:
        memory.progress.clear()
        return []
    if place is None or model is None or fresh is None or situation.has_just_jumped:
        return None
    here = Progress(fresh.received_s, place.along_m, fresh.measurement.altitude_relative_m)
    if not memory.progress or memory.progress[-1].at_s < here.at_s:
        memory.progress.append(here)
    longest_s = (situation.limits.no_progress_s + SLACK * model.line.planned_hold_s(place.along_m)) / situation.link.clock_rate
    while len(memory.progress) > 1 and memory.progress[1].at_s <= situation.now_s - longest_s:
        memory.progress.popleft()
    before = memory.progress[0]
    stood_s = situation.now_s - before.at_s
    step_m = STEP_M * (CLEAR_STEPS if situation.is_open(CODE) else 1.0)
    if stood_s < longest_s or place.along_m - before.along_m >= step_m or _has_climbed(before.height_m, here.height_m):
        return []
    if model.line.length_m - place.along_m <= AT_END_M:
        return []
    values = {"uav": situation.uav.name, "seconds": round(stood_s)}
    return [Finding(CODE, WARNING, WORDS, values, details={"stood_s": round(stood_s), "along_m": round(place.along_m, 1)})]


def _has_climbed(before_m: float | None, height_m: float | None) -> bool:
    return before_m is not None and height_m is not None and abs(height_m - before_m) >= CLIMB_STEP_M


DETECTOR = Detector(
    CODE, detect, raise_after_s=0.0, clear_after_s=2.0, hidden_by=("link-lost", "off-route", "mode-changed"),
    own_delay_s=lambda limits, _interval_s: limits.no_progress_s,
)  # fmt: skip
