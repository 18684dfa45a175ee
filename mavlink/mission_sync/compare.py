"""Compares a vehicle's readback with the approved list, item by item.

Known conversions by an autopilot are not differences; everything else is, and is named. ArduPilot (observed in ArduCopter 4.6.0-dev, read
in its AP_Mission.cpp) truncates altitudes to centimetres and some parameters to whole numbers, uses the frame GLOBAL for items without a
position, and discards some parameters. A discarded parameter is a difference only where a value other than 0 or "autopilot's choice" was
sent. ArduPilot may have received DO_SET_ROI in place of newer commands (see supported_items). PX4 (read in its mavlink_mission.cpp) also
discards some parameters and stores a yaw in radians. Fence and rally items have no `autocontinue`: ArduPilot returns 0. All values are 32
bits on the wire.
"""

import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum, auto
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.supported_items import as_ardupilot, as_old_roi, as_px4
from mavlink.mission_sync.wire import OnboardItem, OnboardList
from mavlink.vehicle_plan import MissionItem
from operation.reasons import Reason

CENTIMETRE_M = 0.01
YAW_DEG = 0.001  # after conversion to radians in 32 bits
NOT_FLOWN = frozenset({
    mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, mavlink.MAV_CMD_NAV_RALLY_POINT,
})  # fmt: skip
PLACELESS_ON_ARDUPILOT = frozenset({mavlink.MAV_FRAME_MISSION, mavlink.MAV_FRAME_GLOBAL})
SAME_FRAME: dict[int, int] = {
    mavlink.MAV_FRAME_GLOBAL_INT: mavlink.MAV_FRAME_GLOBAL,
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
    mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT: mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT,
}


FIELDS = {name: Reason(f"field_{name}") for name in ("command", "frame", "longitude", "latitude", "altitude")}
FIELDS |= {f"parameter {number}": Reason("field_parameter", {"number": number}) for number in range(1, 5)}
FIELDS["going on afterwards"] = Reason("field_going_on")
VALUES = {value: Reason(f"value_{value}") for value in ("missing", "nothing", "yes", "no")}


class ReadbackMatch(StrEnum):
    NOTHING = "nothing"
    APPROVED = "approved"  # the wanted list
    KNOWN = "known"  # another complete approved list
    MIXED = "mixed"  # parts of approved lists
    FOREIGN = "foreign"  # includes an item of none of these


def found(
    held: OnboardList, wanted: Sequence[MissionItem], known: Sequence[Sequence[MissionItem]], autopilot_type: AutopilotType
) -> ReadbackMatch:
    """Return how the readback relates to the approved lists.

    known: other lists approved for this vehicle. Lists of one mission often begin alike, so these are needed to detect a mix.
    """
    if not differences(wanted, held, autopilot_type):
        return ReadbackMatch.APPROVED
    if not held:
        return ReadbackMatch.NOTHING
    if any(not differences(items, held, autopilot_type) for items in known):
        return ReadbackMatch.KNOWN
    lists = [wanted, *(items for items in known if items)]
    if len(lists) == 1:
        return ReadbackMatch.FOREIGN
    is_of_some = (any(place in _of_list(held, items, autopilot_type) for items in lists) for place in range(len(held)))
    return ReadbackMatch.MIXED if all(is_of_some) else ReadbackMatch.FOREIGN


def mix_of(held: OnboardList, wanted: Sequence[MissionItem], before: OnboardList | None, autopilot_type: AutopilotType) -> Reason:
    """Return where each item comes from: "0-2 are new, 3-6 are of the list before". `before` is None if unknown."""
    new = _of_list(held, wanted, autopilot_type)
    whose: list[str] = []
    for place, there in enumerate(held):
        is_old = before is not None and place < len(before) and is_identical(before[place], there)
        if place in new and is_old and whose:
            whose.append(whose[-1])  # both lists have this item
        elif place in new:
            whose.append("new")
        elif is_old:
            whose.append("before")
        else:
            whose.append("neither" if before is not None else "not_approved")
    runs: list[tuple[int, int, str]] = []
    for place, origin in enumerate(whose):
        if runs and runs[-1][2] == origin:
            runs[-1] = (runs[-1][0], place, origin)
        else:
            runs.append((place, place, origin))
    parts = [
        Reason(f"item_{origin}" if first == last else f"items_{origin}", {"item": first, "last": last}) for first, last, origin in runs
    ]
    return Reason("mix", {"held": len(held), "wanted": len(wanted), "parts": parts}) if parts else Reason("no_items")


