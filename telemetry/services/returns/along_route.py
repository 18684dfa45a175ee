"""RTL path along the approved route: the rest of the onboard list from one of its waypoints on."""

from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np
from django.conf import settings
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from inspection.network.spans import spans_of
from inspection.selectors import ground_heights_m
from inspection.selectors.planning import planning_read
from mavlink.approved_route import Flight
from missions.models import Approval, LinkKind, Uav
from missions.selectors.missions import approval_in_force
from missions.selectors.zones import zone_margins
from missions.services.commands.dispatch import ApprovedLoad, DamagedApproval, approved_load
from missions.services.commands.rtl_check import zones_applying
from missions.services.commands.steering import mission_in_hand
from telemetry.alerting.return_path import Here, ReturnPath, return_path, return_path_points
from telemetry.services.links.onboard_lists import LoadedLists, loaded_on

FURTHER = timedelta(minutes=5)  # after the expected landing; zones in force until then count


@dataclass(frozen=True)
class AlongRoute:
    """A return along the route.

    `item` of the onboard list, counted from 0 without home, is flown to directly. `points` are those of `return_path_points`.
    """

    path: ReturnPath
    item: int
    points: tuple[tuple[LonLat, float, float], ...]


@dataclass(frozen=True)
class OnBoard:
    """A flight of an approval that a UAV holds by its last readback, with nothing known to contradict it since."""

    approved: ApprovedLoad

    @property
    def flight(self) -> Flight:
        return self.approved.route.flights[self.approved.flight - 1]

    def waypoint_of(self, item: int) -> int | None:
        """Return the sequence of an item's waypoint; items count from 0 without home."""
        items = () if self.approved.load is None else self.approved.load.mission
        return items[item].waypoint if 0 <= item < len(items) else None

    def item_of(self, sequence: int) -> int | None:
        """Return the last item of a waypoint; intermediate waypoints precede it."""
        items = () if self.approved.load is None else self.approved.load.mission
        found = [place for place, one in enumerate(items) if one.waypoint == sequence and one.command == mavlink.MAV_CMD_NAV_WAYPOINT]
        return found[-1] if found else None


def on_board(uav: Uav) -> OnBoard | None:
    """Return the onboard flight of its present mission; None unless it surely holds a flight of the approval in force."""
    mission = mission_in_hand(uav) if uav.link == LinkKind.MAVLINK else None
    approval = None if mission is None else approval_in_force(mission)
    if approval is None or approval.revoke_requested_at is not None:
        return None
    return held_flight(approval, uav.pk, loaded_on(uav.pk))


def held_flight(approval: Approval, uav_id: int, loaded: LoadedLists | None) -> OnBoard | None:
    """Return the onboard flight; None if the last readback was not of this approval, or is in doubt."""
    if loaded is None or loaded.doubt or loaded.approval != approval.pk:
        return None
    try:
        approved = approved_load(approval, uav_id=uav_id, flight=loaded.flight)
    except (DamagedApproval, LookupError, StopIteration):
        return None
    return OnBoard(approved) if approved.load is not None and approved.content_sha256 == loaded.sha256 else None


def along_route(held: OnBoard, *, position: LonLat, height_m: float, waypoint: int | None, now: datetime) -> AlongRoute | None:
    """Return the path from the UAV's position; None if none is clear. Raises NoGraph.

    height_m is above its take-off; waypoint is the one that it flies to.
    """
    flight = held.flight
    ahead = next((place for place, one in enumerate(flight.waypoints) if one.sequence == waypoint), None)
    if ahead is None:
        return None
    ground = planning_read().ground()
    positions = np.array([position, *(one.position for one in flight.waypoints[ahead:])], dtype=np.float64)
    lasts = timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s) if flight.waypoints[-1].arrival_s is None else _rest(flight, ahead)
    _near, facts = zones_applying(ground.table, positions, (now.timestamp(), (now + lasts + FURTHER).timestamp()))
    here = Here(position, height_m, ahead)
    path = return_path(
        flight, here, cruise_mps=held.approved.route.cruise_speed_mps, base_m=flight.take_off.altitude_amsl_m,
        ground_heights_m=ground_heights_m, spans=spans_of(ground.network()), zones=facts, margins=zone_margins(),
        rules=settings.FLIGHT_RULES,
    )  # fmt: skip
    item = None if path is None else held.item_of(path.sequence)
    return None if path is None or item is None else AlongRoute(path, item, tuple(return_path_points(flight, path, here)))


def _rest(flight: Flight, ahead: int) -> timedelta:
    """Return the planned duration from the previous waypoint on."""
    arrivals = [one.arrival_s for one in flight.waypoints]
    first, last = arrivals[max(ahead - 1, 0)], arrivals[-1]
    return timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s if first is None or last is None else last - first)
