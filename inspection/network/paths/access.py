"""How a position that is not on the graph gets onto it: legs that are clear of zones."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import short_distance_m
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.legs import Attachments, joined
from inspection.network.nearness import chord
from inspection.network.paths.contracted_graph import CORE, ContractedGraph, FloatArray, NumberArray
from inspection.network.paths.hub_labels import HubLabels, IntArray
from inspection.network.paths.node_tree import NodeTree, around_in_tree, nearest_in_tree, point_on_sphere
from inspection.network.route_index import node_tree, route_index
from inspection.network.rules import FlownHeights, asset_heights_m
from inspection.network.zones.zone_detours import Errand, ways_round
from inspection.network.zones.zone_index import ZoneIndex

MAX_ROUND = 8  # nearest nodes behind zones that are offered legs round them
ROUND_ELSEWHERE = 2  # nearest nodes of each component that no straight leg reaches


@dataclass(frozen=True)
class LegRules:
    """How long legs may be, what a metre of them costs, and how far zones are kept from; with heights, at which heights zones count."""

    radius_m: float
    factor: float
    clearance_m: float
    heights: FlownHeights | None = None


def clear_legs(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, rules: LegRules, *, want: int = 24, height_m: float | None = 0.0
) -> Attachments:
    """Legs from the position to nodes within the radius that keep the clearance from every zone, the shortest first.

    These are the `want` nearest clear ones, and beyond them the shortest clear leg to each component that has none yet, so that
    whatever can be reached over one leg can be reached. Nodes nearer than these that zones stand before, and components that no clear
    leg reaches, are offered legs round the zones, no longer than the radius. At a node the leg has 0 m. The cost is the length times
    the factor. With heights a zone counts where its band has a height between the pass heights of the leg's ends; height_m is that of
    the asset at the position, None where it is not known.
    """
    tree, index = node_tree(graph), route_index(graph)
    around = Around(float(position.lon), float(position.lat), float(rules.radius_m), chord(float(rules.radius_m)))
    behind: list[NumberArray] = []

    def clear(node: NumberArray) -> slice | NDArray[np.bool_]:
        """Notes those that are not."""
        if not len(zones):
            return slice(None)
        is_met = zones.meets([position], graph.position[node], rules.clearance_m, *band_of_legs(graph, node, rules.heights, height_m))
        if is_met.any():
            behind.append(node[is_met])
        return ~is_met

    legs: list[Attachments] = []
    missing, tried, asked = want, 0, 2 * want
    while missing > 0 and tried < graph.node_count:
        node, length_m, found = _nearest_legs(around, tried, min(asked, graph.node_count), graph.position, tree)
        is_clear = clear(node)
        node, length_m = node[is_clear][:missing], length_m[is_clear][:missing]
        legs.append(Attachments(node, length_m, length_m * rules.factor))
        missing -= len(node)
        if found < asked:
            break
        tried, asked = asked, 2 * asked
    wanted = [np.concatenate(behind)[:MAX_ROUND]] if behind else []
    if index.component_count >= 2:
        served = joined(legs).node
        node, length_m, component = _legs_elsewhere(around, served, index.contracted, index.labels, graph.position, tree)
        if len(node):
            is_clear = clear(node)
            _, first = np.unique(component[is_clear], return_index=True)
            shortest = np.sort(first)
            legs.append(Attachments(node[is_clear][shortest], length_m[is_clear][shortest], length_m[is_clear][shortest] * rules.factor))
            wanted.append(_nearest_of_each(node, component, component[is_clear][shortest]))
    if behind:
        some = np.unique(np.concatenate(wanted))
        legs.append(_legs_round(graph, zones, position, some, rules, height_m))
    return joined(legs)


def _nearest_of_each(node: NumberArray, component: IntArray, served: IntArray) -> NumberArray:
    """Of nodes, the nearest first, the first few of each component that is not served."""
    order = np.argsort(component, kind="stable")
    _, first = np.unique(component[order], return_index=True)
    rank = np.arange(len(order)) - np.repeat(first, np.diff(np.append(first, len(order))))
    some = order[(rank < ROUND_ELSEWHERE) & ~np.isin(component[order], served)]
    return node[np.sort(some)][:MAX_ROUND]


def band_of_legs(
    graph: InspectionGraph, node: NumberArray, heights: FlownHeights | None, height_m: float | None
) -> tuple[FloatArray | None, FloatArray | None]:
    """Lowest and highest above ground of the legs between a place and these nodes; None where no heights are told."""
    if heights is None:
        return None, None
    low_m, high_m = heights.band_m(asset_heights_m(graph.node_kind[node], graph.node_height_m[node]))
    here_low_m, here_high_m = heights.place_band_m(height_m)
    return np.minimum(low_m, here_low_m), np.maximum(high_m, here_high_m)


def _legs_round(
    graph: InspectionGraph, zones: ZoneIndex, position: LonLat, nodes: NumberArray, rules: LegRules, height_m: float | None
) -> Attachments:
    """The shortest ways to these nodes round the zones that stand before them."""
    low_m, high_m = band_of_legs(graph, nodes, rules.heights, height_m)
    errand = Errand(
        np.concatenate([[position], graph.position[nodes]]),
        np.column_stack([np.zeros(len(nodes), dtype=np.int64), np.arange(1, len(nodes) + 1)]),
        None if low_m is None else float(low_m.min()),
        None if high_m is None else float(high_m.max()),
    )
    found = ways_round(zones, [errand], rules.clearance_m, rules.radius_m)[0]
    there_is = np.array([way is not None for way in found], dtype=bool)
    ways = [way for way in found if way is not None]
    length_m = np.array([way.length_m for way in ways], dtype=np.float64)
    return Attachments(nodes[there_is], length_m, length_m * rules.factor, tuple(way.bend for way in ways))


class Around(NamedTuple):
    """A position, how long legs from it may be, and the same as a chord on the unit sphere."""

    lon: float
    lat: float
    radius_m: float
    chord: float


@njit(cache=True, nogil=True)
def _nearest_legs(around: Around, tried: int, asked: int, position: FloatArray, tree: NodeTree) -> tuple[NumberArray, FloatArray, int]:
    """Legs to the `asked` nearest nodes but those tried before, the shortest first, and how many nodes there are within the chord."""
    nodes = nearest_in_tree(point_on_sphere(around.lon, around.lat), asked, around.chord * around.chord, tree)
    node, length_m = _legs_to(nodes[tried:], around, position)
    return node, length_m, len(nodes)


@njit(cache=True, nogil=True)
def _legs_elsewhere(
    around: Around, served: NumberArray, contracted: ContractedGraph, labels: HubLabels, position: FloatArray, tree: NodeTree
) -> tuple[NumberArray, FloatArray, IntArray]:
    """Legs to all nodes within the radius that share no component with the nodes served, the shortest first, and those components."""
    is_served = np.zeros(labels.component.max() + 1, dtype=np.bool_)
    for node in served:
        is_served[_component_of(node, contracted, labels)] = True
    nodes = around_in_tree(point_on_sphere(around.lon, around.lat), around.chord * around.chord, tree)
    count = 0
    for node in nodes:
        if not is_served[_component_of(node, contracted, labels)]:
            nodes[count] = node
            count += 1
    cut_off, length_m = _legs_to(nodes[:count], around, position)
    components = np.empty(len(cut_off), dtype=np.int64)
    for leg in range(len(cut_off)):
        components[leg] = _component_of(cut_off[leg], contracted, labels)
    return cut_off, length_m, components


@njit(cache=True, nogil=True)
def _legs_to(nodes: IntArray, around: Around, position: FloatArray) -> tuple[NumberArray, FloatArray]:
    """Of these nodes those that a leg within the radius reaches on this side of the antimeridian, and its metres; the shortest first."""
    node = np.empty(len(nodes), dtype=np.int32)
    length_m = np.empty(len(nodes))
    count = 0
    for other in np.sort(nodes):
        if abs(position[other, 0] - around.lon) <= 180.0:
            metres = short_distance_m(around.lon, around.lat, position[other, 0], position[other, 1])
            if metres <= around.radius_m:
                node[count], length_m[count] = other, metres
                count += 1
    by_length = np.argsort(length_m[:count], kind="mergesort")
    return node[:count][by_length], length_m[:count][by_length]


@njit(cache=True, nogil=True)
def _component_of(node: int, contracted: ContractedGraph, labels: HubLabels) -> int:
    chain = contracted.node_chain[node]
    number: int = labels.component[contracted.node_place[node] if chain == CORE else contracted.chain_tail[chain]]
    return number
