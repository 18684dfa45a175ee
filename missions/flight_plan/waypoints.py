"""The points of a route, without and with heights above sea level and take-off."""

from enum import StrEnum
from typing import NamedTuple

from inspection.geodesy import LonLat
from missions.routing.problem import Task


class WaypointKind(StrEnum):
    START = "start"
    PASS = "pass"  # noqa: S105 (no password)
    TARGET = "target"
    END = "end"


class RoutePoint(NamedTuple):
    """A point of a route at its planned height above ground.

    asset is the primary key of the asset that is passed or inspected here; target the index of the target that is being done.
    """

    position: LonLat
    kind: WaypointKind
    agl_m: float
    asset: int | None = None
    target: int | None = None
    task: Task | None = None


class Waypoint(NamedTuple):
    """A route point and its height over the other two references; above sea level only where the ground's height is known."""

    point: RoutePoint
    amsl_m: float | None
    relative_m: float


def point_between(left: RoutePoint, right: RoutePoint, share: float) -> RoutePoint:
    """A point that is passed on the straight lon/lat line; between two points of one target it belongs to the target."""
    lon = left.position.lon + share * (right.position.lon - left.position.lon)
    lat = left.position.lat + share * (right.position.lat - left.position.lat)
    agl_m = left.agl_m + share * (right.agl_m - left.agl_m)
    return RoutePoint(LonLat(lon, lat), WaypointKind.PASS, agl_m, target=left.target if left.target == right.target else None)
