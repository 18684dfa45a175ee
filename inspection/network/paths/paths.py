"""Least-cost ways between places that are attached to the graph for one planning, from the graph's index."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate

import numpy as np
from numba import njit

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import Attachment, Attachments, DirectLeg, NoWay, bends_of, joined
from inspection.network.paths.contracted_graph import FloatArray, NumberArray
from inspection.network.paths.hub_labels import IntArray
from inspection.network.route_index import RouteIndex, route_index

# What `Travel.way` holds in place of an entry: there is no way, or the way is the direct leg, or it stays within one chain.
NO_WAY = -1
DIRECT = -2
ALONG_CHAIN = -3  # minus twice the number of the leg


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

    def path(self, source: int, sink: int) -> IntArray:
        """Nodes from the source to the sink; none for a direct leg. Raises NoWay where the length is inf."""
        out, back = self.way[source, sink].tolist()
        if out == NO_WAY:
            raise NoWay(source, sink)
        if out == DIRECT:
            return np.zeros(0, dtype=np.int64)
        nodes: IntArray = _path(out, back, self.leg_node, self.entry_leg, self.entry_label, *self.index.path_arrays)
        return nodes

    def paths(self, legs: IntArray) -> tuple[IntArray, IntArray]:
        """Nodes of several ways (k, 2), source and sink, one after another, and where each way's begin (k + 1,); as `path`."""
        ways = self.way[legs[:, 0], legs[:, 1]]
        if (ways[:, 0] == NO_WAY).any():
            raise NoWay(legs.tolist())
        nodes, first = _paths(ways, self.leg_node, self.entry_leg, self.entry_label, *self.index.path_arrays)
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
        np.array([0, *accumulate(map(len, legs))], dtype=np.int64),
        all_legs.node,
        all_legs.cost,
        all_legs.length_m,
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


def travel_of_legs(
    index: RouteIndex,
    leg_first: IntArray,
    leg_node: NumberArray,
    leg_cost: FloatArray,
    leg_m: FloatArray,
    sources: IntArray,
    sinks: IntArray,
) -> Travel:
    """The same in plain arrays: place p has the legs leg_first[p] to leg_first[p + 1]; sources and sinks are places."""
    arrays = _between(leg_first, leg_node, leg_cost, leg_m, sources, sinks, *index.query_arrays)
    length_m, cost, way, entry_leg, entry_label = arrays
    return Travel(length_m, cost, way, index, leg_node, entry_leg, entry_label)


