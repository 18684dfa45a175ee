"""The ground as plain arrays: what the builder reads."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

NO_OSM_NODE = -1  # drawn by a curator, or not known to be where the OSM node is


@dataclass(frozen=True)
class InfrastructurePlaces:
    """Assets that are points in the graph: supports, or bridges by their centres."""

    asset: NDArray[np.int64]  # (n,) primary keys
    osm_node: NDArray[np.int64]  # (n,) or NO_OSM_NODE
    position: NDArray[np.float64]  # (n, 2) lon, lat [deg]
    height_m: NDArray[np.float64]  # (n,) NaN when not stated

    def __len__(self) -> int:
        return len(self.asset)


@dataclass(frozen=True)
class BridgeOutlines:
    """The areas of bridges, in their order."""

    area: NDArray[np.object_] = field(default_factory=lambda: np.zeros(0, dtype=object))  # (n,) polygons in lon, lat [deg]
    tall_share: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))  # (n,) see tall_share in inspection/scene/bridges.py


@dataclass(frozen=True)
class InfrastructureWays:
    """Lines or railways; the vertices of way w are numbers first[w] to first[w + 1] - 1."""

    asset: NDArray[np.int64]  # (w,) primary keys
    height_m: NDArray[np.float64]  # (w,) as stated, else of a line of the highest voltages; NaN otherwise
    first: NDArray[np.int64]  # (w + 1,)
    osm_node: NDArray[np.int64]  # (v,) or NO_OSM_NODE
    position: NDArray[np.float64]  # (v, 2) lon, lat [deg]

    def __len__(self) -> int:
        return len(self.asset)

    @property
    def way_of_vertex(self) -> NDArray[np.int64]:
        return np.repeat(np.arange(len(self.asset)), np.diff(self.first))

    @property
    def leg_start(self) -> NDArray[np.int64]:
        """Numbers of the vertices that another one of the same way follows."""
        is_last = np.zeros(len(self.position), dtype=bool)
        is_last[self.first[1:][np.diff(self.first) > 0] - 1] = True
        return np.flatnonzero(~is_last)


@dataclass(frozen=True)
class Zones:
    wkb: tuple[bytes, ...]
    identifier: NDArray[np.int64]  # (z,) primary keys
    name: tuple[str, ...]


@dataclass(frozen=True)
class GroundData:
    """Everything that a graph is built from, as of one revision of the ground."""

    revision: int
    supports: InfrastructurePlaces
    bridges: InfrastructurePlaces
    lines: InfrastructureWays
    railways: InfrastructureWays
    zones: Zones
    bridge_outlines: BridgeOutlines = field(default_factory=BridgeOutlines)  # of all bridges, or of none
