"""Ways between attached places by scipy's Dijkstra, one search over the whole graph for each source: what the index is checked against."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import Attachment, DirectLeg, NoPath

ENTRIES_PER_BLOCK = 8_000_000  # sources x nodes searched at once: 100 MB
KEPT_SEARCHES = 16  # of sources whose paths are asked for, when not all are kept

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]


NO_WAY = -1
DIRECT = -2


@dataclass(frozen=True)
class Travel:
    """Least-cost ways between all sources and sinks.

    length_m (s, t)  metres flown along the way of least cost, inf where there is none
    cost     (s, t)  its cost
    """

    length_m: FloatArray
    cost: FloatArray
    _last: IntArray  # (s, t) the node before the sink, or NO_WAY or DIRECT
    _previous: Callable[[int], NDArray[np.int32]]  # for a source: the node before each node

    def path(self, source: int, sink: int) -> IntArray:
        """Nodes from the source to the sink; none for a direct leg. Raises NoPath where the length is inf."""
        last = int(self._last[source, sink])
        if last == NO_WAY:
            raise NoPath(source, sink)
        if last == DIRECT:
            return np.zeros(0, dtype=np.int64)
        previous = self._previous(source)
        before, size = previous.data, len(previous)
        way = [last]
        while (node := before[way[-1]]) < size:
            way.append(node)
        return np.array(way[::-1], dtype=np.int64)


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

    def search(self, outward: Sequence[Sequence[Attachment]]) -> tuple[FloatArray, NDArray[np.int32]]:
        """For each source the cost of reaching each node, and the node before it: one from node_count on where the source is."""
        legs = [leg for legs in outward for leg in legs]
        size = self.node_count + len(outward)
        first = self.first[-1] + np.cumsum([len(legs) for legs in outward])
        # One row more per source, whose entries are its attachments; nothing leads into these.
        matrix = csr_array(
            (
                np.concatenate([self.cost, [leg.cost for leg in legs]]),
                np.concatenate([self.head, np.array([leg.node for leg in legs], dtype=np.int32)]),
                np.concatenate([self.first, first.astype(np.int32)]),
            ),
            shape=(size, size),
        )
        reached, previous = dijkstra(matrix, indices=self.node_count + np.arange(len(outward)), return_predecessors=True)
        return reached[:, : self.node_count], np.ascontiguousarray(previous[:, : self.node_count])

    def step_lengths_m(self, way: list[int]) -> FloatArray:
        nodes = np.array(way, dtype=np.int64)
        return self.length_m[np.searchsorted(self.key, nodes[:-1] * self.node_count + nodes[1:])]


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
    last = np.full(cost.shape, NO_WAY, dtype=np.int64)
    block = max(1, ENTRIES_PER_BLOCK // max(1, graph.node_count))

    predecessors: dict[int, NDArray[np.int32]] = {}
    if graph.node_count:
        for begin in range(0, len(outward), block):
            reached, previous = adjacency.search(outward[begin : begin + block])
            for row, source in enumerate(range(begin, begin + len(reached))):
                _arrive(reached[row], inward, cost[source], last[source])
                _measure(adjacency, previous[row], outward[source], inward, last[source], length_m[source])
            if len(outward) <= block:
                predecessors = dict(enumerate(previous))
    for leg in direct:
        if leg.cost <= cost[leg.source, leg.sink]:
            cost[leg.source, leg.sink] = leg.cost
            length_m[leg.source, leg.sink] = leg.length_m
            last[leg.source, leg.sink] = DIRECT

    @lru_cache(maxsize=KEPT_SEARCHES)
    def searched_again(source: int) -> NDArray[np.int32]:
        _, previous = adjacency.search(outward[source : source + 1])
        alone: NDArray[np.int32] = previous[0]
        return alone

    return Travel(length_m, cost, last, lambda source: predecessors[source] if predecessors else searched_again(source))


def _arrive(reached: FloatArray, inward: Sequence[Sequence[Attachment]], cost: FloatArray, last: IntArray) -> None:
    """Choose the node from which each sink is reached at the least cost."""
    for sink, legs in enumerate(inward):
        if legs:
            total = reached[[leg.node for leg in legs]] + [leg.cost for leg in legs]
            best = int(np.argmin(total))
            if np.isfinite(total[best]):
                cost[sink], last[sink] = total[best], legs[best].node


def _measure(
    adjacency: _Adjacency,
    previous: NDArray[np.int32],
    outward: Sequence[Attachment],
    inward: Sequence[Sequence[Attachment]],
    last: IntArray,
    length_m: FloatArray,
) -> None:
    """Metres flown to each sink along the tree of least-cost ways; what ways share is walked once."""
    first_leg_m = _cheapest_lengths_m(outward)
    flown_m: dict[int, float] = {}
    before = previous.data
    for sink, node in enumerate(last.tolist()):
        if node == NO_WAY:
            continue
        way = [node]
        while way[-1] not in flown_m:
            parent = before[way[-1]]
            if parent >= adjacency.node_count:
                flown_m[way[-1]] = first_leg_m[way[-1]]
            else:
                way.append(parent)
        way.reverse()
        along_m = flown_m[way[0]] + np.cumsum(adjacency.step_lengths_m(way))
        flown_m.update(zip(way[1:], along_m.tolist(), strict=True))
        length_m[sink] = flown_m[node] + _cheapest_lengths_m(inward[sink])[node]


def _cheapest_lengths_m(legs: Sequence[Attachment]) -> dict[int, float]:
    """For each node the length of the leg that costs least."""
    return {leg.node: leg.length_m for leg in sorted(legs, key=lambda leg: leg.cost, reverse=True)}
