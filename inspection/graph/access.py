"""How a position that is not on the graph gets onto it: legs that are clear of zones."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from inspection.geodesy import LonLat, distance_m
from inspection.graph.edges import component_labels
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.legs import Attachment
from inspection.graph.nearness import chord, on_unit_sphere
from inspection.graph.zone_index import ZoneIndex


class NodeLocator:
    """The nodes of a graph by place, and the component that each belongs to."""

    def __init__(self, graph: InspectionGraph) -> None:
        self.tree = cKDTree(on_unit_sphere(graph.position)) if graph.node_count else None
        self.component_count, self.component = component_labels(graph.node_count, graph.edge)


_locator_of_graph: WeakKeyDictionary[InspectionGraph, NodeLocator] = WeakKeyDictionary()


def node_locator(graph: InspectionGraph) -> NodeLocator:
    """Made once per graph."""
    if graph not in _locator_of_graph:
        _locator_of_graph[graph] = NodeLocator(graph)
    return _locator_of_graph[graph]


def clear_legs(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, *, radius_m: float, factor: float, clearance_m: float, want: int = 24
) -> list[Attachment]:
    """Legs from the position to nodes within the radius that keep the clearance from every zone, the shortest first.

    These are the `want` nearest clear ones, and beyond them the shortest clear leg to each component that has none yet, so that
    whatever can be reached over one leg can be reached. At a node the leg has 0 m. The cost is the length times the factor.
    """
    locator = node_locator(graph)
    if locator.tree is None:
        return []
    here = on_unit_sphere(np.array([position]))[0]
    legs: list[Attachment] = []
    tried, asked = 0, 2 * want
    while len(legs) < want and tried < graph.node_count:
        distance, nodes = locator.tree.query(
            here, k=np.arange(tried + 1, min(asked, graph.node_count) + 1), distance_upper_bound=chord(radius_m)
        )
        is_near = np.isfinite(np.asarray(distance))
        legs += _clear(graph, zones, position, np.asarray(nodes, dtype=np.int64)[is_near], radius_m, factor, clearance_m)
        if not is_near.all():
            break
        tried, asked = asked, 2 * asked
    legs = legs[:want]

    served = np.zeros(locator.component_count, dtype=bool)
    served[locator.component[[leg.node for leg in legs]]] = True
    if not served.all():
        around = np.array(locator.tree.query_ball_point(here, chord(radius_m)), dtype=np.int64)
        for leg in _clear(graph, zones, position, around[~served[locator.component[around]]], radius_m, factor, clearance_m):
            if not served[locator.component[leg.node]]:
                served[locator.component[leg.node]] = True
                legs.append(leg)
    return legs


def _clear(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, nodes: NDArray[np.int64], radius_m: float, factor: float, clearance_m: float
) -> list[Attachment]:
    """The legs to these nodes that are within the radius and clear, the shortest first."""
    here = np.broadcast_to(np.asarray(position, dtype=np.float64), (len(nodes), 2))
    length_m = distance_m(here, graph.position[nodes])
    usable = (length_m <= radius_m) & (np.abs(graph.position[nodes, 0] - position[0]) <= 180.0)
    nodes, length_m = nodes[usable], length_m[usable]
    order = np.lexsort((nodes, length_m))
    nodes, length_m = nodes[order], length_m[order]
    is_clear = ~zones.meets(here[: len(nodes)], graph.position[nodes], clearance_m)
    return [
        Attachment(node, metres, metres * factor)
        for node, metres in zip(nodes[is_clear].tolist(), length_m[is_clear].tolist(), strict=True)
    ]
