"""Manually edited waypoints compared with those of the current route."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat, distance_m, path_length_m
from missions.services.manual_edits.stored_route import KeptWaypoint
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind
from workspace.locale_negotiation import number_text

MOVED_M = 0.1  # less is rounding
HIGHER_M = 0.05
SAME_SPEED_MPS = 0.005
MAX_WAYPOINTS = 5_000
MAX_LENGTH_M = 1_000_000.0


@dataclass(frozen=True)
class EditedPoint:
    """A requested waypoint. `was` is its place in the current route; None: it is added.

    speed_mps: over ground on the leg to it; None: the UAV's own.
    """

    position: LonLat
    agl_m: float
    was: int | None = None
    speed_mps: float | None = None


def list_faults(points: Sequence[EditedPoint], until_now: Sequence[KeptWaypoint]) -> dict[str, str]:
    """Return the faults of the list itself, which prevent any further check."""
    if any(waypoint.task is not None and waypoint.task.view is not None for waypoint in until_now):
        return {"waypoints": _("This route takes planned photos beside wires: it cannot be changed by hand. Change its targets instead.")}
    if any(waypoint.task is not None and waypoint.task.speed_mps is not None for waypoint in until_now):
        return {"waypoints": _("This route flies along a line at an inspection speed: it cannot be changed by hand. Change its targets.")}
    if len(points) > MAX_WAYPOINTS:
        return {"waypoints": _("At most %(limit)s waypoints.") % {"limit": MAX_WAYPOINTS}}
    kept = [point.was for point in points if point.was is not None]
    if any(not 0 <= was < len(until_now) for was in kept) or any(right <= left for left, right in pairwise(kept)):
        return {"waypoints": _("The waypoints are not in the order of the route.")}
    fixed = [number for number, waypoint in enumerate(until_now) if waypoint.kind != WaypointKind.PASS]
    if not set(fixed) <= set(kept) or points[0].was != 0 or points[-1].was != len(until_now) - 1:
        return {"waypoints": _("Start, end and targets stay on the route. Take a target out of the mission instead.")}
    if path_length_m(np.array([point.position for point in points])) > MAX_LENGTH_M:
        return {"waypoints": _("A route is at most %(limit)s km long.") % {"limit": number_text(MAX_LENGTH_M / 1_000)}}
    return {}


def are_moved(points: Sequence[EditedPoint], until_now: Sequence[KeptWaypoint]) -> list[bool]:
    """Return for each point whether it is added or moved from its former waypoint."""
    before = [point.position if point.was is None else until_now[point.was].position for point in points]
    away_m = distance_m(np.array([point.position for point in points]), np.array(before)).tolist()
    return [point.was is None or metres > MOVED_M for point, metres in zip(points, away_m, strict=True)]


def are_by_hand(points: Sequence[EditedPoint], until_now: Sequence[KeptWaypoint]) -> list[bool]:
    """Return for each point whether its place, height or speed is a manual edit."""
    return [
        is_moved or point.was is None or _is_by_hand(point, until_now[point.was])
        for point, is_moved in zip(points, are_moved(points, until_now), strict=True)
    ]


def _is_by_hand(point: EditedPoint, waypoint: KeptWaypoint) -> bool:
    """Whether a point that stays at its place is a manual edit."""
    is_higher = abs(point.agl_m - waypoint.altitude_agl_m) > HIGHER_M
    return waypoint.is_by_hand or is_higher or not _is_same_speed(point.speed_mps, waypoint.speed_mps)


def _is_same_speed(one_mps: float | None, other_mps: float | None) -> bool:
    if one_mps is None or other_mps is None:
        return one_mps is other_mps
    return abs(one_mps - other_mps) < SAME_SPEED_MPS


def route_points(points: Sequence[EditedPoint], until_now: Sequence[KeptWaypoint]) -> RoutePoints:
    """Return the route points. A moved pass point no longer refers to an asset."""
    drawn = []
    for point, is_moved in zip(points, are_moved(points, until_now), strict=True):
        waypoint = None if point.was is None else until_now[point.was]
        if waypoint is None or (waypoint.kind == WaypointKind.PASS and is_moved):
            drawn.append(RoutePoint(point.position, WaypointKind.PASS, point.agl_m, speed_mps=point.speed_mps))
            continue
        asset = None if waypoint.asset is None else waypoint.asset.key
        drawn.append(RoutePoint(waypoint.position, waypoint.kind, point.agl_m, asset, waypoint.target, waypoint.task, point.speed_mps))
    return RoutePoints.of(drawn)
