"""Autopilot types and how each numbers its flight modes."""

from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_class import ARDUPILOT_NAMES, VehicleClass


class AutopilotType(StrEnum):
    PX4 = "px4"
    ARDUPILOT = "ardupilot"
    OTHER = "other"


COMMANDED = frozenset({AutopilotType.PX4, AutopilotType.ARDUPILOT})  # other autopilots are not commanded: their behaviour is unknown


def autopilot_type_of(autopilot: int) -> AutopilotType:
    """Return the type for a heartbeat's MAV_AUTOPILOT value."""
    if autopilot == mavlink.MAV_AUTOPILOT_PX4:
        return AutopilotType.PX4
    return AutopilotType.ARDUPILOT if autopilot == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA else AutopilotType.OTHER


class Mode(StrEnum):
    """Flight modes that the ground station requests or evaluates; each autopilot numbers them differently."""

    MISSION = "mission"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"
    TAKE_OFF = "take-off"
    GUIDED = "guided"


# PX4: main mode and sub mode; sources: its px4_custom_mode.h, and findings of MAVSDK
PX4_AUTO = 4
PX4_SUB_MODES = {Mode.TAKE_OFF: 2, Mode.HOLD: 3, Mode.MISSION: 4, Mode.RETURN: 5, Mode.LAND: 6}
PX4_MAIN_NAMES = {1: "MANUAL", 2: "ALTCTL", 3: "POSCTL", 5: "ACRO", 6: "OFFBOARD", 7: "STABILIZED", 8: "RATTITUDE"}
PX4_AUTO_NAMES = {1: "READY", 2: "TAKEOFF", 3: "LOITER", 4: "MISSION", 5: "RTL", 6: "LAND", 8: "FOLLOW", 9: "PRECLAND"}

# ArduCopter: BRAKE holds without a pilot; LOITER descends unless a stick holds the throttle
COPTER_MODES = {Mode.MISSION: 3, Mode.GUIDED: 4, Mode.RETURN: 6, Mode.LAND: 9, Mode.HOLD: 17}
COPTER_NAMES = {
    0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 5: "LOITER", 6: "RTL", 7: "CIRCLE", 9: "LAND", 11: "DRIFT",
    13: "SPORT", 14: "FLIP", 15: "AUTOTUNE", 16: "POSHOLD", 17: "BRAKE", 18: "THROW", 19: "AVOID_ADSB", 20: "GUIDED_NOGPS",
    21: "SMART_RTL", 22: "FLOWHOLD", 23: "FOLLOW", 24: "ZIGZAG", 25: "SYSTEMID", 26: "AUTOROTATE", 27: "AUTO_RTL",
}  # fmt: skip
COPTER_HOLDING = frozenset({4, 5, 16, 17})  # modes that do not fly the mission: GUIDED, LOITER, POSHOLD, BRAKE
COPTER_NOT_ARMABLE = frozenset({3, 6, 9, 17, 21, 27})  # ArduCopter cannot be armed in these: a start begins with GUIDED
RESTARTS = "MIS_RESTART"  # ArduPilot: unless 0, each change to AUTO restarts the mission
COPTER_RETURNING = frozenset({6, 21, 27})
OTHERS_NAMES = {Mode.MISSION: "AUTO", Mode.RETURN: "RTL", Mode.GUIDED: "GUIDED"}  # of ArduPilot planes and rovers, which are only monitored


MISSION_MODES = frozenset({PX4_AUTO_NAMES[PX4_SUB_MODES[Mode.MISSION]], COPTER_NAMES[COPTER_MODES[Mode.MISSION]]})  # mode names


def px4_mode(custom_mode: int) -> tuple[int, int]:
    """Return main mode and sub mode."""
    return custom_mode >> 16 & 0xFF, custom_mode >> 24 & 0xFF


def mode_name(autopilot_type: AutopilotType, custom_mode: int, vehicle_class: VehicleClass = VehicleClass.COPTER) -> str:
    if autopilot_type is AutopilotType.PX4:
        main, sub = px4_mode(custom_mode)
        return PX4_AUTO_NAMES.get(sub, f"AUTO {sub}") if main == PX4_AUTO else PX4_MAIN_NAMES.get(main, f"MODE {main}")
    if autopilot_type is AutopilotType.ARDUPILOT:
        names = COPTER_NAMES if vehicle_class is VehicleClass.COPTER else ARDUPILOT_NAMES.get(vehicle_class, {})
        return names.get(custom_mode, f"MODE {custom_mode}")
    return f"MODE {custom_mode}"


def is_in_mode(autopilot_type: AutopilotType, custom_mode: int, mode: Mode, vehicle_class: VehicleClass = VehicleClass.COPTER) -> bool:
    if autopilot_type is AutopilotType.PX4:
        return px4_mode(custom_mode) == (PX4_AUTO, PX4_SUB_MODES.get(mode))
    if autopilot_type is AutopilotType.ARDUPILOT and vehicle_class is not VehicleClass.COPTER:
        return mode_name(autopilot_type, custom_mode, vehicle_class) == OTHERS_NAMES.get(mode)
    if autopilot_type is AutopilotType.ARDUPILOT:
        if mode is Mode.HOLD:
            return custom_mode in COPTER_HOLDING - {COPTER_MODES[Mode.GUIDED]}
        if mode is Mode.RETURN:
            return custom_mode in COPTER_RETURNING
        return COPTER_MODES.get(mode) == custom_mode
    return False
