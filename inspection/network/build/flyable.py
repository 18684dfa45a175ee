"""The part of the graph that can be flown over within the height limit."""

from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.rules import asset_heights_m

FloatArray = NDArray[np.float64]

_flyable_of_graph: WeakKeyDictionary[InspectionGraph, dict[float, InspectionGraph | None]] = WeakKeyDictionary()


def node_heights_m(graph: InspectionGraph | Network, nodes: NDArray[np.int64] | slice) -> FloatArray:
    """The height that the asset at each of the nodes is taken to have."""
    return asset_heights_m(graph.node_kind[nodes], graph.node_height_m[nodes])


def flyable_part(graph: InspectionGraph, tallest_m: float) -> InspectionGraph:
    """The graph without nodes that are taller, and without their edges; made once per graph, or stored with it."""
    made = _flyable_of_graph.setdefault(graph, {})
    if tallest_m not in made:
        kept = node_heights_m(graph, slice(None)) <= tallest_m
        remember_flyable_part(graph, tallest_m, graph if kept.all() else _with_nodes(graph, kept))
    return made[tallest_m] or graph


def remember_flyable_part(graph: InspectionGraph, tallest_m: float, part: InspectionGraph) -> None:
    """The part may be the graph itself; it is not held under itself, or it would never be forgotten."""
    _flyable_of_graph.setdefault(graph, {})[tallest_m] = None if part is graph else part


def _with_nodes(graph: InspectionGraph, kept: NDArray[np.bool_]) -> InspectionGraph:
    number = np.cumsum(kept, dtype=np.int64) - 1
    edges = kept[graph.edge].all(axis=1)
    return replace(
        graph,
        position=graph.position[kept],
        node_kind=graph.node_kind[kept],
        node_asset=graph.node_asset[kept],
        node_height_m=graph.node_height_m[kept],
        edge=number[graph.edge[edges]].astype(np.int32),
        length_m=graph.length_m[edges],
        cost=graph.cost[edges],
        edge_kind=graph.edge_kind[edges],
        edge_asset=graph.edge_asset[edges],
    )
