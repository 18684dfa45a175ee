"""Detects a UAV that holds or flies a mission other than the approved one."""

from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.modes import ModeKind

CODE = "other-mission"
FLIES_OTHER = "%(uav)s flies a mission that is not the approved one."
FLIES_UNKNOWN = "%(uav)s flies a mission, and nobody knows which: nothing approved was found on it."
IN_DOUBT = "%(uav)s may hold another mission than the approved one: it changed after it was read back."
BEYOND = "%(uav)s is at item %(item)s of its mission; the approved one has %(items)s."


def detect(inputs: DetectorInput) -> list[Detection] | None:
    held, newest = inputs.held, inputs.uav.newest
    if held is None or held.is_changing:
        return None
    is_flown = inputs.is_in_flight and inputs.mode is ModeKind.MISSION
    item = None if newest is None else newest.measurement.mission_item
    values: dict[str, object] = {}
    if is_flown and held.approval_id is None:
        level, words = CRITICAL, FLIES_UNKNOWN
    elif is_flown and not held.is_approved:
        level, words = CRITICAL, FLIES_OTHER
    elif held.doubt:
        level, words = CRITICAL if is_flown else WARNING, IN_DOUBT
    elif is_flown and held.items is not None and item is not None and item - held.first_item >= held.items:
        level, words, values = CRITICAL, BEYOND, {"item": item, "items": held.items}
    else:
        return []
    details = {"doubt": held.doubt, "loaded_approval": None if held.approval_id is None else str(held.approval_id)}
    return [Detection(CODE, level, words, {"uav": inputs.uav.name, **values}, details=details)]


DETECTOR = Detector(CODE, detect, raise_after_s=3.0, clear_after_s=2.0, needs_flight=False, suppressed_by=("mission-mixed",))
