"""The reference article's way of planning: one A* for each pair of places, then OR-tools with a callback.

What the article leaves open: the heuristic is the great circle, a UAV joins the graph at its nearest node, routes end anywhere.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import networkx as nx
import numpy as np
from ortools.constraint_solver import pywrapcp, routing_enums_pb2
from scipy.spatial import cKDTree

from inspection.network.inspection_graph import InspectionGraph

EARTH_RADIUS_M = 6_371_008.8  # IUGG mean radius
NO_WAY_M = 10**8


@dataclass(frozen=True)
class ArticlePlan:
    total_m: float
    routes: list[list[int]]


class ArticleMethod:
    def __init__(self, graph: InspectionGraph) -> None:
        self.network = nx.Graph()
        self.network.add_nodes_from(range(graph.node_count))
        self.network.add_weighted_edges_from(zip(*graph.edge.T.tolist(), graph.cost.tolist(), strict=True))
        lon, lat = np.radians(graph.position).T
        self.places = np.column_stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
        self.tree = cKDTree(self.places)
        self.at = self.places.tolist()

    def plan(self, uavs: Sequence[tuple[float, float]], targets: Sequence[int]) -> ArticlePlan:
        """uavs are positions lon, lat; targets are nodes."""
        starts = [self._nearest(place) for place in uavs]
        nodes = [node for node, _ in starts] + list(targets)
        ways_m = np.full((len(nodes), len(nodes)), math.inf)
        for left in range(len(nodes)):
            for right in range(max(left + 1, len(uavs)), len(nodes)):
                ways_m[left, right] = ways_m[right, left] = self._shortest_m(nodes[left], nodes[right])
        for uav, (_, leg_m) in enumerate(starts):
            ways_m[uav, len(uavs) :] += leg_m
        return _assign(ways_m, len(uavs))

    def _nearest(self, place: tuple[float, float]) -> tuple[int, float]:
        lon, lat = math.radians(place[0]), math.radians(place[1])
        chord, node = self.tree.query([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
        return int(node), 2 * EARTH_RADIUS_M * math.asin(chord / 2)

    def _shortest_m(self, start: int, end: int) -> float:
        try:
            path = nx.astar_path(self.network, start, end, heuristic=self._great_circle_m, weight="weight")
        except nx.NetworkXNoPath:
            return math.inf
        return float(nx.path_weight(self.network, path, "weight"))

    def _great_circle_m(self, left: int, right: int) -> float:
        chord = math.dist(self.at[left], self.at[right])
        return 2 * EARTH_RADIUS_M * math.asin(min(1.0, chord / 2)) * 0.99  # the ellipsoid's lengths are up to 0.6 % shorter


def _assign(ways_m: np.ndarray, uavs: int) -> ArticlePlan:
    nodes = len(ways_m)
    arcs = np.full((nodes + 1, nodes + 1), NO_WAY_M, dtype=np.int64)
    finite = np.isfinite(ways_m)
    arcs[:nodes, :nodes][finite] = np.round(ways_m[finite]).astype(np.int64)
    arcs[:, nodes] = 0  # the end, anywhere
    table = arcs.tolist()
    manager = pywrapcp.RoutingIndexManager(nodes + 1, uavs, list(range(uavs)), [nodes] * uavs)
    routing = pywrapcp.RoutingModel(manager)
    transit = routing.RegisterTransitCallback(lambda left, right: table[manager.IndexToNode(left)][manager.IndexToNode(right)])
    routing.SetArcCostEvaluatorOfAllVehicles(transit)
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    found = routing.SolveWithParameters(parameters)
    routes = []
    for uav in range(uavs):
        index, route = routing.Start(uav), []
        while not routing.IsEnd(index):
            node = manager.IndexToNode(index)
            if node >= uavs:
                route.append(node - uavs)
            index = found.Value(routing.NextVar(index))
        routes.append(route)
    lengths = [
        ways_m[left, uavs + right]
        for uav, route in enumerate(routes)
        for left, right in zip([uav, *(uavs + t for t in route)], route, strict=False)
    ]
    return ArticlePlan(float(sum(lengths)), routes)
