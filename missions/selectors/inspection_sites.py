"""A tower or a bridge with wires, neighbours and terrain around it, for the planning of photos."""

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
from inspection.scene.bridges import deck_of, has_tall_structure, tall_share
from inspection.scene.overhead import Overhead
from inspection.scene.supports import DrawnSupport
from inspection.selectors.assets import Box, area_of
from inspection.selectors.scene import overhead_in, supports_and_spans
from inspection.selectors.terrain import ground_heights_m, has_terrain
from planning.task import ViewPattern, ViewsRequest
from planning.views.bridge_solid import BridgeShape
from planning.views.ground_band import GroundBand
from planning.views.keep_out import SITE_M, Obstacle
from planning.views.proof import REACH_M
from planning.views.site import InspectionSite, StandingSupport, bridge_site, tower_site
from planning.views.solids import FloatArray
from planning.views.span_views import MAX_HALF_SPAN_M

BEYOND_M = 50.0  # of what a flight may come near: supports, wires and other assets are read up to there
GROUND_BEYOND_M = 30.0  # of the same: the ground
WIRES_BESIDE_M = 15.0  # of lines without drawn spans: from their axis to the outermost wire, swing included
TRACK_BESIDE_M = 6.0  # of railways: half of their width with masts
MIN_PART_M2 = 1.0  # of a bridge's outline: smaller parts are drawing errors, and have no model
MAX_BRIDGE_REACH_M = 300.0  # from its middle
OUTLINE_ERROR_M, MAX_CORNERS = 0.3, 400  # by which the outline of a model is simplified, and its corners then
BESIDE_M, MAX_BESIDE = 40.0, 20  # of bridges that may hide parts of another
OTHER_TOP_M: dict[str, float] = {
    AssetKind.RAILWAY: UNTAGGED_HEIGHT_M[NodeKind.RAILWAY],
    AssetKind.BRIDGE: UNTAGGED_HEIGHT_M[NodeKind.BRIDGE],
}


class UnfitBridge(Exception):
    """A bridge of which no photos are planned; code: of the reason, without "photos_"."""

    def __init__(self, code: str) -> None:
        super().__init__(code)
        self.code = code


@dataclass(frozen=True, eq=False)
class SiteOnMap:
    """The site in the frame around the foot of a tower or the middle of a bridge.

    base_amsl_m: of the ground there, None without terrain data there and under all supports of its surroundings; then heights count from
    the foot, and unknown ground as level. ground_m: the ground over that at places (n, 2) [m], NaN where it is not known. model: what the
    asset is taken to look like; deck_source: what the height of a bridge's deck is taken from.
    """

    site: InspectionSite
    frame: LocalFrame
    base_amsl_m: float | None
    ground_m: Callable[[FloatArray], FloatArray]
    model: DrawnSupport | BridgeShape
    deck_source: str = ""


def site_on_map(asset: Asset, views: ViewsRequest) -> SiteOnMap | None:
    """Return the surroundings of a tower or a bridge, as far as such photos may be taken.

    None where it is neither, or no support of the network, or has no such photos. Raises UnfitBridge. The least height of the
    photos and the greatest of the flight rules are kept everywhere.
    """
    if asset.kind != AssetKind.BRIDGE:
        return _tower_on_map(asset, views)
    return None if views.pattern is ViewPattern.SPANS else _bridge_on_map(asset, views)


def _tower_on_map(asset: Asset, views: ViewsRequest) -> SiteOnMap | None:
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
    ground = _Ground.around(*found.position[own[0]].tolist())
    band = ground.band(views, around_m)
    feet_m = ground.heights_m(ground.frame.to_metres(found.position))
    supports, spans = _standing(found, ground.frame, np.nan_to_num(feet_m), int(own[0]))
    others = list(_others(asset, box, ground, band))
    site = tower_site(supports, spans, settings.CLEARANCE_RULES, band, others, _lens_offset_m(views), around_m)
    return SiteOnMap(site, ground.frame, ground.known_base_m(feet_m), ground.heights_m, supports[0].support)


