"""No-fly zones along a line, with their limits as the zone states them."""

from dataclasses import dataclass

import numpy as np
import shapely
from django.contrib.gis.geos import LineString, Polygon

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import NoFlyZone
from inspection.network.zones.zone_index import MAX_SHRINKING_LAT_DEG, METRES_PER_DEGREE_LAT, METRES_PER_DEGREE_LON, widen
from inspection.terrain.heights import stretches_inside

MAX_ZONES = 200


@dataclass(frozen=True)
class ZoneStretch:
    """The part of a line in a zone, which a line may enter several times. is_crossed: it enters the zone, not only its margin."""

    zone: NoFlyZone
    from_m: float
    to_m: float
    is_crossed: bool = True


def zones_along(line: FloatArray, near_m: float = 0.0) -> list[ZoneStretch]:
    """Return the zones along a line of shape (k, 2), lon lat [deg], in its order; near_m: also where it passes this near."""
    path = LineString(line.tolist(), srid=4326)
    fields = ("name", "geometry", "lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference", "schedule")
    around = _box_around(line, near_m) if near_m else path
    found = []
    for zone in NoFlyZone.objects.filter(geometry__intersects=around).only(*fields)[:MAX_ZONES]:
        area = shapely.from_wkb(bytes(zone.geometry.wkb))
        inside = stretches_inside(line, area)
        if not near_m:
            found += [ZoneStretch(zone, from_m, to_m) for from_m, to_m in inside]
            continue
        (around_zone,) = widen(np.array([area], dtype=object), near_m)
        for from_m, to_m in stretches_inside(line, around_zone):
            is_crossed = any(start_m <= to_m and from_m <= end_m for start_m, end_m in inside)
            found.append(ZoneStretch(zone, from_m, to_m, is_crossed))
    return sorted(found, key=lambda stretch: (stretch.from_m, stretch.zone.pk))


def _box_around(line: FloatArray, near_m: float) -> Polygon:
    west, south, east, north = box_of_line(line)
    high = near_m / METRES_PER_DEGREE_LAT
    wide = near_m / (METRES_PER_DEGREE_LON * np.cos(np.radians(min(max(abs(south), abs(north)) + high, MAX_SHRINKING_LAT_DEG))))
    return Polygon.from_bbox((west - wide, south - high, east + wide, north + high))


def box_of_line(line: FloatArray) -> tuple[float, float, float, float]:
    (west, south), (east, north) = np.min(line, axis=0).tolist(), np.max(line, axis=0).tolist()
    return west, south, east, north
