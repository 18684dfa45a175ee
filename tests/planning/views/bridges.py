"""Bridges of tests and benchmarks of views."""

from collections.abc import Callable, Sequence

import numpy as np
import shapely
import shapely.affinity

from planning.views.bridge_solid import BridgeShape
from planning.views.ground_band import GroundBand
from planning.views.keep_out import ClearanceRules
from planning.views.site import InspectionSite, StandingSupport, bridge_site
from planning.views.solids import FloatArray
from tests.planning.views.towers import MAX_HEIGHT_M, MIN_HEIGHT_M

Ground = Callable[[FloatArray], FloatArray]
COUNTED_M = 30.0  # as high as planners count a bridge without a stated height


def level_m(places: FloatArray) -> FloatArray:
    return np.zeros(len(places))


def valley_m(places: FloatArray) -> FloatArray:
    """A valley across the bridge, 22 m deep, whose sides begin 50 m from its middle."""
    return np.clip((np.abs(places[:, 0]) - 50.0) / 40.0, 0.0, 1.0) * 22.0


def straight(length_m: float, width_m: float, bearing_deg: float = 90.0, skew_m: float = 0.0) -> shapely.Polygon:
    along = np.array([np.sin(np.radians(bearing_deg)), np.cos(np.radians(bearing_deg))])
    left = np.array([-along[1], along[0]])
    ends = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    return shapely.Polygon([along * (u * length_m / 2.0 + v * skew_m / 2.0) + left * v * width_m / 2.0 for u, v in ends])


def curved(radius_m: float, angle_deg: float, width_m: float) -> shapely.Polygon:
    """An arc whose middle is at the origin."""
    turns = np.radians(np.linspace(-angle_deg / 2.0, angle_deg / 2.0, 13))
    arc = np.column_stack([radius_m * np.sin(turns), radius_m * (1.0 - np.cos(turns))])
    return shapely.orient_polygons(shapely.buffer(shapely.LineString(arc), width_m / 2.0, cap_style="flat"))


def bridge(parts: Sequence[shapely.Polygon], deck_m: float, ground_m: Ground = level_m, top_m: float = COUNTED_M) -> BridgeShape:
    return BridgeShape(tuple(shapely.orient_polygons(part) for part in parts), deck_m, top_m, ground_m)


def site_of(own: BridgeShape, supports: Sequence[StandingSupport] = (), spans: Sequence[tuple[int, int]] = ()) -> InspectionSite:
    band = GroundBand.over(own.ground_m, MIN_HEIGHT_M, MAX_HEIGHT_M, own.reach_m + 180.0)
    return bridge_site(own, supports, spans, ClearanceRules(), band)


BRIDGES = {
    "road over road, 40 m": bridge([straight(40.0, 12.0)], 6.5),
    "skewed, 60 m": bridge([straight(60.0, 14.0, 30.0, 16.0)], 6.5),
    "footbridge, 25 m": bridge([straight(25.0, 3.0, 140.0)], 6.5),
    "two decks, 50 m": bridge([shapely.affinity.translate(straight(50.0, 11.0), 0.0, side_m) for side_m in (-8.0, 8.0)], 6.5),
    "viaduct over a valley, 180 m": bridge([straight(180.0, 12.0)], 24.0, valley_m, 52.0),
    "curved viaduct, 150 m": bridge([curved(180.0, 48.0, 9.0)], 18.0),
    "wide, 30 m by 34 m": bridge([straight(34.0, 30.0)], 7.0),
}
