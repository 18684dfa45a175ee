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
from inspection.geodesy.local_frame import short_vector_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.paths.contracted_graph import ContractedGraph
from inspection.network.paths.paths import PathEnds
from planning.connection_points import TargetPaths
from planning.energy.conditions import Conditions, air_density
from planning.energy.leg_cost import J_PER_WH, Air, Speeds, landing_taken, leg_taken, stay_taken, take_off_taken
from planning.energy.path_cost import Bends, FlightClass, GraphTaken, NodeGround, bends_of_paths, graph_taken, taken_on_paths
from planning.problem import End
from planning.rules import FlightRules

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


@dataclass(frozen=True)
class FlyingFleet:
    """Of each UAV: how it flies, how it ends, where it starts, and its home, where that is not its start."""

    classes: Sequence[FlightClass]
    finishes: Sequence[Finish]
    starts: Sequence[LonLat]
    homes: Sequence[LonLat] | None = None


@dataclass(frozen=True)
class FlownVisits:
    """Of each visit: its course, the height above ground, how long the UAV stays, and how fast it flies along at most (inf: any speed)."""

    courses: Sequence[Sequence[LonLat]]
    agl_m: Sequence[float]
    hold_s: Sequence[float]
    most_mps: Sequence[float]


def flight_costs(
    graph: InspectionGraph,
    ways: TargetPaths,
    *,
    fleet: FlyingFleet,
    bases: Sequence[LonLat],
    visits: FlownVisits,
    conditions: Conditions,
    rules: FlightRules,
    ground: NodeGround | None = None,
) -> FlightCosts:
    """UAVs, visits and bases as the ways have them.

    Timing a drawn route finds the same, but for turns of its course that drawing leaves out, waypoints that the terrain asks for, and
    wind that changes with height along a leg. Without the ground nothing is known of hills, and the air is that of the sea's level.
    """
    uavs, count, travel = ways.uavs, ways.visits, ways.travel
    numbers: dict[FlightClass, int] = {}
    class_of = tuple(numbers.setdefault(flying, len(numbers)) for flying in fleet.classes)
    course = np.array(list(chain.from_iterable(visits.courses)), dtype=np.float64).reshape(-1, 2)
    course_first = np.array([0, *accumulate(map(len, visits.courses))], dtype=np.int64)
    begins = np.array(fleet.starts, dtype=np.float64).reshape(-1, 2)
    stands = np.array([*(fleet.starts if fleet.homes is None else fleet.homes), *bases], dtype=np.float64).reshape(-1, 2)
    flown = np.array([visits.agl_m, visits.hold_s, visits.most_mps], dtype=np.float64)
    ends = np.array([(_ENDS[finish.end], finish.lands) for finish in fleet.finishes], dtype=np.int64).reshape(-1, 2)
    source_m, sink_m = (_NOT_KNOWN, _NOT_KNOWN) if ground is None else (ground.source_m, ground.sink_m)
    terms = _Terms(
        np.array(class_of, dtype=np.int64), ends, ways.nearest_base, begins, stands, source_m, sink_m,
        _Visits(course, course_first, flown, float(rules.transit_agl_m)),
    )  # fmt: skip
    costs = _Costs(
        np.empty((2, uavs, count)), np.empty((2, len(numbers), count, count)), np.empty((2, count, uavs)),
        np.empty((2, 2, len(numbers), count)),
    )  # fmt: skip
    bends = bends_of_paths(travel, float(rules.transit_agl_m))
    for flying, number in numbers.items():
        taken = graph_taken(graph, flying, conditions, rules, ground)
        _fill(number, terms, travel.ends, travel.index.contracted, graph.position, taken, bends, costs)
    seconds, wh = (Taken(costs.first[part], costs.onward[part], costs.end[part], *costs.at_visit[part]) for part in range(2))
    usable_wh = [flying.performance.usable_wh for flying in fleet.classes]
    return FlightCosts(seconds, wh, class_of, np.array([np.inf if one is None else one for one in usable_wh], dtype=np.float64))


