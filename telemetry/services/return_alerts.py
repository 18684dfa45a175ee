"""A UAV that was to return and does not, as a command failed: reported at once, with what stands."""

from missions.command_rules import ALONG_ROUTE
from missions.in_air_hooks import uavs_on_the_ground
from missions.models import CommandKind, UavCommand
from missions.services.staggered_returns import stuck_returns
from telemetry.alerting.acts import ACTS, RETURN, acts
from telemetry.models import Alert, AlertLevel
from telemetry.services.alerts import close_alert, open_alert

CODE = "return-not-begun"
HEIGHT_NOT_SET = "No return was sent to %(uav)s, which goes on as before: its return height is not set. %(words)s"
NOT_HELD = "No return was sent to %(uav)s, which goes on as before: it was to hold first. %(words)s"
NOT_ALONG = "%(uav)s does not return along its route, and goes on as before. %(words)s"
NOT_DONE = "%(uav)s was told to return, and does not. %(words)s"


def settle_return_alerts() -> None:
    """Opens those that are due, and closes those that are over: after another command, and on the ground."""
    stuck = {command.uav_id: command for command in stuck_returns()}
    down = uavs_on_the_ground(list(stuck))
    for command in (command for uav_id, command in stuck.items() if uav_id not in down):
        values = {"uav": command.uav.name, "words": command.outcome}
        open_alert(
            uav=command.uav, level=AlertLevel.CRITICAL, code=CODE, message=_message(command), values=values, mission=command.mission,
            details={"command": str(command.pk), ACTS: acts(RETURN, uav_id=command.uav_id)},
        )  # fmt: skip
    over = Alert.objects.filter(code=CODE, closed_at=None).exclude(uav__in=set(stuck) - set(down))
    for alert in over.select_related("uav"):
        if alert.uav is not None:
            close_alert(uav=alert.uav, code=CODE)


def _message(command: UavCommand) -> str:
    if command.parameters.get(ALONG_ROUTE):
        return NOT_ALONG
    return {CommandKind.HOLD: NOT_HELD, CommandKind.SET_RETURN_HEIGHT: HEIGHT_NOT_SET}.get(CommandKind(command.kind), NOT_DONE)
