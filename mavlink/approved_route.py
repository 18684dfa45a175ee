"""An approved route in plain values: the only source of the mission that a vehicle receives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from inspection.geodesy import LonLat
from planning.task import Task, task_from_json, task_to_json
from planning.trajectory.waypoints import WaypointKind

RETURN, LAND, HOVER, BASE = "return", "land", "hover", "base"
END_ACTIONS = (RETURN, LAND, HOVER, BASE)


def photo_clearances_m(waypoints: Sequence["FrozenWaypoint"]) -> dict[int, float]:
    """What the flights through photos keep from wires and supports [m], by the sequences of the waypoints that their legs lead to."""
    of_target = {
        own.target: own.task.view.clearance_m
        for own in waypoints
        if own.target is not None and own.task is not None and own.task.view is not None
    }
    return {
        after.sequence: of_target[after.target]
        for before, after in pairwise(waypoints)
        if after.target == before.target and after.target in of_target
    }


class NotARoute(ValueError):
    """The stored values do not form a valid route."""


@dataclass(frozen=True)
class FrozenWaypoint:
    """A point of a route.

    `sequence` is its place in the stored route. `altitude_relative_m` is measured from the route's first take-off. `speed_mps` is the
    ground speed on the leg that ends here; None means the route's cruise speed. `arrival_s` is measured from the mission's departure.
    """

    sequence: int
    position: LonLat
    kind: WaypointKind
    altitude_agl_m: float
    altitude_relative_m: float
    altitude_amsl_m: float | None = None
    task: Task | None = None
    target: int | None = None
    speed_mps: float | None = None
    arrival_s: float | None = None

    @property
    def ground_relative_m(self) -> float:
        """Return the ground height below this waypoint, measured from the route's first take-off."""
        return self.altitude_relative_m - self.altitude_agl_m


@dataclass(frozen=True)
class TakeOff:
    """The planned place of a take-off, where the vehicle must stand. `altitude_amsl_m` is the ground's; None without terrain data."""

    position: LonLat
    altitude_amsl_m: float | None


@dataclass(frozen=True)
class Flight:
    """The part of a route from one take-off to the next landing.

    The waypoints' `altitude_relative_m` is measured from this take-off. `above_first_m` is the height of this take-off above the route's
    first.
    """

    number: int
    take_off: TakeOff
    waypoints: tuple[FrozenWaypoint, ...]
    end_action: str
    above_first_m: float = 0.0


@dataclass(frozen=True)
class FrozenRoute:
    """The route of one UAV.

    `take_off` is where it begins. `charging_stops` are the sequences of waypoints with a planned charging stop.

    With `begun_by` set, the route begins in the air, anywhere before the waypoint of this `sequence`. The UAV took off from `take_off`
    earlier and measures its heights from there. Such a route has one flight.
    """

    uav: str
    take_off: TakeOff
    cruise_speed_mps: float
    end_action: str
    waypoints: tuple[FrozenWaypoint, ...]
    charging_stops: tuple[int, ...] = ()
    departs_s: float = 0.0
    begun_by: int | None = None

    def __post_init__(self) -> None:
        if self.end_action not in END_ACTIONS:
            raise NotARoute(f"A route cannot end by {self.end_action!r}.")
        if not self.cruise_speed_mps > 0:
            raise NotARoute("A route's speed must be above 0.")
        if self.begun_by is not None and any(waypoint.kind is WaypointKind.BASE for waypoint in self.waypoints):
            raise NotARoute("A route that is begun in the air does not stand at a base between two flights.")

    @property
    def flights(self) -> tuple[Flight, ...]:
        """Return the flights: the route split at its waypoints of kind `base`, where the UAV stands between two flights.

        The result is empty without waypoints. Each flight but the last lands under its last waypoint, where the next battery waits;
        `end_action` applies to the last one only.
        """
        flights: list[Flight] = []
        take_off, ground_m, begin = self.take_off, 0.0, 0
        for place, waypoint in enumerate(self.waypoints):
            if waypoint.kind is WaypointKind.BASE:
                flights.append(self._flight(len(flights), take_off, ground_m, self.waypoints[begin:place], LAND))
                take_off, ground_m, begin = TakeOff(waypoint.position, waypoint.altitude_amsl_m), waypoint.altitude_relative_m, place + 1
        if begin < len(self.waypoints) or flights:
            flights.append(self._flight(len(flights), take_off, ground_m, self.waypoints[begin:], self.end_action))
        return tuple(flights)

    def _flight(self, number: int, take_off: TakeOff, ground_m: float, waypoints: Sequence[FrozenWaypoint], end_action: str) -> Flight:
        if not waypoints:
            raise NotARoute("A route stands at its base with no flight before or after it.")
        above = tuple(replace(waypoint, altitude_relative_m=waypoint.altitude_relative_m - ground_m) for waypoint in waypoints)
        return Flight(number, take_off, above, end_action, ground_m)


