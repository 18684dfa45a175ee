"""A vehicle that holds part of one mission and part of another must not fly: said at once, until it is over."""

from missions.models import UavCommand
from telemetry.models import AlertLevel
from telemetry.services.alerts import close_alert, open_alert

MIXED = "mission-mixed"
LIMITS = "mission-limits"


def tell_of_mission(command: UavCommand, *, is_mixed: bool, words: str) -> None:
    """After a load was brought, or while it is."""
    if not is_mixed:
        close_alert(uav=command.uav, code=MIXED)
        return
    message = f"{command.uav.name} holds a mix of missions. {words}"
    details = {"command": str(command.pk)}
    open_alert(uav=command.uav, level=AlertLevel.CRITICAL, code=MIXED, message=message, mission=command.mission, details=details)


def tell_of_limits(command: UavCommand, *, words: str) -> None:
    """Of a mission that the vehicle holds and would refuse to fly; without words there is nothing."""
    if not words:
        close_alert(uav=command.uav, code=LIMITS)
        return
    message = f"{command.uav.name} would not fly its mission. {words}"
    open_alert(uav=command.uav, level=AlertLevel.WARNING, code=LIMITS, message=message, mission=command.mission)
