"""A graph on which the shortest way is the best, however far from infrastructure it leads."""

from dataclasses import replace

from inspection.network.inspection_graph import InspectionGraph
from inspection.network.route_index import OncePerGraph, asset_places, node_tree


def _by_length(graph: InspectionGraph) -> InspectionGraph:
    shortest = replace(graph, cost=graph.length_m)
    node_tree.remember(shortest, node_tree(graph))  # the nodes are the same
    asset_places.remember(shortest, asset_places(graph))
    return shortest


by_length = OncePerGraph(_by_length)
