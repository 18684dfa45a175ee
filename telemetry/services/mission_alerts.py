"""A vehicle that holds part of one mission and part of another must not fly: said at once, until it is over."""

from missions.models import UavCommand
from telemetry.models import AlertLevel
from telemetry.selectors.alerts import MIXED
from telemetry.services.alerts import close_alert, open_alert


def tell_of_mission(command: UavCommand, *, is_mixed: bool, words: str) -> None:
    """After a load was brought, or while it is."""
    if not is_mixed:
        close_alert(uav=command.uav, code=MIXED)
        return
    message = f"{command.uav.name} holds a mix of missions. {words}"
    details = {"command": str(command.pk)}
    open_alert(uav=command.uav, level=AlertLevel.CRITICAL, code=MIXED, message=message, mission=command.mission, details=details)
