"""The graph without its chains: junctions and ends of lines are the core, what lies between two of them is one chain.

In graphs of power lines 90 to 98 % of the nodes have two neighbours. A chain keeps its nodes in order with the sums of cost and
length from its first node on, so that the way from any node on it to either end, or to another node on it, is a subtraction.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
NumberArray = NDArray[np.int32]

CORE = -1  # in place of a chain's number, for a node of the core


class ContractedGraph(NamedTuple):
    """k core nodes and c chains; p places on chains, both ends of each included; n nodes.

    core_node     int32 (k,)      the graph's number of each core node
    node_chain    int32 (n,)      the chain that a node lies within, CORE for a core node
    node_place    int32 (n,)      its place on the chain; for a core node its number in the core
    chain_first   int32 (c + 1,)  where each chain's places begin
    chain_tail, chain_head  int32 (c,)  core nodes at its ends; one and the same for a loop
    place_node    int32 (p,)      the graph's number of the node at each place
    place_cost    float64 (p,)    from the chain's first place
    place_m       float64 (p,)    from the chain's first place
    """

    core_node: NumberArray
    node_chain: NumberArray
    node_place: NumberArray
    chain_first: NumberArray
    chain_tail: NumberArray
    chain_head: NumberArray
    place_node: NumberArray
    place_cost: FloatArray
    place_m: FloatArray

    @property
    def core_count(self) -> int:
        return len(self.core_node)

    @property
    def chain_cost(self) -> FloatArray:
        cost: FloatArray = self.place_cost[self.chain_first[1:] - 1]
        return cost

    @property
    def chain_m(self) -> FloatArray:
        length_m: FloatArray = self.place_m[self.chain_first[1:] - 1]
        return length_m


def contract(node_count: int, edge: NDArray[np.integer], cost: FloatArray, length_m: FloatArray) -> ContractedGraph:
    """Chains and core of an undirected graph with edges (m, 2); several between two nodes are allowed, loops at a node are left out.

    The core is every node that has not exactly two edges, and of a ring that meets no such node the one with the lowest number.
    """
    return contract_columns(node_count, edge[:, 0], edge[:, 1], cost, length_m)


def contract_columns(
    node_count: int, tail: NDArray[np.integer], head: NDArray[np.integer], cost: FloatArray, length_m: FloatArray
) -> ContractedGraph:
    """The same with the edges' ends in columns. Where the cost is the length, one array serves as both."""
    is_cost_length = cost is length_m
    cost = _column(cost, np.float64)
    length_m = cost if is_cost_length else _column(length_m, np.float64)
    arrays = _contract(node_count, _column(tail, np.int32), _column(head, np.int32), cost, length_m, is_cost_length)
    for array in arrays:
        array.setflags(write=False)
    contracted = ContractedGraph(*arrays)
    return contracted._replace(place_m=contracted.place_cost) if is_cost_length else contracted


def _column(values: NDArray[Any], dtype: type[np.generic]) -> NDArray[Any]:
    """Contiguous and writable: to numba an array that is not would be of another type, and everything compiled twice."""
    column = np.ascontiguousarray(values, dtype=dtype)
    return column if column.flags.writeable else column.copy()


@njit(cache=True, nogil=True)
def edges_of_nodes(node_count: int, tail: NumberArray, head: NumberArray) -> tuple[NumberArray, NumberArray]:
    """Return where each node's edges begin and the edges, one node after another; loops lead nowhere and are left out."""
    first = np.zeros(node_count + 1, dtype=np.int32)
    for edge in range(len(tail)):
        if tail[edge] != head[edge]:
            first[tail[edge] + 1] += 1
            first[head[edge] + 1] += 1
    for node in range(node_count):
        first[node + 1] += first[node]
    edge_at = np.empty(first[node_count], dtype=np.int32)
    filled = first[:-1].copy()
    for edge in range(len(tail)):
        if tail[edge] != head[edge]:
            edge_at[filled[tail[edge]]] = edge
            filled[tail[edge]] += 1
            edge_at[filled[head[edge]]] = edge
            filled[head[edge]] += 1
    return first, edge_at


@njit(cache=True, nogil=True)
def _contract(
    node_count: int, tail: NumberArray, head: NumberArray, cost: FloatArray, length_m: FloatArray, is_cost_length: bool
) -> tuple[NumberArray, NumberArray, NumberArray, NumberArray, NumberArray, NumberArray, NumberArray, FloatArray, FloatArray]:
    first, edge_at = edges_of_nodes(node_count, tail, head)
    node_chain = np.full(node_count, -2, dtype=np.int32)
    node_place = np.full(node_count, -1, dtype=np.int32)
    core_node = np.empty(node_count, dtype=np.int32)
    core_count = 0
    for node in range(node_count):
        if first[node + 1] - first[node] != 2:
            node_chain[node] = -1
            node_place[node] = core_count
            core_node[core_count] = node
            core_count += 1

    most_chains = len(tail)
    chain_first = np.empty(most_chains + 1, dtype=np.int32)
    chain_tail = np.empty(most_chains, dtype=np.int32)
    chain_head = np.empty(most_chains, dtype=np.int32)
    place_node = np.empty(2 * len(tail), dtype=np.int32)
    place_cost = np.empty(2 * len(tail))
    place_m = np.empty(2 * len(tail))
    chain_first[0] = 0
    chains, places = 0, 0
    is_walked = np.zeros(len(tail), dtype=np.bool_)
    # First the chains that begin at a core node, then rings, of which the first node met joins the core.
    for pick in range(core_count + node_count):
        if pick < core_count:
            begin = core_node[pick]
        else:
            begin = pick - core_count
            if node_chain[begin] != -2:
                continue
            node_chain[begin] = -1
            node_place[begin] = core_count
            core_node[core_count] = begin
            core_count += 1
        for at in range(first[begin], first[begin + 1]):
            edge = edge_at[at]
            if is_walked[edge]:
                continue
            node, walked_cost, walked_m = begin, 0.0, 0.0
            place_node[places], place_cost[places] = node, 0.0
            if not is_cost_length:
                place_m[places] = 0.0
            places += 1
            while True:
                is_walked[edge] = True
                node = head[edge] if tail[edge] == node else tail[edge]
                walked_cost += cost[edge]
                place_node[places], place_cost[places] = node, walked_cost
                if not is_cost_length:
                    walked_m += length_m[edge]
                    place_m[places] = walked_m
                places += 1
                if node_chain[node] == -1:
                    break
                node_chain[node] = chains
                node_place[node] = places - 1
                edge = edge_at[first[node]] if edge_at[first[node]] != edge else edge_at[first[node] + 1]
            chain_tail[chains] = node_place[begin]
            chain_head[chains] = node_place[node]
            chains += 1
            chain_first[chains] = places
    return (
        core_node[:core_count].copy(),
        node_chain,
        node_place,
        chain_first[: chains + 1].copy(),
        chain_tail[:chains].copy(),
        chain_head[:chains].copy(),
        place_node[:places],  # what lies behind was never touched and takes no memory
        place_cost[:places],
        place_m[:places],
    )
