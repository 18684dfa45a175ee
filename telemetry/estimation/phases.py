"""What a UAV is doing, from the names that autopilots give their modes."""

from enum import StrEnum


class Phase(StrEnum):
    MISSION = "mission"  # along the approved route
    TAKE_OFF = "take-off"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"
    FREE = "free"  # as a person steers it
    GROUND = "ground"


# As mavlink/autopilot_type.py names them: PX4's, then ArduCopter's, then what companions say.
_PHASES = {
    "MISSION": Phase.MISSION, "TAKEOFF": Phase.TAKE_OFF, "LOITER": Phase.HOLD, "RTL": Phase.RETURN, "LAND": Phase.LAND,
    "PRECLAND": Phase.LAND,
    "AUTO": Phase.MISSION, "BRAKE": Phase.HOLD, "POSHOLD": Phase.HOLD, "SMART_RTL": Phase.RETURN, "AUTO_RTL": Phase.RETURN,
    "HOLD": Phase.HOLD, "RETURN": Phase.RETURN, "TAKE-OFF": Phase.TAKE_OFF,
}  # fmt: skip


def phase_of(mode: str, *, is_armed: bool | None, is_in_air: bool | None) -> Phase | None:
    """None where nothing is said of it. A mode that is not known is flown by somebody: nothing can be foreseen of it."""
    if is_in_air is False or (is_armed is False and is_in_air is None):
        return Phase.GROUND
    name = mode.strip().upper()
    return _PHASES.get(name, Phase.FREE) if name else None
