"""Which waypoint of its approved route a vehicle is at, from the item that its own list is at.

An autopilot counts the items of the list that it holds: with home as item 0 on ArduPilot, and with speeds, tasks and points put in between
waypoints. What is on the vehicle, as it was read back, says to which waypoint each belongs.
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
    """What was read back from a vehicle at `read_at`: `waypoints` are those of its items, `first` is the number of the first of them."""

    mission_id: UUID
    read_at: datetime
    first: int
    waypoints: tuple[int | None, ...]

    def waypoint_of(self, item: int | None) -> int | None:
        """That belongs to the item, as the vehicle counts; None for home, and for what is not in the list."""
        if item is None or not 0 <= item - self.first < len(self.waypoints):
            return None
        return self.waypoints[item - self.first]

    def waypoint_at(self, item: int | None, measured_at: datetime, mission_id: UUID | None) -> int | None:
        """None before it was read back: a report that comes late may be of another list."""
        return self.waypoint_of(item) if mission_id == self.mission_id and measured_at >= self.read_at else None


def lists_on(uav_ids: Iterable[int]) -> dict[int, LoadedList]:
    """By UAV; without those that hold nothing that was approved, or of which that is in doubt."""
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
            found[uav_id] = LoadedList(mission_id, read_at, 1 if autopilot == AutopilotType.ARDUPILOT else 0, waypoints)
    return found


@lru_cache(maxsize=256)
def _approved_waypoints(approval_id: UUID, uav_id: int, flight: int) -> tuple[UUID, tuple[int | None, ...]] | None:
    """The mission, and the waypoint of each item; an approval never changes. None where it has no items for an autopilot."""
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
