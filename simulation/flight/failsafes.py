"""What the autopilot does by itself when its battery or its position fails."""

from simulation.flight.cockpit import Cockpit
from simulation.flight.manoeuvres import Hold, Land, Manoeuvre, Return
from simulation.flight.settings import OwnAction
from simulation.flight.states import Mode, Severity

STRENGTH = {Mode.RETURN: 1, Mode.LAND: 2}  # what is under way is not given up for less


class Failsafes:
    """Each speaks and acts once, until what it is about is well again."""

    def __init__(self) -> None:
        self._battery_level = 0
        self._gps_lost_since_s: float | None = None
        self._has_acted_on_gps = False

    def step(self, cockpit: Cockpit, mode: Mode, battery_percent: float, *, is_gps_lost: bool) -> Manoeuvre | None:
        """What to do from now on; None: as before."""
        manoeuvre = self._gps(cockpit, mode, is_gps_lost=is_gps_lost)
        return self._battery(cockpit, mode, battery_percent) or manoeuvre

    def _battery(self, cockpit: Cockpit, mode: Mode, percent: float) -> Manoeuvre | None:
        settings = cockpit.settings
        thresholds = (settings.battery_warn_percent, settings.battery_low_percent, settings.battery_critical_percent)
        level = sum(percent <= threshold for threshold in thresholds)
        if level <= self._battery_level:
            self._battery_level = level
            return None
        self._battery_level = level
        if level == 1:
            cockpit.say(f"Battery {percent:.0f} %", Severity.WARNING)
            return None
        action = settings.battery_low_action if level == 2 else settings.battery_critical_action
        severity = Severity.WARNING if level == 2 else Severity.CRITICAL
        return _act(cockpit, mode, action, f"Battery {'low' if level == 2 else 'critical'}: {percent:.0f} %", severity)

    def _gps(self, cockpit: Cockpit, mode: Mode, *, is_gps_lost: bool) -> Manoeuvre | None:
        if not is_gps_lost:
            if self._gps_lost_since_s is not None:
                cockpit.say("GPS fix again")
            self._gps_lost_since_s, self._has_acted_on_gps = None, False
            return None
        if self._gps_lost_since_s is None:
            self._gps_lost_since_s = cockpit.now_s
            cockpit.say("No GPS fix, dead reckoning", Severity.WARNING)
        if self._has_acted_on_gps or cockpit.now_s - self._gps_lost_since_s < cockpit.settings.gps_lost_patience_s:
            return None
        self._has_acted_on_gps = True
        return _act(cockpit, mode, cockpit.settings.gps_lost_action, "GPS lost", Severity.CRITICAL)


def _act(cockpit: Cockpit, mode: Mode, action: OwnAction, why: str, severity: Severity) -> Manoeuvre | None:
    manoeuvre = _manoeuvre(action)
    if manoeuvre is None or not cockpit.is_in_air or STRENGTH.get(mode, 0) >= STRENGTH.get(manoeuvre.mode, 0) > 0:
        cockpit.say(why, severity)
        return None
    cockpit.say(f"{why}: {manoeuvre.mode}", severity)
    return manoeuvre


def _manoeuvre(action: OwnAction) -> Manoeuvre | None:
    if action is OwnAction.HOLD:
        return Hold()
    if action is OwnAction.RETURN:
        return Return()
    return Land() if action is OwnAction.LAND else None
