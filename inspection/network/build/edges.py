"""A growing list of edges as arrays, and how it is tidied into the edges of a graph."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from inspection.geodesy import distance_m
from inspection.network.inspection_graph import EdgeKind

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]

NO_ASSET = -1


@dataclass(frozen=True)
class Edges:
    pair: IntArray  # (m, 2) node indices, the smaller first
    kind: NDArray[np.uint8]  # (m,) EdgeKind
    asset: IntArray  # (m,) line or railway, NO_ASSET for links

    def __len__(self) -> int:
        return len(self.kind)

    def where(self, chosen: NDArray[np.bool_] | IntArray) -> "Edges":
        return Edges(self.pair[chosen], self.kind[chosen], self.asset[chosen])


def edges_of(kind: EdgeKind, one: IntArray, other: IntArray, asset: IntArray | None = None) -> Edges:
    """Edges of one kind; those from a node to itself are left out."""
    pair = np.sort(np.column_stack([one, other]).astype(np.int64), axis=1)
    asset = np.full(len(pair), NO_ASSET, dtype=np.int64) if asset is None else asset
    edges = Edges(pair, np.full(len(pair), kind, dtype=np.uint8), asset)
    return edges.where(pair[:, 0] != pair[:, 1])


def joined(*parts: Edges) -> Edges:
    return Edges(
        np.concatenate([part.pair for part in parts]),
        np.concatenate([part.kind for part in parts]),
        np.concatenate([part.asset for part in parts]),
    )


def without_seam(edges: Edges, position: FloatArray) -> Edges:
    """Only legs that do not cross the antimeridian: drawn straight in lon/lat such a leg would go the long way round."""
    return edges.where(np.abs(position[edges.pair[:, 0], 0] - position[edges.pair[:, 1], 0]) <= 180.0)


def lengths_m(edges: Edges, position: FloatArray) -> FloatArray:
    return distance_m(position[edges.pair[:, 0]], position[edges.pair[:, 1]])


def costs(edges: Edges, length_m: FloatArray, off_network_factor: float) -> FloatArray:
    is_link = np.isin(edges.kind, [kind for kind in EdgeKind if not kind.is_on_network])
    return np.where(is_link, length_m * off_network_factor, length_m)


def cheapest_per_pair(edges: Edges, cost: FloatArray) -> IntArray:
    """Indices of the edges to keep, sorted by pair: the cheapest of each pair, of equals the lowest kind, then asset."""
    order = np.lexsort((edges.asset, edges.kind, cost, edges.pair[:, 1], edges.pair[:, 0]))
    pair = edges.pair[order]
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = (pair[1:] != pair[:-1]).any(axis=1)
    return order[is_first]


def component_labels(node_count: int, pair: NDArray[np.integer]) -> tuple[int, IntArray]:
    """Number of connected components, and each node's."""
    if node_count == 0:
        return 0, np.zeros(0, dtype=np.int64)
    links = csr_array((np.ones(len(pair), dtype=np.int8), (pair[:, 0], pair[:, 1])), shape=(node_count, node_count))
    count, labels = connected_components(links, directed=False)
    return int(count), labels.astype(np.int64)
