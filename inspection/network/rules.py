"""How far apart things may stand and still be linked."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.network.inspection_graph import NodeKind


@dataclass(frozen=True)
class LinkingRules:
    """Radii and spacing in metres. The two bridge radii are the reference article's."""

    bridge_to_tower_m: float = 3_000.0
    bridge_to_bridge_m: float = 5_000.0
    railway_to_tower_m: float = 3_000.0  # only where a railway would else be cut off
    crossing_m: float = 150.0  # supports of different lines, and bridges and supports beside railways: crossings, substations
    railway_spacing_m: float = 250.0  # a railway's way vertices are thinned to at most this
    off_network_factor: float = 2.0  # cost per metre away from infrastructure, so that routes stay near the lines
    detour_m: float = 10_000.0  # the longest way round zones, between the ends of what they cut out of a line; 0 for none
    zone_clearance_m: float = 12.0  # error of a satellite position, twice, and 2 m of tracking: a rehearsal asks for 10 m


FloatArray = NDArray[np.float64]

# Where no tag states a height, towards the upper end of what is common, so that the error is on the safe side.
UNTAGGED_HEIGHT_M = {NodeKind.SUPPORT: 45.0, NodeKind.LINE_VERTEX: 45.0, NodeKind.RAILWAY: 8.0, NodeKind.BRIDGE: 30.0, NodeKind.BEND: 0.0}
# Supports of lines of the highest voltages are taller than that.
HIGHEST_VOLTAGE_V, HIGHEST_VOLTAGE_HEIGHT_M = 300_000, 60.0
_UNTAGGED_M = np.array([UNTAGGED_HEIGHT_M[kind] for kind in NodeKind])


@dataclass(frozen=True)
class FlownHeights:
    """Metres above the ground under the UAV. What is no taller than transit_agl_m - clearance_m is passed at transit_agl_m."""

    transit_agl_m: float = 60.0
    clearance_m: float = 15.0  # above what is passed
    tolerance_m: float = 10.0  # how far the height above ground may stray between waypoints, and a waypoint may lie above what it has to
    margin_m: float = 10.0  # to the limits of zones, for the UAV's own error in height
    max_agl_m: float = 120.0  # what stands higher than that less the clearance cannot be flown over

    def band_m(self, heights_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest place, above ground, of a UAV that passes assets of these heights, margin included."""
        passed_m = np.maximum(self.transit_agl_m, heights_m + self.clearance_m)
        return passed_m - self.below_m, passed_m + self.above_m

    @property
    def below_m(self) -> float:
        """How far a UAV may be below the height that it is to have, margin included."""
        return self.tolerance_m + self.margin_m

    @property
    def above_m(self) -> float:
        """How far a UAV may be above the height that it is to have, margin included: a check counts the tolerance from waypoints."""
        return 2.0 * self.tolerance_m + self.margin_m

    def place_band_m(self, height_m: float | None) -> tuple[float, float]:
        """The same at one place; where the height of what stands there is not known, up to any."""
        low_m, high_m = self.band_m(np.array([0.0 if height_m is None else height_m]))
        return float(low_m[0]), np.inf if height_m is None else float(high_m[0])


def asset_heights_m(kind: NDArray[np.uint8], tagged_m: FloatArray) -> FloatArray:
    """The height that the asset at each node is taken to have: as tagged, where NaN by the node's kind."""
    heights_m: FloatArray = np.where(np.isnan(tagged_m), _UNTAGGED_M[kind], tagged_m)
    return heights_m
