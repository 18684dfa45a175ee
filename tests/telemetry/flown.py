"""An approved route flown in the log: a report a second, as a UAV that does what it was told would have sent them."""

import math
from collections.abc import Iterator
from datetime import datetime, timedelta
from typing import Any

from django.test import Client

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute, FrozenWaypoint, route_from_json
from mavlink.decoding.measurement import Measurement
from missions.models import Approval, LinkKind, Mission, Uav
from telemetry.services import NewRecord, store_records

SPEED_MPS = 12.0
USED_PERCENT_S = 0.02


def route_of(approval: Approval, uav: Uav) -> FrozenRoute:
    return route_from_json(next(route["route"] for route in approval.document["routes"] if route["uav"] == uav.pk))


def fly(approval: Approval, uav: Uav, began_at: datetime, *, leaves_out: int | None = None, every_s: int = 1) -> datetime:
    """Stores it all; `leaves_out` is a waypoint of the route that is passed 300 m off. Returns when it was over."""
    records = []
    at = began_at
    for number, measurement in enumerate(_each_second(route_of(approval, uav), leaves_out)):
        at = began_at + timedelta(seconds=number)
        if number % every_s == 0:
            boot_ms = 1_000 * number
            records.append(NewRecord(uav.pk, LinkKind.MAVLINK, "flight", boot_ms, at, at, measurement, mission_id=approval.mission_id))
    store_records(records)
    return at


def _each_second(route: FrozenRoute, leaves_out: int | None) -> Iterator[Measurement]:
    frame = LocalFrame.around(*route.take_off.position)
    east, north, height_m, battery = *_metres(frame, route.take_off.position), 0.0, 100.0
    for waypoint in route.waypoints:
        to_east, to_north = _metres(frame, waypoint.position)
        if waypoint.sequence == leaves_out:
            to_north += 300.0
        away_m = math.dist((east, north, height_m), (to_east, to_north, waypoint.altitude_relative_m))
        steps = max(math.ceil(away_m / SPEED_MPS), 1)
        for step in range(1, steps + 1 + _hold_s(waypoint)):
            share = min(step / steps, 1.0)
            battery -= USED_PERCENT_S
            is_moving = step <= steps
            yield Measurement(
                *_degrees(frame, east + share * (to_east - east), north + share * (to_north - north)),
                altitude_relative_m=height_m + share * (waypoint.altitude_relative_m - height_m),
                velocity_east_mps=(to_east - east) / steps if is_moving else 0.0,
                velocity_north_mps=(to_north - north) / steps if is_moving else 0.0,
                heading_deg=math.degrees(math.atan2(to_east - east, to_north - north)) % 360.0,
                battery_percent=battery,
                mode="Mission",
                is_armed=True,
                is_in_air=True,
                waypoint_sequence=waypoint.sequence,
            )
        east, north, height_m = to_east, to_north, waypoint.altitude_relative_m


def _hold_s(waypoint: FrozenWaypoint) -> int:
    return 0 if waypoint.task is None else math.ceil(waypoint.task.hold_s)


def _metres(frame: LocalFrame, place: LonLat) -> tuple[float, float]:
    return (place.lon - frame.origin.lon) * frame.metres_per_degree_east, (place.lat - frame.origin.lat) * frame.metres_per_degree_north


def _degrees(frame: LocalFrame, east_m: float, north_m: float) -> tuple[float, float]:
    return frame.origin.lon + east_m / frame.metres_per_degree_east, frame.origin.lat + north_m / frame.metres_per_degree_north


def record_of(client: Client, mission: Mission) -> dict[str, Any]:
    answer = client.get(f"/api/v1/missions/{mission.pk}/record")
    assert answer.status_code == 200, answer.content
    found: dict[str, Any] = answer.json()
    return found
