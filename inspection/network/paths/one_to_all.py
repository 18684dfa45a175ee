"""Least-cost ways from one place to every node of the graph, and what they take there and back."""

from dataclasses import dataclass
from heapq import heappop, heappush
from typing import NamedTuple

import numpy as np
from numba import njit

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import Attachments
from inspection.network.paths.contracted_graph import ContractedGraph, FloatArray, NumberArray
from inspection.network.route_index import route_index


@dataclass(frozen=True, eq=False)
class OneToAllSearch:
    """The way of least cost between a place and each of n nodes, the same both ways, and what is summed up along it.

    cost      float64 (n,)       inf where there is no way
    length_m  float64 (n,)       inf where there is no way
    taken     float64 (n, 2, q)  of q quantities: to the node, and from it back to the place; 0 where there is no way
    """

    cost: FloatArray
    length_m: FloatArray
    taken: FloatArray


class CoreGraph(NamedTuple):
    """The chains at each core node: those of node k are chain[first[k]:first[k + 1]]; a loop is there twice."""

    first: NumberArray
    chain: NumberArray


def core_graph(contracted: ContractedGraph) -> CoreGraph:
    chains = np.arange(len(contracted.chain_tail), dtype=np.int32)
    core = np.concatenate([contracted.chain_tail, contracted.chain_head])
    order = np.argsort(core, kind="stable")
    first = np.searchsorted(core[order], np.arange(contracted.core_count + 1)).astype(np.int32)
    return CoreGraph(first, np.concatenate([chains, chains])[order])


def search_from(
    graph: InspectionGraph,
    legs: Attachments,
    at_core: CoreGraph | None = None,
    *,
    place_sum: FloatArray | None = None,
    leg_taken: FloatArray | None = None,
) -> OneToAllSearch:
    """From a place that meets the graph over these legs (Dijkstra 1959 on the core; the chains follow from their ends).

    at_core: of the graph's condensed form, where there are more places to do. place_sum (p, 2, q): of each quantity the sum from the first
    place of a chain to each, and from that one back; leg_taken (legs, 2, q): out over a leg, and back. Without them there are none.
    """
    contracted = route_index(graph).contracted
    at_core = core_graph(contracted) if at_core is None else at_core
    sums = np.zeros((len(contracted.place_node), 2, 0)) if place_sum is None else place_sum
    taken = np.zeros((len(legs), 2, sums.shape[2])) if leg_taken is None else leg_taken
    if taken.shape != (len(legs), 2, sums.shape[2]):
        raise ValueError("leg_taken must have shape (legs, 2, quantities)")
    node, cost = np.asarray(legs.node, dtype=np.int32), np.asarray(legs.cost, dtype=np.float64)
    own_legs = TakenLegs(node, cost, np.asarray(legs.length_m, dtype=np.float64), taken)
    return OneToAllSearch(*_search_from(contracted, at_core, own_legs, sums))


class TakenLegs(NamedTuple):
    """Legs from the place to nodes, and what they take there and back, (legs, 2, q)."""

    node: NumberArray
    cost: FloatArray
    length_m: FloatArray
    taken: FloatArray