@njit(cache=True, nogil=True)
def _between(
    leg_first: IntArray,
    leg_node: NumberArray,
    leg_cost: FloatArray,
    leg_m: FloatArray,
    sources: IntArray,
    sinks: IntArray,
    node_chain: NumberArray,
    node_place: NumberArray,
    chain_first: NumberArray,
    chain_tail: NumberArray,
    chain_head: NumberArray,
    place_cost: FloatArray,
    place_m: FloatArray,
    label_first: IntArray,
    label_hub: NumberArray,
    label_cost: FloatArray,
    label_m: FloatArray,
) -> tuple[FloatArray, FloatArray, NumberArray, NumberArray, IntArray]:
    """Every place gets its least cost to each hub that it can reach; sources and sinks meet at the hubs that both have."""
    places, legs = len(leg_first) - 1, len(leg_node)
    # Where each leg enters the core: at its node, or at both ends of its chain.
    gate = np.empty((legs, 2), dtype=np.int32)
    gate_cost = np.empty((legs, 2))
    gate_m = np.empty((legs, 2))
    most = 0
    for leg in range(legs):
        node = leg_node[leg]
        chain, place = node_chain[node], node_place[node]
        gate[leg, 1] = -1
        if chain < 0:
            gate[leg, 0], gate_cost[leg, 0], gate_m[leg, 0] = place, leg_cost[leg], leg_m[leg]
        else:
            end = chain_first[chain + 1] - 1
            gate[leg, 0], gate[leg, 1] = chain_tail[chain], chain_head[chain]
            gate_cost[leg, 0] = leg_cost[leg] + place_cost[place]
            gate_m[leg, 0] = leg_m[leg] + place_m[place]
            gate_cost[leg, 1] = leg_cost[leg] + (place_cost[end] - place_cost[place])
            gate_m[leg, 1] = leg_m[leg] + (place_m[end] - place_m[place])
        for side in range(2):
            if gate[leg, side] >= 0:
                most += label_first[gate[leg, side] + 1] - label_first[gate[leg, side]]

    # Hubs met so far are numbered as they come, by an open hash table of their places in the order.
    size = 16
    while size < 2 * min(most, len(label_first)):
        size *= 2
    slot_hub = np.full(size, -1, dtype=np.int32)
    slot_number = np.empty(size, dtype=np.int32)
    hubs = 0
    last_place = np.empty(most, dtype=np.int32)  # of each numbered hub: the place that met it last, and with which entry
    last_entry = np.empty(most, dtype=np.int32)
    entry_first = np.empty(places + 1, dtype=np.int64)
    entry_hub = np.empty(most, dtype=np.int32)
    entry_leg = np.empty(most, dtype=np.int32)
    entry_label = np.empty(most, dtype=np.int64)
    entry_cost = np.empty(most)
    entry_m = np.empty(most)
    entries = 0
    for place in range(places):
        entry_first[place] = entries
        for leg in range(leg_first[place], leg_first[place + 1]):
            for side in range(2):
                core = gate[leg, side]
                if core < 0:
                    continue
                to_gate, to_gate_m = gate_cost[leg, side], gate_m[leg, side]
                for item in range(label_first[core], label_first[core + 1]):
                    hub = label_hub[item]
                    slot = (hub * 40503) & (size - 1)
                    while slot_hub[slot] != hub:
                        if slot_hub[slot] == -1:
                            slot_hub[slot] = hub
                            slot_number[slot] = hubs
                            last_place[hubs] = -1
                            hubs += 1
                            break
                        slot = (slot + 1) & (size - 1)
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
    entry_first[places] = entries

    # What each hub has of sinks, one after another.
    bucket_first = np.zeros(hubs + 1, dtype=np.int64)
    for sink in range(len(sinks)):
        for entry in range(entry_first[sinks[sink]], entry_first[sinks[sink] + 1]):
            bucket_first[entry_hub[entry] + 1] += 1
    for number in range(hubs):
        bucket_first[number + 1] += bucket_first[number]
    filled = bucket_first[:-1].copy()
    bucket_sink = np.empty(bucket_first[hubs], dtype=np.int32)
    bucket_entry = np.empty(bucket_first[hubs], dtype=np.int32)
    bucket_cost = np.empty(bucket_first[hubs])
    for sink in range(len(sinks)):
        for entry in range(entry_first[sinks[sink]], entry_first[sinks[sink] + 1]):
            at = filled[entry_hub[entry]]
            bucket_sink[at], bucket_entry[at], bucket_cost[at] = sink, entry, entry_cost[entry]
            filled[entry_hub[entry]] += 1

    # The sinks' legs within each chain, in lists that begin at a slot of another hash table.
    sink_legs = 0
    for sink in range(len(sinks)):
        sink_legs += leg_first[sinks[sink] + 1] - leg_first[sinks[sink]]
    chain_size = 16
    while chain_size < 2 * sink_legs:
        chain_size *= 2
    slot_chain = np.full(chain_size, -1, dtype=np.int32)
    slot_item = np.empty(chain_size, dtype=np.int64)
    item_next = np.empty(sink_legs, dtype=np.int64)
    item_leg = np.empty(sink_legs, dtype=np.int32)
    item_sink = np.empty(sink_legs, dtype=np.int32)
    items = 0
    for sink in range(len(sinks)):
        for leg in range(leg_first[sinks[sink]], leg_first[sinks[sink] + 1]):
            chain = node_chain[leg_node[leg]]
            if chain < 0:
                continue
            slot = (chain * 40503) & (chain_size - 1)
            while slot_chain[slot] != chain and slot_chain[slot] != -1:
                slot = (slot + 1) & (chain_size - 1)
            item_next[items] = slot_item[slot] if slot_chain[slot] == chain else -1
            item_leg[items], item_sink[items] = leg, sink
            slot_chain[slot], slot_item[slot] = chain, items
            items += 1

    cost = np.full((len(sources), len(sinks)), np.inf)
    length_m = np.full((len(sources), len(sinks)), np.inf)
    way = np.full((len(sources), len(sinks), 2), NO_WAY, dtype=np.int32)
    for source in range(len(sources)):
        place = sources[source]
        best, met = cost[source], way[source]
        for leg in range(leg_first[place], leg_first[place + 1]):
            chain, here = node_chain[leg_node[leg]], node_place[leg_node[leg]]
            if chain < 0 or sink_legs == 0:
                continue
            slot = (chain * 40503) & (chain_size - 1)
            while slot_chain[slot] != chain and slot_chain[slot] != -1:
                slot = (slot + 1) & (chain_size - 1)
            item = slot_item[slot] if slot_chain[slot] == chain else -1
            while item >= 0:
                other, sink = item_leg[item], item_sink[item]
                there = node_place[leg_node[other]]
                total = leg_cost[leg] + abs(place_cost[there] - place_cost[here]) + leg_cost[other]
                if total < best[sink]:
                    best[sink] = total
                    length_m[source, sink] = leg_m[leg] + abs(place_m[there] - place_m[here]) + leg_m[other]
                    met[sink, 0], met[sink, 1] = ALONG_CHAIN - 2 * leg, ALONG_CHAIN - 2 * other
                item = item_next[item]
        for entry in range(entry_first[place], entry_first[place + 1]):
            number = entry_hub[entry]
            to_hub = entry_cost[entry]
            for at in range(bucket_first[number], bucket_first[number + 1]):
                sink = bucket_sink[at]
                total = to_hub + bucket_cost[at]
                if total < best[sink]:
                    best[sink] = total
                    met[sink, 0], met[sink, 1] = entry, bucket_entry[at]
        for sink in range(len(sinks)):
            if met[sink, 0] >= 0:
                length_m[source, sink] = entry_m[met[sink, 0]] + entry_m[met[sink, 1]]
    return length_m, cost, way, entry_leg[:entries].copy(), entry_label[:entries].copy()


