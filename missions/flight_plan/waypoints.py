"""The points of a route, without and with heights above sea level and take-off."""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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


class RoutePoints:
    """Points of a route, column by column: some hundred points are a handful of lists. Taken one by one, each is a RoutePoint.

    position holds [lon, lat], kind the values of WaypointKind; lists of points may share a [lon, lat], so nobody changes one.
    """

    __slots__ = ("agl_m", "asset", "kind", "position", "target", "task")

    def __init__(self, points: Sequence[RoutePoint] = ()) -> None:
        self.position: list[list[float]] = [list(point.position) for point in points]
        self.kind: list[str] = [point.kind.value for point in points]
        self.agl_m: list[float] = [point.agl_m for point in points]
        self.asset: list[int | None] = [point.asset for point in points]
        self.target: list[int | None] = [point.target for point in points]
        self.task: list[Task | None] = [point.task for point in points]

    def __len__(self) -> int:
        return len(self.position)

    def __getitem__(self, place: int) -> RoutePoint:
        lon, lat = self.position[place]
        kind = WaypointKind(self.kind[place])
        return RoutePoint(LonLat(lon, lat), kind, self.agl_m[place], self.asset[place], self.target[place], self.task[place])

    def __iter__(self) -> Iterator[RoutePoint]:
        return map(self.__getitem__, range(len(self)))

    def append(self, point: RoutePoint) -> None:
        self.position.append(list(point.position))
        self.kind.append(point.kind.value)
        self.agl_m.append(point.agl_m)
        self.asset.append(point.asset)
        self.target.append(point.target)
        self.task.append(point.task)

    def extend_passed(self, position: Sequence[list[float]], agl_m: Sequence[float], asset: Sequence[int | None]) -> None:
        """Points that are only passed."""
        count = len(position)
        self.position += position
        self.kind += [WaypointKind.PASS.value] * count
        self.agl_m += agl_m
        self.asset += asset
        self.target += [None] * count
        self.task += [None] * count

    def extend(self, points: "RoutePoints", first: int, end: int) -> None:
        """Those of the points from the first up to but without the end."""
        self.position += points.position[first:end]
        self.kind += points.kind[first:end]
        self.agl_m += points.agl_m[first:end]
        self.asset += points.asset[first:end]
        self.target += points.target[first:end]
        self.task += points.task[first:end]

    def pop(self) -> None:
        """Take the last point away."""
        del self.position[-1], self.kind[-1], self.agl_m[-1], self.asset[-1], self.target[-1], self.task[-1]

    def positions(self) -> NDArray[np.float64]:
        """Lon lat of each, shape (n, 2)."""
        flat = np.fromiter(chain.from_iterable(self.position), dtype=np.float64, count=2 * len(self.position))
        return flat.reshape(-1, 2)


class Waypoint(NamedTuple):
    """A route point and its height over the other two references; above sea level only where the ground's height is known."""

    point: RoutePoint
    amsl_m: float | None
    relative_m: float


class Waypoints:
    """Waypoints, column by column; taken one by one, each is a Waypoint. amsl_m is None where the ground is not known."""

    __slots__ = ("amsl_m", "points", "relative_m")

    def __init__(self, points: RoutePoints, amsl_m: list[float] | None, relative_m: list[float]) -> None:
        self.points = points
        self.amsl_m = amsl_m
        self.relative_m = relative_m

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, place: int) -> Waypoint:
        return Waypoint(self.points[place], None if self.amsl_m is None else self.amsl_m[place], self.relative_m[place])

    def __iter__(self) -> Iterator[Waypoint]:
        return map(self.__getitem__, range(len(self)))


def point_between(left: RoutePoint, right: RoutePoint, share: float) -> RoutePoint:
    """A point that is passed on the straight lon/lat line; between two points of one target it belongs to the target."""
    lon = left.position.lon + share * (right.position.lon - left.position.lon)
    lat = left.position.lat + share * (right.position.lat - left.position.lat)
    agl_m = left.agl_m + share * (right.agl_m - left.agl_m)
    return RoutePoint(LonLat(lon, lat), WaypointKind.PASS, agl_m, target=left.target if left.target == right.target else None)
