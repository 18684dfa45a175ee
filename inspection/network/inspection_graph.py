"""The graph as immutable arrays: what the builder makes, what is stored, and what planners memory-map."""

from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class NodeKind(IntEnum):
    SUPPORT = 0  # tower, pole, portal
    LINE_VERTEX = 1  # a line's vertex without a support
    RAILWAY = 2
    BRIDGE = 3
    BEND = 4  # of a detour round a zone: no asset, height 0


class EdgeKind(IntEnum):
    LINE = 0
    RAILWAY = 1
    BRIDGE_TO_TOWER = 2
    BRIDGE_TO_BRIDGE = 3
    RAILWAY_TO_TOWER = 4
    CROSSING = 5
    DETOUR = 6  # round a zone

    @property
    def is_on_network(self) -> bool:
        return self in {EdgeKind.LINE, EdgeKind.RAILWAY}


@dataclass(frozen=True, eq=False)
class InspectionGraph:
    """n nodes and m undirected edges, none of them inside or across a zone.

    position      float64 (n, 2)  lon, lat [deg]
    node_kind     uint8   (n,)    NodeKind
    node_asset    int64   (n,)    primary key of the asset at the node: tower, railway, bridge; for a line vertex its line, for a bend -1
    node_height_m float64 (n,)    height of that asset as stated, or of a line of the highest voltages on it; NaN otherwise
    edge          int32   (m, 2)  node indices, the smaller first; at most one edge per pair
    length_m      float64 (m,)    geodesic length
    cost          float64 (m,)    length_m, times the off-network factor for links
    edge_kind     uint8   (m,)    EdgeKind
    edge_asset    int64   (m,)    primary key of the line or railway, -1 for links
    zone_wkb      tuple of bytes  the zones (polygons, WGS84) that the graph was cleared of
    zone_id       int64   (z,)    their primary keys
    zone_name     tuple of str
    """

    version: int
    ground_revision: int
    position: NDArray[np.float64]
    node_kind: NDArray[np.uint8]
    node_asset: NDArray[np.int64]
    node_height_m: NDArray[np.float64]
    edge: NDArray[np.int32]
    length_m: NDArray[np.float64]
    cost: NDArray[np.float64]
    edge_kind: NDArray[np.uint8]
    edge_asset: NDArray[np.int64]
    zone_wkb: tuple[bytes, ...]
    zone_id: NDArray[np.int64]
    zone_name: tuple[str, ...]

    def __post_init__(self) -> None:
        """Nobody writes to the arrays; and to what is compiled they are of one type, mapped or not."""
        for field in fields(self):
            array = getattr(self, field.name)
            if isinstance(array, np.ndarray) and array.flags.writeable:
                object.__setattr__(self, field.name, read_only(array))

    @property
    def node_count(self) -> int:
        return len(self.position)

    @property
    def edge_count(self) -> int:
        return len(self.edge)


def read_only(array: NDArray[np.generic]) -> NDArray[np.generic]:
    """The same values in one contiguous piece that nobody writes to."""
    view = np.ascontiguousarray(array).view()
    view.setflags(write=False)
    return view
