"""How a position that is not on the graph gets onto it: legs that are clear of zones."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from inspection.geodesy import LonLat, distance_m
from inspection.graph.edges import component_labels
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.nearness import chord, on_unit_sphere
from inspection.graph.shortest_paths import Attachment
from inspection.graph.zone_index import ZoneIndex


class NodeLocator:
    """The nodes of a graph by place, and the component that each belongs to."""

    def __init__(self, graph: InspectionGraph) -> None:
        self.tree = cKDTree(on_unit_sphere(graph.position)) if graph.node_count else None
        self.component = component_labels(graph.node_count, graph.edge)[1]


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
    around = np.asarray(locator.tree.query_ball_point(on_unit_sphere(np.array([position]))[0], chord(radius_m)))
    around = around.astype(np.int64)
    here = np.broadcast_to(np.asarray(position, dtype=np.float64), (len(around), 2))
    length_m = distance_m(here, graph.position[around])
    usable = (length_m <= radius_m) & (np.abs(graph.position[around, 0] - position[0]) <= 180.0)
    around, length_m = around[usable], length_m[usable]
    order = np.lexsort((around, length_m))
    around, length_m = around[order], length_m[order]

    kept: list[int] = []
    tried = 0
    while len(kept) < want and tried < len(around):
        batch = np.arange(tried, min(len(around), tried + max(want, tried)))
        kept.extend(batch[_is_clear(graph, zones, position, around[batch], clearance_m)].tolist())
        tried += len(batch)
    kept = kept[:want]

    component = locator.component[around]
    elsewhere = np.flatnonzero(~np.isin(component, component[kept]))
    clear = elsewhere[_is_clear(graph, zones, position, around[elsewhere], clearance_m)]
    _, nearest = np.unique(component[clear], return_index=True)
    kept.extend(sorted(clear[nearest].tolist()))
    return [Attachment(int(around[leg]), float(length_m[leg]), float(length_m[leg]) * factor) for leg in kept]


def _is_clear(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, nodes: NDArray[np.int64], clearance_m: float
) -> NDArray[np.bool_]:
    here = np.broadcast_to(np.asarray(position, dtype=np.float64), (len(nodes), 2))
    return ~zones.meets(here, graph.position[nodes], clearance_m)
