"""Routes to fly in tests of the estimator: along lines of towers, with targets at some, and back."""

import math
import random

import numpy as np

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from missions.flight_plan.conditions import Conditions, WindLayer
from missions.flight_plan.waypoints import WaypointKind
from missions.mavlink.frozen import HOVER, RETURN, Flight, FrozenRoute, FrozenWaypoint, TakeOff
from missions.routing.problem import Task, TaskKind
from telemetry.estimation.knowledge import Knowledge

HOME = LonLat(9.8, 55.4)
TRANSIT_M = 60.0


def drawn_route(seed: int) -> FrozenRoute:
    """A line that bends now and then; a target at every few towers, the way back over the same towers or straight home."""
    chance = random.Random(seed)
    frame = LocalFrame.around(*HOME)
    places = [(0.0, 0.0)]
    bearing = chance.uniform(0.0, 2.0 * math.pi)
    at = (150.0 * math.sin(bearing), 150.0 * math.cos(bearing))
    towers = []
    for _ in range(chance.randint(4, 12)):
        towers.append(at)
        bearing += chance.choice([0.0, 0.0, chance.gauss(0.0, 0.3), chance.gauss(0.0, 1.2)])
        span_m = chance.uniform(120.0, 420.0)
        at = (at[0] + span_m * math.sin(bearing), at[1] + span_m * math.cos(bearing))
    points: list[tuple[tuple[float, float], float, Task | None, int | None, WaypointKind]] = [
        (places[0], TRANSIT_M, None, None, WaypointKind.START)
    ]
    target = 0
    for number, tower in enumerate(towers):
        height_m = TRANSIT_M + chance.choice([0.0, 0.0, 8.0, -6.0])
        if chance.random() < 0.45 or number == len(towers) - 1:
            kind = chance.choice([TaskKind.PHOTO, TaskKind.HOLD, TaskKind.LOOK])
            low_m = height_m - chance.choice([0.0, 0.0, 15.0, 25.0])
            if low_m < height_m:
                points.append((tower, height_m, None, None, WaypointKind.PASS))
            points.append((tower, low_m, Task(kind, chance.choice([5.0, 10.0, 20.0, 30.0])), target, WaypointKind.TARGET))
            if low_m < height_m:
                points.append((tower, height_m, None, None, WaypointKind.PASS))
            target += 1
        else:
            points.append((tower, height_m, None, None, WaypointKind.PASS))
    if chance.random() < 0.6:
        points += [(tower, TRANSIT_M, None, None, WaypointKind.PASS) for tower in towers[-2::-1]]
    end = chance.choice([RETURN, RETURN, RETURN, HOVER])
    if end == RETURN:
        points.append((places[0], TRANSIT_M, None, None, WaypointKind.END))
    degrees = frame.to_degrees(np.array([place for place, *_ in points]))
    waypoints = tuple(
        FrozenWaypoint(number, LonLat(float(lon), float(lat)), kind, height_m, height_m, None, task, on, None, None)
        for number, ((lon, lat), (_, height_m, task, on, kind)) in enumerate(zip(degrees, points, strict=True))
    )
    return FrozenRoute(f"seed {seed}", TakeOff(HOME, 0.0), chance.choice([8.0, 10.0, 12.0, 14.0]), end, waypoints)


def knowledge_for(route: FrozenRoute, flight: Flight, seed: int) -> Knowledge:
    """What the plan knew: the wind as forecast, and the most that the UAV flies through it."""
    chance = random.Random(seed)
    wind = WindLayer(60.0, chance.uniform(0.0, 8.0), chance.uniform(0.0, 359.0))
    most_mps = route.cruise_speed_mps + chance.choice([2.0, 4.0, 8.0])
    return Knowledge(flight, route.cruise_speed_mps, most_mps, conditions=Conditions((wind,)), home=flight.take_off.position)
