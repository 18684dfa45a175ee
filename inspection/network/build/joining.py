"""Which vertices of ways are one node: those that share an OSM node, and drawn ones that touch."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from inspection.network.infrastructure import NO_OSM_NODE, InfrastructurePlaces, InfrastructureWays
from inspection.network.nearness import chord, nearest_within, on_unit_sphere

TOUCH_M = 1.0  # a vertex that a curator draws so near to another one is meant to be it

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class JoinedVertices:
    """Nodes 0 to len(places) - 1 are the places, the others are vertices without one."""

    node_of_vertex: IntArray  # (v,)
    position: FloatArray  # (n, 2)
    way: IntArray  # (n,) the first way at the node, -1 at a place


def join_vertices(places: InfrastructurePlaces, ways: InfrastructureWays) -> JoinedVertices:
    """Give every vertex its node.

    Vertices with an OSM node are joined by it, to a place and to each other, wherever their way says that they are: the place's
    position wins, then that of the first vertex. A place or vertex without OSM node was drawn: it joins what lies within 1 m of it, the
    nearest first. Two things with different OSM nodes are never joined, however near.
    """
    has_osm = ways.osm_node != NO_OSM_NODE
    node_of_vertex = np.full(len(ways.osm_node), -1, dtype=np.int64)

    known, first_vertex, number = np.unique(ways.osm_node[has_osm], return_index=True, return_inverse=True)
    first_vertex = np.flatnonzero(has_osm)[first_vertex]
    node_of_known = _place_of_osm_node(places, known)
    homeless = np.flatnonzero(node_of_known < 0)
    drawn_place = np.flatnonzero(places.osm_node == NO_OSM_NODE)
    row, other, _ = nearest_within(ways.position[first_vertex[homeless]], places.position[drawn_place], TOUCH_M)
    node_of_known[homeless[row]] = drawn_place[other]
    own = np.flatnonzero(node_of_known < 0)
    node_of_known[own] = len(places) + np.arange(len(own))
    node_of_vertex[has_osm] = node_of_known[number]
    leader = first_vertex[own]

    drawn = np.flatnonzero(~has_osm)
    anchors = np.concatenate([places.position, ways.position[leader]])
    row, other, _ = nearest_within(ways.position[drawn], anchors, TOUCH_M)
    node_of_vertex[drawn[row]] = other
    drawn = drawn[node_of_vertex[drawn] < 0]
    group = _touching_groups(ways.position[drawn])
    leaders, number = np.unique(group, return_inverse=True)
    node_of_vertex[drawn] = len(anchors) + number
    leader = np.concatenate([leader, drawn[leaders]])

    return JoinedVertices(
        node_of_vertex=node_of_vertex,
        position=np.concatenate([places.position, ways.position[leader]]),
        way=np.concatenate([np.full(len(places), -1, dtype=np.int64), ways.way_of_vertex[leader]]),
    )


def _place_of_osm_node(places: InfrastructurePlaces, osm_node: IntArray) -> IntArray:
    """Index of the place at each OSM node, -1 where there is none."""
    order = np.argsort(places.osm_node, kind="stable")
    sorted_nodes = places.osm_node[order]
    slot = np.searchsorted(sorted_nodes, osm_node)
    found = slot < len(places)
    found[found] = sorted_nodes[slot[found]] == osm_node[found]
    place = np.full(len(osm_node), -1, dtype=np.int64)
    place[found] = order[slot[found]]
    return place


def _touching_groups(position: FloatArray) -> IntArray:
    """For each position the first earlier one that leads a group within reach, or itself: groups never grow into chains."""
    leader = np.arange(len(position), dtype=np.int64)
    if len(position) < 2:
        return leader
    taken = np.zeros(len(position), dtype=bool)
    points = on_unit_sphere(position)
    near = cKDTree(points).query_pairs(chord(TOUCH_M), output_type="ndarray")
    near = near[np.lexsort((near[:, 1], near[:, 0]))]
    for first, second in near.tolist():  # by rising first index: a leader is settled before it gathers
        if not taken[first] and not taken[second]:
            taken[second] = True
            leader[second] = first
    return leader
