"""Nothing is heard of a UAV in flight: late first, then lost."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.finding import CRITICAL, WARNING, Finding
from telemetry.alerting.limits import Limits
from telemetry.alerting.situation import Situation

CODE = "link-lost"
LATE = "%(uav)s: no telemetry for %(seconds)s s."
LOST = "Link to %(uav)s lost: no telemetry for %(seconds)s s."
LATE_INTERVALS, LOST_INTERVALS = 2.5, 5.0


def late_after_s(limits: Limits, report_interval_s: float) -> float:
    return max(limits.link_late_s, LATE_INTERVALS * report_interval_s)


def lost_after_s(limits: Limits, report_interval_s: float) -> float:
    return max(limits.link_lost_s, LOST_INTERVALS * report_interval_s)


def detect(situation: Situation) -> list[Finding]:
    heard_s = situation.heard_s
    if heard_s is None:
        return []
    silent_s, interval_s = situation.now_s - heard_s, situation.report_interval_s
    if silent_s < late_after_s(situation.limits, interval_s):
        return []
    is_lost = silent_s >= lost_after_s(situation.limits, interval_s)
    expected_s = None if situation.uav.estimate is None else situation.uav.estimate.contact_expected_s
    return [
        Finding(
            CODE,
            CRITICAL if is_lost else WARNING,
            LOST if is_lost else LATE,
            {"uav": situation.uav.name, "seconds": round(silent_s)},
            details={"heard_s": heard_s, "silent_s": round(silent_s, 1), "contact_expected_s": expected_s},
        )
    ]


DETECTOR = Detector(CODE, detect, raise_after_s=0.0, clear_after_s=2.0, reports=0, own_delay_s=late_after_s)
