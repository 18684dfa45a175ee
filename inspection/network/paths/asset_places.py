"""Where on a graph each asset is: the node that stands for a tower or bridge, the edges of a line or railway."""

from typing import NamedTuple

import numpy as np

from inspection.network.inspection_graph import InspectionGraph, NodeKind
from inspection.network.paths.contracted_graph import NumberArray
from inspection.network.paths.hub_labels import IntArray


class AssetPlaces(NamedTuple):
    """Sorted by the assets' primary keys.

    single_asset  int64 (s,)  towers and bridges
    single_node   int32 (s,)  their nodes
    way_asset     int64 (m,)  each edge's line or railway
    way_edge      int32 (m,)  the edge
    """

    single_asset: IntArray
    single_node: NumberArray
    way_asset: IntArray
    way_edge: NumberArray

    def node_of(self, asset: int) -> int | None:
        """The node of a tower or bridge; None for one that is not on the graph."""
        at = int(self.single_asset.searchsorted(asset))
        return int(self.single_node[at]) if at < len(self.single_asset) and self.single_asset[at] == asset else None

    def edges_of(self, asset: int) -> IntArray:
        """The edges of a line or railway."""
        first, last = self.way_asset.searchsorted([asset, asset + 1])
        return self.way_edge[first:last].astype(np.int64)


def build_asset_places(graph: InspectionGraph) -> AssetPlaces:
    single = np.flatnonzero(np.isin(graph.node_kind, (NodeKind.SUPPORT, NodeKind.BRIDGE)))
    single = single[np.argsort(graph.node_asset[single], kind="stable")]
    edges = np.argsort(graph.edge_asset, kind="stable")
    arrays = graph.node_asset[single], single.astype(np.int32), graph.edge_asset[edges], edges.astype(np.int32)
    for array in arrays:
        array.setflags(write=False)
    return AssetPlaces(*arrays)
