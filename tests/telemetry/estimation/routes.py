"""Routes to fly in tests of the estimator: along lines of towers, with targets at some, and back."""

import math
import random
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import osmium

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import HOVER, RETURN, Flight, FrozenRoute, FrozenWaypoint, TakeOff
from planning.energy.conditions import Conditions, WindLayer
from planning.task import Task, TaskKind
from planning.trajectory.waypoints import WaypointKind
from telemetry.estimation.knowledge import Knowledge


class _Point(NamedTuple):
    place: tuple[float, float]
    height_m: float
    kind: WaypointKind = WaypointKind.PASS
    task: Task | None = None
    target: int | None = None


HOME = LonLat(9.8, 55.4)
TRANSIT_M = 60.0
SPEEDS_MPS = (8.0, 10.0, 12.0, 14.0)


def drawn_route(seed: int, speeds_mps: Sequence[float] = SPEEDS_MPS) -> FrozenRoute:
    """Along a line that bends now and then."""
    chance = random.Random(seed)
    bearing = chance.uniform(0.0, 2.0 * math.pi)
    at = (150.0 * math.sin(bearing), 150.0 * math.cos(bearing))
    towers = []
    for _ in range(chance.randint(4, 12)):
        towers.append(at)
        bearing += chance.choice([0.0, 0.0, chance.gauss(0.0, 0.3), chance.gauss(0.0, 1.2)])
        span_m = chance.uniform(120.0, 420.0)
        at = (at[0] + span_m * math.sin(bearing), at[1] + span_m * math.cos(bearing))
    return _route(f"seed {seed}", HOME, towers, chance, speeds_mps)


def route_on_line(seed: int, lines: Sequence[Sequence[LonLat]], speeds_mps: Sequence[float] = SPEEDS_MPS) -> FrozenRoute:
    """Along a stretch of a real line, from a place some hundred metres beside its first tower."""
    chance = random.Random(f"line {seed}")
    line = chance.choice(lines)
    most = min(len(line), chance.randint(4, 14))
    begin = chance.randrange(len(line) - most + 1)
    stretch = line[begin : begin + most]
    frame = LocalFrame.around(*stretch[0])
    angle, far_m = chance.uniform(0.0, 2.0 * math.pi), chance.uniform(60.0, 250.0)
    lon, lat = frame.to_degrees(np.array([[far_m * math.sin(angle), far_m * math.cos(angle)]]))[0]
    home = LonLat(float(lon), float(lat))
    towers = [(float(east), float(north)) for east, north in LocalFrame.around(*home).to_metres(np.array(stretch))]
    return _route(f"line {seed}", home, towers, chance, speeds_mps)


def lines_of(path: Path) -> list[list[LonLat]]:
    """Power lines of an OSM file, tower by tower; those of a few towers, and with spans that one flies in a flight."""
    reader = _Lines()
    reader.apply_file(str(path), locations=True)
    return reader.lines


class _Lines(osmium.SimpleHandler):
    def __init__(self) -> None:
        super().__init__()
        self.lines: list[list[LonLat]] = []

    def way(self, way: Any) -> None:
        if way.tags.get("power") not in {"line", "minor_line"}:
            return
        places = [LonLat(node.location.lon, node.location.lat) for node in way.nodes if node.location.valid()]
        spans_m = [distance_m(one, other) for one, other in pairwise(places)]
        if len(places) >= 4 and max(spans_m) < 600.0 and min(spans_m) > 5.0:
            self.lines.append(places)


def _route(
    name: str, home: LonLat, towers: Sequence[tuple[float, float]], chance: random.Random, speeds_mps: Sequence[float]
) -> FrozenRoute:
    """A target at every few towers; the way back over the same towers, or straight home, or none."""
    points: list[_Point] = [_Point((0.0, 0.0), TRANSIT_M, WaypointKind.START)]
    target = 0
    for number, tower in enumerate(towers):
        height_m = TRANSIT_M + chance.choice([0.0, 0.0, 8.0, -6.0])
        if chance.random() < 0.45 or number == len(towers) - 1:
            kind = chance.choice([TaskKind.PHOTO, TaskKind.HOLD, TaskKind.LOOK])
            low_m = height_m - chance.choice([0.0, 0.0, 15.0, 25.0])
            above = [_Point(tower, height_m)] if low_m < height_m else []
            task = Task(kind, chance.choice([5.0, 10.0, 20.0, 30.0]))
            points += [*above, _Point(tower, low_m, WaypointKind.TARGET, task, target), *above]
            target += 1
        else:
            points.append(_Point(tower, height_m))
    if chance.random() < 0.6:
        points += [_Point(tower, TRANSIT_M) for tower in towers[-2::-1]]
    end = chance.choice([RETURN, RETURN, RETURN, HOVER])
    if end == RETURN:
        points.append(_Point((0.0, 0.0), TRANSIT_M, WaypointKind.END))
    degrees = LocalFrame.around(*home).to_degrees(np.array([point.place for point in points]))
    waypoints = tuple(
        FrozenWaypoint(number, LonLat(float(lon), float(lat)), point.kind, point.height_m, point.height_m, None, point.task, point.target)
        for number, ((lon, lat), point) in enumerate(zip(degrees, points, strict=True))
    )
    return FrozenRoute(name, TakeOff(home, 0.0), chance.choice(speeds_mps), end, waypoints)


def knowledge_for(route: FrozenRoute, flight: Flight, seed: int) -> Knowledge:
    """What the plan knew: the wind as forecast, and the most that the UAV flies through it."""
    chance = random.Random(seed)
    wind = WindLayer(60.0, chance.uniform(0.0, 8.0), chance.uniform(0.0, 359.0))
    most_mps = route.cruise_speed_mps + chance.choice([2.0, 4.0, 8.0])
    return Knowledge(flight, route.cruise_speed_mps, most_mps, conditions=Conditions((wind,)), home=flight.take_off.position)
