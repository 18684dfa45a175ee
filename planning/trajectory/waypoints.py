"""The points of a route, without and with heights above sea level and take-off."""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from planning.task import Task

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class WaypointKind(StrEnum):
    START = "start"
    PASS = "pass"  # noqa: S105 (no password)
    TARGET = "target"
    END = "end"
    BASE = "base"  # on the ground between two flights


KINDS = tuple(WaypointKind)  # columns hold places in it
START, PASS, TARGET, END, BASE = range(len(KINDS))
NONE = -1  # in place of an asset's or a target's number


class RoutePoint(NamedTuple):
    """A point of a route at its planned height above ground.

    asset is the primary key of the asset that is passed or inspected here; target the index of the target that is being done; speed_mps
    what is wanted over ground on the leg that leads here, None: as the UAV does.
    """

    position: LonLat
    kind: WaypointKind
    agl_m: float
    asset: int | None = None
    target: int | None = None
    task: Task | None = None
    speed_mps: float | None = None


class RoutePoints:
    """Points of a route, column by column: some hundred points are a handful of arrays. Taken one by one, each is a RoutePoint.

    position float64 (n, 2), lon lat [deg]; agl_m float64 (n,); kind (n,) places in KINDS; asset, target int64 (n,), NONE where there is
    none; task: what is done at a point, by its place in the route; speed_mps likewise, where the leg to it is not flown as the UAV does.
    """

    __slots__ = ("agl_m", "asset", "kind", "position", "speed_mps", "target", "task")

    def __init__(
        self,
        position: FloatArray,
        agl_m: FloatArray,
        kind: IntArray,
        asset: IntArray,
        target: IntArray,
        task: dict[int, Task],
        speed_mps: dict[int, float] | None = None,
    ) -> None:
        self.position = position
        self.agl_m = agl_m
        self.kind = kind
        self.asset = asset
        self.target = target
        self.task = task
        self.speed_mps = speed_mps or {}

    @classmethod
    def of(cls, points: Sequence[RoutePoint]) -> "RoutePoints":
        return cls(
            np.array([point.position for point in points], dtype=np.float64).reshape(-1, 2),
            np.array([point.agl_m for point in points], dtype=np.float64),
            np.array([KINDS.index(point.kind) for point in points], dtype=np.int64),
            np.array([NONE if point.asset is None else point.asset for point in points], dtype=np.int64),
            np.array([NONE if point.target is None else point.target for point in points], dtype=np.int64),
            {place: point.task for place, point in enumerate(points) if point.task is not None},
            {place: point.speed_mps for place, point in enumerate(points) if point.speed_mps is not None},
        )

    def __len__(self) -> int:
        return len(self.position)

    def __getitem__(self, place: int) -> RoutePoint:
        asset, target = int(self.asset[place]), int(self.target[place])
        return RoutePoint(
            LonLat(*self.position[place].tolist()),
            KINDS[self.kind[place]],
            float(self.agl_m[place]),
            None if asset == NONE else asset,
            None if target == NONE else target,
            self.task.get(place),
            self.speed_mps.get(place),
        )

    def __iter__(self) -> Iterator[RoutePoint]:
        return map(self.__getitem__, range(len(self)))

    def with_points_between(self, legs: IntArray, shares: FloatArray) -> "RoutePoints":
        """With a point more, which is passed, at each share of a leg on its straight lon/lat line; both (k,), in the order of the route.

        Between two points of one target it belongs to the target. A leg that is divided is flown as fast as before.
        """
        columns = _with_points_between(self.position, self.agl_m, self.kind, self.asset, self.target, legs, shares)

        def moved(place: int) -> int:
            return place + int(np.searchsorted(legs, place))

        speeds = {
            number: speed_mps
            for place, speed_mps in self.speed_mps.items()
            for number in range(moved(place - 1) + 1 if place else 0, moved(place) + 1)
        }
        return RoutePoints(*columns, {moved(place): task for place, task in self.task.items()}, speeds)

    def at_heights(self, agl_m: FloatArray) -> "RoutePoints":
        """The same points at other heights above ground, (n,)."""
        return RoutePoints(self.position, agl_m, self.kind, self.asset, self.target, self.task, self.speed_mps)


@njit(cache=True, nogil=True)
def _with_points_between(
    position: FloatArray, agl_m: FloatArray, kind: IntArray, asset: IntArray, target: IntArray, legs: IntArray, shares: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray]:
    count = len(position) + len(legs)
    positions, heights_m = np.empty((count, 2)), np.empty(count)
    kinds, assets, targets = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    at = more = 0
    for place in range(len(position)):
        positions[at], heights_m[at] = position[place], agl_m[place]
        kinds[at], assets[at], targets[at] = kind[place], asset[place], target[place]
        at += 1
        while more < len(legs) and legs[more] == place:
            share = shares[more]
            for axis in range(2):
                positions[at, axis] = position[place, axis] + share * (position[place + 1, axis] - position[place, axis])
            heights_m[at] = agl_m[place] + share * (agl_m[place + 1] - agl_m[place])
            kinds[at], assets[at] = PASS, NONE
            targets[at] = target[place] if target[place] == target[place + 1] else NONE
            at += 1
            more += 1
    return positions, heights_m, kinds, assets, targets


class WaypointRow(NamedTuple):
    """A route point and its height over the other two references; above sea level only where the ground's height is known."""

    point: RoutePoint
    amsl_m: float | None
    relative_m: float


class Waypoints:
    """Waypoints, column by column; taken one by one, each is a WaypointRow. amsl_m is None where the ground is not known."""

    __slots__ = ("amsl_m", "points", "relative_m")

    def __init__(self, points: RoutePoints, amsl_m: FloatArray | None, relative_m: FloatArray) -> None:
        self.points = points
        self.amsl_m = amsl_m
        self.relative_m = relative_m

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, place: int) -> WaypointRow:
        return WaypointRow(self.points[place], None if self.amsl_m is None else float(self.amsl_m[place]), float(self.relative_m[place]))

    def __iter__(self) -> Iterator[WaypointRow]:
        return map(self.__getitem__, range(len(self)))

    def part(self, begin: int, end: int) -> "Waypoints":
        """Those from one place up to but without another."""
        points, own = self.points, slice(begin, end)
        part = RoutePoints(
            points.position[own],
            points.agl_m[own],
            points.kind[own],
            points.asset[own],
            points.target[own],
            {place - begin: task for place, task in points.task.items() if begin <= place < end},
            {place - begin: speed_mps for place, speed_mps in points.speed_mps.items() if begin <= place < end},
        )
        return Waypoints(part, None if self.amsl_m is None else self.amsl_m[own], self.relative_m[own])
