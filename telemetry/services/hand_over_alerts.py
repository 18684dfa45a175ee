"""A UAV that was held to be given another route and hovers without it: said at once, with what is to be done, until somebody does it."""

from missions.services.handover import stuck_hand_overs
from telemetry.models import Alert, AlertLevel
from telemetry.services.alerts import close_alert, open_alert

WAITS = "hand-over-failed"
IS_STUCK = (
    "%(uav)s is held and was to fly on with %(mission)s, but a step failed: %(step)s. %(words)s"
    " Send it its mission again and start it, or tell it to return."
)


def settle_hand_over_alerts() -> None:
    """Opens those that are due, and closes those that are over."""
    stuck = {command.uav_id: command for command in stuck_hand_overs()}
    for command in stuck.values():
        values = {
            "uav": command.uav.name, "mission": str(command.mission), "step": command.get_kind_display(), "words": command.outcome,
        }  # fmt: skip
        open_alert(
            uav=command.uav, level=AlertLevel.CRITICAL, code=WAITS, message=IS_STUCK, values=values, mission=command.mission,
            details={"command": str(command.pk)},
        )  # fmt: skip
    for alert in Alert.objects.filter(code=WAITS, closed_at=None).exclude(uav__in=list(stuck)).select_related("uav"):
        if alert.uav is not None:
            close_alert(uav=alert.uav, code=WAITS)
