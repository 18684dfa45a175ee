"""A tower with its wires, neighbours and terrain, for the planning of photos."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from django.conf import settings
from django.contrib.gis.db.models.functions import AsWKB

from inspection.geodesy.local_frame import LocalFrame
from inspection.models import Asset, AssetKind
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import HIGHEST_VOLTAGE_HEIGHT_M, UNTAGGED_HEIGHT_M
from inspection.scene.overhead import Overhead
from inspection.selectors.assets import Box, area_of
from inspection.selectors.scene import overhead_in, supports_and_spans
from inspection.selectors.terrain import ground_heights_m, has_terrain
from planning.task import ViewPattern, ViewsRequest
from planning.views.ground_band import GroundBand
from planning.views.keep_out import SITE_M, Obstacle
from planning.views.proof import REACH_M
from planning.views.site import StandingSupport, TowerSite, tower_site
from planning.views.solids import FloatArray
from planning.views.span_views import MAX_HALF_SPAN_M

BEYOND_M = 50.0  # of what a flight may come near: supports, wires and other assets are read up to there
GROUND_BEYOND_M = 30.0  # of the same: the ground
WIRES_BESIDE_M = 15.0  # of lines without drawn spans: from their axis to the outermost wire, swing included
TRACK_BESIDE_M = 6.0  # of railways: half of their width with masts
OTHER_TOP_M: dict[str, float] = {
    AssetKind.RAILWAY: UNTAGGED_HEIGHT_M[NodeKind.RAILWAY],
    AssetKind.BRIDGE: UNTAGGED_HEIGHT_M[NodeKind.BRIDGE],
}


@dataclass(frozen=True, eq=False)
class TowerOnMap:
    """The site in the frame around the tower's foot.

    base_amsl_m: of the ground there, None without terrain data there and under all supports of its surroundings; then heights count from
    the foot, and unknown ground as level. ground_m: the ground over that at places (n, 2) [m], NaN where it is not known.
    """

    site: TowerSite
    frame: LocalFrame
    base_amsl_m: float | None
    ground_m: Callable[[FloatArray], FloatArray]


def tower_on_map(asset: Asset, views: ViewsRequest) -> TowerOnMap | None:
    """Return the surroundings of a tower, as far as such photos may be taken; None where it is no support of the network.

    The least height of the photos and the greatest of the flight rules are kept everywhere.
    """
    min_height_m, lens_offset_m = views.min_height_m, float(np.linalg.norm(views.camera.offset_m))
    around_m, box = SITE_M, _box(asset, SITE_M)
    found = overhead_in(box)
    own = np.flatnonzero(found.support == asset.pk)
    if len(own) and views.pattern is ViewPattern.SPANS:
        spans_m = found.length_m[(found.span == own[0]).any(axis=1)]
        around_m = max(SITE_M, min(float(spans_m.max(initial=0.0)) / 2.0, MAX_HALF_SPAN_M) + REACH_M)
        box = _box(asset, around_m)
        found = overhead_in(box)
        own = np.flatnonzero(found.support == asset.pk)
    if not len(own):
        return None
    frame = LocalFrame.around(*found.position[own[0]].tolist())
    base_m = float(ground_heights_m(found.position[own[:1]])[0]) if has_terrain() else np.nan
    has_ground = not np.isnan(base_m)
    max_height_m = settings.FLIGHT_RULES.max_agl_m

    def ground_m(places: FloatArray) -> FloatArray:
        return ground_heights_m(frame.to_degrees(places)) - base_m if has_ground else np.full(len(places), np.nan)

    band = GroundBand.level(min_height_m, max_height_m)
    if has_ground:
        band = GroundBand.over(ground_m, min_height_m, max_height_m, around_m + GROUND_BEYOND_M)
    others = list(_others(box, frame, band))
    feet_m = ground_m(frame.to_metres(found.position))
    is_known = has_ground and not bool(np.isnan(feet_m).any())  # else the wires to a far support would be lower here than they are
    supports, spans = _standing(found, int(own[0]), frame, np.nan_to_num(feet_m))
    site = tower_site(supports, spans, settings.CLEARANCE_RULES, band, others, lens_offset_m, around_m)
    return TowerOnMap(site, frame, base_m if is_known else None, ground_m)


def _box(asset: Asset, around_m: float) -> Box:
    side_m = around_m + BEYOND_M
    corners = LocalFrame.around(*asset.centre.coords).to_degrees(np.array([[-side_m, -side_m], [side_m, side_m]]))
    return (*corners[0].tolist(), *corners[1].tolist())


def _standing(found: Overhead, own: int, frame: LocalFrame, foot_m: FloatArray) -> tuple[list[StandingSupport], list[tuple[int, int]]]:
    """The supports, the inspected one first, and the spans between their places."""
    drawn, hung, _ = supports_and_spans(found)
    places = frame.to_metres(found.position)
    order = [own, *(place for place in range(len(drawn)) if place != own)]
    number = {place: count for count, place in enumerate(order)}
    supports = [StandingSupport(drawn[place], float(places[place, 0]), float(places[place, 1]), float(foot_m[place])) for place in order]
    return supports, [(number[span.start], number[span.end]) for span in hung]


def _others(box: Box, frame: LocalFrame, band: GroundBand) -> Iterator[Obstacle]:
    """Railways, bridges, and lines that are not in use, as obstacles on the highest ground of the box around each."""
    rows = Asset.objects.filter(vanished_at=None, geometry__intersects=area_of(box)).exclude(kind=AssetKind.TOWER)
    for row in rows.annotate(wkb=AsWKB("geometry")).only("kind", "height_m", "max_voltage_v", "is_flyable"):
        if row.kind == AssetKind.LINE and row.is_flyable:
            continue
        shape = shapely.intersection(shapely.force_2d(shapely.from_wkb(bytes(row.wkb))), shapely.box(*box))
        height_m = row.height_m or OTHER_TOP_M.get(row.kind, HIGHEST_VOLTAGE_HEIGHT_M)
        beside_m = WIRES_BESIDE_M if row.kind == AssetKind.LINE else TRACK_BESIDE_M if row.kind == AssetKind.RAILWAY else 0.0
        for part in shapely.get_parts(shape):
            corners = frame.to_metres(shapely.get_coordinates(part))
            if row.kind == AssetKind.BRIDGE and len(corners):
                yield Obstacle(corners, beside_m, band.highest_low_m(corners) + height_m)
            else:
                pieces = (corners[place : place + 2] for place in range(len(corners) - 1))
                yield from (Obstacle(piece, beside_m, band.highest_low_m(piece) + height_m) for piece in pieces)
