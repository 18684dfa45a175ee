"""Mission lists as sent on the wire, with home first if the autopilot expects it."""

import hashlib
import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import Addressing, Message
from mavlink.autopilot_type import AutopilotType
from mavlink.mission_sync.supported_items import Version, as_known
from mavlink.vehicle_plan import MissionItem, MissionType

NOTHING = MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_FRAME_GLOBAL_INT, (0.0, 0.0, 0.0, 0.0))


@dataclass(frozen=True)
class OnboardItem:
    """An item as the vehicle holds it. Without `goes_on` (`autocontinue`) the vehicle would stop there."""

    item: MissionItem
    goes_on: bool = True


OnboardList = tuple[OnboardItem, ...]


def has_home(kind: MissionType, autopilot_type: AutopilotType) -> bool:
    """Return whether item 0 is home. ArduPilot ignores what is sent there; a list without it would lose its first item."""
    return kind is MissionType.MISSION and autopilot_type is AutopilotType.ARDUPILOT


def sent_list(
    items: Sequence[MissionItem], kind: MissionType, autopilot_type: AutopilotType, firmware: Version | None = None
) -> tuple[MissionItem, ...]:
    """Return the items to send, by commands that the firmware supports; empty for an empty list."""
    items = as_known(items, autopilot_type, firmware)
    if not items or not has_home(kind, autopilot_type):
        return items
    placed = next((item for item in items if item.longitude_e7 or item.latitude_e7), NOTHING)
    home = MissionItem(NOTHING.command, NOTHING.frame, NOTHING.parameters, placed.longitude_e7, placed.latitude_e7)
    return (home, *items)


def onboard_list(read: OnboardList, kind: MissionType, autopilot_type: AutopilotType) -> OnboardList:
    """Return the items that were read, without home."""
    return read[1:] if has_home(kind, autopilot_type) else read


def onboard_sha256(held: OnboardList) -> str:
    """Return the hash of a list as read. Values are hashed as on the wire; all NaN are equal."""
    rows = [
        (
            there.item.command, there.item.frame, there.item.longitude_e7, there.item.latitude_e7, there.goes_on,
            *(None if math.isnan(value) else struct.pack("<f", value).hex() for value in (*there.item.parameters, there.item.altitude_m)),
        )
        for there in held
    ]  # fmt: skip
    return hashlib.sha256(repr(rows).encode()).hexdigest()


def item_message(item: MissionItem, sequence: int, kind: MissionType, addressing: Addressing) -> Message:
    return mavlink.MAVLink_mission_item_int_message(
        addressing.system,
        addressing.component,
        sequence,
        item.frame,
        item.command,
        0,
        1,
        *item.parameters,
        item.latitude_e7,
        item.longitude_e7,
        item.altitude_m,
        int(kind),
    )


def onboard_item(message: Message) -> OnboardItem:
    """Return the item of a MISSION_ITEM_INT."""
    item = MissionItem(
        command=message.command,
        frame=message.frame,
        parameters=(message.param1, message.param2, message.param3, message.param4),
        longitude_e7=message.y,
        latitude_e7=message.x,
        altitude_m=message.z,
    )
    return OnboardItem(item, bool(message.autocontinue))


def ack_message(result: int, kind: MissionType, addressing: Addressing) -> Message:
    return mavlink.MAVLink_mission_ack_message(addressing.system, addressing.component, result, int(kind))


def result_name(result: int) -> str:
    """Return the code of a MAV_MISSION_RESULT, such as `no-space`."""
    entry = mavlink.enums["MAV_MISSION_RESULT"].get(result)
    return f"result-{result}" if entry is None else entry.name.removeprefix("MAV_MISSION_").lower().replace("_", "-")
