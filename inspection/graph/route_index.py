"""What planners ask of a graph, made once: the condensed graph and its hub labels."""

from dataclasses import dataclass
from functools import cached_property
from threading import Lock
from typing import Any
from weakref import WeakKeyDictionary

from inspection.graph.condensed import CondensedGraph, condense
from inspection.graph.hub_labels import HubLabels, label
from inspection.graph.inspection_graph import InspectionGraph


@dataclass(frozen=True, eq=False)
class RouteIndex:
    """Read-only arrays that threads and, memory-mapped, processes share."""

    condensed: CondensedGraph
    labels: HubLabels

    @cached_property
    def query_arrays(self) -> tuple[Any, ...]:
        """In the order in which the compiled query takes them."""
        condensed, labels = self.condensed, self.labels
        return (
            condensed.node_chain,
            condensed.node_place,
            condensed.chain_first,
            condensed.chain_tail,
            condensed.chain_head,
            condensed.place_cost,
            condensed.place_m,
            labels.label_first,
            labels.label_hub,
            labels.label_cost,
            labels.label_m,
        )

    @cached_property
    def path_arrays(self) -> tuple[Any, ...]:
        """In the order in which the compiled expansion takes them."""
        condensed, labels = self.condensed, self.labels
        return (
            condensed.node_chain,
            condensed.node_place,
            condensed.chain_first,
            condensed.chain_tail,
            condensed.chain_head,
            condensed.place_node,
            labels.label_first,
            labels.label_hub,
            labels.label_chain,
        )


def build_route_index(graph: InspectionGraph) -> RouteIndex:
    condensed = condense(graph.node_count, graph.edge, graph.cost, graph.length_m)
    return RouteIndex(condensed, label(condensed))


_index_of_graph: WeakKeyDictionary[InspectionGraph, RouteIndex] = WeakKeyDictionary()
_one_build = Lock()


def remember_route_index(graph: InspectionGraph, index: RouteIndex) -> None:
    """For a graph that was stored with its index."""
    _index_of_graph[graph] = index


def route_index(graph: InspectionGraph) -> RouteIndex:
    """The graph's index: the one it came with, or one made now, once per graph."""
    index = _index_of_graph.get(graph)
    if index is None:
        with _one_build:
            index = _index_of_graph.get(graph)
            if index is None:
                index = _index_of_graph[graph] = build_route_index(graph)
    return index
