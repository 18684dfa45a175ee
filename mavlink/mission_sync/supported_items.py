"""Mission items that a vehicle's firmware supports, and substitutes for those that it does not.

ArduPilot accepts DO_SET_ROI_LOCATION and DO_SET_ROI_NONE as mission items since 4.7 (its pull request 29567), IMAGE_START_CAPTURE since 4.4
(23147), and DO_SET_ROI in every version. A DO_SET_ROI without position and altitude ends the region of interest (its AC_AutoYaw::set_roi).
PX4 refuses CONDITION_YAW in missions (its mavlink_mission.cpp); it turns its nose to a region of interest by itself (MIS_MNT_YAW_CTL 0).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.vehicle_plan import MissionItem

Version = tuple[int, int, int]
PHOTO_RADIUS_M = 0.5  # within which a waypoint beside wires is reached: PX4's own may be 10 m
ROI_SINCE: Version = (4, 7, 0)
KNOWN_SINCE: Mapping[AutopilotType, Mapping[int, Version]] = {AutopilotType.ARDUPILOT: {mavlink.MAV_CMD_IMAGE_START_CAPTURE: (4, 4, 0)}}
NAMES = {AutopilotType.ARDUPILOT: "ArduPilot", AutopilotType.PX4: "PX4"}


@dataclass(frozen=True)
class UnknownItem:
    """A mission item that the firmware refuses; `place` counts from 0."""

    place: int
    item: MissionItem


def as_old_roi(item: MissionItem) -> MissionItem:
    """Return the item as DO_SET_ROI; other items unchanged."""
    if item.command == mavlink.MAV_CMD_DO_SET_ROI_LOCATION:
        return replace(item, command=mavlink.MAV_CMD_DO_SET_ROI, parameters=(float(mavlink.MAV_ROI_LOCATION), 0.0, 0.0, 0.0))
    if item.command == mavlink.MAV_CMD_DO_SET_ROI_NONE:
        frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
        return MissionItem(mavlink.MAV_CMD_DO_SET_ROI, frame, (float(mavlink.MAV_ROI_NONE), 0.0, 0.0, 0.0), waypoint=item.waypoint)
    return item


def as_px4(item: MissionItem) -> MissionItem:
    """Return CONDITION_YAW as a delay of 0 s; other items unchanged. The list keeps its length, and items their places."""
    if item.command != mavlink.MAV_CMD_CONDITION_YAW:
        return item
    return replace(item, command=mavlink.MAV_CMD_NAV_DELAY, parameters=(0.0, -1.0, -1.0, -1.0))


def as_ardupilot(item: MissionItem) -> MissionItem:
    """Return a waypoint beside wires without its radius, which ArduPilot discards: it flies on to the place while it waits there."""
    if item.command != mavlink.MAV_CMD_NAV_WAYPOINT or item.parameters[1] != PHOTO_RADIUS_M:
        return item
    hold_s, _radius_m, passing_m, yaw_deg = item.parameters
    return replace(item, parameters=(hold_s, 0.0, passing_m, yaw_deg))


def as_known(items: Sequence[MissionItem], autopilot_type: AutopilotType, firmware: Version | None) -> tuple[MissionItem, ...]:
    """Return the items as this firmware accepts them. An unknown version counts as an old one."""
    if autopilot_type is AutopilotType.PX4:
        return tuple(map(as_px4, items))
    if autopilot_type is not AutopilotType.ARDUPILOT:
        return tuple(items)
    items = tuple(map(as_ardupilot, items))
    return items if firmware is not None and firmware >= ROI_SINCE else tuple(map(as_old_roi, items))


def unknown_items(items: Sequence[MissionItem], autopilot_type: AutopilotType, firmware: Version | None) -> list[UnknownItem]:
    """Return the items that this firmware refuses; none while its version is unknown."""
    if firmware is None:
        return []
    since = KNOWN_SINCE.get(autopilot_type, {})
    return [UnknownItem(place, item) for place, item in enumerate(items) if firmware < since.get(item.command, firmware)]


def firmware_words(autopilot_type: AutopilotType | None, firmware: Version | None) -> str:
    """Return name and version, as "ArduPilot 4.6.0"; the name only if the version is unknown."""
    name = "The autopilot" if autopilot_type is None else NAMES.get(autopilot_type, "The autopilot")
    return name if firmware is None else f"{name} {'.'.join(map(str, firmware))}"


def command_words(command: int) -> str:
    """Return name and number, as "DO_SET_ROI (201)"."""
    entry = mavlink.enums["MAV_CMD"].get(command)
    return f"command {command}" if entry is None else f"{entry.name.removeprefix('MAV_CMD_')} ({command})"


def version_of(words: str) -> Version | None:
    """Parse "4.6.0"; None for anything else."""
    parts = words.split(".")
    if len(parts) != 3 or not all(part.isdecimal() for part in parts):
        return None
    major, minor, patch = map(int, parts)
    return major, minor, patch
