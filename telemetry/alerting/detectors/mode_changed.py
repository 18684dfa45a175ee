"""Its mode is not what we told it: it acts by itself, or somebody else flies it."""

from telemetry.alerting.detector import Detector
from telemetry.alerting.finding import CRITICAL, WARNING, Finding
from telemetry.alerting.modes import AT_THE_END, LEADS_TO, WITHOUT_ORDER, ModeKind
from telemetry.alerting.situation import Situation

CODE = "mode-changed"
RETURNS = "%(uav)s returns (%(mode)s) without a command of ours: by its own failsafe, or told by others."
LANDS = "%(uav)s lands (%(mode)s) without a command of ours: by its own failsafe, or told by others."
FLOWN = "%(uav)s is flown by somebody else: its mode is %(mode)s."
HOLDS = "%(uav)s has stopped its mission (%(mode)s) without a command of ours."
FLIES = "%(uav)s flies a mission again (%(mode)s), though it was told otherwise."
SETTLES_S = 4.0  # after a command of ours was carried out, until modes are compared again
AT_END_M = 40.0

_WORDS = {
    ModeKind.RETURN: RETURNS, ModeKind.LAND: LANDS, ModeKind.HOLD: HOLDS, ModeKind.MISSION: FLIES, ModeKind.TAKE_OFF: FLIES,
    ModeKind.GUIDED: FLOWN, ModeKind.BY_HAND: FLOWN,
}  # fmt: skip


def detect(situation: Situation) -> list[Finding] | None:
    kind, order, newest = situation.mode, situation.order, situation.uav.newest
    if kind is None or newest is None:
        return None
    if order is not None and (order.done_s is None or newest.received_s < order.done_s + SETTLES_S):
        return None
    if kind in (WITHOUT_ORDER if order is None else LEADS_TO.get(order.kind, WITHOUT_ORDER)):
        return []
    if kind in AT_THE_END and _is_at_end(situation) and (order is None or order.kind in {"start", "resume", "take-off", "arm"}):
        return []
    level = CRITICAL if kind in (ModeKind.RETURN, ModeKind.LAND) else WARNING
    mode = newest.measurement.mode or situation.link.mode
    details = {"mode": mode, "order": None if order is None else order.kind}
    return [Finding(CODE, level, _WORDS[kind], {"uav": situation.uav.name, "mode": mode}, details=details)]


def _is_at_end(situation: Situation) -> bool:
    place, model = situation.memory.place, situation.model
    return place is not None and model is not None and model.line.length_m - place.along_m <= AT_END_M


DETECTOR = Detector(CODE, detect, raise_after_s=2.0, clear_after_s=3.0)
