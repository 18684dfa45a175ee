"""Map data below a UAV that would land at its position."""

import math
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import shapely
from django.utils.translation import gettext as _

from inspection.models import Asset
from inspection.network.zones.zone_index import METRES_PER_DEGREE_LAT, METRES_PER_DEGREE_LON
from inspection.selectors import asset_label, assets_near, ground_heights_m
from inspection.selectors.zone_table import zone_table
from missions.models import Uav
from missions.services.commands.rtl_check import zones_applying
from telemetry.selectors.present import LastReceived, PresentPosition, last_received

BESIDE_M = 30.0  # around the landing point: drift by wind and position error
BELOW_M = 3.0
SLOPE_ABOUT_M = 10.0
STEEP_DEG = 10.0  # ArduPilot and PX4 give no limit; multicopters on skids tip over from about 15 degrees on
MAX_ABOUT_M = 300.0
LASTS_S = 600.0  # zones in force within this time count


@dataclass(frozen=True)
class NearAsset:
    """An asset and its horizontal distance from the UAV."""

    asset: int
    kind: str
    name: str
    distance_m: float


@dataclass(frozen=True)
class LandingHere:
    """Result of the check. `warnings` are sentences about obstructions, `facts` about the rest. None: unknown."""

    uav: Uav
    present: PresentPosition | None
    altitude_agl_m: float | None = None
    slope_deg: float | None = None
    assets: tuple[NearAsset, ...] = ()
    zones: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    facts: tuple[str, ...] = ()


def landing_here(*, uav: Uav, now: datetime) -> LandingHere:
    """Check the ground below its position and within its uncertainty."""
    (received,) = last_received([uav], now)
    present = received.present
    if present is None or present.uncertainty_m > MAX_ABOUT_M:
        words = _("Where %(uav)s is now is not known well enough: what lies below it is not known.") % {"uav": uav.name}
        return LandingHere(uav, present, warnings=(words,))
    agl_m, slope_deg = _height_m(received, present), _slope_deg(present)
    found = assets_near(present.position, BESIDE_M + present.uncertainty_m)
    assets = tuple(NearAsset(asset.pk, asset.kind, asset_label(asset), round(away_m, 1)) for asset, away_m in found)
    zones = _zones(present, agl_m, now)
    warnings = [
        *(_asset_words(asset, away_m, present) for asset, away_m in found),
        *(_("It comes down in %(zone)s.") % {"zone": zone} for zone in zones),
        *_slope_words(slope_deg, is_steep=True),
    ]
    facts = [_height_words(agl_m), *_slope_words(slope_deg, is_steep=False)]
    if not found:
        words = _("No line, tower, railway or bridge within %(metres)s m.")
        facts.append(words % {"metres": f"{BESIDE_M + present.uncertainty_m:.0f}"})
    facts.append(_("People, buildings, roads, trees and water are not in the data: look before it lands."))
    return LandingHere(uav, present, agl_m, slope_deg, assets, zones, tuple(warnings), tuple(facts))


def _height_m(received: LastReceived, present: PresentPosition) -> float | None:
    """Return the height above ground as measured, else by the terrain model."""
    if received.altitude_agl_m is not None and present.is_measured:
        return round(received.altitude_agl_m, 1)
    if present.altitude_relative_m is None or received.home is None:
        return None
    home_m, ground_m = ground_heights_m(np.array([received.home, present.position])).tolist()
    height_m = home_m + present.altitude_relative_m - ground_m
    return None if math.isnan(height_m) else round(height_m, 1)


def _slope_deg(present: PresentPosition) -> float | None:
    """Return the steepest slope of the terrain model to any side."""
    position, about_m = present.position, max(SLOPE_ABOUT_M, present.uncertainty_m)
    bearing = np.radians(np.arange(0.0, 360.0, 45.0))
    per_degree = np.array([METRES_PER_DEGREE_LON * math.cos(math.radians(position.lat)), METRES_PER_DEGREE_LAT])
    around = np.array(position) + about_m * np.column_stack([np.sin(bearing), np.cos(bearing)]) / per_degree
    heights_m = ground_heights_m(np.concatenate([np.array([position]), around]))
    if np.isnan(heights_m).any():
        return None
    return round(math.degrees(math.atan(float(np.abs(heights_m[1:] - heights_m[0]).max()) / about_m)), 1)


def _zones(present: PresentPosition, agl_m: float | None, now: datetime) -> tuple[str, ...]:
    """Return the names of zones in force that it touches during the descent."""
    begin_s = now.timestamp()
    near, _facts = zones_applying(zone_table(), present.places(), (begin_s, begin_s + LASTS_S))
    if not len(near):
        return ()
    below = near.only(near.reaching(0.0, math.inf if agl_m is None else agl_m))
    reach_deg = present.uncertainty_m / METRES_PER_DEGREE_LAT
    touched: list[bool] = []
    if len(below):
        touched = shapely.dwithin(below.polygons, shapely.Point(*present.position), reach_deg).tolist()
    return tuple(name for name, is_touched in zip(below.names, touched, strict=True) if is_touched)


def _asset_words(asset: Asset, away_m: float, present: PresentPosition) -> str:
    values = {"kind": asset.get_kind_display(), "name": asset_label(asset), "metres": f"{away_m:.0f}"}
    if away_m <= BELOW_M + present.uncertainty_m:
        return _("%(kind)s %(name)s is below it.") % values
    return _("%(kind)s %(name)s is %(metres)s m beside where it comes down.") % values


def _slope_words(slope_deg: float | None, *, is_steep: bool) -> list[str]:
    if slope_deg is None:
        return [] if is_steep else [_("How steep the ground is there is not known: there is no terrain model.")]
    if (slope_deg >= STEEP_DEG) is not is_steep:
        return []
    return [_("The ground slopes by %(degrees)s° there.") % {"degrees": f"{slope_deg:.0f}"}]


def _height_words(agl_m: float | None) -> str:
    if agl_m is None:
        return _("How high it is above the ground is not known.")
    return _("It is %(metres)s m above the ground.") % {"metres": f"{agl_m:.0f}"}
