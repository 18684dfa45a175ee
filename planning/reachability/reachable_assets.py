"""From nodes that can be reached to assets that can be inspected, and why others cannot."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.network import Network
from inspection.network.inspection_graph import InspectionGraph, NodeKind

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


class Reachability(IntEnum):
    """The order is that of what to say first where the parts of a line differ."""

    REACHABLE = 0
    PARTLY = 1  # a line or railway of which some spans can be inspected
    BEYOND_RANGE = 2
    BEYOND_ENERGY = 3  # the range does, the battery does not
    WIND = 4  # there is a way, but not against this wind
    CUT_OFF = 5  # no way keeps clear of zones, or there is none
    ABOVE_HEIGHT_LIMIT = 6
    INSIDE_ZONE = 7
    NO_LANDING = 8  # it could be inspected, but every flight that gets there would have to come down to the ground through a zone


@dataclass(frozen=True, eq=False)
class Reach:
    """What is known of each of `a` assets, sorted by their primary keys.

    asset       int64 (a,)
    state       int8 (a,)     see Reachability
    flight      int16 (a,)    of the flights that can do it the one that flies least; -1 for none, or for a way that takes several
    missing_m   float64 (a,)  by how much the range is too short at best; 0 unless that is the state
    missing_wh  float64 (a,)  the same of the battery
    zone        int32 (a,)    the number of the zone that it is in; -1 for none
    box         float64 (a, 4)  west, south, east, north of its nodes
    """

    asset: IntArray
    state: NDArray[np.int8]
    flight: NDArray[np.int16]
    missing_m: FloatArray
    missing_wh: FloatArray
    zone: NDArray[np.int32]
    box: FloatArray


@dataclass(frozen=True, eq=False)
class NodeReach:
    """The same of each node of a network, (n,); zone as in Reach."""

    state: NDArray[np.int8]
    flight: NDArray[np.int16]
    missing_m: FloatArray
    missing_wh: FloatArray
    zone: NDArray[np.int32]


def of_assets(network: Network, graph: InspectionGraph, on_graph: IntArray, nodes: NodeReach) -> Reach:
    """Towers and bridges as their nodes; of lines and railways every span counts, and both of its ends."""
    single = np.flatnonzero(np.isin(network.node_kind, (NodeKind.SUPPORT, NodeKind.BRIDGE)))
    spans = np.flatnonzero(network.edge_asset >= 0)
    way, of_span = np.unique(network.edge_asset[spans], return_inverse=True)
    ends = network.edge[spans]
    reached = (nodes.state[ends] == Reachability.REACHABLE).all(axis=1) & _is_edge(graph, on_graph[ends])
    count, done = np.bincount(of_span, minlength=len(way)), np.bincount(of_span, weights=reached, minlength=len(way))

    # What keeps a span from being inspected: the worse of its ends; a zone, where both ends can be reached but it is not flown over.
    worst = nodes.state[ends].argmax(axis=1)
    node = ends[np.arange(len(ends)), worst]
    why = np.where(~reached & (nodes.state[node] == Reachability.REACHABLE), Reachability.INSIDE_ZONE, nodes.state[node]).astype(np.int8)
    # Of all spans of a way the first that can be had most easily.
    order = np.lexsort((nodes.missing_m[node] + nodes.missing_wh[node], why, of_span))
    first = order[np.searchsorted(of_span[order], np.arange(len(way)))]
    path_state = np.where(done == count, Reachability.REACHABLE, np.where(done > 0, Reachability.PARTLY, why[first])).astype(np.int8)
    least, most = np.full(len(way), 32_767, dtype=np.int16), np.full(len(way), -1, dtype=np.int16)
    for end in range(2):
        np.minimum.at(least, of_span, nodes.flight[ends[:, end]])
        np.maximum.at(most, of_span, nodes.flight[ends[:, end]])
    box = np.full((len(way), 4), [np.inf, np.inf, -np.inf, -np.inf])
    for end in range(2):
        for axis in range(2):
            np.minimum.at(box[:, axis], of_span, network.position[ends[:, end], axis])
            np.maximum.at(box[:, 2 + axis], of_span, network.position[ends[:, end], axis])
    is_short, is_inside = (
        np.isin(path_state, (Reachability.BEYOND_RANGE, Reachability.BEYOND_ENERGY)),
        path_state == Reachability.INSIDE_ZONE,
    )

    asset = np.concatenate([network.node_asset[single], way])
    order = np.argsort(asset, kind="stable")
    position = network.position[single]
    return Reach(
        asset=asset[order],
        state=np.concatenate([nodes.state[single], path_state])[order],
        flight=np.concatenate([nodes.flight[single], np.where(least == most, least, -1).astype(np.int16)])[order],
        missing_m=np.concatenate([nodes.missing_m[single], np.where(is_short, nodes.missing_m[node[first]], 0.0)])[order],
        missing_wh=np.concatenate([nodes.missing_wh[single], np.where(is_short, nodes.missing_wh[node[first]], 0.0)])[order],
        zone=np.concatenate([nodes.zone[single], np.where(is_inside, nodes.zone[node[first]], -1).astype(np.int32)])[order],
        box=np.concatenate([np.hstack([position, position]), box])[order],
    )


def _is_edge(graph: InspectionGraph, pairs: IntArray) -> BoolArray:
    """Whether each two nodes of the graph are joined by an edge; -1 for a node that it lacks."""
    key = np.sort(graph.edge[:, 0].astype(np.int64) * graph.node_count + graph.edge[:, 1], kind="stable")
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    at = np.searchsorted(key, low * graph.node_count + high)
    found: BoolArray = np.zeros(len(pairs), dtype=bool)
    inside = (low >= 0) & (at < len(key))
    found[inside] = key[at[inside]] == low[inside] * graph.node_count + high[inside]
    return found