@njit(cache=True, nogil=True)
def _path(
    out: int,
    back: int,
    leg_node: NumberArray,
    entry_leg: NumberArray,
    entry_label: IntArray,
    node_chain: NumberArray,
    node_place: NumberArray,
    chain_first: NumberArray,
    chain_tail: NumberArray,
    chain_head: NumberArray,
    place_node: NumberArray,
    label_first: IntArray,
    label_hub: NumberArray,
    label_chain: NumberArray,
) -> IntArray:
    """Nodes of one way: along one chain, or out to the hub and from there back to the sink."""
    if out <= ALONG_CHAIN:
        left = node_place[leg_node[(ALONG_CHAIN - out) // 2]]
        right = node_place[leg_node[(ALONG_CHAIN - back) // 2]]
        step = 1 if right >= left else -1
        nodes = np.empty(abs(right - left) + 1, dtype=np.int64)
        for number in range(len(nodes)):
            nodes[number] = place_node[left + step * number]
        return nodes
    there = 0
    begin = np.empty(2, dtype=np.int64)
    nodes = np.empty(0, dtype=np.int64)
    for is_filling in (False, True):
        at = 0
        for half in range(2):
            entry = out if half == 0 else back
            leg, side = entry_leg[entry] // 2, entry_leg[entry] % 2
            node = leg_node[leg]
            chain, place = node_chain[node], node_place[node]
            item = entry_label[entry]
            hub = label_hub[item]
            begin[half] = at
            if is_filling:
                nodes[at] = node
            at += 1
            if chain < 0:
                core = place
            else:
                end = chain_first[chain] if side == 0 else chain_first[chain + 1] - 1
                core = chain_tail[chain] if side == 0 else chain_head[chain]
                if is_filling:
                    step = -1 if side == 0 else 1
                    for number in range(1, abs(end - place) + 1):
                        nodes[at + number - 1] = place_node[place + step * number]
                at += abs(end - place)
            while label_chain[item] >= 0:
                chain = label_chain[item]
                first, last = chain_first[chain], chain_first[chain + 1] - 1
                is_forward = chain_tail[chain] == core
                if is_filling:
                    for number in range(1, last - first + 1):
                        nodes[at + number - 1] = place_node[first + number] if is_forward else place_node[last - number]
                at += last - first
                core = chain_head[chain] if is_forward else chain_tail[chain]
                low, high = label_first[core], label_first[core + 1]
                while low < high:
                    middle = (low + high) // 2
                    if label_hub[middle] < hub:
                        low = middle + 1
                    else:
                        high = middle
                item = low
        if not is_filling:
            there = at
            nodes = np.empty(there, dtype=np.int64)
    # The second half was walked from the sink to the hub, which the first half ends with.
    turned = nodes[begin[1] :][::-1].copy()
    nodes[begin[1] : there - 1] = turned[1:]
    return nodes[: there - 1].copy()


@njit(cache=True, nogil=True)
def _paths(
    ways: NumberArray,
    leg_node: NumberArray,
    entry_leg: NumberArray,
    entry_label: IntArray,
    node_chain: NumberArray,
    node_place: NumberArray,
    chain_first: NumberArray,
    chain_tail: NumberArray,
    chain_head: NumberArray,
    place_node: NumberArray,
    label_first: IntArray,
    label_hub: NumberArray,
    label_chain: NumberArray,
) -> tuple[IntArray, IntArray]:
    nodes = np.empty(1024, dtype=np.int64)
    first = np.zeros(len(ways) + 1, dtype=np.int64)
    for leg in range(len(ways)):
        if ways[leg, 0] == DIRECT:
            first[leg + 1] = first[leg]
            continue
        path = _path(
            ways[leg, 0],
            ways[leg, 1],
            leg_node,
            entry_leg,
            entry_label,
            node_chain,
            node_place,
            chain_first,
            chain_tail,
            chain_head,
            place_node,
            label_first,
            label_hub,
            label_chain,
        )
        begin, end = first[leg], first[leg] + len(path)
        if end > len(nodes):
            larger = np.empty(2 * end, dtype=np.int64)
            larger[:begin] = nodes[:begin]
            nodes = larger
        nodes[begin:end] = path
        first[leg + 1] = end
    return nodes[: first[len(ways)]].copy(), first