_NOT_KNOWN = np.zeros(0)
_ENDS = {End.OPEN: 0, End.RETURN: 1, End.ANY_BASE: 2}
_OPEN, _RETURN = _ENDS[End.OPEN], _ENDS[End.RETURN]

# What _at_visits tells of each visit: the stretch; what is done there, with the way down; the way up again; the landing there.
ALONG, SERVICE, UP, LANDING_THERE = range(4)
TAKE_OFF, LANDING = range(2)


class _Visits(NamedTuple):
    """The visits' courses one after another, lon, lat [deg], and where each begins; transit height.

    flown (3, v): height, hold, and greatest speed along each.
    """

    course: FloatArray
    course_first: IntArray
    flown: FloatArray
    transit_m: float


class _Terms(NamedTuple):
    """Who flies, from where to where: each UAV's class, ends (u, 2): where it ends and whether it lands; each visit's nearest base.

    begins: the starts; stands: the homes, then the bases; the ground above sea level of sources and sinks, empty where not known.
    """

    class_of: IntArray
    ends: IntArray
    nearest_base: IntArray
    begins: FloatArray
    stands: FloatArray
    source_ground_m: FloatArray
    sink_ground_m: FloatArray
    visits: _Visits


class _Costs(NamedTuple):
    """Seconds and Wh that are written: first (2, u, v), onward (2, c, v, v), end (2, v, u) and at_visit (2, along or service, c, v)."""

    first: FloatArray
    onward: FloatArray
    end: FloatArray
    at_visit: FloatArray


@njit(cache=True, nogil=True)
def _fill(
    number: int,
    terms: _Terms,
    path_ends: PathEnds,
    contracted: ContractedGraph,
    node_position: FloatArray,
    graph: GraphTaken,
    bends: Bends,
    costs: _Costs,
) -> None:
    """Write what UAVs of one class take."""
    source, sink = _sources_and_sinks(terms)
    class_of, ends, uavs, visits = terms.class_of, terms.ends, len(terms.class_of), len(terms.visits.course_first) - 1
    first, onward, end, at_visit = costs.first, costs.onward, costs.end, costs.at_visit
    taken = taken_on_paths(path_ends, contracted, node_position, graph, source, sink, bends)
    parts, columns = _at_visits(terms.visits, source[:, 3], graph.air)
    for part in range(2):
        for visit in range(visits):
            # What cannot be done in this wind cannot be flown to.
            is_closed = math.isinf(parts[part, SERVICE, visit]) or math.isinf(parts[part, ALONG, visit])
            for kind in (ALONG, SERVICE):
                at_visit[part, kind, number, visit] = 0.0 if is_closed else parts[part, kind, visit]
            for other in range(visits):
                onward[part, number, other, visit] = np.inf if is_closed else parts[part, UP, other] + taken[part, uavs + other, visit]
            for uav in range(uavs):
                if class_of[uav] != number:
                    continue
                first[part, uav, visit] = np.inf if is_closed else columns[part, TAKE_OFF] + taken[part, uav, visit]
                landing = columns[part, LANDING]
                if ends[uav, 0] == _OPEN:
                    end[part, visit, uav], landing = 0.0, parts[part, LANDING_THERE, visit]
                else:
                    home = visits + (uav if ends[uav, 0] == _RETURN else uavs + terms.nearest_base[visit])
                    there = taken[part, uavs + visit, home] if home < len(sink) else np.inf  # no base is free
                    end[part, visit, uav] = parts[part, UP, visit] + there
                if ends[uav, 1]:
                    end[part, visit, uav] += landing


@njit(cache=True, nogil=True)
def _sources_and_sinks(terms: _Terms) -> tuple[FloatArray, FloatArray]:
    """As taken_on_paths has them: starts, then exits; entries, then homes and bases."""
    course, course_first, flown, transit_m = terms.visits.course, terms.visits.course_first, terms.visits.flown, terms.visits.transit_m
    uavs, visits, stands = len(terms.class_of), len(course_first) - 1, terms.stands
    source, sink = np.full((uavs + visits, 4), np.nan), np.full((visits + len(stands), 4), np.nan)
    for uav in range(len(stands)):
        sink[visits + uav, :2], sink[visits + uav, 2] = stands[uav], transit_m
    for uav in range(uavs):
        source[uav, :2], source[uav, 2] = terms.begins[uav], transit_m
    for visit in range(visits):
        source[uavs + visit, :2], sink[visit, :2] = course[course_first[visit + 1] - 1], course[course_first[visit]]
        source[uavs + visit, 2] = sink[visit, 2] = max(flown[0, visit], transit_m)
    if len(terms.source_ground_m):
        source[:, 3], sink[:, 3] = terms.source_ground_m, terms.sink_ground_m
    return source, sink