def flight_to_json(flight: Flight, route: FrozenRoute) -> dict[str, Any]:
    """Return one flight of a route for a companion computer, with heights measured from this flight's take-off."""
    return {
        "flight": flight.number + 1,
        "take_off": {"position": list(flight.take_off.position), "altitude_amsl_m": flight.take_off.altitude_amsl_m},
        "cruise_speed_mps": route.cruise_speed_mps,
        "end_action": flight.end_action,
        "departs_s": route.departs_s,
        "waypoints": [_waypoint_to_json(waypoint) for waypoint in flight.waypoints],
    }


def route_to_json(route: FrozenRoute) -> dict[str, Any]:
    return {
        "uav": route.uav,
        "take_off": {"position": list(route.take_off.position), "altitude_amsl_m": route.take_off.altitude_amsl_m},
        "cruise_speed_mps": route.cruise_speed_mps,
        "end_action": route.end_action,
        "charging_stops": list(route.charging_stops),
        "departs_s": route.departs_s,
        **({} if route.begun_by is None else {"begun_by": route.begun_by}),
        "waypoints": [_waypoint_to_json(waypoint) for waypoint in route.waypoints],
    }


def route_from_json(stored: Mapping[str, Any]) -> FrozenRoute:
    take_off = stored["take_off"]
    return FrozenRoute(
        uav=stored["uav"],
        take_off=TakeOff(LonLat(*take_off["position"]), take_off["altitude_amsl_m"]),
        cruise_speed_mps=stored["cruise_speed_mps"],
        end_action=stored["end_action"],
        waypoints=tuple(_waypoint_from_json(waypoint) for waypoint in stored["waypoints"]),
        charging_stops=tuple(stored["charging_stops"]),
        departs_s=stored["departs_s"],
        begun_by=stored.get("begun_by"),
    )


def _waypoint_to_json(waypoint: FrozenWaypoint) -> dict[str, Any]:
    task = waypoint.task
    return {
        "sequence": waypoint.sequence,
        "position": list(waypoint.position),
        "kind": waypoint.kind.value,
        "altitude_agl_m": waypoint.altitude_agl_m,
        "altitude_amsl_m": waypoint.altitude_amsl_m,
        "altitude_relative_m": waypoint.altitude_relative_m,
        "task": None if task is None else task_to_json(task),
        "target": waypoint.target,
        "speed_mps": waypoint.speed_mps,
        "arrival_s": waypoint.arrival_s,
    }


def _waypoint_from_json(stored: Mapping[str, Any]) -> FrozenWaypoint:
    return FrozenWaypoint(
        sequence=stored["sequence"],
        position=LonLat(*stored["position"]),
        kind=WaypointKind(stored["kind"]),
        altitude_agl_m=stored["altitude_agl_m"],
        altitude_relative_m=stored["altitude_relative_m"],
        altitude_amsl_m=stored["altitude_amsl_m"],
        task=task_from_json(stored["task"]),
        target=stored["target"],
        speed_mps=stored["speed_mps"],
        arrival_s=stored["arrival_s"],
    )
