"""Least-cost ways between places that are attached to the graph for one planning, from the graph's index."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numba import njit

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import Attachment, Attachments, DirectLeg, NoPath, bends_of, joined
from inspection.network.paths.contracted_graph import ContractedGraph, FloatArray, NumberArray
from inspection.network.paths.hub_labels import HubLabels, IntArray, entry_at
from inspection.network.route_index import RouteIndex, route_index

# What `Travel.way` holds in place of an entry: there is no way, or the way is the direct leg, or it stays within one chain.
NO_WAY = -1
DIRECT = -2
ALONG_CHAIN = -3  # minus twice the number of the leg
EMPTY = -1  # in place of a key, in a slot of a hash table


class PlaceLegs(NamedTuple):
    """How places meet the graph: place p has the legs first[p] to first[p + 1], to these nodes."""

    first: IntArray
    node: NumberArray
    cost: FloatArray
    length_m: FloatArray


class Gates(NamedTuple):
    """Where each leg enters the core, (legs, 2): at its node, or at both ends of its chain; -1 for none. Cost and length from the place."""

    core: NumberArray
    cost: FloatArray
    length_m: FloatArray


class Entries(NamedTuple):
    """The hubs that each place reaches: place p has the entries first[p] to first[p + 1].

    hub is its number among the hubs that are reached; leg twice the leg, plus 1 if it leaves its chain by the head; label the label's
    entry. Cost and length from the place to the hub.
    """

    first: IntArray
    hub: NumberArray
    leg: NumberArray
    label: IntArray
    cost: FloatArray
    length_m: FloatArray


class PathEnds(NamedTuple):
    """How paths leave their sources and come to their sinks, as Travel has it."""

    way: NumberArray
    leg_node: NumberArray
    entry_leg: NumberArray
    entry_label: IntArray


@dataclass(frozen=True, eq=False)
class Travel:
    """Least-cost ways between s sources and t sinks.

    length_m (s, t)     metres flown along the way of least cost, inf where there is none
    cost     (s, t)     its cost
    way      (s, t, 2)  the entries in which source and sink meet: indices of entry_leg and entry_label; or see NO_WAY
    """

    length_m: FloatArray
    cost: FloatArray
    way: NumberArray
    index: RouteIndex
    leg_node: NumberArray
    entry_leg: NumberArray  # twice the leg, plus 1 if it leaves its chain by the head
    entry_label: IntArray
    leg_bends: tuple[FloatArray, ...] = ()  # of each leg, from its place on; nothing where all are straight
    direct_bends: Mapping[tuple[int, int], FloatArray] = field(default_factory=dict)  # of source and sink

    @property
    def ends(self) -> PathEnds:
        return PathEnds(self.way, self.leg_node, self.entry_leg, self.entry_label)

    def path(self, source: int, sink: int) -> IntArray:
        """Nodes from the source to the sink; none for a direct leg. Raises NoPath where the length is inf."""
        out, back = self.way[source, sink].tolist()
        if out == NO_WAY:
            raise NoPath(source, sink)
        if out == DIRECT:
            return np.zeros(0, dtype=np.int64)
        nodes: IntArray = _path(out, back, self.ends, self.index.contracted, self.index.labels)
        return nodes

    def paths(self, legs: IntArray) -> tuple[IntArray, IntArray]:
        """Nodes of several ways (k, 2), source and sink, one after another, and where each way's begin (k + 1,); as `path`."""
        ways = self.way[legs[:, 0], legs[:, 1]]
        if (ways[:, 0] == NO_WAY).any():
            raise NoPath(legs.tolist())
        nodes, first = _paths(ways, self.ends, self.index.contracted, self.index.labels)
        return nodes, first