@njit(cache=True, nogil=True)
def _search_from(
    contracted: ContractedGraph, at_core: CoreGraph, legs: TakenLegs, place_sum: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    core_cost, core_m, core_taken = _search_core(contracted, at_core, legs, place_sum)
    nodes = len(contracted.node_chain)
    cost, length_m, taken = np.full(nodes, np.inf), np.full(nodes, np.inf), np.zeros((nodes, 2, place_sum.shape[2]))
    for core in range(len(core_cost)):
        node = contracted.core_node[core]
        cost[node], length_m[node] = core_cost[core], core_m[core]
        taken[node] = core_taken[core]
    _fill_chains(contracted, (core_cost, core_m, core_taken), place_sum, cost, length_m, taken)
    _fill_along_legs(contracted, legs, place_sum, cost, length_m, taken)
    return cost, length_m, taken


@njit(cache=True, nogil=True)
def _search_core(
    contracted: ContractedGraph, at_core: CoreGraph, legs: TakenLegs, place_sum: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cost, metres and what is taken of each node of the core."""
    chain_first, chain_tail, chain_head = contracted.chain_first, contracted.chain_tail, contracted.chain_head
    place_cost, place_m, core_first, core_chain = contracted.place_cost, contracted.place_m, at_core.first, at_core.chain
    cores, quantities = len(contracted.core_node), place_sum.shape[2]
    core_cost, core_m = np.full(cores, np.inf), np.full(cores, np.inf)
    core_taken = np.zeros((cores, 2, quantities))
    waiting = [(np.inf, np.int64(-1))]  # which says what is in it
    waiting.pop()
    for leg in range(len(legs.node)):
        chain, place = contracted.node_chain[legs.node[leg]], contracted.node_place[legs.node[leg]]
        if chain < 0:
            if legs.cost[leg] < core_cost[place]:
                core_cost[place], core_m[place] = legs.cost[leg], legs.length_m[leg]
                core_taken[place] = legs.taken[leg]
                heappush(waiting, (legs.cost[leg], np.int64(place)))
            continue
        last = chain_first[chain + 1] - 1
        for end in range(2):
            core = chain_tail[chain] if end == 0 else chain_head[chain]
            on_chain = place_cost[place] if end == 0 else place_cost[last] - place_cost[place]
            if legs.cost[leg] + on_chain < core_cost[core]:
                core_cost[core] = legs.cost[leg] + on_chain
                core_m[core] = legs.length_m[leg] + (place_m[place] if end == 0 else place_m[last] - place_m[place])
                for quantity in range(quantities):
                    to_place, back = place_sum[place, 0, quantity], place_sum[place, 1, quantity]
                    onward, hither = place_sum[last, 0, quantity] - to_place, place_sum[last, 1, quantity] - back
                    core_taken[core, 0, quantity] = legs.taken[leg, 0, quantity] + (back if end == 0 else onward)
                    core_taken[core, 1, quantity] = legs.taken[leg, 1, quantity] + (to_place if end == 0 else hither)
                heappush(waiting, (core_cost[core], np.int64(core)))
    while len(waiting) > 0:
        so_far, core = heappop(waiting)
        if so_far > core_cost[core]:
            continue
        for at in range(core_first[core], core_first[core + 1]):
            chain = core_chain[at]
            last = chain_first[chain + 1] - 1
            is_forward = chain_tail[chain] == core
            other = chain_head[chain] if is_forward else chain_tail[chain]
            if so_far + place_cost[last] < core_cost[other]:
                core_cost[other], core_m[other] = so_far + place_cost[last], core_m[core] + place_m[last]
                there = 0 if is_forward else 1
                for quantity in range(quantities):
                    core_taken[other, 0, quantity] = core_taken[core, 0, quantity] + place_sum[last, there, quantity]
                    core_taken[other, 1, quantity] = core_taken[core, 1, quantity] + place_sum[last, 1 - there, quantity]
                heappush(waiting, (core_cost[other], np.int64(other)))
    return core_cost, core_m, core_taken


@njit(cache=True, nogil=True)
def _fill_chains(
    contracted: ContractedGraph,
    of_core: tuple[FloatArray, FloatArray, FloatArray],
    place_sum: FloatArray,
    cost: FloatArray,
    length_m: FloatArray,
    taken: FloatArray,
) -> None:
    """Write nodes within chains, each from the end of its chain that costs less."""
    core_cost, core_m, core_taken = of_core
    chain_first, place_node, place_cost, place_m = contracted.chain_first, contracted.place_node, contracted.place_cost, contracted.place_m
    for chain in range(len(contracted.chain_tail)):
        tail, head, last = contracted.chain_tail[chain], contracted.chain_head[chain], chain_first[chain + 1] - 1
        if core_cost[tail] == np.inf and core_cost[head] == np.inf:
            continue
        for place in range(chain_first[chain] + 1, last):
            node = place_node[place]
            from_tail, from_head = core_cost[tail] + place_cost[place], core_cost[head] + place_cost[last] - place_cost[place]
            if from_tail <= from_head:
                cost[node], length_m[node] = from_tail, core_m[tail] + place_m[place]
                for way in range(2):
                    for quantity in range(taken.shape[2]):
                        taken[node, way, quantity] = core_taken[tail, way, quantity] + place_sum[place, way, quantity]
            else:
                cost[node], length_m[node] = from_head, core_m[head] + place_m[last] - place_m[place]
                for way in range(2):
                    for quantity in range(taken.shape[2]):
                        along = place_sum[last, 1 - way, quantity] - place_sum[place, 1 - way, quantity]
                        taken[node, way, quantity] = core_taken[head, way, quantity] + along


@njit(cache=True, nogil=True)
def _fill_along_legs(
    contracted: ContractedGraph, legs: TakenLegs, place_sum: FloatArray, cost: FloatArray, length_m: FloatArray, taken: FloatArray
) -> None:
    """Write nodes of the chains that legs meet, where the way along the chain costs less than by its ends."""
    chain_first, place_cost, place_m = contracted.chain_first, contracted.place_cost, contracted.place_m
    for leg in range(len(legs.node)):
        chain, here = contracted.node_chain[legs.node[leg]], contracted.node_place[legs.node[leg]]
        if chain < 0:
            continue
        for place in range(chain_first[chain] + 1, chain_first[chain + 1] - 1):
            node = contracted.place_node[place]
            along_chain = legs.cost[leg] + abs(place_cost[place] - place_cost[here])
            if along_chain < cost[node]:
                cost[node], length_m[node] = along_chain, legs.length_m[leg] + abs(place_m[place] - place_m[here])
                direction = 0 if place >= here else 1
                for way in range(2):
                    for quantity in range(taken.shape[2]):
                        along = abs(place_sum[place, (way + direction) % 2, quantity] - place_sum[here, (way + direction) % 2, quantity])
                        taken[node, way, quantity] = legs.taken[leg, way, quantity] + along
