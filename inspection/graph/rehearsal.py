"""Every compiled function of the graph run once, so that it is compiled, or loaded, before somebody waits for it."""

import numpy as np

from inspection.geodesy import LonLat
from inspection.graph.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.graph.legs import Attachment
from inspection.graph.route_index import node_tree
from inspection.graph.ways import travel_between


def rehearse() -> None:
    """Index a graph of three nodes, and find a way and a place on it."""
    edge = np.array([[0, 1], [1, 2]], dtype=np.int32)
    metres = np.array([100.0, 80.0])
    graph = InspectionGraph(
        version=0,
        ground_revision=0,
        position=np.array([[9.0, 47.0], [9.001, 47.0], [9.002, 47.0]]),
        node_kind=np.full(3, NodeKind.SUPPORT, dtype=np.uint8),
        node_asset=np.arange(3, dtype=np.int64),
        node_height_m=np.full(3, np.nan),
        edge=edge,
        length_m=metres,
        cost=metres,
        edge_kind=np.full(2, EdgeKind.LINE, dtype=np.uint8),
        edge_asset=np.full(2, 3, dtype=np.int64),
        zone_wkb=(),
        zone_id=np.zeros(0, dtype=np.int64),
        zone_name=(),
    )
    travel = travel_between(graph, [[Attachment(0, 1.0, 1.0)]], [[Attachment(2, 1.0, 1.0)]])
    travel.path(0, 0)
    tree = node_tree(graph)
    tree.nearest(LonLat(9.0, 47.0), 2)
    tree.around(LonLat(9.0, 47.0), 1.0)
