"""Map data of a box for the 3D view: terrain, supports and spans, railways, bridges and zones."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict, TypeVar

import numpy as np
import shapely
from django.contrib.gis.db.models.functions import AsWKB
from django.db.models import QuerySet
from django.utils.translation import gettext_noop

from inspection.geodesy.local_frame import LocalFrame
from inspection.geodesy.wgs84 import FloatArray
from inspection.models import Asset, AssetKind, NoFlyZone
from inspection.network.infrastructure import InfrastructureWays
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import UNTAGGED_HEIGHT_M
from inspection.scene.bridges import deck_of
from inspection.scene.overhead import Overhead, overhead
from inspection.scene.supports import DrawnSpan, DrawnSupport, LineFacts, SceneSupportFacts, drawn
from inspection.selectors.assets import Box, area_of
from inspection.selectors.ground_data import supports_and_lines
from inspection.selectors.terrain import ground_heights_m
from inspection.selectors.terrain_models import finest_step_m, terrain_models
from inspection.selectors.zone_table import zone_table

RECIPE = 3  # part of the ETag: incremented when the content of a scene changes
MIN_SIDE_M, MAX_SIDE_M = 50.0, 40_000.0
MAX_SHRINKING_LAT_DEG = 85.0
MAX_POSTS = 225  # of the terrain, along each side
AROUND_M = 1_500.0  # terrain, railways, bridges and zones extend this far beyond the box
REACH_DEG = 0.15  # longest span in degrees
MAX_SUPPORTS, MAX_SPANS, MAX_RAILWAYS, MAX_BRIDGES, MAX_ZONES = 4_000, 6_000, 1_500, 1_500, 200
SIMPLER_DEG, COARSEST_DEG = 5e-6, 1e-3  # half a metre to a hundred metres: for outlines of zones
MAX_CORNERS = 4_000  # of a zone
Row = TypeVar("Row", Asset, NoFlyZone)


class UnfitBox(Exception):
    """Raised for an invalid box; its message is a key of the catalogues."""


@dataclass(frozen=True, eq=False)
class SceneGround:
    """Terrain of a scene. kind: terrain, partly or flat; altitude_amsl_m (rows, columns), from the north-west."""

    kind: str
    west_deg: float
    north_deg: float
    step_lon_deg: float
    step_lat_deg: float
    altitude_amsl_m: FloatArray


@dataclass(frozen=True, eq=False)
class SceneBridge:
    asset: Asset
    shape: shapely.geometry.base.BaseGeometry
    deck_amsl_m: float
    deck_source: str
    height_m: float
    height_source: str


@dataclass(frozen=True, eq=False)
class SceneZone:
    """A zone of a scene. A limit is open where planners count it so: not stated, another reference, or AMSL over unknown terrain."""

    zone: NoFlyZone
    shape: shapely.geometry.base.BaseGeometry
    lower_is_open: bool
    upper_is_open: bool


@dataclass(frozen=True, eq=False)
class SceneContent:
    box: Box
    clip: Box
    origin_amsl_m: float
    ground: SceneGround
    place: Overhead
    support_amsl_m: FloatArray  # of the terrain at each
    supports: list[DrawnSupport]
    spans: list[DrawnSpan]
    assets: dict[int, Asset]  # of supports
    railways: list[tuple[Asset, shapely.geometry.base.BaseGeometry]]
    bridges: list[SceneBridge]
    zones: list[SceneZone]
    left_out: dict[str, int]

    @property
    def middle(self) -> tuple[float, float]:
        west, south, east, north = self.box
        return (west + east) / 2, (south + north) / 2


def check_box(box: Box) -> None:
    """Raise UnfitBox for an invalid box."""
    west, south, east, north = box
    if west > east:
        raise UnfitBox(gettext_noop("A scene does not cross the 180th meridian."))
    if max(abs(south), abs(north)) > MAX_SHRINKING_LAT_DEG:
        raise UnfitBox(gettext_noop("A scene does not lie within 5 degrees of a pole."))
    sides_m = _sides_m(box)
    if min(sides_m) < MIN_SIDE_M:
        raise UnfitBox(gettext_noop("A side of the box is shorter than 50 m."))
    if max(sides_m) > MAX_SIDE_M:
        raise UnfitBox(gettext_noop("A side of the box is longer than 40 km."))


def scene_in(box: Box) -> SceneContent:
    """Return the content of a box. Raises UnfitBox."""
    check_box(box)
    clip = _wider(box, AROUND_M)
    ground = _ground(clip)
    west, south, east, north = box
    middle = np.array([(west + east) / 2, (south + north) / 2])
    found, left_out = _overhead(box, middle)
    supports, spans, assets = supports_and_spans(found)
    railways = [(asset, _shape(asset, clip)) for asset in _in_area(AssetKind.RAILWAY, clip).filter(is_flyable=True)]
    zones = NoFlyZone.objects.filter(geometry__intersects=area_of(clip)).annotate(wkb=AsWKB("geometry")).defer("geometry")
    kept_railways, left_out["railways"] = _nearest(railways, middle, MAX_RAILWAYS)
    kept_bridges, left_out["bridges"] = _nearest(
        [(row, _shape(row, clip)) for row in _in_area(AssetKind.BRIDGE, clip)], middle, MAX_BRIDGES
    )
    kept_zones, left_out["zones"] = _nearest([(zone, _shape(zone, clip)) for zone in zones], middle, MAX_ZONES)
    return SceneContent(
        box=box,
        clip=clip,
        origin_amsl_m=float(_reported(middle[None], ground)[0]),
        ground=ground,
        place=found,
        support_amsl_m=_reported(found.position, ground),
        supports=supports,
        spans=spans,
        assets=assets,
        railways=kept_railways,
        bridges=_bridges(kept_bridges, ground),
        zones=_zones(kept_zones),
        left_out=left_out,
    )


def supports_and_spans(found: Overhead) -> tuple[list[DrawnSupport], list[DrawnSpan], dict[int, Asset]]:
    """Return supports and spans in the order of `found`, and the assets of supports by primary key."""
    assets = {asset.pk: asset for asset in _read(Asset.objects.filter(pk__in=found.support[found.support >= 0].tolist()))}
    lines = {asset.pk: asset for asset in _read(Asset.objects.filter(pk__in=sorted({line for own in found.span_lines for line in own})))}
    supports, spans = drawn(
        found,
        {pk: SceneSupportFacts(asset.subtype or "tower", asset.max_voltage_v, asset.tags) for pk, asset in assets.items()},
        {pk: LineFacts(line.max_voltage_v, line.circuits, line.tags, is_minor=line.subtype == "minor_line") for pk, line in lines.items()},
    )
    return supports, spans, assets


def overhead_in(box: Box) -> Overhead:
    """Return the supports of a box, and every span that touches it.

    Rows are read twice: first the lines that touch the box, then everything within reach of their spans.
    """
    _, lines = supports_and_lines(box)
    supports, lines = supports_and_lines(_reach(box, lines))
    return overhead(supports, lines, box)


def _sides_m(box: Box) -> tuple[float, float]:
    """Return the longest side from west to east, and the side from south to north."""
    west, south, east, north = box
    nearest_equator = 0.0 if south <= 0.0 <= north else min(south, north, key=abs)
    frame = LocalFrame.around(west, nearest_equator)
    return (east - west) * frame.metres_per_degree_east, (north - south) * frame.metres_per_degree_north


def _wider(box: Box, by_m: float) -> Box:
    west, south, east, north = box
    frame = LocalFrame.around((west + east) / 2, (south + north) / 2)
    lon, lat = by_m / frame.metres_per_degree_east, by_m / frame.metres_per_degree_north
    return max(west - lon, -180.0), max(south - lat, -90.0), min(east + lon, 180.0), min(north + lat, 90.0)


def _ground(box: Box) -> SceneGround:
    """Return the terrain as fine as the model there, or as MAX_POSTS allow."""
    west, south, east, north = box
    step_m = 2.0 * finest_step_m(box)
    columns, rows = (min(max(math.ceil(side_m / step_m) + 1, 2), MAX_POSTS) for side_m in _sides_m(box))
    lon, lat = np.meshgrid(np.linspace(west, east, columns), np.linspace(north, south, rows))
    heights = np.full(rows * columns, np.nan)
    if terrain_models():
        heights = ground_heights_m(np.column_stack([lon.ravel(), lat.ravel()]))
    is_known = ~np.isnan(heights)
    kind = "terrain" if is_known.all() else "partly" if is_known.any() else "flat"
    if kind == "flat":
        columns = rows = 2
        heights, is_known = np.full(4, np.nan), np.zeros(4, dtype=bool)
    filled = np.where(is_known, heights, heights[is_known].mean() if is_known.any() else 0.0).reshape(rows, columns)
    return SceneGround(kind, west, north, (east - west) / (columns - 1), (north - south) / (rows - 1), filled)


def _reported(positions: FloatArray, ground: SceneGround) -> FloatArray:
    """Return the terrain heights at positions (n, 2); where no model has data, as the scene's own terrain is filled."""
    heights = np.full(len(positions), np.nan) if ground.kind == "flat" else ground_heights_m(positions)
    return np.where(np.isnan(heights), ground.altitude_amsl_m.mean() if ground.kind != "flat" else 0.0, heights)


