"""Two UAVs come too near each other. The pair has one alert: of the UAV with the smaller key, its subject is the other."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.finding import CRITICAL, WARNING, Finding
from telemetry.alerting.situation import Situation

CODE = "converging"
WORDS = "%(uav)s and %(other)s come within %(metres)s m of each other in %(seconds)s s."
NOW = "%(uav)s and %(other)s are %(metres)s m from each other."
CLEAR_SHARE = 1.3
CRITICAL_WITHIN_S = 12.0


def detect(situation: Situation) -> list[Finding]:
    limits = situation.limits
    found: dict[str, Finding] = {}
    for meeting in situation.meetings:
        subject = str(meeting.other_id)
        share = CLEAR_SHARE if situation.is_open(CODE, subject) else 1.0
        lateral_m, height_m = limits.separation_m * share, limits.separation_height_m * share
        if meeting.in_s > limits.converging_s or meeting.least_lateral_m >= lateral_m or meeting.least_height_m >= height_m:
            continue
        is_near = meeting.lateral_m < limits.separation_m and meeting.height_m < limits.separation_height_m
        values = {"uav": situation.uav.name, "other": meeting.other_name, "metres": round(meeting.lateral_m)}
        in_s = meeting.in_s / situation.link.clock_rate  # for those who look at the server's clock
        if in_s >= 1.0:
            values["seconds"] = round(in_s)
        level = CRITICAL if is_near and meeting.in_s <= CRITICAL_WITHIN_S else WARNING
        if subject in found and (level == WARNING or found[subject].level == CRITICAL):
            continue
        details = {
            "other": meeting.other_id, "in_s": round(in_s, 1), "lateral_m": round(meeting.lateral_m, 1),
            "height_m": round(meeting.height_m, 1), "least_lateral_m": round(meeting.least_lateral_m, 1),
        }  # fmt: skip
        found[subject] = Finding(CODE, level, WORDS if in_s >= 1.0 else NOW, values, subject=subject, details=details)
    return list(found.values())


DETECTOR = Detector(CODE, detect, raise_after_s=2.0, clear_after_s=5.0)
