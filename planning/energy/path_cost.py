"""Seconds and watt-hours along ways of the graph, in one wind and for UAVs that fly alike, by sums that are kept from plan to plan."""

import math
from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass
from itertools import accumulate
from threading import Lock
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy.local_frame import short_vector_m
from inspection.network.build.flyable import node_heights_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.paths.along_paths import PathSteps, Sums, leg_of_way, quantities_of_pairs, steps_of_graph, sums_along
from inspection.network.paths.contracted_graph import ContractedGraph, NumberArray
from inspection.network.paths.hub_labels import IntArray
from inspection.network.paths.paths import DIRECT, PathEnds, Travel
from inspection.network.route_index import route_index
from planning.energy.conditions import Conditions, air_density, wind_in_table
from planning.energy.leg_cost import J_PER_WH, Air, is_closed, leg_taken, taken_in_wind
from planning.energy.performance import Performance
from planning.rules import FlightRules
from planning.trajectory.heights import pass_agl_m

FloatArray = NDArray[np.float64]

NO_HEADWAY = 1e9  # seconds and joules of a step against too strong a wind: sums of it stay numbers, and a way with it is no way
MAX_BYTES = 100 * 2**20  # of sums kept for one graph; of 200,000 nodes they take 10 MB for each wind and kind of UAV


@dataclass(frozen=True)
class FlightClass:
    """UAVs that fly alike."""

    performance: Performance
    cruise_speed_mps: float


@dataclass(frozen=True, eq=False)
class NodeGround:
    """Ground above sea level [m], NaN where not known: of each node (n,), each source (s,) and each sink (t,) of the ways."""

    node_m: FloatArray
    source_m: FloatArray
    sink_m: FloatArray


class GraphTaken(NamedTuple):
    """Sums along the graph's chains and labels, in the air in which they are flown; the height at which each node is passed; its ground.

    ground_m is empty where not known.
    """

    sums: Sums
    air: Air
    passed_m: FloatArray
    ground_m: FloatArray


_NOT_KNOWN = np.zeros(0)
_kept: WeakKeyDictionary[InspectionGraph, "OrderedDict[Hashable, GraphTaken]"] = WeakKeyDictionary()
_one_thread = Lock()


def graph_taken(
    graph: InspectionGraph, flying: FlightClass, conditions: Conditions, rules: FlightRules, ground: NodeGround | None
) -> GraphTaken:
    """What every step of the graph takes, summed up. What was used last is kept, within MAX_BYTES for a graph."""
    ground_m = _NOT_KNOWN if ground is None else ground.node_m
    key = (flying, conditions, rules, id(ground_m))  # which is held with what is kept, so that no other has its number
    with _one_thread:
        kept_of_graph = _kept.setdefault(graph, OrderedDict())
        if key in kept_of_graph:
            kept_of_graph.move_to_end(key)
            return kept_of_graph[key]
    air = Air.of(flying.performance, flying.cruise_speed_mps, conditions, rules)
    passed_m = pass_agl_m(node_heights_m(graph, slice(None)), rules)
    taken = _steps_taken(route_index(graph).contracted, steps_of_graph(graph), passed_m, ground_m, air)
    kept = GraphTaken(sums_along(graph, taken), air, passed_m, ground_m)
    with _one_thread:
        kept_of_graph[key] = kept
        while len(kept_of_graph) > 1 and sum(one.sums.nbytes for one in kept_of_graph.values()) > MAX_BYTES:
            kept_of_graph.popitem(last=False)
    return kept


class Bends(NamedTuple):
    """bend (b, 3): lon, lat [deg] and height above ground of the bends of legs, from their place on.

    Those of leg i begin at bend_first[i], where any has some. Direct ways with bends are numbered on after the legs: direct_number (s, t).
    """

    bend: FloatArray
    bend_first: IntArray
    direct_number: NumberArray