def _bridge_on_map(asset: Asset, views: ViewsRequest) -> SiteOnMap | None:
    if asset.vanished_at is not None:
        return None
    if asset.height_m is None and has_tall_structure(asset.bridge_tags):
        raise UnfitBridge("bridge_height_unknown")
    ground = _Ground.around(*asset.centre.coords)
    outline = _outline(asset, ground.frame)
    parts = _parts(outline)
    if not parts:
        raise UnfitBridge("bridge_outline")
    reach_m = float(np.linalg.norm(shapely.get_coordinates(outline), axis=1).max())
    if reach_m > MAX_BRIDGE_REACH_M:
        raise UnfitBridge("bridge_too_long")
    box = _box(asset, reach_m + SITE_M)
    found = overhead_in(box)
    band = ground.band(views, reach_m + SITE_M)
    model, deck_source = _bridge(asset, parts, ground, band)
    feet_m = ground.heights_m(ground.frame.to_metres(found.position))
    supports, spans = _standing(found, ground.frame, np.nan_to_num(feet_m))
    small_parts = [
        Obstacle(shapely.get_coordinates(part), 0.0, model.top_m) for part in shapely.get_parts(outline) if shapely.area(part) < MIN_PART_M2
    ]
    others = [*small_parts, *_others(asset, box, ground, band)]
    rules, occluders = settings.CLEARANCE_RULES, list(_bridges_beside(asset, ground, band))
    site = bridge_site(model, supports, spans, rules, band, others, _lens_offset_m(views), occluders)
    edge_m = ground.heights_m(shapely.get_coordinates(outline))
    return SiteOnMap(site, ground.frame, ground.known_base_m(np.concatenate([edge_m, feet_m])), ground.heights_m, model, deck_source)


def _outline(asset: Asset, frame: LocalFrame) -> shapely.Geometry:
    return shapely.transform(shapely.force_2d(shapely.from_wkb(bytes(asset.geometry.wkb))), frame.to_metres)


def _parts(outline: shapely.Geometry) -> tuple[shapely.Polygon, ...]:
    """The parts of an outline that have a model, with fewer corners; none where it is not valid or has too many."""
    simple = shapely.simplify(outline, OUTLINE_ERROR_M)
    if not shapely.is_valid(simple) or shapely.get_num_coordinates(simple) > MAX_CORNERS:
        return ()
    polygons = [part for part in shapely.get_parts(simple) if isinstance(part, shapely.Polygon)]
    return tuple(shapely.orient_polygons(part) for part in polygons if part.area >= MIN_PART_M2)


def _bridge(asset: Asset, parts: tuple[shapely.Polygon, ...], ground: "_Ground", band: GroundBand) -> tuple[BridgeShape, str]:
    """Return a bridge as it likely is, and what the height of its deck is taken from."""
    corners = np.concatenate([shapely.get_coordinates(part.exterior) for part in parts])
    deck_m, source = deck_of(np.nan_to_num(ground.heights_m(corners)), asset.height_m, asset.bridge_tags)
    counted_m = OTHER_TOP_M[AssetKind.BRIDGE] if asset.height_m is None else asset.height_m
    top_m = band.highest_low_m(corners) + counted_m
    return BridgeShape(parts, deck_m, top_m, lambda places: np.nan_to_num(ground.heights_m(places)), OUTLINE_ERROR_M), source


def _bridges_beside(asset: Asset, ground: "_Ground", band: GroundBand) -> Iterator[BridgeShape]:
    """Other bridges so near that they hide parts of this one."""
    west, south, east, north = asset.geometry.extent
    margin = np.array([BESIDE_M, BESIDE_M]) / (ground.frame.metres_per_degree_east, ground.frame.metres_per_degree_north)
    near = area_of((west - margin[0], south - margin[1], east + margin[0], north + margin[1]))
    rows = Asset.objects.filter(kind=AssetKind.BRIDGE, vanished_at=None, geometry__intersects=near).exclude(pk=asset.pk)
    for row in rows.order_by("pk")[:MAX_BESIDE]:
        parts = _parts(_outline(row, ground.frame))
        if parts:
            yield _bridge(row, parts, ground, band)[0]


