"""Approved routes for tests."""

from collections.abc import Sequence

from inspection.geodesy import LonLat
from mavlink.approved_route import RETURN, FrozenRoute, FrozenWaypoint, TakeOff
from planning.task import Task
from planning.trajectory.waypoints import WaypointKind

START = LonLat(9.8, 55.4)
GROUND_AMSL_M = 20.0


def waypoint(
    sequence: int,
    kind: WaypointKind,
    *,
    lon: float | None = None,
    relative_m: float = 60.0,
    agl_m: float = 60.0,
    task: Task | None = None,
    target: int | None = None,
    speed_mps: float | None = None,
) -> FrozenWaypoint:
    position = LonLat(START.lon + 0.001 * sequence if lon is None else lon, START.lat)
    return FrozenWaypoint(
        sequence, position, kind, agl_m, relative_m, relative_m + GROUND_AMSL_M, task=task, target=target, speed_mps=speed_mps
    )


def route(waypoints: Sequence[FrozenWaypoint], *, end_action: str = RETURN, charging_stops: tuple[int, ...] = ()) -> FrozenRoute:
    return FrozenRoute("A", TakeOff(START, GROUND_AMSL_M), 12.0, end_action, tuple(waypoints), charging_stops)


def start_and_end(*between: FrozenWaypoint, end_action: str = RETURN) -> FrozenRoute:
    last = len(between) + 1
    return route(
        [waypoint(0, WaypointKind.START, lon=START.lon), *between, waypoint(last, WaypointKind.END, lon=START.lon)], end_action=end_action
    )