def travel_between(
    graph: InspectionGraph,
    outward: Sequence[Attachments | Sequence[Attachment]],
    inward: Sequence[Attachments | Sequence[Attachment]],
    direct: Sequence[DirectLeg] = (),
) -> Travel:
    """Least-cost ways from each source to each sink.

    outward[i] says how source i enters the graph, inward[j] how the graph reaches sink j. Neither ever serves as a way through.
    A direct leg is taken where it costs no more than the way over the graph.
    """
    # A place that is source and sink has one list of legs for both: what its legs reach is looked up once.
    number = {key: place for place, key in enumerate(dict.fromkeys(id(legs) for legs in (*outward, *inward)))}
    legs_of = {id(legs): Attachments.of(legs) for legs in (*outward, *inward)}
    return travel_between_places(
        graph,
        [legs_of[key] for key in number],
        [number[id(legs)] for legs in outward],
        [number[id(legs)] for legs in inward],
        direct,
    )


def travel_between_places(
    graph: InspectionGraph,
    legs: Sequence[Attachments],
    sources: Sequence[int],
    sinks: Sequence[int],
    direct: Sequence[DirectLeg] = (),
) -> Travel:
    """The same where a place may be source and sink: place p meets the graph over legs[p], sources and sinks are places."""
    all_legs = joined(legs)
    travel = travel_of_legs(
        route_index(graph),
        PlaceLegs(np.array([0, *accumulate(map(len, legs))], dtype=np.int64), all_legs.node, all_legs.cost, all_legs.length_m),
        np.array(sources, dtype=np.int64),
        np.array(sinks, dtype=np.int64),
    )
    bends = {}
    for one in direct:
        if one.cost <= travel.cost[one.source, one.sink]:
            travel.cost[one.source, one.sink] = one.cost
            travel.length_m[one.source, one.sink] = one.length_m
            travel.way[one.source, one.sink] = DIRECT
            bends[one.source, one.sink] = one.bends
    by_bends = {ends: bends_of(way) for ends, way in bends.items() if way}
    return replace(travel, leg_bends=all_legs.bends, direct_bends=by_bends) if all_legs.bends or by_bends else travel


def travel_of_legs(index: RouteIndex, legs: PlaceLegs, sources: IntArray, sinks: IntArray) -> Travel:
    """The same in plain arrays: sources and sinks are places."""
    length_m, cost, way, entry_leg, entry_label = _between(legs, sources, sinks, index.contracted, index.labels)
    return Travel(length_m, cost, way, index, legs.node, entry_leg, entry_label)


@njit(cache=True, nogil=True)
def _between(
    legs: PlaceLegs, sources: IntArray, sinks: IntArray, contracted: ContractedGraph, labels: HubLabels
) -> tuple[FloatArray, FloatArray, NumberArray, NumberArray, IntArray]:
    """Every place gets its least cost to each hub that it can reach; sources and sinks meet at the hubs that both have."""
    entries, hubs = _entries(legs, _gates(legs, contracted), labels)
    cost = np.full((len(sources), len(sinks)), np.inf)
    length_m = np.full((len(sources), len(sinks)), np.inf)
    way = np.full((len(sources), len(sinks), 2), NO_WAY, dtype=np.int32)
    _join_along_chains(legs, sources, sinks, contracted, length_m, cost, way)
    _join_at_hubs(entries, hubs, sources, sinks, length_m, cost, way)
    return length_m, cost, way, entries.leg.copy(), entries.label.copy()


@njit(cache=True, nogil=True)
def _empty_keys(count: int) -> NumberArray:
    """The keys of an open hash table with room for so many."""
    size = 16
    while size < 2 * count:
        size *= 2
    return np.full(size, EMPTY, dtype=np.int32)


@njit(cache=True, nogil=True, inline="always")
def _slot_of(keys: NumberArray, key: int) -> int:
    """Where a key is in an open hash table, or where it belongs: the first EMPTY slot from its own on."""
    slot = (key * 40503) & (len(keys) - 1)
    while keys[slot] != key and keys[slot] != EMPTY:
        slot = (slot + 1) & (len(keys) - 1)
    return slot


