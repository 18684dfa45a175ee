"""Rings of official files that cross themselves in a slip of a few metres, read on the safe side: all that any loop encloses.

Only for formats whose published files have such slips. The number of crossings is counted first and bounded, so that a hostile ring
costs nothing; what somebody draws here is never mended.
"""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import MultiLineString, MultiPolygon, Polygon

from inspection.geodesy.wgs84 import FloatArray

MOST_CROSSINGS = 8
_CHUNK = 256


def area_of_all_loops(ring: FloatArray) -> list[Polygon] | None:
    """The polygons that the closed ring of shape (n, 2) encloses with any of its loops; None if it crosses itself too often."""
    segments = shapely.get_parts(MultiLineString(list(np.stack([ring[:-1], ring[1:]], axis=1))))
    if _crossings(segments) > MOST_CROSSINGS:
        return None
    faces = shapely.get_parts(shapely.polygonize([shapely.unary_union(segments)]))
    if not len(faces):
        return None
    area = shapely.unary_union([Polygon(face.exterior) for face in faces])  # what a loop leaves out in its middle is enclosed too
    parts = list(area.geoms) if isinstance(area, MultiPolygon) else [area]
    return [part for part in parts if isinstance(part, Polygon) and part.is_valid and part.area > 0.0] or None


def _crossings(segments: NDArray[np.object_]) -> int:
    """How many pairs of sides meet that are not neighbours; counting stops above MOST_CROSSINGS."""
    tree = shapely.STRtree(segments)
    count, last = 0, len(segments) - 1
    for first in range(0, len(segments), _CHUNK):
        one, other = tree.query(segments[first : first + _CHUNK], predicate="intersects")
        gap = other - (one + first)
        count += int(((gap > 1) & (gap < last)).sum())
        if count > MOST_CROSSINGS:
            break
    return count
