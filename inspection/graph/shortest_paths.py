"""Shortest paths between places that are attached to the graph for one planning."""

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from inspection.graph.inspection_graph import InspectionGraph

ENTRIES_PER_BLOCK = 8_000_000  # sources x nodes searched at once: 100 MB

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Attachment:
    """A leg between a place and a node of the graph."""

    node: int
    length_m: float
    cost: float


@dataclass(frozen=True)
class DirectLeg:
    """A leg from a source straight to a sink, without the graph."""

    source: int
    sink: int
    length_m: float
    cost: float


@dataclass(frozen=True)
class Travel:
    """Least-cost ways between all sources and sinks.

    length_m (s, t)  metres flown along the way of least cost, inf where there is none
    cost     (s, t)  its cost
    """

    length_m: FloatArray
    cost: FloatArray
    _ways: dict[tuple[int, int], IntArray]

    def path(self, source: int, sink: int) -> IntArray:
        """Nodes from the source to the sink; none for a direct leg. Raises KeyError when there is no way."""
        return self._ways[source, sink]


class _Adjacency:
    """A graph's edges in both directions, as sorted CSR arrays."""

    def __init__(self, graph: InspectionGraph) -> None:
        n = self.node_count = graph.node_count
        tail = np.concatenate([graph.edge[:, 0], graph.edge[:, 1]]).astype(np.int64)
        head = np.concatenate([graph.edge[:, 1], graph.edge[:, 0]]).astype(np.int64)
        key = tail * n + head
        order = np.argsort(key)
        self.key = key[order]
        self.head = head[order].astype(np.int32)
        self.first = np.searchsorted(tail[order], np.arange(n + 1)).astype(np.int32)
        self.cost = np.tile(graph.cost, 2)[order]
        self.length_m = np.tile(graph.length_m, 2)[order]

    def with_sources(self, outward: Sequence[Sequence[Attachment]]) -> csr_array:
        """The matrix of costs with one row more per source, whose entries are its attachments; nothing leads into these."""
        legs = [leg for legs in outward for leg in legs]
        size = self.node_count + len(outward)
        first = self.first[-1] + np.cumsum([len(legs) for legs in outward])
        data = np.concatenate([self.cost, [leg.cost for leg in legs]])
        indices = np.concatenate([self.head, np.array([leg.node for leg in legs], dtype=np.int32)])
        return csr_array((data, indices, np.concatenate([self.first, first.astype(np.int32)])), shape=(size, size))

    def way_length_m(self, way: IntArray) -> float:
        return float(self.length_m[np.searchsorted(self.key, way[:-1] * self.node_count + way[1:])].sum())


_adjacency_of_graph: WeakKeyDictionary[InspectionGraph, _Adjacency] = WeakKeyDictionary()


def _adjacency(graph: InspectionGraph) -> _Adjacency:
    if graph not in _adjacency_of_graph:
        _adjacency_of_graph[graph] = _Adjacency(graph)
    return _adjacency_of_graph[graph]


def travel_between(
    graph: InspectionGraph,
    outward: Sequence[Sequence[Attachment]],
    inward: Sequence[Sequence[Attachment]],
    direct: Sequence[DirectLeg] = (),
) -> Travel:
    """Least-cost ways from each source to each sink.

    outward[i] says how source i enters the graph, inward[j] how the graph reaches sink j. Neither ever serves as a way through.
    A direct leg is taken where it costs no more than the way over the graph.
    """
    adjacency = _adjacency(graph)
    cost = np.full((len(outward), len(inward)), np.inf)
    length_m = cost.copy()
    ways: dict[tuple[int, int], IntArray] = {}
    block = max(1, ENTRIES_PER_BLOCK // max(1, graph.node_count))
    for begin in range(0, len(outward), block):
        _search(adjacency, begin, outward[begin : begin + block], inward, cost, length_m, ways)
    for leg in direct:
        if leg.cost <= cost[leg.source, leg.sink]:
            cost[leg.source, leg.sink] = leg.cost
            length_m[leg.source, leg.sink] = leg.length_m
            ways[leg.source, leg.sink] = np.zeros(0, dtype=np.int64)
    return Travel(length_m, cost, ways)


def _search(
    adjacency: _Adjacency,
    begin: int,
    outward: Sequence[Sequence[Attachment]],
    inward: Sequence[Sequence[Attachment]],
    cost: FloatArray,
    length_m: FloatArray,
    ways: dict[tuple[int, int], IntArray],
) -> None:
    """Fill in the rows of the given sources, the first of which is number `begin`."""
    n = adjacency.node_count
    if n == 0:
        return
    reached, previous = dijkstra(adjacency.with_sources(outward), indices=n + np.arange(len(outward)), return_predecessors=True)
    for row, exits in enumerate(outward):
        exit_length_m: dict[int, tuple[float, float]] = {}
        for leg in exits:
            exit_length_m[leg.node] = min(exit_length_m.get(leg.node, (np.inf, np.inf)), (leg.cost, leg.length_m))
        before = memoryview(previous[row])
        for column, entries in enumerate(inward):
            if not entries:
                continue
            total = reached[row, [leg.node for leg in entries]] + [leg.cost for leg in entries]
            best = int(np.argmin(total))
            if np.isinf(total[best]):
                continue
            way = [entries[best].node]
            while (node := before[way[-1]]) < n:
                way.append(node)
            nodes = np.array(way[::-1], dtype=np.int64)
            cost[begin + row, column] = total[best]
            length_m[begin + row, column] = exit_length_m[way[-1]][1] + adjacency.way_length_m(nodes) + entries[best].length_m
            ways[begin + row, column] = nodes
