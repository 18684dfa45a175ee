"""Alerts of failed commands that left a UAV without its next route or its return. They last until another command is given."""

from collections.abc import Iterable
from typing import Any

from missions.command_rules import ALONG_ROUTE
from missions.hooks.in_air import uavs_on_the_ground
from missions.models import CommandKind, UavCommand
from missions.services.commands.route_swap import stuck_hand_overs
from missions.services.commands.staggered_returns import stuck_returns
from telemetry.alerting.detection import ACTS, RETURN, acts
from telemetry.models import Alert, AlertLevel
from telemetry.selectors.alert_words import outcome_values
from telemetry.services.alerts.alerts import close_alert, open_alert

HAND_OVER_FAILED, RETURN_NOT_BEGUN = "hand-over-failed", "return-not-begun"
IS_STUCK = (
    "%(uav)s is held and was to fly on with %(mission)s, but a step failed: %(step)s. %(words)s"
    " Send it its mission again and start it, or tell it to return."
)
HEIGHT_NOT_SET = "No return was sent to %(uav)s, which goes on as before: its return height is not set. %(words)s"
NOT_HELD = "No return was sent to %(uav)s, which goes on as before: it was to hold first. %(words)s"
NOT_ALONG = "%(uav)s does not return along its route, and goes on as before. %(words)s"
NOT_DONE = "%(uav)s was told to return, and does not. %(words)s"


def settle_command_alerts() -> None:
    """Open alerts that are due and close those that are over; alerts of returns also close once the UAV is on the ground."""
    hand_overs = stuck_hand_overs()
    for command in hand_overs:
        _open(command, HAND_OVER_FAILED, IS_STUCK, {"mission": str(command.mission), "step": command.get_kind_display()}, {})
    _close_others(HAND_OVER_FAILED, hand_overs)
    returns = stuck_returns()
    down = uavs_on_the_ground([command.uav_id for command in returns])
    in_the_air = [command for command in returns if command.uav_id not in down]
    for command in in_the_air:
        _open(command, RETURN_NOT_BEGUN, _return_message(command), {}, {ACTS: acts(RETURN, uav_id=command.uav_id)})
    _close_others(RETURN_NOT_BEGUN, in_the_air)


def _open(command: UavCommand, code: str, message: str, values: dict[str, Any], details: dict[str, Any]) -> None:
    open_alert(
        uav=command.uav, level=AlertLevel.CRITICAL, code=code, message=message, mission=command.mission,
        values={"uav": command.uav.name, **outcome_values(command), **values}, details={"command": str(command.pk), **details},
    )  # fmt: skip


def _close_others(code: str, commands: Iterable[UavCommand]) -> None:
    still = {command.uav_id for command in commands}
    for alert in Alert.objects.filter(code=code, closed_at=None).exclude(uav__in=still).select_related("uav"):
        if alert.uav is not None:
            close_alert(uav=alert.uav, code=code)


def _return_message(command: UavCommand) -> str:
    if command.parameters.get(ALONG_ROUTE):
        return NOT_ALONG
    return {CommandKind.HOLD: NOT_HELD, CommandKind.SET_RETURN_HEIGHT: HEIGHT_NOT_SET}.get(CommandKind(command.kind), NOT_DONE)
