"""Detects missing telemetry of a UAV in flight: first late, then lost."""

from typing import Any

from planning.clearance.lost_link import LostLink
from telemetry.alerting.advice import (
    FAILSAFE_UNKNOWN,
    FAILSAFES,
    GOES_ON,
    HOLDS_THEN_RETURNS,
    NOT_PLANNED,
    RETURNS_PLANNED,
    WAS_FLOWN,
    WAS_HOLDING,
    WAS_LANDING,
    WAS_RETURNING,
    advice,
)
from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.limits import AlertLimits
from telemetry.alerting.modes import ModeKind

CODE = "link-lost"
LATE = "%(uav)s: no telemetry for %(seconds)s s."
LOST = "Link to %(uav)s lost: no telemetry for %(seconds)s s."
_LAST_RECEIVED: dict[ModeKind | None, str] = {ModeKind.RETURN: WAS_RETURNING, ModeKind.LAND: WAS_LANDING, ModeKind.HOLD: WAS_HOLDING}
LATE_INTERVALS, LOST_INTERVALS = 2.5, 5.0


def late_after_s(limits: AlertLimits, report_interval_s: float) -> float:
    return max(limits.link_late_s, LATE_INTERVALS * report_interval_s)


def lost_after_s(limits: AlertLimits, report_interval_s: float) -> float:
    return max(limits.link_lost_s, LOST_INTERVALS * report_interval_s)


def detect(inputs: DetectorInput) -> list[Detection]:
    last_message_s = inputs.last_message_s
    if last_message_s is None:
        return []
    silent_s, interval_s = inputs.now_s - last_message_s, inputs.report_interval_s
    if silent_s < late_after_s(inputs.limits, interval_s):
        return []
    is_lost = silent_s >= lost_after_s(inputs.limits, interval_s)
    expected_s = None if inputs.uav.estimate is None else inputs.uav.estimate.contact_expected_s
    return [
        Detection(
            CODE,
            CRITICAL if is_lost else WARNING,
            LOST if is_lost else LATE,
            {"uav": inputs.uav.name, "seconds": round(silent_s)},
            details={
                "heard_s": last_message_s,
                "silent_s": round(silent_s, 1),
                "contact_expected_s": expected_s,
                **_does_by_itself(inputs),
            },
        )
    ]


def _does_by_itself(inputs: DetectorInput) -> dict[str, Any]:
    """Return what it does meanwhile, by its last messages and its lost-link plan. Failsafe parameters of autopilots are not read."""
    mode, model = inputs.mode, inputs.model
    if mode in _LAST_RECEIVED:
        return advice(_LAST_RECEIVED[mode])
    if mode in (ModeKind.BY_HAND, ModeKind.GUIDED):
        newest = inputs.uav.newest
        return advice(WAS_FLOWN, mode=(newest.measurement.mode if newest is not None else "") or inputs.link.mode)
    planned = None if model is None else model.lost_link
    if planned is None:
        return advice(NOT_PLANNED)
    failsafe = FAILSAFES.get(inputs.link.autopilot, FAILSAFE_UNKNOWN)
    if planned.behaviour is LostLink.HOLD:
        return advice(HOLDS_THEN_RETURNS, seconds=round(planned.hold_s), failsafe=failsafe)
    return advice(RETURNS_PLANNED if planned.behaviour is LostLink.RETURN else GOES_ON, failsafe=failsafe)


DETECTOR = Detector(CODE, detect, raise_after_s=0.0, clear_after_s=2.0, reports=0, own_delay_s=late_after_s)
