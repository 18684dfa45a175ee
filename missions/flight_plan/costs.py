"""Seconds and watt-hours of everything that an assignment may choose, in wind and over tall assets, before any route is drawn.

They follow the ways that are least in cost, which the wind does not change. A way that the wind closes is no way.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, chain
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.short_vector import short_vector_m
from inspection.graph.inspection_graph import InspectionGraph
from missions.flight_plan.conditions import Conditions, air_density, wind_in_table
from missions.flight_plan.leg_taken import J_PER_WH, Speeds, hold_taken, leg_taken
from missions.flight_plan.rules import FlightRules
from missions.flight_plan.ways_taken import Air, FlightClass, NodeGround, Places, taken_on_ways
from missions.routing.problem import End
from missions.routing.terminals import Ways

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Taken:
    """Seconds or Wh of u UAVs in c classes and v visits; inf where there is no way. Nothing else has to be added to them.

    first   (u, v)     take-off, and the way from each start to each visit
    onward  (c, v, v)  from the row's visit, up to transit height if it lies lower, on to the column's
    end     (v, u)     from each visit to where each UAV's route ends, and the landing
    along   (c, v)     along the stretch of each visit
    service (c, v)     what is done at each visit, and the way down to it from transit height
    """

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    along: FloatArray
    service: FloatArray


@dataclass(frozen=True, eq=False)
class FlightCosts:
    """class_of (u,) numbers the classes in order of their first UAV; usable_wh (u,) is inf where a battery is not known."""

    seconds: Taken
    wh: Taken
    class_of: tuple[int, ...]
    usable_wh: FloatArray


@dataclass(frozen=True)
class Finish:
    """How a UAV's route ends: where, and whether on the ground."""

    end: End
    lands: bool


def flight_costs(
    graph: InspectionGraph,
    ways: Ways,
    *,
    classes: Sequence[FlightClass],
    finishes: Sequence[Finish],
    starts: Sequence[LonLat],
    bases: Sequence[LonLat],
    courses: Sequence[Sequence[LonLat]],
    agl_m: Sequence[float],
    hold_s: Sequence[float],
    conditions: Conditions,
    rules: FlightRules,
    ground: NodeGround | None = None,
) -> FlightCosts:
    """classes, finishes, starts: of each UAV of the ways; courses, agl_m, hold_s: of each visit; bases as the ways have them.

    Timing a drawn route finds the same, but for turns of its course that drawing leaves out, waypoints that the terrain asks for, and
    wind that changes with height along a leg. Without the ground nothing is known of hills, and the air is that of the sea's level.
    """
    uavs, visits = ways.uavs, ways.visits
    numbers: dict[FlightClass, int] = {}
    class_of = tuple(numbers.setdefault(flying, len(numbers)) for flying in classes)
    transit_m = float(rules.transit_agl_m)
    course = _Courses.of(courses, agl_m, hold_s)
    flown_agl_m = np.maximum(course.agl_m, transit_m)
    start = _positions(starts)
    sources = Places(
        np.concatenate([start, course.position[course.first[1:] - 1]]),
        np.concatenate([np.full(uavs, transit_m), flown_agl_m]),
        np.full(uavs + visits, np.nan) if ground is None else ground.source_m,
    )
    sinks = Places(
        np.concatenate([course.position[course.first[:-1]], start, _positions(bases)]),
        np.concatenate([flown_agl_m, np.full(uavs + ways.bases, transit_m)]),
        np.full(visits + uavs + ways.bases, np.nan) if ground is None else ground.sink_m,
    )
    of_class = [_ClassTaken.of(graph, ways, flying, sources, sinks, course, ground, conditions, rules) for flying in numbers]
    seconds, wh = (_taken(of_class, quantity, class_of, finishes, ways) for quantity in range(2))
    usable_wh = [flying.performance.usable_wh for flying in classes]
    return FlightCosts(seconds, wh, class_of, np.array([np.inf if one is None else one for one in usable_wh], dtype=np.float64))


def _positions(places: Sequence[LonLat]) -> FloatArray:
    return np.array(places, dtype=np.float64).reshape(-1, 2)


class _Courses(NamedTuple):
    """The courses of visits one after another, where each begins (v + 1,), and how high and for how long each visit is done (v,)."""

    position: FloatArray
    first: IntArray
    agl_m: FloatArray
    hold_s: FloatArray

    @classmethod
    def of(cls, courses: Sequence[Sequence[LonLat]], agl_m: Sequence[float], hold_s: Sequence[float]) -> "_Courses":
        first = np.array([0, *accumulate(map(len, courses))], dtype=np.int64)
        together = _positions(list(chain.from_iterable(courses)))
        return cls(together, first, np.array(agl_m, dtype=np.float64), np.array(hold_s, dtype=np.float64))


class _ClassTaken(NamedTuple):
    """What UAVs of one class take, seconds first, then Wh: on ways (2, s, t), at visits (v, VISIT_PARTS, 2), and straight up and down."""

    ways: FloatArray
    visits: FloatArray
    columns: FloatArray

    @classmethod
    def of(
        cls,
        graph: InspectionGraph,
        ways: Ways,
        flying: FlightClass,
        sources: Places,
        sinks: Places,
        course: _Courses,
        ground: NodeGround | None,
        conditions: Conditions,
        rules: FlightRules,
    ) -> "_ClassTaken":
        air = Air.of(flying, conditions, rules)
        visits, columns = _at_visits(*course, sources.ground_m, float(rules.transit_agl_m), air.wind, air.temperature_c, air.own, air.table)
        visits[:, :, 1] /= J_PER_WH
        columns[:, 1] /= J_PER_WH
        return cls(taken_on_ways(graph, ways.travel, flying, sources, sinks, conditions, rules, ground), visits, columns)


