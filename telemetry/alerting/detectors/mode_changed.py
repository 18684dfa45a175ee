"""Detects a mode that was not commanded from here: an action of the autopilot, a pilot or another ground station."""

from telemetry.alerting.detection import CRITICAL, WARNING, Detection
from telemetry.alerting.detector import Detector
from telemetry.alerting.detector_input import DetectorInput
from telemetry.alerting.modes import LEADS_TO, WITHOUT_ORDER, ModeKind
from telemetry.alerting.status_texts import AFTER_S, BEFORE_S, quoted

CODE = "mode-changed"
RETURNS = "%(uav)s is returning (%(mode)s): failsafe or pilot, not commanded from here."
LANDS = "%(uav)s is landing (%(mode)s): failsafe or pilot, not commanded from here."
FLOWN = "%(uav)s is under other control (mode %(mode)s): pilot or another ground station."
HOLDS = "%(uav)s has stopped its mission (%(mode)s), not commanded from here."
FLIES = "%(uav)s has resumed its mission (%(mode)s), not commanded from here."
RETURN_TEXTS = "%(uav)s is returning (%(mode)s), not commanded from here. Autopilot: %(words)s"
LANDING_TEXTS = "%(uav)s is landing (%(mode)s), not commanded from here. Autopilot: %(words)s"
PILOT_TEXTS = "%(uav)s is under other control (mode %(mode)s). Autopilot: %(words)s"
HOLD_TEXTS = "%(uav)s has stopped its mission (%(mode)s), not commanded from here. Autopilot: %(words)s"
MISSION_TEXTS = "%(uav)s has resumed its mission (%(mode)s), not commanded from here. Autopilot: %(words)s"
SETTLES_S = 4.0  # after one of our commands, until modes are compared again

_WORDS = {
    ModeKind.RETURN: RETURNS, ModeKind.LAND: LANDS, ModeKind.HOLD: HOLDS, ModeKind.MISSION: FLIES, ModeKind.TAKE_OFF: FLIES,
    ModeKind.GUIDED: FLOWN, ModeKind.BY_HAND: FLOWN,
}  # fmt: skip
_TEXTS = {
    RETURNS: RETURN_TEXTS, LANDS: LANDING_TEXTS, FLOWN: PILOT_TEXTS, HOLDS: HOLD_TEXTS, FLIES: MISSION_TEXTS,
}  # fmt: skip


def detect(inputs: DetectorInput) -> list[Detection] | None:
    kind, order, newest = inputs.mode, inputs.order, inputs.uav.newest
    if kind is None or newest is None:
        return None
    if order is not None and (order.done_s is None or newest.received_s < order.done_s + SETTLES_S):
        return None
    if inputs.detector_state.mode_words[0] and kind is ModeKind.MISSION:
        inputs.detector_state.mode_words = ("", "")
    if kind in (WITHOUT_ORDER if order is None else LEADS_TO.get(order.kind, WITHOUT_ORDER)):
        return []
    if inputs.ends_as_planned:
        return []
    level = CRITICAL if kind in (ModeKind.RETURN, ModeKind.LAND) else WARNING
    mode = newest.measurement.mode or inputs.link.mode
    details = {"mode": mode, "order": None if order is None else order.kind}
    template, values = _WORDS[kind], {"uav": inputs.uav.name, "mode": mode}
    words = _words_about(inputs, mode)
    if words:
        template, values = _TEXTS[template], values | {"words": words}
    return [Detection(CODE, level, template, values, details=details)]


def _words_about(inputs: DetectorInput, mode: str) -> str:
    """Return the vehicle's status texts around the change to this mode, stored while it stays in it."""
    cause, (of_mode, words) = inputs.detector_state.causes.get((CODE, "")), inputs.detector_state.mode_words
    if of_mode == mode and words:
        return words
    since_s = inputs.now_s if cause is None else min(cause.since_s.values(), default=inputs.now_s)
    words = quoted(inputs.status_texts, since_s - BEFORE_S, since_s + AFTER_S)
    inputs.detector_state.mode_words = (mode, words)
    return words


DETECTOR = Detector(CODE, detect, raise_after_s=2.0, clear_after_s=3.0)