@njit(cache=True, nogil=True)
def _gates(legs: PlaceLegs, contracted: ContractedGraph) -> Gates:
    count = len(legs.node)
    core, cost, length_m = np.empty((count, 2), dtype=np.int32), np.empty((count, 2)), np.empty((count, 2))
    place_cost, place_m = contracted.place_cost, contracted.place_m
    for leg in range(count):
        chain, place = contracted.node_chain[legs.node[leg]], contracted.node_place[legs.node[leg]]
        core[leg, 1] = -1
        if chain < 0:
            core[leg, 0], cost[leg, 0], length_m[leg, 0] = place, legs.cost[leg], legs.length_m[leg]
        else:
            end = contracted.chain_first[chain + 1] - 1
            core[leg, 0], core[leg, 1] = contracted.chain_tail[chain], contracted.chain_head[chain]
            cost[leg, 0] = legs.cost[leg] + place_cost[place]
            length_m[leg, 0] = legs.length_m[leg] + place_m[place]
            cost[leg, 1] = legs.cost[leg] + (place_cost[end] - place_cost[place])
            length_m[leg, 1] = legs.length_m[leg] + (place_m[end] - place_m[place])
    return Gates(core, cost, length_m)


@njit(cache=True, nogil=True)
def _entries(legs: PlaceLegs, gates: Gates, labels: HubLabels) -> tuple[Entries, int]:
    """The entries of all places, and how many hubs there are. Hubs are numbered as they are met first."""
    label_first, label_hub, label_cost, label_m = labels.label_first, labels.label_hub, labels.label_cost, labels.label_m
    most = 0
    for core in gates.core.flat:
        if core >= 0:
            most += label_first[core + 1] - label_first[core]
    slot_hub = _empty_keys(min(most, len(label_first)))
    slot_number = np.empty(len(slot_hub), dtype=np.int32)
    hubs = 0
    last_place = np.empty(most, dtype=np.int32)  # of each numbered hub: the place that met it last, and with which entry
    last_entry = np.empty(most, dtype=np.int32)
    entry_first = np.empty(len(legs.first), dtype=np.int64)
    entry_hub = np.empty(most, dtype=np.int32)
    entry_leg = np.empty(most, dtype=np.int32)
    entry_label = np.empty(most, dtype=np.int64)
    entry_cost = np.empty(most)
    entry_m = np.empty(most)
    entries = 0
    for place in range(len(legs.first) - 1):
        entry_first[place] = entries
        for leg in range(legs.first[place], legs.first[place + 1]):
            for side in range(2):
                core = gates.core[leg, side]
                if core < 0:
                    continue
                to_gate, to_gate_m = gates.cost[leg, side], gates.length_m[leg, side]
                for item in range(label_first[core], label_first[core + 1]):
                    slot = _slot_of(slot_hub, label_hub[item])
                    if slot_hub[slot] == EMPTY:
                        slot_hub[slot], slot_number[slot], last_place[hubs] = label_hub[item], hubs, -1
                        hubs += 1
                    number = slot_number[slot]
                    total = to_gate + label_cost[item]
                    if last_place[number] == place:
                        entry = last_entry[number]
                        if total >= entry_cost[entry]:
                            continue
                    else:
                        entry = entries
                        entries += 1
                        last_place[number], last_entry[number] = place, entry
                    entry_hub[entry], entry_leg[entry], entry_label[entry] = number, 2 * leg + side, item
                    entry_cost[entry], entry_m[entry] = total, to_gate_m + label_m[item]
    entry_first[-1] = entries
    return Entries(
        entry_first, entry_hub[:entries], entry_leg[:entries], entry_label[:entries], entry_cost[:entries], entry_m[:entries]
    ), hubs


