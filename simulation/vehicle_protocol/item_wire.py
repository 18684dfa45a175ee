"""Mission items as messages bear them, and as each flavour keeps them."""

import math
import struct
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from mavlink.vehicle_plan import MissionItem, MissionType
from simulation.vehicle_protocol.flavour import Flavour
from simulation.vehicle_protocol.stations import Station

E7 = 1e7
_LARGEST_E7 = 2**31 - 1
WITH_PLACE = frozenset(
    {16, 17, 18, 19, 21, 22, 31, 82, 195, 201}
)  # of a mission: waypoints, loiter, land, take-off, splines, regions of interest
# How many of its parameters ArduCopter keeps, as whole numbers (read in its AP_Mission.cpp); the others come back as 0.
KEPT_BY_ARDUPILOT = {
    mavlink.MAV_CMD_NAV_WAYPOINT: 1, mavlink.MAV_CMD_NAV_TAKEOFF: 1, mavlink.MAV_CMD_NAV_LAND: 1, mavlink.MAV_CMD_NAV_LOITER_TIME: 1,
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: 1, mavlink.MAV_CMD_DO_SET_ROI_NONE: 1, mavlink.MAV_CMD_DO_SET_ROI: 1,
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: 0,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: 1, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: 1,
    mavlink.MAV_CMD_NAV_RALLY_POINT: 0,
}  # fmt: skip


def item_of(message: Any) -> MissionItem:
    """Of a MISSION_ITEM_INT or a MISSION_ITEM, whose places are in degrees of 32 bits. Never raises: what is no number stays none."""
    parameters = (message.param1, message.param2, message.param3, message.param4)
    if message.get_type() == "MISSION_ITEM_INT":
        return MissionItem(message.command, message.frame, parameters, message.y, message.x, message.z)
    return MissionItem(message.command, message.frame, parameters, _e7(message.y), _e7(message.x), message.z)


def item_message(item: MissionItem, number: int, kind: MissionType, to: Station, *, is_current: bool) -> Message:
    return mavlink.MAVLink_mission_item_int_message(
        *to.ends, number, item.frame, item.command, int(is_current), 1, *item.parameters,
        item.latitude_e7, item.longitude_e7, item.altitude_m, int(kind),
    )  # fmt: skip


def float_item_message(item: MissionItem, number: int, kind: MissionType, to: Station, *, is_current: bool) -> Message:
    """For who asks by MISSION_REQUEST, as stations did before places became whole numbers."""
    return mavlink.MAVLink_mission_item_message(
        *to.ends, number, item.frame, item.command, int(is_current), 1, *item.parameters,
        item.latitude_e7 / E7, item.longitude_e7 / E7, item.altitude_m, int(kind),
    )  # fmt: skip


def as_kept(item: MissionItem, kind: MissionType, flavour: Flavour) -> MissionItem:
    """What is stored, flown and given back. PX4 keeps all; ArduPilot cuts altitudes to whole centimetres and forgets parameters."""
    if flavour is Flavour.PX4:
        return item
    parameters = [0.0 if math.isnan(value) else value for value in item.parameters]
    kept = KEPT_BY_ARDUPILOT.get(item.command)
    if kept is not None:
        parameters = [float(math.trunc(value)) if place < kept else 0.0 for place, value in enumerate(parameters)]
    one, two, three, four = parameters
    if kind is MissionType.MISSION and item.command not in WITH_PLACE:
        return MissionItem(item.command, mavlink.MAV_FRAME_GLOBAL, (one, two, three, four))
    frame = {mavlink.MAV_FRAME_GLOBAL_INT: mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: 3}.get(
        item.frame, item.frame
    )
    altitude_m = 0.0 if math.isnan(item.altitude_m) else math.trunc(_float32(_float32(item.altitude_m) * 100.0)) / 100.0
    return MissionItem(item.command, frame, (one, two, three, four), item.longitude_e7, item.latitude_e7, altitude_m)


def _e7(degrees: float) -> int:
    """Out of range where it is no number, so that it is refused for its place."""
    return max(-_LARGEST_E7, min(_LARGEST_E7, round(degrees * E7))) if math.isfinite(degrees) else _LARGEST_E7


def _float32(value: float) -> float:
    return float(struct.unpack("<f", struct.pack("<f", value))[0])
