"""A vehicle that holds part of one mission and part of another must not fly: said at once, until it is over."""

from missions.models import UavCommand
from telemetry.models import AlertLevel
from telemetry.selectors.alerts import MIXED
from telemetry.services.alerts import close_alert, open_alert

IS_MIXED = "%(uav)s holds a mix of missions. %(words)s"


def tell_of_mission(command: UavCommand, *, is_mixed: bool, words: str) -> None:
    """After a load was brought, or while it is."""
    if not is_mixed:
        close_alert(uav=command.uav, code=MIXED)
        return
    open_alert(
        uav=command.uav, level=AlertLevel.CRITICAL, code=MIXED, message=IS_MIXED, values={"uav": command.uav.name, "words": words},
        mission=command.mission, details={"command": str(command.pk)},
    )  # fmt: skip
