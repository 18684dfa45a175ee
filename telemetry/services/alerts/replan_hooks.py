"""Alerts that trigger an offer to replan the rest of a mission; when the cause ends, the offer is withdrawn.

Causes: a UAV is lost, down off plan or returns by itself, or its battery is short.
"""

from collections.abc import Iterable
from uuid import UUID

from missions.services.replanning import suggest, withdraw
from telemetry.alerting.detection import CRITICAL, Detection
from telemetry.alerting.detectors import battery, down, link, mode_changed
from telemetry.alerting.modes import ModeKind, mode_kind
from telemetry.alerting.state_machine import CLEARED, Closed
from telemetry.models import Alert

UAV_OUT, BATTERY_SHORT = "uav-out", "battery-short"
CODES_OF = {link.CODE: UAV_OUT, mode_changed.CODE: UAV_OUT, battery.CODE: BATTERY_SHORT}  # a UAV that was down stays out
COMES_DOWN = frozenset({ModeKind.RETURN, ModeKind.LAND})


def suggest_for_detections(detections: Iterable[tuple[UUID, int, Detection]]) -> None:
    """Offer a new plan for detections, given as mission, UAV and detection; once for each cause. Idempotent."""
    for mission_id, uav_id, detection in detections:
        code = code_of(detection)
        if code is not None:
            suggest(mission_id=mission_id, code=code, cause={"figures": detection.values, "uav": uav_id, "alert": detection.code})


def withdraw_for_closed(closed: Iterable[tuple[UUID, int, Closed]]) -> None:
    """Withdraw offers for alerts just closed, given as mission, UAV that flies its mission, and alert. Idempotent.

    An offer stays while another open alert of the UAV justifies it.
    """
    for mission_id, uav_id, change in closed:
        code = CODES_OF.get(change.code)
        if code is None or change.reason != CLEARED:
            continue
        rows = Alert.objects.filter(mission=mission_id, closed_at=None).order_by("opened_at")
        reasons = [
            (row.uav_id, detection) for row in rows if row.uav_id is not None and code_of(detection := _detection_of(row)) is not None
        ]
        if any(uav == uav_id and code_of(detection) == code for uav, detection in reasons):
            continue
        if withdraw(mission_id=mission_id, code=code, uav_id=uav_id):  # it had replaced an offer for another UAV
            suggest_for_detections((mission_id, uav, detection) for uav, detection in reasons if uav != uav_id)


def _detection_of(alert: Alert) -> Detection:
    return Detection(alert.code, alert.level, alert.message, alert.values, alert.subject, alert.details)


def code_of(detection: Detection) -> str | None:
    """Return the code of the offer for a detection; None: no offer."""
    if detection.code == battery.CODE and (detection.level == CRITICAL or detection.details.get("route_short")):
        return BATTERY_SHORT
    if detection.code == link.CODE and detection.level == CRITICAL:
        return UAV_OUT
    if detection.code == down.CODE:
        return UAV_OUT
    if detection.code == mode_changed.CODE and mode_kind(str(detection.details.get("mode") or "")) in COMES_DOWN:
        return UAV_OUT
    return None
