"""Every compiled function of the graph run once, so that it is compiled, or loaded, before somebody waits for it."""

import numpy as np
from shapely import box

from inspection.geodesy import LonLat
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.legs import Attachment
from inspection.network.paths.access import LegRules, clear_legs
from inspection.network.paths.paths import travel_between
from inspection.network.route_index import node_tree
from inspection.network.zones.zone_detours import Errand, ways_round
from inspection.network.zones.zone_index import ZoneIndex


def rehearse() -> None:
    """Index a graph of four nodes, find a way and a place on it, and go round a zone."""
    graph = graph_to_rehearse_on()
    travel = travel_between(graph, [[Attachment(0, 1.0, 1.0)]], [[Attachment(2, 1.0, 1.0)]])
    travel.path(0, 0)
    clear_legs(graph, ZoneIndex([], [], []), BESIDE, LegRules(1_000.0, 2.0, 0.0))
    tree = node_tree(graph)
    tree.nearest(BESIDE, 2)
    tree.around(BESIDE, 1.0)
    before = ZoneIndex([box(9.0005, 46.9999, 9.0006, 47.0001)], [1], [""])
    ways_round(before, [Errand(graph.position[:2], np.array([(0, 1)]))], 0.0, 1_000.0)


BESIDE = LonLat(9.0, 47.001)


def graph_to_rehearse_on() -> InspectionGraph:
    """A line over three towers, and one that stands alone."""
    metres = np.array([100.0, 80.0])
    return InspectionGraph(
        version=0,
        ground_revision=0,
        position=np.array([[9.0, 47.0], [9.001, 47.0], [9.002, 47.0], [9.003, 47.001]]),
        node_kind=np.full(4, NodeKind.SUPPORT, dtype=np.uint8),
        node_asset=np.arange(4, dtype=np.int64),
        node_height_m=np.full(4, np.nan),
        edge=np.array([[0, 1], [1, 2]], dtype=np.int32),
        length_m=metres,
        cost=metres,
        edge_kind=np.full(2, EdgeKind.LINE, dtype=np.uint8),
        edge_asset=np.full(2, 4, dtype=np.int64),
        zone_wkb=(),
        zone_id=np.zeros(0, dtype=np.int64),
        zone_name=(),
    )
