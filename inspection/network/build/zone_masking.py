"""From the network to the inspection graph for one set of zones: everything out that meets one, and links where there is room."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.detours import detours, gaps
from inspection.network.build.edges import NO_ASSET, Edges, component_labels, joined
from inspection.network.build.flown_nodes import FlownNodes
from inspection.network.build.links import bridge_to_tower_links, railway_to_tower_links
from inspection.network.build.network import Network, Nodes, put_together
from inspection.network.build.obstacles import low_ceilings, too_tall_obstacles, with_obstacles
from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex

NO_VERSION = 0  # until the graph is stored


@dataclass(frozen=True)
class MaskedGraph:
    """The graph, and what the zones have taken: nodes, edges (pairs of nodes) and the nearest links that they are in the way of."""

    graph: InspectionGraph
    components: int
    excluded_nodes: int
    excluded_edges: int


def masked(
    network: Network, zones: ZoneIndex, rules: LinkingRules, heights: FlownHeights, *, version: int = NO_VERSION, ground_revision: int = 0
) -> MaskedGraph:
    """The network without what is within the clearance of a zone at the height flown there; what zones cut off is linked anew.

    What cannot be flown over, as it is too tall at all or under a zone, bars every leg but stays as a place. Each bridge, and each
    railway that would be cut off, is linked to the nearest support that is left. The ends of what is cut out of a line or railway are
    joined by the shortest ways round, and so is what no straight link reaches. The same network, zones, rules and heights always give
    the same arrays.
    """
    nodes = Nodes(network.position, network.node_kind, network.node_asset, network.node_height_m)
    edges = Edges(network.edge.astype(np.int64), network.edge_kind, network.edge_asset)
    flown = FlownNodes.of(nodes.position, nodes.kind, nodes.height_m, heights)
    inside = flown.in_zones(zones, rules.zone_clearance_m)
    obstacles, ceilings = too_tall_obstacles(network, heights), low_ceilings(network, zones, heights, rules.zone_clearance_m)
    barred = with_obstacles(zones, obstacles)
    out = _edges_out(edges, inside, flown, barred, rules)
    if len(ceilings.obstacles):
        hangs_there = np.isin(edges.pair, ceilings.node).any(axis=1)
        out |= ~hangs_there & flown.legs_in_zones(ceilings.obstacles, edges.pair[:, 0], edges.pair[:, 1], rules.zone_clearance_m)
        barred = with_obstacles(barred, ceilings.obstacles)
    wanted = gaps(edges, out, inside | obstacles.contains(nodes.position, rules.zone_clearance_m), nodes.position)
    index = np.cumsum(~inside) - 1
    wanted = [replace(gap, node=index[gap.node]) for gap in wanted]
    excluded_nodes, excluded_edges = int(inside.sum()), int(out.sum())
    edges = Edges(index[edges.pair[~out]], edges.kind[~out], edges.asset[~out])
    nodes, flown = nodes.where(~inside), flown.where(~inside)

    supports = nodes.of_kind(NodeKind.SUPPORT)
    to_tower = bridge_to_tower_links(_unlinked_bridges(nodes, edges), supports, flown, barred, rules)
    edges = joined(edges, to_tower.edges)
    to_railway = railway_to_tower_links(nodes.of_kind(NodeKind.RAILWAY), supports, flown, edges, barred, rules)
    edges = joined(edges, to_railway.edges)
    round_zones = detours([*wanted, *to_tower.unlinked, *to_railway.unlinked], flown, barred, rules, heights)
    whole = put_together(joined(edges, round_zones.edges()), _with_bends(nodes, round_zones.bend), rules)
    graph = InspectionGraph(
        **whole.graph_arrays(),
        version=version,
        ground_revision=ground_revision,
        zone_wkb=zones.wkb,
        zone_id=zones.ids,
        zone_name=zones.names,
    )
    components, _ = component_labels(graph.node_count, graph.edge)
    return MaskedGraph(graph, components, excluded_nodes, excluded_edges + to_tower.blocked + to_railway.blocked)


def _edges_out(edges: Edges, inside: NDArray[np.bool_], flown: FlownNodes, zones: ZoneIndex, rules: LinkingRules) -> NDArray[np.bool_]:
    """Which edges end in a zone or come within the clearance of one."""
    out: NDArray[np.bool_] = inside[edges.pair[:, 0]] | inside[edges.pair[:, 1]]
    free = np.flatnonzero(~out)
    out[free[flown.legs_in_zones(zones, edges.pair[free, 0], edges.pair[free, 1], rules.zone_clearance_m)]] = True
    return out


def _with_bends(nodes: Nodes, bend: NDArray[np.float64]) -> Nodes:
    return Nodes(
        np.concatenate([nodes.position, bend]),
        np.concatenate([nodes.kind, np.full(len(bend), NodeKind.BEND, dtype=np.uint8)]),
        np.concatenate([nodes.asset, np.full(len(bend), NO_ASSET, dtype=np.int64)]),
        np.concatenate([nodes.height_m, np.zeros(len(bend))]),
    )


def _unlinked_bridges(nodes: Nodes, edges: Edges) -> NDArray[np.int64]:
    """Bridges that the network itself does not link to a support, as one made elsewhere may."""
    linked = edges.pair[edges.kind == EdgeKind.BRIDGE_TO_TOWER]
    return np.setdiff1d(nodes.of_kind(NodeKind.BRIDGE), linked)
