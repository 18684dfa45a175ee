"""It flies its list, but beside the approved route."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import Situation
from telemetry.alerting.finding import CRITICAL, WARNING, Finding

CODE = "off-route"
WORDS = "%(uav)s is %(metres)s m beside its route; %(limit)s m are allowed."
CLEAR_SHARE = 0.8  # of the limit, below which it is over


def detect(situation: Situation) -> list[Finding] | None:
    if not situation.flies_mission:
        return []
    place, limits = situation.place, situation.limits
    if place is None or situation.has_just_jumped:
        return None
    if place.across_m <= limits.off_route_m * (CLEAR_SHARE if situation.is_open(CODE) else 1.0):
        return []
    level = CRITICAL if place.across_m > limits.off_route_critical_m else WARNING
    values = {"uav": situation.uav.name, "metres": round(place.across_m), "limit": round(limits.off_route_m)}
    return [Finding(CODE, level, WORDS, values, details={"across_m": round(place.across_m, 1), "along_m": round(place.along_m, 1)})]


DETECTOR = Detector(CODE, detect, raise_after_s=3.0, clear_after_s=5.0)
