"""Phases of flight, by autopilots' names of their modes."""

from enum import StrEnum


class Phase(StrEnum):
    MISSION = "mission"  # along the approved route
    TAKE_OFF = "take-off"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"
    FREE = "free"  # flown manually
    GROUND = "ground"


# Names of mavlink/autopilot_type.py: PX4's, then ArduCopter's, then those of companions.
_PHASES = {
    "MISSION": Phase.MISSION, "TAKEOFF": Phase.TAKE_OFF, "LOITER": Phase.HOLD, "RTL": Phase.RETURN, "LAND": Phase.LAND,
    "PRECLAND": Phase.LAND,
    "AUTO": Phase.MISSION, "BRAKE": Phase.HOLD, "POSHOLD": Phase.HOLD, "SMART_RTL": Phase.RETURN, "AUTO_RTL": Phase.RETURN,
    "HOLD": Phase.HOLD, "RETURN": Phase.RETURN, "TAKE-OFF": Phase.TAKE_OFF,
}  # fmt: skip


def phase_of(mode: str, *, is_armed: bool | None, is_in_air: bool | None) -> Phase | None:
    """Return the phase; None if nothing is reported. An unknown mode counts as flown manually, so nothing is predicted."""
    if is_in_air is False or (is_armed is False and is_in_air is None):
        return Phase.GROUND
    name = mode.strip().upper()
    return _PHASES.get(name, Phase.FREE) if name else None
