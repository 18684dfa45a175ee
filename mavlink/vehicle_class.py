"""Vehicle classes by the MAV_TYPE of the heartbeat, and the mode numbers of ArduPilot's firmware for each.

Spanwise plans for multicopters. It commands no other class on ArduPilot, whose mode numbers differ there. PX4 numbers its modes alike on
all classes, so those can at least be held, returned and landed.
"""

from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from operation.reasons import Reason


class VehicleClass(StrEnum):
    COPTER = "multicopter"
    PLANE = "plane"
    VTOL = "VTOL"
    ROVER = "rover"
    BOAT = "boat"
    SUBMARINE = "submarine"
    OTHER = "vehicle of another kind"


_CLASSES = {
    VehicleClass.COPTER: (
        mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_TYPE_COAXIAL, mavlink.MAV_TYPE_HELICOPTER, mavlink.MAV_TYPE_HEXAROTOR,
        mavlink.MAV_TYPE_OCTOROTOR, mavlink.MAV_TYPE_TRICOPTER, mavlink.MAV_TYPE_DODECAROTOR, mavlink.MAV_TYPE_DECAROTOR,
        mavlink.MAV_TYPE_GENERIC_MULTIROTOR,
    ),
    VehicleClass.PLANE: (mavlink.MAV_TYPE_FIXED_WING, mavlink.MAV_TYPE_FLAPPING_WING),
    VehicleClass.VTOL: (*range(mavlink.MAV_TYPE_VTOL_DUOROTOR, mavlink.MAV_TYPE_VTOL_RESERVED5 + 1), mavlink.MAV_TYPE_VTOL_GYRODYNE),
    VehicleClass.ROVER: (mavlink.MAV_TYPE_GROUND_ROVER,),
    VehicleClass.BOAT: (mavlink.MAV_TYPE_SURFACE_BOAT,),
    VehicleClass.SUBMARINE: (mavlink.MAV_TYPE_SUBMARINE,),
}  # fmt: skip
_CLASS_OF = {mav_type: vehicle_class for vehicle_class, types in _CLASSES.items() for mav_type in types}

# ArduPilot's sources: ArduPlane/mode.h, Rover/mode.h
PLANE_NAMES = {
    0: "MANUAL", 1: "CIRCLE", 2: "STABILIZE", 3: "TRAINING", 4: "ACRO", 5: "FLY_BY_WIRE_A", 6: "FLY_BY_WIRE_B", 7: "CRUISE",
    8: "AUTOTUNE", 10: "AUTO", 11: "RTL", 12: "LOITER", 13: "TAKEOFF", 14: "AVOID_ADSB", 15: "GUIDED", 16: "INITIALISING",
    17: "QSTABILIZE", 18: "QHOVER", 19: "QLOITER", 20: "QLAND", 21: "QRTL", 22: "QAUTOTUNE", 23: "QACRO", 24: "THERMAL",
    25: "LOITER_ALT_QLAND", 26: "AUTOLAND",
}  # fmt: skip
ROVER_NAMES = {
    0: "MANUAL", 1: "ACRO", 3: "STEERING", 4: "HOLD", 5: "LOITER", 6: "FOLLOW", 7: "SIMPLE", 8: "DOCK", 9: "CIRCLE", 10: "AUTO",
    11: "RTL", 12: "SMART_RTL", 15: "GUIDED", 16: "INITIALISING",
}  # fmt: skip
ARDUPILOT_NAMES = {
    VehicleClass.PLANE: PLANE_NAMES,
    VehicleClass.VTOL: PLANE_NAMES,
    VehicleClass.ROVER: ROVER_NAMES,
    VehicleClass.BOAT: ROVER_NAMES,
}


def class_of(mav_type: int | None) -> VehicleClass:
    return VehicleClass.OTHER if mav_type is None else _CLASS_OF.get(mav_type, VehicleClass.OTHER)


def type_name(mav_type: int) -> str:
    """Return the name of a MAV_TYPE, as "fixed wing"."""
    entry = mavlink.enums["MAV_TYPE"].get(mav_type)
    return entry.name.removeprefix("MAV_TYPE_").replace("_", " ").lower() if entry else f"type {mav_type}"


def refusal_of(vehicle_class: VehicleClass) -> Reason:
    """Return why the vehicle receives no mission."""
    kind = "other" if vehicle_class is VehicleClass.OTHER else vehicle_class.value
    return Reason("only_multicopters", {"kind": Reason(f"kind_{kind}")})