@njit(cache=True, nogil=True)
def _join_along_chains(
    legs: PlaceLegs,
    sources: IntArray,
    sinks: IntArray,
    contracted: ContractedGraph,
    length_m: FloatArray,
    cost: FloatArray,
    way: NumberArray,
) -> None:
    """Write the ways of sources and sinks whose legs meet the same chain, along that chain."""
    sink_legs = 0
    for place in sinks:
        sink_legs += legs.first[place + 1] - legs.first[place]
    if sink_legs == 0:
        return
    # The sinks' legs within each chain are lists, which begin at the chain's slot.
    node_chain, node_place, place_cost, place_m = contracted.node_chain, contracted.node_place, contracted.place_cost, contracted.place_m
    slot_chain = _empty_keys(sink_legs)
    slot_item = np.empty(len(slot_chain), dtype=np.int64)
    item_next = np.empty(sink_legs, dtype=np.int64)
    item_leg = np.empty(sink_legs, dtype=np.int32)
    item_sink = np.empty(sink_legs, dtype=np.int32)
    items = 0
    for sink in range(len(sinks)):
        for leg in range(legs.first[sinks[sink]], legs.first[sinks[sink] + 1]):
            chain = node_chain[legs.node[leg]]
            if chain < 0:
                continue
            slot = _slot_of(slot_chain, chain)
            item_next[items] = slot_item[slot] if slot_chain[slot] == chain else -1
            item_leg[items], item_sink[items] = leg, sink
            slot_chain[slot], slot_item[slot] = chain, items
            items += 1
    for source in range(len(sources)):
        for leg in range(legs.first[sources[source]], legs.first[sources[source] + 1]):
            chain, here = node_chain[legs.node[leg]], node_place[legs.node[leg]]
            if chain < 0:
                continue
            slot = _slot_of(slot_chain, chain)
            item = slot_item[slot] if slot_chain[slot] == chain else -1
            while item >= 0:
                other, sink = item_leg[item], item_sink[item]
                there = node_place[legs.node[other]]
                total = legs.cost[leg] + abs(place_cost[there] - place_cost[here]) + legs.cost[other]
                if total < cost[source, sink]:
                    cost[source, sink] = total
                    length_m[source, sink] = legs.length_m[leg] + abs(place_m[there] - place_m[here]) + legs.length_m[other]
                    way[source, sink, 0], way[source, sink, 1] = ALONG_CHAIN - 2 * leg, ALONG_CHAIN - 2 * other
                item = item_next[item]


@njit(cache=True, nogil=True)
def _join_at_hubs(
    entries: Entries, hubs: int, sources: IntArray, sinks: IntArray, length_m: FloatArray, cost: FloatArray, way: NumberArray
) -> None:
    """Write the ways that lead over a hub, where they cost less than those that are written already."""
    # What each hub has of sinks, one after another.
    bucket_first = np.zeros(hubs + 1, dtype=np.int64)
    for place in sinks:
        for entry in range(entries.first[place], entries.first[place + 1]):
            bucket_first[entries.hub[entry] + 1] += 1
    for number in range(hubs):
        bucket_first[number + 1] += bucket_first[number]
    filled = bucket_first[:-1].copy()
    bucket_sink = np.empty(bucket_first[hubs], dtype=np.int32)
    bucket_entry = np.empty(bucket_first[hubs], dtype=np.int32)
    bucket_cost = np.empty(bucket_first[hubs])
    for sink in range(len(sinks)):
        for entry in range(entries.first[sinks[sink]], entries.first[sinks[sink] + 1]):
            at = filled[entries.hub[entry]]
            bucket_sink[at], bucket_entry[at], bucket_cost[at] = sink, entry, entries.cost[entry]
            filled[entries.hub[entry]] += 1
    for source in range(len(sources)):
        best, met = cost[source], way[source]
        for entry in range(entries.first[sources[source]], entries.first[sources[source] + 1]):
            number, to_hub = entries.hub[entry], entries.cost[entry]
            for at in range(bucket_first[number], bucket_first[number + 1]):
                sink = bucket_sink[at]
                total = to_hub + bucket_cost[at]
                if total < best[sink]:
                    best[sink] = total
                    met[sink, 0], met[sink, 1] = entry, bucket_entry[at]
        for sink in range(len(sinks)):
            if met[sink, 0] >= 0:
                length_m[source, sink] = entries.length_m[met[sink, 0]] + entries.length_m[met[sink, 1]]


