"""Polygons from the closed ways and multipolygon relations of OSM; what does not make a valid one is reported, not repaired."""

from collections.abc import Sequence

import numpy as np
from shapely import LineString, MultiPolygon, Polygon, polygonize_full
from shapely.geometry.base import BaseGeometry

from inspection.geodesy.wgs84 import FloatArray


class BrokenArea(Exception):
    """The ways do not close to rings, or the rings make no valid polygon."""


def polygon_of_ring(points: FloatArray) -> Polygon:
    polygon = Polygon(points)
    _check(polygon)
    return polygon


def polygon_of_relation(outer: Sequence[FloatArray], inner: Sequence[FloatArray]) -> Polygon | MultiPolygon:
    """The area inside the outer rings without that inside the inner ones; members may be parts of rings in any order."""
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