@dataclass(frozen=True)
class _Ground:
    """Terrain over that at the origin of a frame, base_m above the sea; NaN without terrain data."""

    frame: LocalFrame
    base_m: float

    @classmethod
    def around(cls, lon: float, lat: float) -> "_Ground":
        base_m = float(ground_heights_m(np.array([[lon, lat]]))[0]) if has_terrain() else np.nan
        return cls(LocalFrame.around(lon, lat), base_m)

    @property
    def is_known(self) -> bool:
        return not np.isnan(self.base_m)

    def heights_m(self, places: FloatArray) -> FloatArray:
        return ground_heights_m(self.frame.to_degrees(places)) - self.base_m if self.is_known else np.full(len(places), np.nan)

    def band(self, views: ViewsRequest, around_m: float) -> GroundBand:
        heights_m = (views.min_height_m, settings.FLIGHT_RULES.max_agl_m)
        if not self.is_known:
            return GroundBand.level(*heights_m)
        return GroundBand.over(self.heights_m, *heights_m, around_m + GROUND_BEYOND_M)

    def known_base_m(self, needed_m: FloatArray) -> float | None:
        """base_m; None where one of the needed heights is not known: what stands there could be lower or higher than it is taken for."""
        return self.base_m if self.is_known and not bool(np.isnan(needed_m).any()) else None


def _lens_offset_m(views: ViewsRequest) -> float:
    return float(np.linalg.norm(views.camera.offset_m))


def _box(asset: Asset, around_m: float) -> Box:
    side_m = around_m + BEYOND_M
    corners = LocalFrame.around(*asset.centre.coords).to_degrees(np.array([[-side_m, -side_m], [side_m, side_m]]))
    return (*corners[0].tolist(), *corners[1].tolist())


def _standing(
    found: Overhead, frame: LocalFrame, foot_m: FloatArray, first: int | None = None
) -> tuple[list[StandingSupport], list[tuple[int, int]]]:  # fmt: skip
    """The supports, the inspected one first where there is one, and the spans between their places."""
    drawn, hung, _ = supports_and_spans(found)
    places = frame.to_metres(found.position)
    order = sorted(range(len(drawn)), key=lambda place: place != first)
    number = {place: count for count, place in enumerate(order)}
    supports = [StandingSupport(drawn[place], float(places[place, 0]), float(places[place, 1]), float(foot_m[place])) for place in order]
    return supports, [(number[span.start], number[span.end]) for span in hung]


def _others(asset: Asset, box: Box, ground: "_Ground", band: GroundBand) -> Iterator[Obstacle]:
    """Other railways, bridges, and lines that are not in use, as obstacles on the highest ground of the box around each.

    Bridges count from the highest ground at their whole outline, however far away, as on routes.
    """
    frame = ground.frame
    rows = Asset.objects.filter(vanished_at=None, geometry__intersects=area_of(box)).exclude(kind=AssetKind.TOWER).exclude(pk=asset.pk)
    for row in rows.annotate(wkb=AsWKB("geometry")).only("kind", "height_m", "max_voltage_v", "is_flyable", "tags", "parts"):
        if row.kind == AssetKind.LINE and row.is_flyable:
            continue
        whole = shapely.force_2d(shapely.from_wkb(bytes(row.wkb)))
        shape = shapely.intersection(whole, shapely.box(*box))
        height_m = row.height_m or OTHER_TOP_M.get(row.kind, HIGHEST_VOLTAGE_HEIGHT_M)
        beside_m = WIRES_BESIDE_M if row.kind == AssetKind.LINE else TRACK_BESIDE_M if row.kind == AssetKind.RAILWAY else 0.0
        for part in shapely.get_parts(shape):
            corners = frame.to_metres(shapely.get_coordinates(part))
            if row.kind == AssetKind.BRIDGE and len(corners):
                outline_m = frame.to_metres(shapely.get_coordinates(shapely.convex_hull(whole)))
                bank_m = float(np.fmax.reduce(ground.heights_m(outline_m), initial=-np.inf))
                guessed_m = 0.0 if row.height_m else tall_share(row.bridge_tags) * float(np.hypot(*np.ptp(outline_m, axis=0)))
                yield Obstacle(corners, beside_m, max(band.highest_low_m(corners), bank_m) + max(height_m, guessed_m))
            else:
                pieces = (corners[place : place + 2] for place in range(len(corners) - 1))
                yield from (Obstacle(piece, beside_m, band.highest_low_m(piece) + height_m) for piece in pieces)