# What _at_visits tells of each visit: what is done there, with the way down; the way up again; the landing there; the stretch.
SERVICE, UP, LANDING_THERE, ALONG = range(4)
TAKE_OFF, LANDING = range(2)


def _taken(of_class: Sequence[_ClassTaken], quantity: int, class_of: Sequence[int], finishes: Sequence[Finish], ways: Ways) -> Taken:
    uavs, visits = ways.uavs, ways.visits
    first, end = np.empty((uavs, visits)), np.zeros((visits, uavs))
    onward, service, along = np.empty((len(of_class), visits, visits)), np.empty((len(of_class), visits)), np.empty((len(of_class), visits))
    for number, found in enumerate(of_class):
        at_visits = found.visits[:, :, quantity]
        service[number], along[number] = at_visits[:, SERVICE], at_visits[:, ALONG]
        np.add(found.ways[quantity, uavs:, :visits], at_visits[:, UP, None], out=onward[number])
    for uav, (number, finish) in enumerate(zip(class_of, finishes, strict=True)):
        found = of_class[number]
        first[uav] = found.ways[quantity, uav, :visits] + found.columns[TAKE_OFF, quantity]
        if finish.end is End.OPEN:
            end[:, uav] = found.visits[:, LANDING_THERE, quantity] if finish.lands else 0.0
            continue
        home: int | IntArray = visits + uav if finish.end is End.RETURN else visits + uavs + ways.nearest_base
        end[:, uav] = found.ways[quantity, uavs + np.arange(visits), home] + found.visits[:, UP, quantity]
        if finish.lands:
            end[:, uav] += found.columns[LANDING, quantity]
    # What cannot be done in this wind cannot be flown to.
    closed = np.isinf(service) | np.isinf(along)
    if closed.any():
        first[closed[list(class_of)]] = np.inf
        onward[np.broadcast_to(closed[:, None, :], onward.shape)] = np.inf
        service[closed] = along[closed] = 0.0
    return Taken(first, onward, end, along, service)


@njit(cache=True, nogil=True)
def _at_visits(
    course: FloatArray,
    course_first: IntArray,
    agl_m: FloatArray,
    hold_s: FloatArray,
    ground_m: FloatArray,
    transit_m: float,
    wind: FloatArray,
    temperature_c: float,
    own: Speeds,
    table: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Seconds and joules of each visit's parts, (v, 4, 2), and of take-off to transit height and landing from there, (2, 2).

    ground_m is of the starts and then of the visits, NaN where not known. The columns are those of the highest start: in the thinnest air.
    """
    parts, columns = np.zeros((len(agl_m), 4, 2)), np.zeros((2, 2))
    uavs = len(ground_m) - len(agl_m)
    for visit in range(len(agl_m)):
        level_m = agl_m[visit]
        low_m = min(level_m, transit_m)
        known_m = ground_m[uavs + visit]
        density = air_density(0.0 if math.isnan(known_m) else known_m + level_m, temperature_c)
        east_mps, north_mps = wind_in_table(wind, level_m)
        seconds, joules = hold_taken(hold_s[visit], east_mps, north_mps, density, own, table)
        for vertex in range(course_first[visit] + 1, course_first[visit + 1]):
            east, north = short_vector_m(course[vertex - 1, 0], course[vertex - 1, 1], course[vertex, 0], course[vertex, 1])
            length_m = math.hypot(east, north)
            if length_m > 0.0:
                along = leg_taken(length_m, east / length_m, north / length_m, 0.0, east_mps, north_mps, density, own, table)
                parts[visit, ALONG, 0] += along[0]
                parts[visit, ALONG, 1] += along[1]
        east_mps, north_mps = wind_in_table(wind, 0.5 * (low_m + transit_m))
        down = leg_taken(0.0, 0.0, 0.0, low_m - transit_m, east_mps, north_mps, density, own, table)
        up = leg_taken(0.0, 0.0, 0.0, transit_m - low_m, east_mps, north_mps, density, own, table)
        east_mps, north_mps = wind_in_table(wind, 0.5 * level_m)
        landing = leg_taken(0.0, 0.0, 0.0, -level_m, east_mps, north_mps, density, own, table)
        parts[visit, SERVICE, 0], parts[visit, SERVICE, 1] = seconds + down[0], joules + down[1]
        parts[visit, UP, 0], parts[visit, UP, 1] = up
        parts[visit, LANDING_THERE, 0], parts[visit, LANDING_THERE, 1] = landing
    highest_m = 0.0
    for uav in range(uavs):
        if not math.isnan(ground_m[uav]):
            highest_m = max(highest_m, ground_m[uav])
    density = air_density(highest_m, temperature_c)
    east_mps, north_mps = wind_in_table(wind, 0.5 * transit_m)
    columns[TAKE_OFF, 0], columns[TAKE_OFF, 1] = leg_taken(0.0, 0.0, 0.0, transit_m, east_mps, north_mps, density, own, table)
    columns[LANDING, 0], columns[LANDING, 1] = leg_taken(0.0, 0.0, 0.0, -transit_m, east_mps, north_mps, density, own, table)
    return parts, columns
