"""Airframes: each is a JSBSim model file and an entry here."""

from dataclasses import dataclass
from enum import StrEnum

from planning.rules import FlightRules

AS_PLANNED = FlightRules()


@dataclass(frozen=True, slots=True)
class Airframe:
    """Data of a model file for the autopilot. The file has the physics, and the source of each value.

    max_airspeed_mps       that plans may use; the tilt limit leaves some more for gusts
    max_speed_mps          over ground, regardless of the mission
    climb_mps, descent_mps as in plans, and as an operator sets the autopilot; each airframe can do more
    acceleration_mps2      along a straight leg, accelerating and braking
    corner_mps2            lateral, in the rounded corner before a passed waypoint; ArduCopter's is twice its WPNAV_ACCEL of 2.5
    empty_cell_v, full_cell_v, resistance_ohm
                           the battery's open-circuit voltage at 0 and 100 %, and its internal resistance
    """

    code: str
    name: str
    mass_kg: float
    battery_wh: float
    cells: int
    max_airspeed_mps: float
    max_speed_mps: float
    cruise_speed_mps: float
    climb_mps: float = AS_PLANNED.climb_speed_mps
    descent_mps: float = AS_PLANNED.climb_speed_mps
    acceleration_mps2: float = 2.0
    corner_mps2: float = 2.5
    empty_cell_v: float = 3.5
    full_cell_v: float = 4.2
    resistance_ohm: float = 0.02


AIRFRAMES = {
    airframe.code: airframe
    for airframe in (
        Airframe(
            code="iris",
            name="Iris",
            mass_kg=1.545,
            battery_wh=56.6,  # 3S 5.1 Ah
            cells=3,
            max_airspeed_mps=11.0,
            max_speed_mps=10.0,
            cruise_speed_mps=5.0,  # PX4's MPC_XY_CRUISE
        ),
        Airframe(
            code="inspector",
            name="Inspector",
            mass_kg=3.77,
            battery_wh=263.2,  # 2 x 131.6 Wh
            cells=6,
            max_airspeed_mps=19.0,
            max_speed_mps=17.0,
            cruise_speed_mps=10.0,
            corner_mps2=5.0,
            resistance_ohm=0.03,
        ),
    )
}


class OwnAction(StrEnum):
    """Actions of the autopilot without an order."""

    NONE = "none"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of the autopilot. Heights are metres above the take-off, shares are percent of a full battery.

    `return_adds_to_rally_point`: the RTL height is measured from a rally point's own height, as PX4 does; else the higher of both is flown,
    as ArduPilot does. `turns_to_target`: the nose turns to what the gimbal looks at, as PX4's does (MIS_MNT_YAW_CTL 0); else only that of a
    UAV whose gimbal has no pan, as ArduPilot's.

    Defaults are those of PX4 v1.15 where it has them: MIS_TAKEOFF_ALT 2.5, RTL_RETURN_ALT 60 (30 here: inspections fly low), RTL_MIN_DIST
    10 (0 here, with RTL_CONE_ANG 0: it climbs at any distance from home), BAT_LOW_THR 15 %, BAT_CRIT_THR 7 %, NAV_ACC_RAD 10 (2 here: a
    target is to be passed), COM_DISARM_PRFLT 10 s. PX4's default action on a low battery is a warning (COM_LOW_BAT_ACT 0); here it returns
    and then lands, the usual setting for flights over people.
    """

    take_off_height_m: float = 2.5
    return_height_m: float = 30.0
    return_near_m: float = 0.0
    return_adds_to_rally_point: bool = True
    acceptance_m: float = 2.0
    battery_warn_percent: float = 25.0
    battery_low_percent: float = 15.0
    battery_low_action: OwnAction = OwnAction.RETURN
    battery_critical_percent: float = 7.0
    battery_critical_action: OwnAction = OwnAction.LAND
    gps_lost_patience_s: float = 10.0
    gps_lost_action: OwnAction = OwnAction.LAND
    disarm_on_ground_s: float = 10.0
    turns_to_target: bool = True
