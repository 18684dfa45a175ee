"""What is summed up along ways of the graph, where the two directions of an edge differ: seconds in wind, energy, climbs.

The ways are those of `paths.py`, which are least in cost. What a way of them takes is a difference of sums along chains and a sum kept
with each hub label, so that no way is walked. Each quantity of each direction is made once for all edges, by who knows what it is.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from inspection.geodesy.local_frame import short_vector_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import NO_BENDS
from inspection.network.paths.contracted_graph import ContractedGraph, FloatArray, NumberArray
from inspection.network.paths.hub_labels import HubLabels, IntArray, entry_at
from inspection.network.paths.paths import ALONG_CHAIN, DIRECT, NO_WAY, PathEnds, Travel
from inspection.network.route_index import OncePerGraph, route_index


class PathSteps(NamedTuple):
    """Each place of a chain and the step to it from the place before; the first place of a chain has none. p places, e label entries.

    length_m     float64 (p,)  metres of the step
    east, north  float64 (p,)  its direction, of length 1; 0 where there is no step
    next_entry   int64 (e,)    where the way of a label entry goes on after its first chain; -1 at the hub
    turn         int64 (e,)    the entries in an order in which each comes after the one that it goes on with
    """

    length_m: FloatArray
    east: FloatArray
    north: FloatArray
    next_entry: IntArray
    turn: IntArray


class Sums(NamedTuple):
    """q quantities along chains and along label entries.

    place  float64 (p, 2, q)  from the chain's first place to this one, and from this one back to it
    label  float64 (e, 2, q)  from the core's node to the hub, and from the hub to the node
    """

    place: FloatArray
    label: FloatArray

    @property
    def nbytes(self) -> int:
        return self.place.nbytes + self.label.nbytes


def _steps(graph: InspectionGraph) -> PathSteps:
    index = route_index(graph)
    contracted, labels = index.contracted, index.labels
    next_entry, turn = _entries_in_turn(contracted, labels)
    length_m, east, north = _directions(contracted, graph.position)
    return PathSteps(length_m, east, north, next_entry, turn)


steps_of_graph = OncePerGraph(_steps)


def sums_along(graph: InspectionGraph, taken: FloatArray) -> Sums:
    """taken (p, 2, q): what the step to each place of a chain takes, and the step back; 0 at a chain's first place. Summed in place."""
    index = route_index(graph)
    return Sums(taken, _sums(taken, index.contracted, index.labels, steps_of_graph(graph)))


def quantities_of_ways(travel: Travel, sums: Sums, out: FloatArray, back: FloatArray, direct: FloatArray) -> FloatArray:
    """What the way of each source and sink takes, (q, s, t); inf where there is no way.

    out (legs, q) and back (legs, q): the legs of Travel.leg_node flown to the node and from it; only those need be right that ways
    take (see `ends_of_ways`). direct (s, t, q): straight from source to sink, where the way is direct.
    """
    return quantities_of_pairs(travel.ends, out, back, direct, sums, travel.index.contracted)


@njit(cache=True, nogil=True)
def leg_of_way(end: int, entry_leg: NumberArray) -> int:
    """The leg by which a way leaves its source or comes to its sink, from what Travel.way holds of it; -1 for none."""
    if end <= ALONG_CHAIN:
        return (ALONG_CHAIN - end) // 2
    return entry_leg[end] // 2 if end >= 0 else -1