@njit(cache=True, nogil=True)
def _path(out: int, back: int, ends: PathEnds, contracted: ContractedGraph, labels: HubLabels) -> IntArray:
    """Nodes of one way: along one chain, or out to the hub and from there back to the sink."""
    if out <= ALONG_CHAIN:
        left = contracted.node_place[ends.leg_node[(ALONG_CHAIN - out) // 2]]
        right = contracted.node_place[ends.leg_node[(ALONG_CHAIN - back) // 2]]
        step = 1 if right >= left else -1
        nodes = np.empty(abs(right - left) + 1, dtype=np.int64)
        for number in range(len(nodes)):
            nodes[number] = contracted.place_node[left + step * number]
        return nodes
    nodes = np.empty(0, dtype=np.int64)  # until they are counted, none is written
    middle = there = 0
    for _ in range(2):
        middle = _to_hub(out, ends, contracted, labels, nodes, 0)
        there = _to_hub(back, ends, contracted, labels, nodes, middle)
        if len(nodes) == 0:
            nodes = np.empty(there, dtype=np.int64)
    # The second half was walked from the sink to the hub, which the first half ends with.
    turned = nodes[middle:][::-1].copy()
    nodes[middle : there - 1] = turned[1:]
    return nodes[: there - 1].copy()


@njit(cache=True, nogil=True)
def _to_hub(entry: int, ends: PathEnds, contracted: ContractedGraph, labels: HubLabels, nodes: IntArray, at: int) -> int:
    """Write the nodes from a leg to the hub of an entry from `at` on, unless there are to be none; returns where they end."""
    chain_first, place_node = contracted.chain_first, contracted.place_node
    is_filling = len(nodes) > 0
    node, side = ends.leg_node[ends.entry_leg[entry] // 2], ends.entry_leg[entry] % 2
    chain, place = contracted.node_chain[node], contracted.node_place[node]
    item = ends.entry_label[entry]
    hub = labels.label_hub[item]
    if is_filling:
        nodes[at] = node
    at += 1
    if chain < 0:
        core = place
    else:
        end = chain_first[chain] if side == 0 else chain_first[chain + 1] - 1
        core = contracted.chain_tail[chain] if side == 0 else contracted.chain_head[chain]
        if is_filling:
            step = -1 if side == 0 else 1
            for number in range(1, abs(end - place) + 1):
                nodes[at + number - 1] = place_node[place + step * number]
        at += abs(end - place)
    while labels.label_chain[item] >= 0:
        chain = labels.label_chain[item]
        first, last = chain_first[chain], chain_first[chain + 1] - 1
        is_forward = contracted.chain_tail[chain] == core
        if is_filling:
            for number in range(1, last - first + 1):
                nodes[at + number - 1] = place_node[first + number] if is_forward else place_node[last - number]
        at += last - first
        core = contracted.chain_head[chain] if is_forward else contracted.chain_tail[chain]
        item = entry_at(labels, core, hub)
    return at


@njit(cache=True, nogil=True)
def _paths(ways: NumberArray, ends: PathEnds, contracted: ContractedGraph, labels: HubLabels) -> tuple[IntArray, IntArray]:
    nodes = np.empty(1024, dtype=np.int64)
    first = np.zeros(len(ways) + 1, dtype=np.int64)
    for leg in range(len(ways)):
        if ways[leg, 0] == DIRECT:
            first[leg + 1] = first[leg]
            continue
        path = _path(ways[leg, 0], ways[leg, 1], ends, contracted, labels)
        begin, end = first[leg], first[leg] + len(path)
        if end > len(nodes):
            larger = np.empty(2 * end, dtype=np.int64)
            larger[:begin] = nodes[:begin]
            nodes = larger
        nodes[begin:end] = path
        first[leg + 1] = end
    return nodes[: first[len(ways)]].copy(), first
