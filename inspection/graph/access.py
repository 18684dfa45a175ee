"""How a position that is not on the graph gets onto it: legs that are clear of zones."""

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import LonLat, distance_m
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.legs import Attachment
from inspection.graph.nearness import chord
from inspection.graph.route_index import node_tree, route_index
from inspection.graph.zone_index import ZoneIndex


def clear_legs(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, *, radius_m: float, factor: float, clearance_m: float, want: int = 24
) -> list[Attachment]:
    """Legs from the position to nodes within the radius that keep the clearance from every zone, the shortest first.

    These are the `want` nearest clear ones, and beyond them the shortest clear leg to each component that has none yet, so that
    whatever can be reached over one leg can be reached. At a node the leg has 0 m. The cost is the length times the factor.
    """
    tree, index = node_tree(graph), route_index(graph)
    legs: list[Attachment] = []
    tried, asked = 0, 2 * want
    while len(legs) < want and tried < graph.node_count:
        nodes = tree.nearest(position, min(asked, graph.node_count), chord(radius_m))
        legs += _clear(graph, zones, position, nodes[tried:], radius_m, factor, clearance_m)
        if len(nodes) < asked:
            break
        tried, asked = asked, 2 * asked
    legs = legs[:want]

    if index.component_count > 1:
        served = set(index.component_of(np.array([leg.node for leg in legs], dtype=np.int64)).tolist())
        around = tree.around(position, chord(radius_m))
        component = index.component_of(around)
        is_cut_off = np.ones(len(around), dtype=bool)
        for number in served:
            is_cut_off &= component != number
        if is_cut_off.any():
            others = _clear(graph, zones, position, around[is_cut_off], radius_m, factor, clearance_m)
            components = index.component_of(np.array([leg.node for leg in others], dtype=np.int64)).tolist()
            for leg, number in zip(others, components, strict=True):
                if number not in served:
                    served.add(number)
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