_STRAIGHT = Bends(np.zeros((0, 3)), np.zeros(0, dtype=np.int64), np.zeros((0, 0), dtype=np.int32))


def bends_of_paths(travel: Travel, agl_m: float) -> Bends:
    """The bends of the legs and direct ways of a travel, all flown at this height above ground."""
    if not (travel.leg_bends or travel.direct_bends):
        return _STRAIGHT
    of_legs = travel.leg_bends or (np.zeros((0, 2)),) * len(travel.leg_node)
    together = [*of_legs, *travel.direct_bends.values()]
    direct_number = np.full(travel.way.shape[:2], -1, dtype=np.int32)
    for number, (source, sink) in enumerate(travel.direct_bends, start=len(of_legs)):
        direct_number[source, sink] = number
    position = np.concatenate(together)
    first = np.array([0, *accumulate(map(len, together))], dtype=np.int64)
    return Bends(np.column_stack([position, np.full(len(position), agl_m)]), first, direct_number)


@njit(cache=True, nogil=True)
def _rise_and_density(
    lower_agl_m: float, lower_ground_m: float, upper_agl_m: float, upper_ground_m: float, temperature_c: float
) -> tuple[float, float]:
    """Metres up from the first place to the second, and the density of the air between; flat and at sea level where not known."""
    rise_m = upper_agl_m - lower_agl_m
    if math.isnan(lower_ground_m) or math.isnan(upper_ground_m):
        return rise_m, air_density(0.0, temperature_c)
    rise_m += upper_ground_m - lower_ground_m
    return rise_m, air_density(0.5 * (lower_agl_m + lower_ground_m + upper_agl_m + upper_ground_m), temperature_c)


@njit(cache=True, nogil=True)
def _steps_taken(contracted: ContractedGraph, steps: PathSteps, passed_m: FloatArray, ground_m: FloatArray, air: Air) -> FloatArray:
    """Seconds and joules of the step to each place of a chain and of the step back, (p, 2, 2)."""
    chain_first, place_node = contracted.chain_first, contracted.place_node
    length_m, east, north, temperature_c = steps.length_m, steps.east, steps.north, air.temperature_c
    taken = np.zeros((len(place_node), 2, 2))
    is_known = len(ground_m) > 0
    density = air_density(0.0, temperature_c)
    wind_agl_m = -1.0
    wind_mps = (0.0, 0.0)
    for chain_number in range(len(chain_first) - 1):
        for place in range(chain_first[chain_number] + 1, chain_first[chain_number + 1]):
            before, node = place_node[place - 1], place_node[place]
            rise_m = passed_m[node] - passed_m[before]
            if is_known:
                rise_m, density = _rise_and_density(passed_m[before], ground_m[before], passed_m[node], ground_m[node], temperature_c)
            middle_m, is_level = 0.5 * (passed_m[before] + passed_m[node]), passed_m[before] == passed_m[node]
            if middle_m != wind_agl_m:
                wind_agl_m = middle_m
                wind_mps = wind_in_table(air.wind, middle_m)
            for way in range(2):
                sign = 1.0 - 2.0 * way
                to_east, to_north = sign * east[place], sign * north[place]
                # As leg_taken: most steps are level, and in the wind of the step before.
                seconds, joules = taken_in_wind(length_m[place], to_east, to_north, sign * rise_m, wind_mps, density, air.own, air.table)
                if not is_level and is_closed(True, to_east, to_north, passed_m[before], passed_m[node], air):
                    seconds = joules = np.inf
                taken[place, way, 0], taken[place, way, 1] = min(seconds, NO_HEADWAY), min(joules, NO_HEADWAY)
    return taken