@njit(cache=True, nogil=True)
def _at_speed(air: Air, cruise_mps: float) -> Air:
    """The same, flown more slowly."""
    own = air.own
    slower = Speeds(cruise_mps, own.limit_mps, own.climb_mps, own.descent_mps, own.brake_s, own.settle_s, own.lift_s, own.touch_s)
    return Air(air.wind, air.temperature_c, slower, air.table)


@njit(cache=True, nogil=True)
def _at_visits(of_visits: _Visits, ground_m: FloatArray, air: Air) -> tuple[FloatArray, FloatArray]:
    """Seconds and Wh of each visit's parts, (2, 4, v), and of take-off to transit height and landing from there, (2, 2).

    ground_m is of the starts and then of the visits, NaN where not known. The columns are those of the highest start: in the thinnest air.
    """
    course, course_first, flown, transit_m = of_visits.course, of_visits.course_first, of_visits.flown, of_visits.transit_m
    visits = len(course_first) - 1
    uavs = len(ground_m) - visits
    parts, columns = np.zeros((2, 4, visits)), np.zeros((2, 2))
    for visit in range(visits):
        level_m = flown[0, visit]
        low_m = min(level_m, transit_m)
        known_m = ground_m[uavs + visit]
        density = air_density(0.0 if math.isnan(known_m) else known_m + level_m, air.temperature_c)
        parts[0, SERVICE, visit], parts[1, SERVICE, visit] = stay_taken(flown[1, visit], level_m, density, air)
        slowed = air if flown[2, visit] >= air.own.cruise_mps else _at_speed(air, flown[2, visit])
        for vertex in range(course_first[visit] + 1, course_first[visit + 1]):
            east, north = short_vector_m(course[vertex - 1, 0], course[vertex - 1, 1], course[vertex, 0], course[vertex, 1])
            length_m = math.hypot(east, north)
            if length_m > 0.0:
                along = leg_taken(length_m, east / length_m, north / length_m, level_m, level_m, 0.0, density, slowed)
                parts[0, ALONG, visit] += along[0]
                parts[1, ALONG, visit] += along[1]
        down = leg_taken(0.0, 0.0, 0.0, transit_m, low_m, low_m - transit_m, density, air)
        up = leg_taken(0.0, 0.0, 0.0, low_m, transit_m, transit_m - low_m, density, air)
        landing = leg_taken(0.0, 0.0, 0.0, level_m, 0.0, -level_m, density, air)
        touching = landing_taken(level_m, density, air)
        for part in range(2):
            parts[part, SERVICE, visit] += down[part]
            parts[part, UP, visit], parts[part, LANDING_THERE, visit] = up[part], landing[part] + touching[part]
    highest_m = 0.0
    for uav in range(uavs):
        if not math.isnan(ground_m[uav]):
            highest_m = max(highest_m, ground_m[uav])
    density = air_density(highest_m, air.temperature_c)
    columns[0, TAKE_OFF], columns[1, TAKE_OFF] = leg_taken(0.0, 0.0, 0.0, 0.0, transit_m, transit_m, density, air)
    columns[0, LANDING], columns[1, LANDING] = leg_taken(0.0, 0.0, 0.0, transit_m, 0.0, -transit_m, density, air)
    lifting, touching = take_off_taken(transit_m, density, air), landing_taken(transit_m, density, air)
    for part in range(2):
        columns[part, TAKE_OFF] += lifting[part]
        columns[part, LANDING] += touching[part]
    parts[1] /= J_PER_WH
    columns[1] /= J_PER_WH
    return parts, columns
