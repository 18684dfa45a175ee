"""Maps the item of a vehicle's list to the waypoint of its approved route.

An autopilot counts the items of its list: with home as item 0 on ArduPilot, and with speeds, tasks and intermediate waypoints. The onboard
list as read back gives the waypoint of each item.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from typing import NamedTuple
from uuid import UUID

from django.db import connection
from pymavlink.dialects.v20 import common as mavlink

from inspection.geodesy import LonLat
from mavlink.autopilot_type import AutopilotType
from mavlink.vehicle_plan import MissionItem
from missions.models import Approval
from missions.services.commands.dispatch import DamagedApproval, approved_load

E7, M_PER_DEGREE = 1e7, 111_195.0
NEAR_ITEMS = 8  # between the item that a vehicle reports and the one that takes the photo


class PhotoItem(NamedTuple):
    """An item that takes photos: its place in the list, its waypoint, and where it is flown; the height is above take-off."""

    number: int
    waypoint: int
    position: LonLat
    height_m: float

    def away2(self, position: LonLat, height_m: float | None) -> float:
        """Return the square of the distance [m²]; without a height the horizontal one."""
        east_m = (position.lon - self.position.lon) * M_PER_DEGREE * math.cos(math.radians(position.lat))
        north_m = (position.lat - self.position.lat) * M_PER_DEGREE
        return float(east_m**2 + north_m**2 + (0.0 if height_m is None else (height_m - self.height_m) ** 2))


@dataclass(frozen=True, slots=True)
class LoadedList:
    """The list read back at `read_at`: `waypoints` of its items, and `first`, the number of the first item; `flight` is the route's.

    `photos` are the items that take photos.
    """

    mission_id: UUID
    read_at: datetime
    first: int
    waypoints: tuple[int | None, ...]
    flight: int = 1
    photos: tuple[PhotoItem, ...] = ()

    def waypoint_of(self, item: int | None) -> int | None:
        """Return the waypoint of an item, as the vehicle counts; None for home, and outside the list."""
        if item is None or not 0 <= item - self.first < len(self.waypoints):
            return None
        return self.waypoints[item - self.first]

    def waypoint_at(self, item: int | None, measured_at: datetime, mission_id: UUID | None) -> int | None:
        """Return the waypoint; None before the readback, as a late report may refer to another list."""
        return self.waypoint_of(item) if mission_id == self.mission_id and measured_at >= self.read_at else None

    def waypoint_of_photo(self, item: int | None, position: LonLat | None, height_m: float | None, *, is_late: bool = False) -> int | None:
        """Return the waypoint that a photo belongs to while the vehicle's list was at this item.

        A vehicle reports its item once a second, and may go on to the next as it takes the photo: of the nearby items that take photos
        the nearest in space counts. is_late: reported later, with the list at any item by then.
        """
        if item is None or position is None:
            return self.waypoint_of(item)
        near = [one for one in self.photos if is_late or abs(one.number - (item - self.first)) <= NEAR_ITEMS]
        nearest = min(near, key=lambda one: (one.away2(position, height_m), one.number), default=None)
        return self.waypoint_of(item) if nearest is None else nearest.waypoint


def lists_on(uav_ids: Iterable[int]) -> dict[int, LoadedList]:
    """Return the lists by UAV; without UAVs that hold nothing approved, or whose list is in doubt."""
    with connection.cursor() as cursor:
        cursor.execute(
            "SELECT uav_id, loaded_approval, loaded_flight, autopilot, loaded_read_at FROM telemetry_uavlink WHERE uav_id = ANY(%s) "
            "AND loaded_approval IS NOT NULL AND loaded_flight IS NOT NULL AND loaded_read_at IS NOT NULL AND loaded_doubt = ''",
            [sorted(uav_ids)],
        )
        rows = cursor.fetchall()
    found = {}
    for uav_id, approval, flight, autopilot, read_at in rows:
        approved = _approved_waypoints(approval, uav_id, flight)
        if approved is not None:
            mission_id, waypoints, photos = approved
            found[uav_id] = LoadedList(mission_id, read_at, 1 if autopilot == AutopilotType.ARDUPILOT else 0, waypoints, flight, photos)
    return found


@lru_cache(maxsize=256)
def _approved_waypoints(approval_id: UUID, uav_id: int, flight: int) -> tuple[UUID, tuple[int | None, ...], tuple[PhotoItem, ...]] | None:
    """Return the mission, the waypoint of each item, and the items that take photos; None without items for an autopilot.

    An approval never changes.
    """
    approval = Approval.objects.filter(pk=approval_id).first()
    if approval is None:
        return None
    try:
        approved = approved_load(approval, uav_id=uav_id, flight=flight)
    except (DamagedApproval, LookupError, StopIteration):
        return None
    if approved.load is None:
        return None
    items = approved.load.mission
    return approved.mission, tuple(item.waypoint for item in items), tuple(_photo_items(items))


def _photo_items(items: Sequence[MissionItem]) -> Iterator[PhotoItem]:
    place: MissionItem | None = None
    for index, item in enumerate(items):
        if item.command == mavlink.MAV_CMD_NAV_WAYPOINT:
            place = item
        elif item.command == mavlink.MAV_CMD_IMAGE_START_CAPTURE and place is not None and item.waypoint is not None:
            yield PhotoItem(index, item.waypoint, LonLat(place.longitude_e7 / E7, place.latitude_e7 / E7), place.altitude_m)
