"""A circle as a polygon that holds all of it."""

from math import cos, pi
from typing import Any

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import GeometryFault, VertexBudget, polygons_of_rings
from inspection.geodesy.wgs84 import WGS84, FloatArray

CORNERS = 64
CHECKS_PER_SIDE = 16
MAX_RADIUS_M = 500_000.0


def checked_radius_m(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value <= MAX_RADIUS_M:
        raise GeometryFault(place, f"a radius is a number of metres above 0, up to {MAX_RADIUS_M:.0f}")
    return float(value)


def enclosing_polygon(centre: LonLat, radius_m: float, place: str, budget: VertexBudget | None = None) -> MultiPolygon:
    """A regular polygon of 64 corners around the circle of points radius_m from the centre along the ellipsoid.

    Its sides are straight in longitude and latitude, as everywhere; it is widened until they clear the circle, which takes about a
    centimetre for each kilometre of radius at middle latitudes.
    """
    (budget or VertexBudget()).take(CORNERS + 1, place)
    pole_m = min(WGS84.inv(centre.lon, centre.lat, centre.lon, latitude)[2] for latitude in (90.0, -90.0))
    if pole_m <= radius_m * 1.2:
        raise GeometryFault(place, "the circle comes too near to a pole", centre)
    checks = _circle(centre, radius_m, CORNERS * CHECKS_PER_SIDE, offset=0.0)
    margin = 1e-5
    while margin < 0.1:
        ring = _circle(centre, radius_m / cos(pi / CORNERS) * (1.0 + margin), CORNERS, offset=0.5)
        polygon = Polygon(ring)
        if shapely.contains_xy(polygon, checks[:, 0], checks[:, 1]).all():
            wrapped = np.column_stack([(ring[:, 0] + 180.0) % 360.0 - 180.0, ring[:, 1]]) if np.abs(ring[:, 0]).max() > 180.0 else ring
            return MultiPolygon(polygons_of_rings([wrapped], place))
        margin *= 2.0
    raise GeometryFault(place, "the circle cannot be drawn as a polygon there", centre)


def _circle(centre: LonLat, radius_m: float, corners: int, offset: float) -> FloatArray:
    """Closed ring of points at a distance; longitudes run on past ±180. offset shifts the first corner by a share of a side."""
    bearings = (np.arange(corners) + offset) * (360.0 / corners)
    lon, lat, _ = WGS84.fwd(np.full(corners, centre.lon), np.full(corners, centre.lat), bearings, np.full(corners, radius_m))
    east = (np.asarray(lon) - centre.lon + 180.0) % 360.0 - 180.0
    ring = np.column_stack([centre.lon + east, np.asarray(lat)])
    return np.vstack([ring, ring[:1]])
