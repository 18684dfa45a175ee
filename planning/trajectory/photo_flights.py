"""Routes with the flights through the photos of their targets, and which of their legs these are."""

from collections.abc import Mapping

import numpy as np

from planning.task import TURN_S, Task, TaskKind
from planning.trajectory.waypoints import NONE, PASS, TARGET, FloatArray, IntArray, RoutePoints, Waypoints
from planning.views.photo_flight import BEND_HOLD_S, SPEED_MPS, PhotoFlight

BoolArray = np.ndarray[tuple[int], np.dtype[np.bool_]]


class GroundNotKnown(ValueError):
    """The route has no heights above the sea: a flight beside wires has no reference. target: the first with photos."""

    def __init__(self, target: int) -> None:
        super().__init__(f"target {target} is photographed, but the ground under the route is not known")
        self.target = target


def with_photo_flights(waypoints: Waypoints, flights: Mapping[int, PhotoFlight]) -> Waypoints:
    """The waypoints, and behind each target that has one its flight through photos, by targets. Raises GroundNotKnown.

    The UAV stops over the target, comes down or climbs to where the flight begins, which is over the target too, and comes back in the
    end. What it does at the target is done at the photos: there it stays as long as the task says.
    """
    points = waypoints.points
    own = [place for place in np.flatnonzero(points.kind == TARGET).tolist() if int(points.target[place]) in flights]
    if not own:
        return waypoints
    if waypoints.amsl_m is None:
        raise GroundNotKnown(int(points.target[own[0]]))
    parts: list[Waypoints] = []
    begin = 0
    for place in own:
        task = points.task[place]
        over = waypoints.part(begin, place + 1)
        over.points.task[place - begin] = Task(TaskKind.HOLD, BEND_HOLD_S)
        parts += [over, _flown(waypoints, place, flights[int(points.target[place])], task)]
        begin = place + 1
    parts.append(waypoints.part(begin, len(points)))
    return _joined(parts)


def photo_legs(target: IntArray, has_view: BoolArray) -> BoolArray:
    """Whether the leg to each waypoint, (n,), belongs to a flight through photos.

    target (n,): the target that is being done, NONE for none; has_view (n,): whether a photo with a view is taken there.
    """
    photographed = np.isin(target, target[has_view & (target != NONE)])
    legs: BoolArray = np.zeros(len(target), dtype=np.bool_)
    legs[1:] = photographed[1:] & (target[1:] == target[:-1])
    return legs


def photo_legs_of(points: RoutePoints) -> BoolArray:
    has_view = np.zeros(len(points), dtype=np.bool_)
    has_view[[place for place, task in points.task.items() if task.view is not None]] = True
    return photo_legs(points.target, has_view)


def clearances_m(points: RoutePoints) -> FloatArray:
    """What the flight through photos keeps from wires and supports on the leg to each waypoint [m], (n,); NaN on other legs."""
    kept_m = np.full(len(points), np.nan)
    legs = photo_legs_of(points)
    of_target = {int(points.target[place]): task.view.clearance_m for place, task in points.task.items() if task.view is not None}
    kept_m[legs] = [of_target[target] for target in points.target[legs].tolist()]
    return kept_m


def _flown(waypoints: Waypoints, place: int, flight: PhotoFlight, task: Task) -> Waypoints:
    """The flight, and the way back up to the waypoint over the target, at this place."""
    assert waypoints.amsl_m is not None  # noqa: S101 - checked by the caller
    points, count = waypoints.points, len(flight) + 1
    tasks = {stop: Task(TaskKind.HOLD, BEND_HOLD_S) for stop in np.flatnonzero(flight.stops).tolist()}
    tasks |= {
        photo: Task(TaskKind.PHOTO, task.hold_s + (0.0 if view.heading_deg is None else TURN_S), view=view)
        for photo, view in flight.view.items()
    }
    flown = RoutePoints(
        np.concatenate([flight.position, points.position[place : place + 1]]),
        np.append(flight.agl_m, points.agl_m[place]),
        np.full(count, PASS, dtype=np.int64),
        np.full(count, NONE, dtype=np.int64),
        np.full(count, points.target[place], dtype=np.int64),
        tasks,
        dict.fromkeys(range(count), SPEED_MPS),
    )
    amsl_m = np.append(flight.amsl_m, waypoints.amsl_m[place])
    return Waypoints(flown, amsl_m, amsl_m - (waypoints.amsl_m[0] - waypoints.relative_m[0]))


def _joined(parts: list[Waypoints]) -> Waypoints:
    first = np.cumsum([0, *(len(part) for part in parts[:-1])]).tolist()

    def column(name: str) -> np.ndarray:
        return np.concatenate([getattr(part.points, name) for part in parts])

    points = RoutePoints(
        column("position"), column("agl_m"), column("kind"), column("asset"), column("target"),
        {begin + place: task for begin, part in zip(first, parts, strict=True) for place, task in part.points.task.items()},
        {begin + place: mps for begin, part in zip(first, parts, strict=True) for place, mps in part.points.speed_mps.items()},
    )  # fmt: skip
    amsl_m = np.concatenate([part.amsl_m for part in parts if part.amsl_m is not None])
    return Waypoints(points, amsl_m, np.concatenate([part.relative_m for part in parts]))
