"""How a position that is not on the graph gets onto it: legs that are clear of zones."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import short_distance_m
from inspection.graph.condensed import CORE, FloatArray, NumberArray
from inspection.graph.hub_labels import IntArray
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.legs import Attachments, joined
from inspection.graph.nearness import chord
from inspection.graph.node_tree import around_in_tree, nearest_in_tree, point_on_sphere
from inspection.graph.route_index import node_tree, route_index
from inspection.graph.zone_index import ZoneIndex


def clear_legs(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, *, radius_m: float, factor: float, clearance_m: float, want: int = 24
) -> Attachments:
    """Legs from the position to nodes within the radius that keep the clearance from every zone, the shortest first.

    These are the `want` nearest clear ones, and beyond them the shortest clear leg to each component that has none yet, so that
    whatever can be reached over one leg can be reached. At a node the leg has 0 m. The cost is the length times the factor.
    """
    tree, index = node_tree(graph).arrays, route_index(graph)
    reach = float(position.lon), float(position.lat), float(radius_m), chord(float(radius_m))

    def clear(node: NumberArray) -> slice | NDArray[np.bool_]:
        return ~zones.meets([position], graph.position[node], clearance_m) if len(zones) else slice(None)

    legs: list[Attachments] = []
    missing, tried, asked = want, 0, 2 * want
    while missing > 0 and tried < graph.node_count:
        node, length_m, found = _nearest_legs(*reach, tried, min(asked, graph.node_count), graph.position, *tree)
        is_clear = clear(node)
        node, length_m = node[is_clear][:missing], length_m[is_clear][:missing]
        legs.append(Attachments(node, length_m, length_m * factor))
        missing -= len(node)
        if found < asked:
            break
        tried, asked = asked, 2 * asked
    nearest = joined(legs)
    if index.component_count < 2:
        return nearest

    node, length_m, component = _legs_elsewhere(*reach, nearest.node, index.component_count, *index.component_arrays, graph.position, *tree)
    if not len(node):
        return nearest
    is_clear = clear(node)
    node, length_m = node[is_clear], length_m[is_clear]
    _, first = np.unique(component[is_clear], return_index=True)
    shortest = np.sort(first)
    return joined([nearest, Attachments(node[shortest], length_m[shortest], length_m[shortest] * factor)])


@njit(cache=True, nogil=True)
def _nearest_legs(
    lon: float,
    lat: float,
    radius_m: float,
    within: float,
    tried: int,
    asked: int,
    position: FloatArray,
    order: NumberArray,
    point: FloatArray,
    axis: NDArray[np.uint8],
) -> tuple[NumberArray, FloatArray, int]:
    """Legs to the `asked` nearest nodes but those tried before, the shortest first, and how many nodes there are in the chord `within`."""
    nodes = nearest_in_tree(point_on_sphere(lon, lat), asked, within * within, order, point, axis)
    node, length_m = _legs_to(nodes[tried:], lon, lat, radius_m, position)
    return node, length_m, len(nodes)


@njit(cache=True, nogil=True)
def _legs_elsewhere(
    lon: float,
    lat: float,
    radius_m: float,
    within: float,
    served: NumberArray,
    component_count: int,
    node_chain: NumberArray,
    node_place: NumberArray,
    chain_tail: NumberArray,
    component: NumberArray,
    position: FloatArray,
    order: NumberArray,
    point: FloatArray,
    axis: NDArray[np.uint8],
) -> tuple[NumberArray, FloatArray, IntArray]:
    """Legs to all nodes within the radius that share no component with the nodes served, the shortest first, and those components."""
    is_served = np.zeros(component_count, dtype=np.bool_)
    for node in served:
        is_served[_component_of(node, node_chain, node_place, chain_tail, component)] = True
    nodes = around_in_tree(point_on_sphere(lon, lat), within * within, order, point, axis)
    count = 0
    for node in nodes:
        if not is_served[_component_of(node, node_chain, node_place, chain_tail, component)]:
            nodes[count] = node
            count += 1
    cut_off, length_m = _legs_to(nodes[:count], lon, lat, radius_m, position)
    components = np.empty(len(cut_off), dtype=np.int64)
    for leg in range(len(cut_off)):
        components[leg] = _component_of(cut_off[leg], node_chain, node_place, chain_tail, component)
    return cut_off, length_m, components


@njit(cache=True, nogil=True)
def _legs_to(nodes: IntArray, lon: float, lat: float, radius_m: float, position: FloatArray) -> tuple[NumberArray, FloatArray]:
    """Of these nodes those that a leg within the radius reaches on this side of the antimeridian, and its metres; the shortest first."""
    node = np.empty(len(nodes), dtype=np.int32)
    length_m = np.empty(len(nodes))
    count = 0
    for other in np.sort(nodes):
        if abs(position[other, 0] - lon) <= 180.0:
            metres = short_distance_m(lon, lat, position[other, 0], position[other, 1])
            if metres <= radius_m:
                node[count], length_m[count] = other, metres
                count += 1
    by_length = np.argsort(length_m[:count], kind="mergesort")
    return node[:count][by_length], length_m[:count][by_length]


@njit(cache=True, nogil=True)
def _component_of(node: int, node_chain: NumberArray, node_place: NumberArray, chain_tail: NumberArray, component: NumberArray) -> int:
    chain = node_chain[node]
    number: int = component[node_place[node] if chain == CORE else chain_tail[chain]]
    return number
