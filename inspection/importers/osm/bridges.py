"""Bridges: ways on one bridge area form one bridge, and a way without an area gets a polygon from its width."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import LineString, MultiPolygon, Point, Polygon, STRtree, polygonize_full
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.geodesy.wgs84 import FloatArray
from inspection.importers.osm.records import OsmAssetRecord
from inspection.importers.osm.tags import bridge_width_m, height_m

LYING_ON_SHARE = 0.5  # a way is on an area if at least half of its length is
AREA_TOLERANCE_M = 1.0  # area edges are sometimes drawn along the way's own nodes


@dataclass(frozen=True)
class BridgeWay:
    """A way tagged as bridge, with the positions of its nodes, shape (n, 2), lon lat."""

    osm_id: int
    tags: Mapping[str, str]
    points: FloatArray
    node_osm_ids: tuple[int, ...]
    length_m: float


@dataclass(frozen=True)
class BridgeArea:
    """A man_made=bridge area: a closed way or a multipolygon relation."""

    osm_type: str
    osm_id: int
    tags: Mapping[str, str]
    polygon: Polygon | MultiPolygon


def bridges_of(ways: Sequence[BridgeWay], areas: Sequence[BridgeArea]) -> list[OsmAssetRecord]:
    """Return one record per bridge: every area with the ways on it, and every way that is on no area."""
    owner = _area_of_each_way(ways, areas)
    parts: dict[int, list[BridgeWay]] = {index: [] for index in range(len(areas))}
    lone: list[BridgeWay] = []
    for way, area in zip(ways, owner, strict=True):
        if area is None:
            lone.append(way)
        elif (areas[area].osm_type, areas[area].osm_id) != ("w", way.osm_id):
            parts[area].append(way)
    return [_bridge_of_area(area, parts[index]) for index, area in enumerate(areas)] + [_bridge_of_way(way) for way in lone]


def _area_of_each_way(ways: Sequence[BridgeWay], areas: Sequence[BridgeArea]) -> list[int | None]:
    """Return for each way the index of the area that carries it, or None; of several areas the one that carries most."""
    own = {area.osm_id: index for index, area in enumerate(areas) if area.osm_type == "w"}
    if not areas:
        return [None] * len(ways)
    tree = STRtree([area.polygon for area in areas])
    return [own[way.osm_id] if way.osm_id in own else _area_under(way, areas, tree) for way in ways]


def _area_under(way: BridgeWay, areas: Sequence[BridgeArea], tree: STRtree) -> int | None:
    near = sorted(int(index) for index in tree.query(LineString(way.points)))
    if not near:
        return None
    frame = LocalFrame.around(*way.points[0])
    line = LineString(frame.to_metres(way.points))
    polygons = [shapely.transform(areas[index].polygon, frame.to_metres).buffer(AREA_TOLERANCE_M) for index in near]
    if line.intersection(shapely.union_all(polygons)).length < LYING_ON_SHARE * line.length:
        return None
    return near[int(np.argmax([line.intersection(polygon).length for polygon in polygons]))]


def _bridge_of_area(area: BridgeArea, ways: Sequence[BridgeWay]) -> OsmAssetRecord:
    ordered = sorted(ways, key=lambda way: way.osm_id)
    return OsmAssetRecord(
        kind="bridge", subtype="area", osm_type=area.osm_type, osm_id=area.osm_id, geometry=area.polygon,
        centre=inner_point(area.polygon), tags=dict(area.tags), height_m=height_m(area.tags),
        parts=tuple({"osm_id": way.osm_id, "tags": dict(way.tags)} for way in ordered),
    )  # fmt: skip


def _bridge_of_way(way: BridgeWay) -> OsmAssetRecord:
    """Return a way's bridge: a closed way tagged area=yes is the outline; any other is widened to both sides, flat at its ends."""
    frame = LocalFrame.around(*way.points[0])
    metres = frame.to_metres(way.points)
    polygon: BaseGeometry = Polygon()
    if way.tags.get("area") == "yes" and len(metres) > 3 and np.array_equal(metres[0], metres[-1]):
        polygon = Polygon(metres)
    if polygon.is_empty or not polygon.is_valid:
        polygon = LineString(metres).buffer(bridge_width_m(way.tags) / 2, cap_style="flat", join_style="mitre", mitre_limit=2.0)
        centre = LineString(metres).interpolate(0.5, normalized=True)
        middle = LonLat(*map(float, frame.to_degrees(np.array([[centre.x, centre.y]]))[0]))
    else:
        middle = inner_point(shapely.transform(polygon, frame.to_degrees))
    return OsmAssetRecord(
        kind="bridge", subtype="way", osm_type="w", osm_id=way.osm_id, geometry=shapely.transform(polygon, frame.to_degrees), centre=middle,
        tags=dict(way.tags), height_m=height_m(way.tags), length_m=way.length_m, node_osm_ids=way.node_osm_ids,
    )  # fmt: skip


def inner_point(polygon: BaseGeometry) -> LonLat:
    """Return the centroid, or a point inside where the centroid is outside."""
    point: Point = polygon.centroid
    if not polygon.covers(point):
        point = polygon.representative_point()
    return LonLat(point.x, point.y)


class BrokenArea(Exception):
    """Raised when ways do not close to rings, or rings form no valid polygon."""


def polygon_of_ring(points: FloatArray) -> Polygon:
    polygon = Polygon(points)
    _check(polygon)
    return polygon


def polygon_of_relation(outer: Sequence[FloatArray], inner: Sequence[FloatArray]) -> Polygon | MultiPolygon:
    """Return the area of the outer rings without the inner ones; members may be parts of rings in any order."""
    shells, holes = _rings(outer), _rings(inner)
    if not shells:
        raise BrokenArea
    polygons = []
    for shell in shells:
        polygon = Polygon(shell.exterior, [hole.exterior for hole in holes if shell.contains(hole)])
        _check(polygon)
        polygons.append(polygon)
    area = polygons[0] if len(polygons) == 1 else MultiPolygon(polygons)
    _check(area)
    return area


def _rings(lines: Sequence[FloatArray]) -> list[Polygon]:
    if any(len(line) < 2 for line in lines):
        raise BrokenArea
    rings, cuts, dangles, invalid = polygonize_full([LineString(line) for line in lines])
    if not (cuts.is_empty and dangles.is_empty and invalid.is_empty):
        raise BrokenArea
    return [ring for ring in rings.geoms if isinstance(ring, Polygon)]


def _check(area: BaseGeometry) -> None:
    west, _, east, _ = area.bounds if not area.is_empty else (0.0, 0.0, 360.0, 0.0)
    if area.is_empty or not area.is_valid or area.area <= 0.0 or east - west > 180.0 or not np.isfinite(area.area):
        raise BrokenArea
