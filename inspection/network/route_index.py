"""What planners ask of a graph, made once: the condensed graph, its hub labels, its nodes by place, and where its assets are."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from threading import RLock
from typing import Generic, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.paths.asset_places import build_asset_places
from inspection.network.paths.contracted_graph import CORE, ContractedGraph, NumberArray, contract
from inspection.network.paths.hub_labels import HubLabels, label
from inspection.network.paths.node_tree import build_node_tree


@dataclass(frozen=True, eq=False)
class RouteIndex:
    """Read-only arrays that threads and, memory-mapped, processes share."""

    contracted: ContractedGraph
    labels: HubLabels

    @cached_property
    def component_count(self) -> int:
        return int(self.labels.component.max(initial=-1)) + 1


Part = TypeVar("Part")


def build_route_index(graph: InspectionGraph) -> RouteIndex:
    contracted = contract(graph.node_count, graph.edge, graph.cost, graph.length_m)
    return RouteIndex(contracted, label(contracted))


class OncePerGraph(Generic[Part]):
    """A part of a graph's index: the one that it was stored with, or one made now."""

    def __init__(self, make: Callable[[InspectionGraph], Part]) -> None:
        self._make = make
        self._made: WeakKeyDictionary[InspectionGraph, Part] = WeakKeyDictionary()
        self._one_thread = RLock()

    def __call__(self, graph: InspectionGraph) -> Part:
        part = self._made.get(graph)
        if part is None:
            with self._one_thread:
                part = self._made.get(graph)
                if part is None:
                    part = self._made[graph] = self._make(graph)
        return part

    def remember(self, graph: InspectionGraph, part: Part) -> None:
        self._made[graph] = part


route_index = OncePerGraph(build_route_index)
node_tree = OncePerGraph(lambda graph: build_node_tree(graph.position))
asset_places = OncePerGraph(build_asset_places)


def components_of_nodes(graph: InspectionGraph) -> NumberArray:
    """The number of the component that each node is in, (n,)."""
    contracted, labels = route_index(graph).contracted, route_index(graph).labels
    chain, place, tail = contracted.node_chain, contracted.node_place, contracted.chain_tail
    core = np.where(chain == CORE, place, tail[np.maximum(chain, 0)] if len(tail) else place)
    found: NumberArray = labels.component[core]
    return found
