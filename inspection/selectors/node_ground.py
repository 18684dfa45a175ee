"""Terrain heights under the nodes of a graph, read once per terrain version."""

from threading import Lock
from weakref import WeakKeyDictionary

from inspection.geodesy.wgs84 import FloatArray
from inspection.network.inspection_graph import InspectionGraph
from inspection.selectors.terrain import ground_heights_m

Terrain = tuple[int | None, int]

_one_thread = Lock()
_kept: WeakKeyDictionary[InspectionGraph, tuple[Terrain, FloatArray]] = WeakKeyDictionary()


def node_ground_m(graph: InspectionGraph, terrain: Terrain) -> FloatArray:
    """Return heights above sea level (n,), NaN where no terrain model has data; the same array while the terrain is unchanged."""
    with _one_thread:
        kept = _kept.get(graph)
        if kept is None or kept[0] != terrain:
            heights_m = ground_heights_m(graph.position)
            heights_m.setflags(write=False)
            kept = _kept[graph] = terrain, heights_m
        return kept[1]
