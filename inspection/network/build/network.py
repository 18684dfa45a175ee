"""From the ground to the network: nodes and edges that depend on no zone."""

from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.decks import NO_DECKS, Decks, bridge_heights_m, decks
from inspection.network.build.edges import Edges, cheapest_per_pair, component_labels, costs, edges_of, joined, lengths_m, without_seam
from inspection.network.build.joining import JoinedVertices, join_vertices
from inspection.network.build.links import bridge_links, crossing_links, railway_crossing_links
from inspection.network.build.railway_points import railway_points
from inspection.network.infrastructure import GroundData, InfrastructurePlaces, InfrastructureWays
from inspection.network.inspection_graph import EdgeKind, NodeKind, read_only
from inspection.network.rules import UNTAGGED_HEIGHT_M, LinkingRules

NO_PLACES = InfrastructurePlaces(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0))

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Network:
    """n nodes and m undirected edges as if there were no zones. It lacks the links that are laid where zones leave room for them.

    The arrays are those of InspectionGraph, and those of Decks by the names of its fields.
    """

    position: FloatArray
    node_kind: NDArray[np.uint8]
    node_asset: IntArray
    node_height_m: FloatArray
    edge: NDArray[np.int32]
    length_m: FloatArray
    cost: FloatArray
    edge_kind: NDArray[np.uint8]
    edge_asset: IntArray
    deck_line: FloatArray = field(default_factory=lambda: NO_DECKS.line)
    deck_bridge: IntArray = field(default_factory=lambda: NO_DECKS.bridge)
    deck_centre: FloatArray = field(default_factory=lambda: NO_DECKS.centre)
    deck_over_centre_m: FloatArray = field(default_factory=lambda: NO_DECKS.over_centre_m)
    deck_over_banks_m: FloatArray = field(default_factory=lambda: NO_DECKS.over_banks_m)
    deck_group: IntArray = field(default_factory=lambda: NO_DECKS.group)
    deck_corner: FloatArray = field(default_factory=lambda: NO_DECKS.corner)
    deck_corner_group: IntArray = field(default_factory=lambda: NO_DECKS.corner_group)

    def __post_init__(self) -> None:
        """Nobody writes to the arrays."""
        for own in fields(self):
            array = getattr(self, own.name)
            if array.flags.writeable:
                object.__setattr__(self, own.name, read_only(array))

    def graph_arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays that an inspection graph has too."""
        return {name: getattr(self, name) for name in GRAPH_FIELDS}

    @property
    def decks(self) -> Decks:
        return Decks(*(getattr(self, f"deck_{name}") for name in Decks._fields))

    @property
    def node_count(self) -> int:
        return len(self.position)

    @property
    def edge_count(self) -> int:
        return len(self.edge)


GRAPH_FIELDS = [own.name for own in fields(Network) if not own.name.startswith("deck_")]


@dataclass(frozen=True)
class Nodes:
    position: FloatArray
    kind: NDArray[np.uint8]
    asset: IntArray
    height_m: FloatArray

    def where(self, chosen: NDArray[np.bool_]) -> "Nodes":
        return Nodes(self.position[chosen], self.kind[chosen], self.asset[chosen], self.height_m[chosen])

    def of_kind(self, kind: NodeKind) -> IntArray:
        return np.flatnonzero(self.kind == kind)


def network(ground: GroundData, rules: LinkingRules) -> Network:
    """The network of the ground. The same ground and rules always give the same arrays; zones count for nothing.

    Nodes come in the order supports, line vertices, railway points, bridges.
    """
    found = decks(ground.bridges.position, ground.bridges.height_m, ground.bridge_outlines)._asdict()
    return replace(put_together(*_nodes_and_edges(ground, rules), rules), **{f"deck_{name}": array for name, array in found.items()})


def put_together(edges: Edges, nodes: Nodes, rules: LinkingRules) -> Network:
    """What edges of 0 m join made one node; the edges measured and sorted by pair, the cheapest of each pair."""
    edges, nodes = _contracted(edges, nodes)
    length_m = lengths_m(edges, nodes.position)
    cost = costs(edges, length_m, rules.off_network_factor)
    kept = cheapest_per_pair(edges, cost)
    edges, length_m, cost = edges.where(kept), length_m[kept], cost[kept]
    return Network(
        position=nodes.position,
        node_kind=nodes.kind,
        node_asset=nodes.asset,
        node_height_m=nodes.height_m,
        edge=edges.pair.astype(np.int32),
        length_m=length_m,
        cost=cost,
        edge_kind=edges.kind,
        edge_asset=edges.asset,
    )


def _contracted(edges: Edges, nodes: Nodes) -> tuple[Edges, Nodes]:
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


def _nodes_and_edges(ground: GroundData, rules: LinkingRules) -> tuple[Edges, Nodes]:
    """All nodes, and the edges that depend on no other edge."""
    on_lines = join_vertices(ground.supports, ground.lines)
    railways = railway_points(ground.railways, join_vertices(NO_PLACES, ground.railways), rules.railway_spacing_m)
    first_railway = len(on_lines.position)
    vertices = on_lines.way[len(ground.supports) :]
    nodes = Nodes(
        position=np.concatenate([on_lines.position, railways.position, ground.bridges.position]),
        kind=np.repeat(
            np.array([NodeKind.SUPPORT, NodeKind.LINE_VERTEX, NodeKind.RAILWAY, NodeKind.BRIDGE], dtype=np.uint8),
            [len(ground.supports), len(vertices), len(railways.way), len(ground.bridges)],
        ),
        asset=np.concatenate(
            [ground.supports.asset, ground.lines.asset[vertices], ground.railways.asset[railways.way], ground.bridges.asset]
        ),
        height_m=np.concatenate(
            [
                support_heights_m(ground.supports, ground.lines, on_lines),
                ground.lines.height_m[vertices],
                ground.railways.height_m[railways.way],
                bridge_heights_m(ground.bridges.height_m, ground.bridge_outlines),
            ]
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
    return without_seam(joined(along_lines, along_railways, crossings, changeovers, between_bridges), nodes.position), nodes


def support_heights_m(supports: InfrastructurePlaces, lines: InfrastructureWays, on_lines: JoinedVertices) -> FloatArray:
    """As stated; else that of the tallest line on it, if it is taller than supports are otherwise taken to be; NaN where neither tells."""
    heights_m = np.full(len(on_lines.position), UNTAGGED_HEIGHT_M[NodeKind.SUPPORT])
    np.fmax.at(heights_m, on_lines.node_of_vertex, lines.height_m[lines.way_of_vertex])
    by_line_m = heights_m[: len(supports)]
    taller_m = np.where(by_line_m > UNTAGGED_HEIGHT_M[NodeKind.SUPPORT], by_line_m, np.nan)
    return np.where(np.isnan(supports.height_m), taller_m, supports.height_m)


def _edges_along(kind: EdgeKind, ways: InfrastructureWays, node_of_vertex: IntArray) -> Edges:
    start = ways.leg_start
    return edges_of(kind, node_of_vertex[start], node_of_vertex[start + 1], ways.asset[ways.way_of_vertex[start]])
