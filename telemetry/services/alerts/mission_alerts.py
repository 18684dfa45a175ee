"""Alerts of vehicles that hold an unapproved mission and must not fly: opened at once, and closed when resolved."""

from collections.abc import Sequence

from missions.models import UavCommand
from operation.reasons import Reason
from telemetry.models import AlertLevel
from telemetry.selectors.alert_words import why_values
from telemetry.selectors.alerts import MIXED, OTHER_LIST
from telemetry.services.alerts.alerts import close_alert, open_alert

IS_MIXED = "%(uav)s holds a mix of missions. %(words)s"
HOLDS_OTHER = "%(uav)s was not started: another list than the approved one is on board. %(words)s"


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
