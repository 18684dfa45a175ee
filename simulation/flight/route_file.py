"""A route as a file has it: read, checked, and made the mission items that a vehicle would be given."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from inspection.geodesy import LonLat, path_length_m
from mavlink.approved_route import LAND, FrozenRoute, FrozenWaypoint, TakeOff
from mavlink.mission_items import flight_loads
from mavlink.vehicle_plan import MissionItem
from planning.trajectory.waypoints import WaypointKind

MAX_WAYPOINTS = 9_000
HEIGHTS_M = (1.0, 5_000.0)
SPEEDS_MPS = (0.2, 50.0)
MAX_LEG_M = 200_000.0  # beyond any battery of ours


class InvalidRoute(ValueError):
    """A route file that cannot be flown as it stands; the message names the entry."""


@dataclass(frozen=True)
class RouteFile:
    """Heights count from the ground at the first waypoint."""

    positions: tuple[LonLat, ...]
    altitudes_relative_m: tuple[float, ...]
    speed_mps: float


def read_route(value: Any) -> RouteFile:
    """Of `{"waypoints": [{"position": [lon, lat], "altitude_relative_m"}], "speed_mps"}`. Raises InvalidRoute."""
    if not isinstance(value, Mapping):
        raise InvalidRoute("The route is not an object with waypoints and speed_mps.")
    waypoints = value.get("waypoints")
    if not isinstance(waypoints, list) or not waypoints:
        raise InvalidRoute("waypoints must be a list with at least one waypoint.")
    if len(waypoints) > MAX_WAYPOINTS:
        raise InvalidRoute(f"waypoints has {len(waypoints):,} entries; at most {MAX_WAYPOINTS:,} are flown.")
    positions, heights = [], []
    for number, waypoint in enumerate(waypoints):
        if not isinstance(waypoint, Mapping):
            raise InvalidRoute(f"waypoints[{number}] is not an object with position and altitude_relative_m.")
        positions.append(_position(waypoint.get("position"), f"waypoints[{number}].position"))
        if number and abs(positions[-1].lon - positions[-2].lon) > 180.0:
            raise InvalidRoute(f"waypoints[{number}] is on the other side of the 180th meridian; routes across it are not flown.")
        heights.append(_number(waypoint.get("altitude_relative_m"), f"waypoints[{number}].altitude_relative_m", *HEIGHTS_M))
        if number and (length_m := path_length_m(np.array(positions[-2:]))) > MAX_LEG_M:
            raise InvalidRoute(
                f"waypoints[{number}] is {length_m / 1000:,.0f} km from the one before; at most {MAX_LEG_M / 1000:.0f} km are flown. "
                "A position is [longitude, latitude]."
            )
    return RouteFile(tuple(positions), tuple(heights), _number(value.get("speed_mps"), "speed_mps", *SPEEDS_MPS))


def items_of(route: RouteFile) -> tuple[MissionItem, ...]:
    """Take-off at the first waypoint's ground, all waypoints, landing at the last."""
    waypoints = tuple(
        FrozenWaypoint(number, position, WaypointKind.PASS, height_m, height_m)
        for number, (position, height_m) in enumerate(zip(route.positions, route.altitudes_relative_m, strict=True))
    )
    frozen = FrozenRoute("", TakeOff(route.positions[0], None), route.speed_mps, LAND, waypoints)
    return flight_loads(frozen)[0].mission


def _position(value: Any, place: str) -> LonLat:
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise InvalidRoute(f"{place} must be [longitude, latitude].")
    lon = _number(value[0], f"{place}[0], the longitude,", -180.0, 180.0)
    lat = _number(value[1], f"{place}[1], the latitude,", -85.0, 85.0)
    return LonLat(lon, lat)


def _number(value: Any, place: str, least: float, most: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidRoute(f"{place} must be a number.")
    if not least <= value <= most:  # also of NaN; whole numbers may have hundreds of digits
        raise InvalidRoute(f"{place} must be from {least:g} to {most:g}, not {_shown(value)}.")
    return float(value)


def _shown(value: float) -> str:
    try:
        return f"{value:g}"
    except OverflowError:
        return "a number so large"