def _of_list(held: OnboardList, items: Sequence[MissionItem], autopilot_type: AutopilotType) -> set[int]:
    """Return the places at which the vehicle holds this list's item."""
    return {place for place, (item, there) in enumerate(zip(items, held, strict=False)) if is_same(item, there.item, autopilot_type)}


class Keeps(Enum):
    """How an autopilot stores a parameter."""

    ALL = auto()
    WHOLE = auto()  # truncated to a whole number
    NOTHING = auto()
    YAW = auto()
    NOT_YAW = auto()  # overwritten if no yaw was sent


ALL, WHOLE, NOTHING, YAW, NOT_YAW = Keeps
FOUR_ALL = (ALL, ALL, ALL, ALL)
ARDUPILOT_KEEPS = {
    mavlink.MAV_CMD_NAV_WAYPOINT: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_TAKEOFF: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_LAND: (WHOLE, NOTHING, NOTHING, NOT_YAW),
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: (NOTHING, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_LOITER_TIME: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_DO_CHANGE_SPEED: (WHOLE, ALL, ALL, NOTHING),
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_DO_SET_ROI_NONE: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_DO_SET_ROI: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_IMAGE_START_CAPTURE: (WHOLE, ALL, WHOLE, WHOLE),
    mavlink.MAV_CMD_CONDITION_YAW: (ALL, ALL, WHOLE, WHOLE),
    mavlink.MAV_CMD_DO_SET_SERVO: (WHOLE, WHOLE, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_RALLY_POINT: (NOTHING, NOTHING, NOTHING, NOTHING),
}
PX4_KEEPS = {
    mavlink.MAV_CMD_NAV_WAYPOINT: (ALL, ALL, NOTHING, YAW),
    mavlink.MAV_CMD_NAV_TAKEOFF: (NOTHING, NOTHING, NOTHING, YAW),
    mavlink.MAV_CMD_NAV_LAND: (NOTHING, ALL, NOTHING, YAW),
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: (NOTHING, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: (WHOLE, NOTHING, NOTHING, NOTHING),
    mavlink.MAV_CMD_NAV_RALLY_POINT: (NOTHING, NOTHING, NOTHING, NOTHING),
}
KEEPS = {AutopilotType.ARDUPILOT: ARDUPILOT_KEEPS, AutopilotType.PX4: PX4_KEEPS}


@dataclass(frozen=True)
class ItemDifference:
    """One difference. `item` is the place in the approved list, counted from 0; `field` names what differs."""

    item: int
    field: str
    wanted: str
    held: str
    waypoint: int | None = None

    @property
    def params(self) -> dict[str, Any]:
        field = FIELDS.get(self.field, self.field)
        return {"item": self.item, "field": field, "wanted": VALUES.get(self.wanted, self.wanted), "held": VALUES.get(self.held, self.held)}


def differences(wanted: Sequence[MissionItem], held: OnboardList, autopilot_type: AutopilotType) -> tuple[ItemDifference, ...]:
    """Return all differences in list order; empty if the lists match. `held` excludes home (see `onboard_list`)."""
    return tuple(_differences(wanted, held, autopilot_type))


def _differences(wanted: Sequence[MissionItem], held: OnboardList, autopilot_type: AutopilotType) -> Iterator[ItemDifference]:
    for place, (item, there) in enumerate(zip(wanted, held, strict=False)):
        for name, asked_for, found in _of_item(item, there.item, autopilot_type):
            yield ItemDifference(place, name, asked_for, found, item.waypoint)
        if not there.goes_on and item.command not in NOT_FLOWN:
            yield ItemDifference(place, "going on afterwards", "yes", "no", item.waypoint)
    for place in range(len(held), len(wanted)):
        yield ItemDifference(place, "command", str(wanted[place].command), "missing", wanted[place].waypoint)
    for place in range(len(wanted), len(held)):
        yield ItemDifference(place, "command", "nothing", str(held[place].item.command))


def is_identical(one: OnboardItem, other: OnboardItem) -> bool:
    """Return whether two items that were read have the same values; NaN equals NaN."""
    left, right = one.item, other.item
    return (
        (left.command, left.frame, left.longitude_e7, left.latitude_e7, one.goes_on)
        == (right.command, right.frame, right.longitude_e7, right.latitude_e7, other.goes_on)
        and _is_float32(left.altitude_m, right.altitude_m)
        and all(map(_is_float32, left.parameters, right.parameters))
    )


def are_identical(one: OnboardList, other: OnboardList) -> bool:
    return len(one) == len(other) and all(map(is_identical, one, other))


def is_same(wanted: MissionItem, held: MissionItem, autopilot_type: AutopilotType) -> bool:
    return next(_of_item(wanted, held, autopilot_type), None) is None


def _of_item(wanted: MissionItem, held: MissionItem, autopilot_type: AutopilotType) -> Iterator[tuple[str, str, str]]:
    if autopilot_type is AutopilotType.ARDUPILOT:
        wanted = as_ardupilot(wanted)
    if autopilot_type is AutopilotType.ARDUPILOT and held.command == mavlink.MAV_CMD_DO_SET_ROI:
        wanted = as_old_roi(wanted)
    if autopilot_type is AutopilotType.PX4:
        wanted = as_px4(wanted)
    if wanted.command != held.command:
        yield "command", str(wanted.command), str(held.command)
        return
    if not _is_same_frame(wanted, held, autopilot_type):
        yield "frame", str(wanted.frame), str(held.frame)
    if wanted.longitude_e7 != held.longitude_e7:
        yield "longitude", f"{wanted.longitude_e7 / 1e7:.7f}", f"{held.longitude_e7 / 1e7:.7f}"
    if wanted.latitude_e7 != held.latitude_e7:
        yield "latitude", f"{wanted.latitude_e7 / 1e7:.7f}", f"{held.latitude_e7 / 1e7:.7f}"
    if not _is_same_altitude(wanted.altitude_m, held.altitude_m, autopilot_type):
        yield "altitude", f"{wanted.altitude_m:g} m", f"{held.altitude_m:g} m"
    keeps = KEEPS.get(autopilot_type, {}).get(wanted.command, FOUR_ALL)
    for number, (asked_for, found, kept) in enumerate(zip(wanted.parameters, held.parameters, keeps, strict=True), 1):
        if not _is_kept(asked_for, found, kept):
            yield f"parameter {number}", f"{asked_for:g}", f"{found:g}"


def _is_same_frame(wanted: MissionItem, held: MissionItem, autopilot_type: AutopilotType) -> bool:
    if autopilot_type is AutopilotType.ARDUPILOT and wanted.frame == mavlink.MAV_FRAME_MISSION:
        return held.frame in PLACELESS_ON_ARDUPILOT
    return _plain_frame(wanted.frame) == _plain_frame(held.frame)


def _plain_frame(frame: int) -> int:
    return SAME_FRAME.get(frame, frame)


def _is_same_altitude(wanted_m: float, held_m: float, autopilot_type: AutopilotType) -> bool:
    if _is_float32(wanted_m, held_m):
        return True
    if autopilot_type is not AutopilotType.ARDUPILOT or not (math.isfinite(wanted_m) and math.isfinite(held_m)):
        return False
    rounding_m = max(abs(wanted_m), 1.0) * 2.0**-22  # of two 32-bit values
    lost_m = abs(wanted_m) - abs(held_m)
    return wanted_m * held_m >= 0 and -rounding_m <= lost_m < CENTIMETRE_M + rounding_m


def _is_kept(wanted: float, held: float, keeps: Keeps) -> bool:
    is_open = wanted == 0 or math.isnan(wanted)
    if keeps is NOTHING:
        return held == 0 and is_open
    if keeps is NOT_YAW:
        return is_open and held in (0.0, 1.0, -1.0)
    if _is_float32(wanted, held):
        return True
    if keeps is WHOLE:
        return (math.isfinite(wanted) and held == math.trunc(wanted)) or (math.isnan(wanted) and held == 0)
    return keeps is YAW and abs(wanted - held) < YAW_DEG


def _is_float32(wanted: float, held: float) -> bool:
    if math.isnan(wanted) or math.isnan(held):
        return math.isnan(wanted) and math.isnan(held)
    if wanted == held:
        return True
    try:
        return bool(struct.pack("<f", wanted) == struct.pack("<f", held))
    except OverflowError:
        return False
