"""From the ground to the inspection graph: nodes, edges, links, and everything out that meets a zone."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from inspection.graph.edges import (
    Edges,
    cheapest_per_pair,
    component_labels,
    costs,
    edges_of,
    joined,
    lengths_m,
    without_seam,
)
from inspection.graph.ground_data import GroundData, Places, Ways
from inspection.graph.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.graph.joining import join_vertices
from inspection.graph.links import bridge_links, bridge_to_tower_links, crossing_links, railway_crossing_links, railway_to_tower_links
from inspection.graph.railway_points import railway_points
from inspection.graph.rules import LinkingRules
from inspection.graph.zone_index import ZoneIndex

NO_VERSION = 0  # until the graph is stored
NO_PLACES = Places(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0))

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class BuiltGraph:
    graph: InspectionGraph
    components: int
    excluded_nodes: int
    excluded_edges: int


@dataclass(frozen=True)
class _Nodes:
    position: FloatArray
    kind: NDArray[np.uint8]
    asset: IntArray
    height_m: FloatArray

    def where(self, chosen: NDArray[np.bool_]) -> "_Nodes":
        return _Nodes(self.position[chosen], self.kind[chosen], self.asset[chosen], self.height_m[chosen])

    def of_kind(self, kind: NodeKind) -> IntArray:
        return np.flatnonzero(self.kind == kind)


def build(ground: GroundData, rules: LinkingRules, progress: Callable[[str, float], None] | None = None) -> BuiltGraph:
    """Build the graph. The same ground and rules always give the same arrays.

    Nodes come in the order supports, line vertices, railway points, bridges. Zones take away nodes within the clearance of one and
    edges that come so near; then each bridge, and each railway that would be cut off, is linked to the nearest support that is left.
    """
    tell = progress or (lambda message, fraction: None)
    tell("joining lines and railways", 0.1)
    nodes, edges = _network(ground, rules)
    edges, nodes = _contracted(edges, nodes)
    tell("clearing the zones", 0.5)
    zones = ZoneIndex(shapely.from_wkb(np.array(ground.zones.wkb, dtype=object)), ground.zones.identifier, ground.zones.name)
    nodes, edges, excluded_nodes, excluded_edges = _cleared(nodes, edges, zones, rules)
    tell("linking bridges and railways", 0.8)
    supports, bridges = nodes.of_kind(NodeKind.SUPPORT), nodes.of_kind(NodeKind.BRIDGE)
    to_tower = bridge_to_tower_links(bridges, supports, nodes.position, zones, rules)
    edges = joined(edges, to_tower.edges)
    to_railway = railway_to_tower_links(nodes.of_kind(NodeKind.RAILWAY), supports, nodes.position, edges, zones, rules)
    edges, nodes = _contracted(joined(edges, to_railway.edges), nodes)

    length_m = lengths_m(edges, nodes.position)
    cost = costs(edges, length_m, rules.off_network_factor)
    kept = cheapest_per_pair(edges, cost)
    edges, length_m, cost = edges.where(kept), length_m[kept], cost[kept]
    graph = InspectionGraph(
        version=NO_VERSION,
        ground_revision=ground.revision,
        position=nodes.position,
        node_kind=nodes.kind,
        node_asset=nodes.asset,
        node_height_m=nodes.height_m,
        edge=edges.pair.astype(np.int32),
        length_m=length_m,
        cost=cost,
        edge_kind=edges.kind,
        edge_asset=edges.asset,
        zone_wkb=ground.zones.wkb,
        zone_id=ground.zones.identifier,
        zone_name=ground.zones.name,
    )
    components, _ = component_labels(graph.node_count, graph.edge)
    return BuiltGraph(graph, components, excluded_nodes, excluded_edges + to_tower.blocked + to_railway.blocked)


def _network(ground: GroundData, rules: LinkingRules) -> tuple[_Nodes, Edges]:
    """All nodes, and the edges that depend on no other edge, as if there were no zones."""
    on_lines = join_vertices(ground.supports, ground.lines)
    railways = railway_points(ground.railways, join_vertices(NO_PLACES, ground.railways), rules.railway_spacing_m)
    first_railway = len(on_lines.position)
    vertices = on_lines.way[len(ground.supports) :]
    nodes = _Nodes(
        position=np.concatenate([on_lines.position, railways.position, ground.bridges.position]),
        kind=np.repeat(
            np.array([NodeKind.SUPPORT, NodeKind.LINE_VERTEX, NodeKind.RAILWAY, NodeKind.BRIDGE], dtype=np.uint8),
            [len(ground.supports), len(vertices), len(railways.way), len(ground.bridges)],
        ),
        asset=np.concatenate(
            [ground.supports.asset, ground.lines.asset[vertices], ground.railways.asset[railways.way], ground.bridges.asset]
        ),
        height_m=np.concatenate(
            [ground.supports.height_m, ground.lines.height_m[vertices], ground.railways.height_m[railways.way], ground.bridges.height_m]
        ),
    )

    along_lines = _edges_along(EdgeKind.LINE, ground.lines, on_lines.node_of_vertex)
    along_railways = edges_of(
        EdgeKind.RAILWAY,
        first_railway + railways.leg[:, 0],
        first_railway + railways.leg[:, 1],
        ground.railways.asset[railways.way_of_leg],
    )
    crossings = crossing_links(nodes.position[:first_railway], ground.lines, on_lines.node_of_vertex, rules)
    bridges = nodes.of_kind(NodeKind.BRIDGE)
    beside_railways = np.concatenate([np.arange(first_railway), bridges])
    changeovers = railway_crossing_links(beside_railways, nodes.of_kind(NodeKind.RAILWAY), nodes.position, rules)
    between_bridges = bridge_links(bridges, nodes.position, rules)
    return nodes, without_seam(joined(along_lines, along_railways, crossings, changeovers, between_bridges), nodes.position)


def _edges_along(kind: EdgeKind, ways: Ways, node_of_vertex: IntArray) -> Edges:
    start = ways.leg_start
    return edges_of(kind, node_of_vertex[start], node_of_vertex[start + 1], ways.asset[ways.way_of_vertex[start]])


def _contracted(edges: Edges, nodes: _Nodes) -> tuple[Edges, _Nodes]:
    """Two nodes that an edge of 0 m joins become one, the first: whatever stands at one position is one place to fly to."""
    is_zero = (nodes.position[edges.pair[:, 0]] == nodes.position[edges.pair[:, 1]]).all(axis=1)
    if not is_zero.any():
        return edges, nodes
    _, label = component_labels(len(nodes.kind), edges.pair[is_zero])
    _, first = np.unique(label, return_index=True)
    stays = np.zeros(len(nodes.kind), dtype=bool)
    stays[first] = True
    index = np.cumsum(stays) - 1
    end = index[first[label[edges.pair]]]
    end.sort(axis=1)
    moved = Edges(end, edges.kind, edges.asset)
    return moved.where(end[:, 0] != end[:, 1]), nodes.where(stays)


def _cleared(nodes: _Nodes, edges: Edges, zones: ZoneIndex, rules: LinkingRules) -> tuple[_Nodes, Edges, int, int]:
    """Without what is in a zone or comes within the clearance of one, and how many nodes and edges (pairs of nodes) that took away."""
    inside = zones.contains(nodes.position, rules.zone_clearance_m)
    out = inside[edges.pair[:, 0]] | inside[edges.pair[:, 1]]
    free = np.flatnonzero(~out)
    start, end = nodes.position[edges.pair[free, 0]], nodes.position[edges.pair[free, 1]]
    out[free[zones.meets(start, end, rules.zone_clearance_m)]] = True
    index = np.cumsum(~inside) - 1
    left = Edges(index[edges.pair[~out]], edges.kind[~out], edges.asset[~out])
    return nodes.where(~inside), left, int(inside.sum()), len(np.unique(edges.pair[out], axis=0))
