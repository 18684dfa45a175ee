"""A small route and flights along it, point by point."""

import math
from collections.abc import Iterator
from dataclasses import replace

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute, FrozenWaypoint, TakeOff
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from telemetry.mission_report.fix import Fix

FRAME = LocalFrame.around(9.5, 47.1)
PLACES_M = ((0.0, 0.0), (300.0, 0.0), (600.0, 0.0), (600.0, 400.0))  # east, north; targets at the middle ones
HEIGHTS_M = (30.0, 30.0, 60.0, 60.0)
SPEED_MPS = 10.0
HOLD_S = 20.0


def place(east_m: float, north_m: float) -> LonLat:
    origin = FRAME.origin
    return LonLat(origin.lon + east_m / FRAME.metres_per_degree_east, origin.lat + north_m / FRAME.metres_per_degree_north)


def route() -> FrozenRoute:
    kinds = (WaypointKind.START, WaypointKind.TARGET, WaypointKind.TARGET, WaypointKind.END)
    waypoints = tuple(
        FrozenWaypoint(
            sequence=number,
            position=place(*PLACES_M[number]),
            kind=kind,
            altitude_agl_m=HEIGHTS_M[number],
            altitude_relative_m=HEIGHTS_M[number],
            task=Task(TaskKind.HOLD, HOLD_S) if number == 1 else None,
            target=number - 1 if kind is WaypointKind.TARGET else None,
        )
        for number, kind in enumerate(kinds)
    )
    return FrozenRoute("Kite", TakeOff(place(0.0, 0.0), 450.0), SPEED_MPS, "land", waypoints)


SECOND = 5  # sequence at which the second flight of two begins


def route_of_two_flights() -> FrozenRoute:
    """The same line twice, with other targets, and a base between, where it starts anew."""
    once = route()
    base = replace(once.waypoints[0], sequence=SECOND - 1, kind=WaypointKind.BASE, altitude_agl_m=0.0, altitude_relative_m=0.0)
    again = [
        replace(waypoint, sequence=waypoint.sequence + SECOND, target=None if waypoint.target is None else waypoint.target + 2)
        for waypoint in once.waypoints
    ]
    return replace(once, waypoints=(*once.waypoints, base, *again))


def flown_twice() -> list[Fix]:
    """The second flight half an hour after the first."""
    return [*flown(), *(replace(fix, at_s=fix.at_s + 1_800.0, waypoint_sequence=(fix.waypoint_sequence or 0) + SECOND) for fix in flown())]


def flown(
    *, aside_m: float = 0.0, higher_m: float = 0.0, held_s: float = HOLD_S, every_s: float = 1.0, leaves_out: int | None = None
) -> list[Fix]:
    """Along the route at its speed, reported every so many seconds; `leaves_out` is a waypoint that it was told to go past by 200 m."""
    return [fix for number, fix in enumerate(_each_second(aside_m, higher_m, held_s, leaves_out)) if number % every_s == 0]


def _each_second(aside_m: float, higher_m: float, held_s: float, leaves_out: int | None) -> Iterator[Fix]:
    places = list(zip(PLACES_M, HEIGHTS_M, strict=True))
    at_s, battery = 1_000.0, 100.0
    (east, north), height = places[0]
    for number in range(1, len(places)):
        (to_east, to_north), to_height = places[number]
        if number == leaves_out:
            to_north += 200.0
        steps = max(round(math.hypot(to_east - east, to_north - north) / SPEED_MPS), 1)
        stays = round(held_s) if number == 1 else 0
        for step in range(1, steps + 1 + stays):
            share = min(step / steps, 1.0)
            at_s, battery = at_s + 1.0, battery - 0.1
            here = place(east + share * (to_east - east), north + share * (to_north - north) + aside_m)
            yield Fix(at_s, here, height + share * (to_height - height) + higher_m, battery, number, is_in_air=True)
        (east, north), height = (to_east, to_north), to_height
