"""The part of the inspection graph that can be flown over within the height limit."""

from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from inspection.graph.inspection_graph import InspectionGraph, NodeKind
from missions.flight_plan.heights import DEFAULT_HEIGHT_M, FloatArray
from missions.flight_plan.rules import FlightRules

HEIGHT_OF_NODE_KIND_M = {
    NodeKind.SUPPORT: DEFAULT_HEIGHT_M["tower"],
    NodeKind.LINE_VERTEX: DEFAULT_HEIGHT_M["line"],
    NodeKind.RAILWAY: DEFAULT_HEIGHT_M["railway"],
    NodeKind.BRIDGE: DEFAULT_HEIGHT_M["bridge"],
}

_flyable_of_graph: WeakKeyDictionary[InspectionGraph, dict[float, InspectionGraph | None]] = WeakKeyDictionary()


def node_heights_m(graph: InspectionGraph) -> FloatArray:
    """The height that the asset at each node is taken to have."""
    default_m = np.array([HEIGHT_OF_NODE_KIND_M[kind] for kind in NodeKind])
    heights_m: FloatArray = np.where(np.isnan(graph.node_height_m), default_m[graph.node_kind], graph.node_height_m)
    return heights_m


def flyable_graph(graph: InspectionGraph, rules: FlightRules) -> InspectionGraph:
    """The graph without nodes too tall to be flown over with clearance, and without their edges; made once per graph."""
    tallest_m = rules.max_agl_m - rules.clearance_m
    made = _flyable_of_graph.setdefault(graph, {})
    if tallest_m not in made:
        kept = node_heights_m(graph) <= tallest_m
        made[tallest_m] = None if kept.all() else _with_nodes(graph, kept)  # a graph kept under itself would never be forgotten
    return made[tallest_m] or graph


def _with_nodes(graph: InspectionGraph, kept: np.ndarray) -> InspectionGraph:
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
