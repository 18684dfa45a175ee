"""Small graphs drawn by hand or by hypothesis, as the arrays that planners read."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from inspection.network.inspection_graph import InspectionGraph


def drawn_graph(
    positions: Sequence[tuple[float, float]],
    edges: Sequence[tuple[int, int, float]],
    *,
    factor: Sequence[float] = (),
    zones: Sequence[BaseGeometry] = (),
) -> InspectionGraph:
    """Nodes at the positions; edges as (node, node, metres); cost is metres times the edge's factor (1 unless given)."""
    length_m = np.array([metres for _, _, metres in edges], dtype=np.float64)
    pairs = np.array([(min(a, b), max(a, b)) for a, b, _ in edges], dtype=np.int32).reshape(-1, 2)
    return InspectionGraph(
        version=1,
        ground_revision=1,
        position=np.array(positions, dtype=np.float64).reshape(-1, 2),
        node_kind=np.zeros(len(positions), dtype=np.uint8),
        node_asset=np.arange(len(positions), dtype=np.int64) + 100,
        node_height_m=np.full(len(positions), np.nan),
        edge=pairs,
        length_m=length_m,
        cost=length_m * (np.array(factor) if len(factor) else 1.0),
        edge_kind=np.zeros(len(edges), dtype=np.uint8),
        edge_asset=np.full(len(edges), -1, dtype=np.int64),
        zone_wkb=tuple(shapely.to_wkb(zone) for zone in zones),
        zone_id=np.arange(len(zones), dtype=np.int64) + 1,
        zone_name=tuple(f"zone {number + 1}" for number in range(len(zones))),
    )
