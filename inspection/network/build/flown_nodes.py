"""Where UAVs pass nodes and legs, and whether that is in a zone."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.network.rules import FlownHeights, asset_heights_m
from inspection.network.zones.zone_index import ZoneIndex

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FlownNodes:
    """Nodes where a UAV passes them: position (n, 2) lon, lat [deg]; low_m and high_m (n,) above ground."""

    position: FloatArray
    low_m: FloatArray
    high_m: FloatArray

    @classmethod
    def of(cls, position: FloatArray, kind: NDArray[np.uint8], tagged_m: FloatArray, heights: FlownHeights) -> "FlownNodes":
        return cls(position, *heights.band_m(asset_heights_m(kind, tagged_m)))

    def where(self, chosen: BoolArray) -> "FlownNodes":
        return FlownNodes(self.position[chosen], self.low_m[chosen], self.high_m[chosen])

    def in_zones(self, zones: ZoneIndex, clearance_m: float) -> BoolArray:
        return zones.contains(self.position, clearance_m, self.low_m, self.high_m)

    def legs_in_zones(self, zones: ZoneIndex, start: IntArray, end: IntArray, clearance_m: float) -> BoolArray:
        """Whether the legs between these nodes meet a zone, each flown between the heights of its ends."""
        low_m, high_m = np.minimum(self.low_m[start], self.low_m[end]), np.maximum(self.high_m[start], self.high_m[end])
        return zones.meets(self.position[start], self.position[end], clearance_m, low_m, high_m)