@njit(cache=True, nogil=True)
def _directions(contracted: ContractedGraph, position: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    chain_first, place_node, place_m = contracted.chain_first, contracted.place_node, contracted.place_m
    places = len(place_node)
    length_m, east, north = np.zeros(places), np.zeros(places), np.zeros(places)
    for chain in range(len(chain_first) - 1):
        for place in range(chain_first[chain] + 1, chain_first[chain + 1]):
            before, node = place_node[place - 1], place_node[place]
            east_m, north_m = short_vector_m(position[before, 0], position[before, 1], position[node, 0], position[node, 1])
            straight_m = np.hypot(east_m, north_m)
            length_m[place] = place_m[place] - place_m[place - 1]
            if straight_m > 0.0:
                east[place], north[place] = east_m / straight_m, north_m / straight_m
    return length_m, east, north


@njit(cache=True, nogil=True)
def _entries_in_turn(contracted: ContractedGraph, labels: HubLabels) -> tuple[IntArray, IntArray]:
    chain_tail, chain_head = contracted.chain_tail, contracted.chain_head
    label_first, label_hub, label_chain = labels.label_first, labels.label_hub, labels.label_chain
    entries = len(label_hub)
    next_entry = np.full(entries, -1, dtype=np.int64)
    for core in range(len(label_first) - 1):
        for entry in range(label_first[core], label_first[core + 1]):
            chain = label_chain[entry]
            if chain < 0:
                continue
            other = chain_head[chain] if chain_tail[chain] == core else chain_tail[chain]
            next_entry[entry] = entry_at(labels, other, label_hub[entry])
    turn = np.empty(entries, dtype=np.int64)
    is_placed = np.zeros(entries, dtype=np.bool_)
    waiting = np.empty(max(len(label_first), 1), dtype=np.int64)  # a way passes no node twice
    placed = 0
    for entry in range(entries):
        count, at = 0, entry
        while at >= 0 and not is_placed[at]:
            waiting[count] = at
            count += 1
            at = next_entry[at]
        for number in range(count - 1, -1, -1):
            turn[placed] = waiting[number]
            is_placed[waiting[number]] = True
            placed += 1
    return next_entry, turn


@njit(cache=True, nogil=True)
def _sums(taken: FloatArray, contracted: ContractedGraph, labels: HubLabels, steps: PathSteps) -> FloatArray:
    chain_first, chain_tail = contracted.chain_first, contracted.chain_tail
    label_first, label_chain, next_entry = labels.label_first, labels.label_chain, steps.next_entry
    quantities = taken.shape[2]
    for chain in range(len(chain_first) - 1):
        for place in range(chain_first[chain] + 1, chain_first[chain + 1]):
            for way in range(2):
                for quantity in range(quantities):
                    taken[place, way, quantity] += taken[place - 1, way, quantity]
    core_of = np.empty(len(label_chain), dtype=np.int32)
    for core in range(len(label_first) - 1):
        core_of[label_first[core] : label_first[core + 1]] = core
    label = np.zeros((len(label_chain), 2, quantities))
    for entry in steps.turn:
        chain = label_chain[entry]
        if chain < 0:
            continue
        last, onward = chain_first[chain + 1] - 1, next_entry[entry]
        forward = 0 if chain_tail[chain] == core_of[entry] else 1
        for quantity in range(quantities):
            label[entry, 0, quantity] = taken[last, forward, quantity] + label[onward, 0, quantity]
            label[entry, 1, quantity] = taken[last, 1 - forward, quantity] + label[onward, 1, quantity]
    return label


@njit(cache=True, nogil=True)
def quantities_of_pairs(
    ends: PathEnds, out: FloatArray, back: FloatArray, direct: FloatArray, sums: Sums, contracted: ContractedGraph
) -> FloatArray:
    """As quantities_of_ways, for compiled code."""
    way, leg_node, entry_leg, entry_label = ends.way, ends.leg_node, ends.entry_leg, ends.entry_label
    place_sum, label_sum = sums.place, sums.label
    node_chain, node_place, chain_first = contracted.node_chain, contracted.node_place, contracted.chain_first
    sources, sinks = way.shape[0], way.shape[1]
    quantities = place_sum.shape[2]
    taken = np.full((quantities, sources, sinks), np.inf)
    for source in range(sources):
        for sink in range(sinks):
            start, end = way[source, sink, 0], way[source, sink, 1]
            if start == NO_WAY:
                continue
            if start == DIRECT:
                for quantity in range(quantities):
                    taken[quantity, source, sink] = direct[source, sink, quantity]
                continue
            left, right = leg_of_way(start, entry_leg), leg_of_way(end, entry_leg)
            here, there = node_place[leg_node[left]], node_place[leg_node[right]]
            if start <= ALONG_CHAIN:
                direction = 0 if there >= here else 1
                for quantity in range(quantities):
                    along = abs(place_sum[there, direction, quantity] - place_sum[here, direction, quantity])
                    taken[quantity, source, sink] = out[left, quantity] + along + back[right, quantity]
                continue
            for quantity in range(quantities):
                total = out[left, quantity] + back[right, quantity]
                total += label_sum[entry_label[start], 0, quantity] + label_sum[entry_label[end], 1, quantity]
                chain = node_chain[leg_node[left]]
                if chain >= 0 and entry_leg[start] % 2 == 0:
                    total += place_sum[here, 1, quantity]
                elif chain >= 0:
                    total += place_sum[chain_first[chain + 1] - 1, 0, quantity] - place_sum[here, 0, quantity]
                chain = node_chain[leg_node[right]]
                if chain >= 0 and entry_leg[end] % 2 == 0:
                    total += place_sum[there, 0, quantity]
                elif chain >= 0:
                    total += place_sum[chain_first[chain + 1] - 1, 1, quantity] - place_sum[there, 1, quantity]
                taken[quantity, source, sink] = total
    return taken


BEND = -1  # in place of a node


@dataclass(frozen=True, eq=False)
class Passed:
    """What several ways lead over, one way after another: way w has the places first[w] up to but without first[w + 1], (w + 1,).

    position (n, 2) lon, lat [deg]; node (n,), BEND for a bend of a leg.
    """

    position: FloatArray
    node: IntArray
    first: IntArray


def passed_on(travel: Travel, ways: IntArray, position: FloatArray) -> Passed:
    """The places of several ways (k, 2), source and sink; position is that of the graph's nodes. Raises NoWay as `Travel.paths`."""
    node, first = travel.paths(ways)
    if not (travel.leg_bends or travel.direct_bends):
        return Passed(position[node], node, first)
    places: list[FloatArray] = []
    nodes: list[IntArray] = []
    counts = [0]
    for way, (source, sink) in enumerate(ways.tolist()):
        own = node[first[way] : first[way + 1]]
        out, back = _bends(travel, source, sink)
        places += [out, position[own], back[::-1]]
        nodes += [np.full(len(out), BEND, dtype=np.int64), own, np.full(len(back), BEND, dtype=np.int64)]
        counts.append(len(out) + len(own) + len(back))
    return Passed(np.concatenate(places), np.concatenate(nodes), np.cumsum(counts))


def _bends(travel: Travel, source: int, sink: int) -> tuple[FloatArray, FloatArray]:
    """Of the leg from the source, and of the leg to the sink from the sink on."""
    out, back = travel.way[source, sink].tolist()
    if out == DIRECT:
        return travel.direct_bends.get((source, sink), NO_BENDS), NO_BENDS
    if not travel.leg_bends:
        return NO_BENDS, NO_BENDS
    if out <= ALONG_CHAIN:
        return travel.leg_bends[(ALONG_CHAIN - out) // 2], travel.leg_bends[(ALONG_CHAIN - back) // 2]
    return travel.leg_bends[int(travel.entry_leg[out]) // 2], travel.leg_bends[int(travel.entry_leg[back]) // 2]