def _overhead(box: Box, middle: FloatArray) -> tuple[Overhead, dict[str, int]]:
    """Return the supports and spans nearest to the middle, and the numbers of those beyond."""
    found = overhead_in(box)
    stays = _nearest_places(found.position, middle, MAX_SUPPORTS)
    centre = found.position[found.span].mean(axis=1)
    hangs = _nearest_places(centre, middle, MAX_SPANS)
    kept = found.where(stays, hangs)
    return kept, {"supports": int((~stays).sum()), "spans": len(found.span) - len(kept.span)}


def _reach(box: Box, lines: InfrastructureWays) -> Box:
    """Return the box extended by the ends of all spans that touch it; spans longer than REACH_DEG stay cut."""
    west, south, east, north = box
    start = lines.leg_start
    ends = np.stack([lines.position[start], lines.position[start + 1]], axis=1)
    low, high = ends.min(axis=1, initial=180.0), ends.max(axis=1, initial=-180.0)
    touches = (low <= (east, north)).all(axis=1) & (high >= (west, south)).all(axis=1)
    low = np.maximum(low[touches].min(axis=0, initial=180.0), (west - REACH_DEG, south - REACH_DEG))
    high = np.minimum(high[touches].max(axis=0, initial=-180.0), (east + REACH_DEG, north + REACH_DEG))
    return min(west, float(low[0])), min(south, float(low[1])), max(east, float(high[0])), max(north, float(high[1]))


