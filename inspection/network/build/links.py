"""Links away from infrastructure: bridges, railways that would be cut off, crossings of lines."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.detours import NetworkBreak
from inspection.network.build.edges import Edges, component_labels, edges_of
from inspection.network.build.flown_nodes import FlownNodes
from inspection.network.infrastructure import InfrastructureWays
from inspection.network.inspection_graph import EdgeKind
from inspection.network.nearness import nearest_within, pairs_within
from inspection.network.rules import LinkingRules
from inspection.network.zones.zone_index import ZoneIndex

TRIES = 8  # the nearest, and when a zone is in the way as many more

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def bridge_links(bridges: IntArray, position: FloatArray, rules: LinkingRules) -> Edges:
    """Bridges to all bridges within the radius (the reference article's rule)."""
    pairs = pairs_within(position[bridges], rules.bridge_to_bridge_m)
    return edges_of(EdgeKind.BRIDGE_TO_BRIDGE, bridges[pairs[:, 0]], bridges[pairs[:, 1]])


def crossing_links(position: FloatArray, lines: InfrastructureWays, node_of_vertex: IntArray, rules: LinkingRules) -> Edges:
    """Supports that stand within the radius and have no line in common: where lines cross, run close by, or meet in a substation.

    `position` is that of all supports and line vertices: a vertex is mostly a support that nobody has tagged.
    A support without line has none in common with any other.
    """
    pairs = pairs_within(position, rules.crossing_m)
    pairs = pairs[~_share_a_way(pairs, lines, node_of_vertex)]
    return edges_of(EdgeKind.CROSSING, pairs[:, 0], pairs[:, 1])


def railway_crossing_links(places: IntArray, railway_points: IntArray, position: FloatArray, rules: LinkingRules) -> Edges:
    """Bridges and supports to the nearest railway point within the radius: where a UAV changes over without a detour."""
    row, other, _ = nearest_within(position[places], position[railway_points], rules.crossing_m, count=1)
    return edges_of(EdgeKind.CROSSING, places[row], railway_points[other])


def _share_a_way(pairs: IntArray, ways: InfrastructureWays, node_of_vertex: IntArray) -> BoolArray:
    """Whether some way passes through both nodes of each pair."""
    membership = np.unique(node_of_vertex * len(ways) + ways.way_of_vertex) if len(ways) else np.zeros(0, dtype=np.int64)
    node, way = np.divmod(membership, max(1, len(ways)))
    begin, end = np.searchsorted(node, pairs[:, 0]), np.searchsorted(node, pairs[:, 0], side="right")
    number = np.repeat(np.arange(len(pairs)), end - begin)
    entry = np.arange(len(number)) - np.repeat(np.cumsum(end - begin) - (end - begin), end - begin) + begin[number]
    shared = np.isin(pairs[number, 1] * len(ways) + way[entry], membership)
    share = np.zeros(len(pairs), dtype=bool)
    share[number[shared]] = True
    return share


@dataclass(frozen=True)
class NearestLinks:
    edges: Edges
    blocked: int  # nearest legs that a zone is in the way of
    unlinked: list[NetworkBreak]  # what a zone is in every way of, for a way round


def bridge_to_tower_links(bridges: IntArray, supports: IntArray, nodes: FlownNodes, zones: ZoneIndex, rules: LinkingRules) -> NearestLinks:
    """Each bridge to the nearest support within the radius, the next nearest when a zone is in the way."""
    row, other, _ = nearest_within(nodes.position[bridges], nodes.position[supports], rules.bridge_to_tower_m, count=TRIES)
    return _nearest_clear(EdgeKind.BRIDGE_TO_TOWER, row, bridges[row], supports[other], nodes, zones, rules)


def railway_to_tower_links(
    railway_points: IntArray, supports: IntArray, nodes: FlownNodes, masked: Edges, zones: ZoneIndex, rules: LinkingRules
) -> NearestLinks:
    """One link, the shortest clear one, for each component of the cleared graph that has railway points and no support."""
    _, component = component_labels(len(nodes.position), masked.pair)
    cut_off = railway_points[~np.isin(component[railway_points], component[supports])]
    row, other, metres = nearest_within(nodes.position[cut_off], nodes.position[supports], rules.railway_to_tower_m, count=TRIES)
    order = np.lexsort((other, row, metres, component[cut_off[row]]))
    row, other, metres = row[order], other[order], metres[order]
    return _nearest_clear(EdgeKind.RAILWAY_TO_TOWER, component[cut_off[row]], cut_off[row], supports[other], nodes, zones, rules)


def _nearest_clear(
    kind: EdgeKind, group: IntArray, start: IntArray, end: IntArray, nodes: FlownNodes, zones: ZoneIndex, rules: LinkingRules
) -> NearestLinks:
    """Of legs sorted by group, then length, the first clear one of each group."""
    usable = np.flatnonzero(np.abs(nodes.position[start, 0] - nodes.position[end, 0]) <= 180.0)
    _, first = np.unique(group[usable], return_index=True)
    nearest = usable[first]
    met = nodes.legs_in_zones(zones, start[nearest], end[nearest], rules.zone_clearance_m)
    others = np.setdiff1d(usable[np.isin(group[usable], group[nearest[met]])], nearest)
    others = others[~nodes.legs_in_zones(zones, start[others], end[others], rules.zone_clearance_m)]
    _, first = np.unique(group[others], return_index=True)
    chosen = np.sort(np.concatenate([nearest[~met], others[first]]))
    unlinked = [
        _way_round(start[legs], end[legs])
        for one in np.setdiff1d(group[nearest[met]], group[chosen])
        for legs in [usable[group[usable] == one][:TRIES]]
    ]
    return NearestLinks(edges_of(kind, start[chosen], end[chosen]), int(met.sum()), unlinked)


def _way_round(start: IntArray, end: IntArray) -> NetworkBreak:
    node, place = np.unique(np.concatenate([start, end]), return_inverse=True)
    return NetworkBreak(node, place.reshape(2, -1).T, is_one_enough=True)