@njit(cache=True, nogil=True)
def taken_on_paths(
    ends: PathEnds,
    contracted: ContractedGraph,
    node_position: FloatArray,
    graph: GraphTaken,
    source: FloatArray,
    sink: FloatArray,
    bends: Bends,
) -> FloatArray:
    """Seconds and Wh of the way from each source to each sink, (2, s, t); inf where there is none, or the wind closes it.

    source (s, 4) and sink (t, 4): lon, lat [deg], the height above ground at which it is left or come to, and the ground above sea level
    there, NaN where not known.
    """
    air, way, entry_leg, leg_node = graph.air, ends.way, ends.entry_leg, ends.leg_node
    bend, bend_first, direct_number = bends.bend, bends.bend_first, bends.direct_number
    legs = len(leg_node)
    out, back = np.full((legs, 2), np.nan), np.full((legs, 2), np.nan)
    direct = np.full((len(source), len(sink), 2), np.inf)
    node_at = np.empty(4)
    none = bend[:0]
    for start in range(len(source)):
        for end in range(len(sink)):
            if way[start, end, 0] == DIRECT:
                over = none
                if len(direct_number):
                    leg = direct_number[start, end]
                    over = none if leg < 0 else bend[bend_first[leg] : bend_first[leg + 1]]
                direct[start, end, 0], direct[start, end, 1] = _over(source[start], over, sink[end], air)
                continue
            left, right = leg_of_way(way[start, end, 0], entry_leg), leg_of_way(way[start, end, 1], entry_leg)
            if left >= 0 and math.isnan(out[left, 0]):
                _put_node(node_at, leg_node[left], node_position, graph)
                over = bend[bend_first[left] : bend_first[left + 1]] if len(bend) else none
                out[left, 0], out[left, 1] = _over(source[start], over, node_at, air)
            if right >= 0 and math.isnan(back[right, 0]):
                _put_node(node_at, leg_node[right], node_position, graph)
                over = bend[bend_first[right] : bend_first[right + 1]][::-1] if len(bend) else none[::-1]
                back[right, 0], back[right, 1] = _over(node_at, over, sink[end], air)
    taken = quantities_of_pairs(ends, out, back, direct, graph.sums, contracted)
    for start in range(len(source)):
        for end in range(len(sink)):
            if taken[0, start, end] >= NO_HEADWAY / 2.0 or taken[1, start, end] >= NO_HEADWAY / 2.0:
                taken[0, start, end] = taken[1, start, end] = np.inf
            else:
                taken[1, start, end] /= J_PER_WH
    return taken


@njit(cache=True, nogil=True)
def _put_node(at: FloatArray, node: int, node_position: FloatArray, graph: GraphTaken) -> None:
    at[0], at[1], at[2] = node_position[node, 0], node_position[node, 1], graph.passed_m[node]
    at[3] = graph.ground_m[node] if len(graph.ground_m) else np.nan


@njit(cache=True, nogil=True)
def _over(start: FloatArray, bend: FloatArray, end: FloatArray, air: Air) -> tuple[float, float]:
    """Seconds and joules from place to place over bends, under which the ground is taken to be that of the start."""
    if len(bend) == 0:
        return _straight(start, end, air)
    seconds = joules = 0.0
    here, there = start.copy(), start.copy()
    for number in range(len(bend) + 1):
        if number < len(bend):
            there[:3] = bend[number]
        else:
            there[:] = end
        one_s, one_j = _straight(here, there, air)
        seconds, joules = seconds + one_s, joules + one_j
        here[:] = there
    return seconds, joules


@njit(cache=True, nogil=True)
def _straight(start: FloatArray, end: FloatArray, air: Air) -> tuple[float, float]:
    """Seconds and joules of the straight leg between two places, each as in taken_on_ways."""
    east, north = short_vector_m(start[0], start[1], end[0], end[1])
    length_m = math.hypot(east, north)
    if length_m > 0.0:
        east, north = east / length_m, north / length_m
    rise_m, density = _rise_and_density(start[2], start[3], end[2], end[3], air.temperature_c)
    return leg_taken(length_m, east, north, start[2], end[2], rise_m, density, air)