def _read(assets: "QuerySet[Asset]") -> "QuerySet[Asset]":
    return assets.select_related("line").defer(
        "geometry", "node_osm_ids", "source_facts", "line__geometry", "line__node_osm_ids", "line__source_facts"
    )


class AsStored(TypedDict):
    wkb: bytes | memoryview


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    StoredAsset = WithAnnotations[Asset, AsStored]
    StoredZone = WithAnnotations[NoFlyZone, AsStored]
else:
    StoredAsset, StoredZone = Asset, NoFlyZone


def _in_area(kind: AssetKind, clip: Box) -> "QuerySet[StoredAsset]":
    assets = Asset.objects.filter(kind=kind, vanished_at=None, geometry__intersects=area_of(clip))
    return assets.annotate(wkb=AsWKB("geometry")).defer("geometry", "node_osm_ids", "source_facts").order_by("pk")


def _shape(row: StoredAsset | StoredZone, clip: Box) -> shapely.geometry.base.BaseGeometry:
    """Return the part of the shape in the box; bridges whole."""
    shape = shapely.force_2d(shapely.from_wkb(bytes(row.wkb)))
    if isinstance(row, Asset) and row.kind == AssetKind.BRIDGE:
        return shape
    if isinstance(row, NoFlyZone):
        return _with_fewer_corners(shapely.intersection(shape, shapely.box(*clip)))
    return shapely.intersection(shape, shapely.box(*clip))


