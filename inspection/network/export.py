"""The graph in formats that other programs read: GraphML and GeoJSON."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import networkx as nx
import numpy as np

from inspection.network.inspection_graph import EdgeKind, InspectionGraph, NodeKind
from inspection.network.route_index import OncePerGraph, asset_places, node_tree


def to_networkx(graph: InspectionGraph) -> "nx.Graph[int]":
    """Nodes and edges under their numbers, with attributes that say their unit; what is not stated has no attribute."""
    copy: nx.Graph[int] = nx.Graph(graph_version=graph.version, ground_revision=graph.ground_revision)
    copy.add_nodes_from(enumerate(_node_attributes(graph)))
    copy.add_edges_from((a, b, attributes) for (a, b), attributes in zip(graph.edge.tolist(), _edge_attributes(graph), strict=True))
    return copy


def geojson_features(graph: InspectionGraph) -> Iterator[dict[str, Any]]:
    """One LineString per edge, then one Point per node without edges."""
    ends = graph.position[graph.edge].tolist()
    for number, ((a, b), line, attributes) in enumerate(zip(graph.edge.tolist(), ends, _edge_attributes(graph), strict=True)):
        yield {
            "type": "Feature",
            "id": number,
            "geometry": {"type": "LineString", "coordinates": line},
            "properties": {"nodes": [a, b]} | attributes,
        }
    is_joined = np.zeros(graph.node_count, dtype=bool)
    is_joined[graph.edge.ravel()] = True
    for node, attributes in enumerate(_node_attributes(graph)):
        if not is_joined[node]:
            place = [attributes.pop("lon_deg"), attributes.pop("lat_deg")]
            yield {"type": "Feature", "geometry": {"type": "Point", "coordinates": place}, "properties": {"node": node} | attributes}


def _node_attributes(graph: InspectionGraph) -> Iterator[dict[str, Any]]:
    columns = (graph.position.tolist(), graph.node_kind.tolist(), graph.node_asset.tolist(), graph.node_height_m.tolist())
    for (lon, lat), kind, asset, height_m in zip(*columns, strict=True):
        attributes = {"lon_deg": lon, "lat_deg": lat, "kind": NodeKind(kind).name.lower(), "asset": asset}
        yield attributes if np.isnan(height_m) else attributes | {"height_m": height_m}


def _edge_attributes(graph: InspectionGraph) -> Iterator[dict[str, Any]]:
    columns = (graph.edge_kind.tolist(), graph.length_m.tolist(), graph.cost.tolist(), graph.edge_asset.tolist())
    for kind, length_m, cost_m, asset in zip(*columns, strict=True):
        attributes = {"kind": EdgeKind(kind).name.lower(), "length_m": length_m, "weighted_cost_m": cost_m}
        yield attributes if asset < 0 else attributes | {"asset": asset}


def _by_length(graph: InspectionGraph) -> InspectionGraph:
    shortest = replace(graph, cost=graph.length_m)
    node_tree.remember(shortest, node_tree(graph))  # the nodes are the same
    asset_places.remember(shortest, asset_places(graph))
    return shortest


by_length = OncePerGraph(_by_length)
