"""What an autopilot's parameters set: heights, thresholds, and what it does by itself."""

from dataclasses import dataclass
from enum import StrEnum


class OwnAction(StrEnum):
    """What the autopilot does without being told."""

    NONE = "none"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"


@dataclass(frozen=True, slots=True)
class Settings:
    """Heights are metres above the take-off, shares percent of a full battery. `return_adds_to_haven`: over a rally point the height of
    returns counts from that point's own height, as PX4 has it; else the higher of both is flown, as ArduPilot does.

    Defaults as PX4 v1.15 has them where it has them: MIS_TAKEOFF_ALT 2.5, RTL_RETURN_ALT 60 (30 here: UAVs inspect low), RTL_MIN_DIST 10
    (0 here, with RTL_CONE_ANG 0: it climbs however near home it is), BAT_LOW_THR 15 %, BAT_CRIT_THR 7 %, NAV_ACC_RAD 10 (2 here: a target
    is to be passed), COM_DISARM_PRFLT 10 s. Its own answer to a low battery is a warning (COM_LOW_BAT_ACT 0); here it returns and then
    lands, as those who fly over people set it.
    """

    take_off_height_m: float = 2.5
    return_height_m: float = 30.0
    return_near_m: float = 0.0
    return_adds_to_haven: bool = True
    acceptance_m: float = 2.0
    battery_warn_percent: float = 25.0
    battery_low_percent: float = 15.0
    battery_low_action: OwnAction = OwnAction.RETURN
    battery_critical_percent: float = 7.0
    battery_critical_action: OwnAction = OwnAction.LAND
    gps_lost_patience_s: float = 10.0
    gps_lost_action: OwnAction = OwnAction.LAND
    disarm_on_ground_s: float = 10.0