def _with_fewer_corners(shape: shapely.geometry.base.BaseGeometry) -> shapely.geometry.base.BaseGeometry:
    """Return the shape simplified by half a metre, or by as much as MAX_CORNERS requires."""
    tolerance_deg = SIMPLER_DEG
    while True:
        simpler = shapely.simplify(shape, tolerance_deg)
        if shapely.get_num_coordinates(simpler) <= MAX_CORNERS or tolerance_deg > COARSEST_DEG:
            return shape if simpler.is_empty or not shapely.is_valid(simpler) else simpler
        tolerance_deg *= 2


def _nearest(
    rows: Iterable[tuple[Row, shapely.geometry.base.BaseGeometry]], middle: FloatArray, most: int
) -> tuple[list[tuple[Row, shapely.geometry.base.BaseGeometry]], int]:
    """Return the rows nearest to the middle in their order, and the number of omitted ones; rows outside the box do not count."""
    there = [(row, shape) for row, shape in rows if not shape.is_empty]
    if len(there) <= most:
        return there, 0
    far = shapely.distance(np.array([shape for _, shape in there], dtype=object), shapely.points(middle))
    kept = np.sort(np.argsort(far, kind="stable")[:most])
    return [there[place] for place in kept.tolist()], len(there) - most


def _nearest_places(position: FloatArray, middle: FloatArray, most: int) -> "np.typing.NDArray[np.bool_]":
    stays = np.ones(len(position), dtype=bool)
    if len(position) > most:
        stretch = (math.cos(math.radians(float(middle[1]))), 1.0)
        far = np.hypot(*((position - middle) * stretch).T)
        stays[np.argsort(far, kind="stable")[most:]] = False
    return stays


def _bridges(rows: list[tuple[Asset, shapely.geometry.base.BaseGeometry]], ground: SceneGround) -> list[SceneBridge]:
    edges, number = shapely.get_coordinates(np.array([shape for _, shape in rows], dtype=object), return_index=True)
    edges_m = _reported(edges, ground)
    firsts = np.searchsorted(number, np.arange(1, len(rows)))
    return [_bridge(asset, shape, own_m) for (asset, shape), own_m in zip(rows, np.split(edges_m, firsts), strict=False)]


def _bridge(asset: Asset, shape: shapely.geometry.base.BaseGeometry, edge_m: FloatArray) -> SceneBridge:
    """Return a bridge. height_m is its top as planners count it. edge_m: the terrain at its corners."""
    deck_m, source = deck_of(edge_m, asset.height_m, asset.bridge_tags)
    height_m = UNTAGGED_HEIGHT_M[NodeKind.BRIDGE] if asset.height_m is None else asset.height_m
    return SceneBridge(asset, shape, deck_m, source, height_m, "assumed" if asset.height_m is None else "tag")


def _zones(rows: list[tuple[NoFlyZone, shapely.geometry.base.BaseGeometry]]) -> list[SceneZone]:
    table = zone_table()
    bands = dict(zip(table.ids.tolist(), zip(table.floor_agl_m.tolist(), table.ceiling_agl_m.tolist(), strict=True), strict=True))
    found = []
    for zone, shape in rows:
        floor_m, ceiling_m = bands.get(zone.pk, (-math.inf, math.inf))
        found.append(SceneZone(zone, shape, not math.isfinite(floor_m), not math.isfinite(ceiling_m)))
    return found
