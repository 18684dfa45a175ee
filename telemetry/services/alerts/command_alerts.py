"""Alerts of commands that failed and left a UAV without its next route or its return, and of vehicles with an unapproved mission."""

from collections.abc import Iterable, Sequence
from typing import Any

from missions.command_rules import ALONG_ROUTE
from missions.hooks.in_air import uavs_on_the_ground
from missions.models import CommandKind, UavCommand
from missions.services.commands.route_swap import stuck_hand_overs
from missions.services.commands.staggered_returns import stuck_returns
from operation.reasons import Reason
from telemetry.alerting.detection import ACTS, RETURN, acts
from telemetry.models import Alert, AlertLevel
from telemetry.selectors.alert_words import outcome_values, why_values
from telemetry.selectors.alerts import MIXED, OTHER_LIST
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
IS_MIXED = "%(uav)s holds a mix of missions. %(words)s"
HOLDS_OTHER = "%(uav)s was not started: another list than the approved one is on board. %(words)s"


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


def raise_mission_mismatch(command: UavCommand, *, is_mixed: bool, why: Sequence[Reason]) -> None:
    """Open or close the alert, after an upload or during it."""
    if not is_mixed:
        close_alert(uav=command.uav, code=MIXED)
        return
    open_alert(
        uav=command.uav, level=AlertLevel.CRITICAL, code=MIXED, message=IS_MIXED, values={"uav": command.uav.name, **why_values(why)},
        mission=command.mission, details={"command": str(command.pk)},
    )  # fmt: skip


def raise_other_list(command: UavCommand, why: Sequence[Reason] = ()) -> None:
    """Open the alert after a readback before a start or resume; without reasons the list is the approved one, and the alert is closed."""
    if not why:
        close_alert(uav=command.uav, code=OTHER_LIST)
        return
    open_alert(
        uav=command.uav, level=AlertLevel.CRITICAL, code=OTHER_LIST, message=HOLDS_OTHER, mission=command.mission,
        values={"uav": command.uav.name, **why_values(why)}, details={"command": str(command.pk)},
    )  # fmt: skip
