"""Items that a simulated UAV accepts. Others are refused with the matching MAVLink result."""

import math
from collections.abc import Sequence

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.vehicle_plan import MissionItem, MissionType
from simulation.flight.orders import MAX_HEIGHT_M, CannotFly, orders
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot

MAX_ITEMS = {
    SimulatedAutopilot.PX4: {MissionType.MISSION: 2_000, MissionType.FENCE: 64, MissionType.RALLY: 32},
    SimulatedAutopilot.ARDUPILOT: {MissionType.MISSION: 649, MissionType.FENCE: 84, MissionType.RALLY: 50},  # without home
}
ABOVE_SEA = frozenset({mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT})
RELATIVE = frozenset({mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT})
PLACED_FRAMES = RELATIVE | ABOVE_SEA
POLYGONS = frozenset({mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION})
CIRCLES = frozenset({mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION})
FENCE = POLYGONS | CIRCLES | {mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT}
INVALID_PARAMETERS = {
    1: mavlink.MAV_MISSION_INVALID_PARAM1, 2: mavlink.MAV_MISSION_INVALID_PARAM2, 3: mavlink.MAV_MISSION_INVALID_PARAM3,
    4: mavlink.MAV_MISSION_INVALID_PARAM4, 5: mavlink.MAV_MISSION_INVALID_PARAM5_X, 6: mavlink.MAV_MISSION_INVALID_PARAM6_Y,
    7: mavlink.MAV_MISSION_INVALID_PARAM7,
}  # fmt: skip


def refusal_of(item: MissionItem, kind: MissionType) -> int | None:
    """Return the MAV_MISSION_RESULT for an item that is refused by itself; None if accepted."""
    if kind is MissionType.MISSION:
        # The destination of a jump is checked with the complete list.
        return None if item.command == mavlink.MAV_CMD_DO_JUMP else _refusal_of_mission((item,))
    if item.command not in (FENCE if kind is MissionType.FENCE else {mavlink.MAV_CMD_NAV_RALLY_POINT}):
        return int(mavlink.MAV_MISSION_UNSUPPORTED)
    return _refusal_of_place(item)


def refusal_of_list(items: Sequence[MissionItem], kind: MissionType) -> int | None:
    """Return the result for a list of accepted items; None if accepted."""
    if kind is MissionType.MISSION:
        return _refusal_of_mission(items)
    return _refusal_of_fence(items) if kind is MissionType.FENCE else None


def begins_with_take_off(items: Sequence[MissionItem]) -> bool:
    """Return whether the first navigation command of a list without home is a take-off; True for a list without any.

    ArduCopter flies no other list from the ground (AP_Mission::starts_with_takeoff_cmd). Navigation commands are those below
    MAV_CMD_NAV_LAST.
    """
    flown = next((item.command for item in items if item.command < mavlink.MAV_CMD_NAV_LAST), None)
    return flown in (None, mavlink.MAV_CMD_NAV_TAKEOFF)


def _refusal_of_mission(items: Sequence[MissionItem]) -> int | None:
    try:
        orders(items, is_home_first=False)
    except CannotFly as error:
        if error.code == "frame":
            return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
        return int(INVALID_PARAMETERS.get(error.parameter, mavlink.MAV_MISSION_UNSUPPORTED))
    return None


def _refusal_of_place(item: MissionItem) -> int | None:
    if item.frame not in PLACED_FRAMES:
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    for number, value in enumerate(item.parameters, 1):
        if math.isinf(value):
            return int(INVALID_PARAMETERS[number])
    if abs(item.latitude_e7) > 900_000_000:
        return int(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if abs(item.longitude_e7) > 1_800_000_000:
        return int(mavlink.MAV_MISSION_INVALID_PARAM6_Y)
    return None if abs(item.altitude_m) <= MAX_HEIGHT_M else int(mavlink.MAV_MISSION_INVALID_PARAM7)


def _refusal_of_fence(items: Sequence[MissionItem]) -> int | None:
    """Check polygons: each vertex has the number of vertices, and they are consecutive."""
    place = 0
    while place < len(items):
        item = items[place]
        if item.command in CIRCLES and not item.parameters[0] > 0:
            return int(mavlink.MAV_MISSION_INVALID_PARAM1)
        if item.command not in POLYGONS:
            place += 1
            continue
        count = item.parameters[0]
        if not (count >= 3 and count == int(count)):
            return int(mavlink.MAV_MISSION_INVALID_PARAM1)
        vertices = items[place : place + int(count)]
        if len(vertices) < count or any((one.command, one.parameters[0]) != (item.command, count) for one in vertices):
            return int(mavlink.MAV_MISSION_INVALID_PARAM1)
        place += int(count)
    return None
