"""Maps the item of a vehicle's list to the waypoint of its approved route.

An autopilot counts the items of its list: with home as item 0 on ArduPilot, and with speeds, tasks and intermediate waypoints. The onboard
list as read back gives the waypoint of each item.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from uuid import UUID

from django.db import connection

from mavlink.autopilot_type import AutopilotType
from missions.models import Approval
from missions.services.commands.dispatch import DamagedApproval, approved_load


@dataclass(frozen=True, slots=True)
class LoadedList:
    """The list read back at `read_at`: `waypoints` of its items, and `first`, the number of the first item; `flight` is the route's."""

    mission_id: UUID
    read_at: datetime
    first: int
    waypoints: tuple[int | None, ...]
    flight: int = 1

    def waypoint_of(self, item: int | None) -> int | None:
        """Return the waypoint of an item, as the vehicle counts; None for home, and outside the list."""
        if item is None or not 0 <= item - self.first < len(self.waypoints):
            return None
        return self.waypoints[item - self.first]

    def waypoint_at(self, item: int | None, measured_at: datetime, mission_id: UUID | None) -> int | None:
        """Return the waypoint; None before the readback, as a late report may refer to another list."""
        return self.waypoint_of(item) if mission_id == self.mission_id and measured_at >= self.read_at else None


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
            mission_id, waypoints = approved
            found[uav_id] = LoadedList(mission_id, read_at, 1 if autopilot == AutopilotType.ARDUPILOT else 0, waypoints, flight)
    return found


@lru_cache(maxsize=256)
def _approved_waypoints(approval_id: UUID, uav_id: int, flight: int) -> tuple[UUID, tuple[int | None, ...]] | None:
    """Return the mission, and the waypoint of each item; None without items for an autopilot. An approval never changes."""
    approval = Approval.objects.filter(pk=approval_id).first()
    if approval is None:
        return None
    try:
        approved = approved_load(approval, uav_id=uav_id, flight=flight)
    except (DamagedApproval, LookupError, StopIteration):
        return None
    if approved.load is None:
        return None
    return approved.mission, tuple(item.waypoint for item in approved.load.mission)
