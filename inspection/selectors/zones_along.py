"""No-fly zones along a line, with their limits as the zone states them."""

from dataclasses import dataclass

import numpy as np
import shapely
from django.contrib.gis.geos import LineString

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import NoFlyZone
from inspection.terrain.profile import stretches_inside

MOST_ZONES = 200


@dataclass(frozen=True)
class ZoneStretch:
    """Where a line lies in a zone; a line may enter a zone several times."""

    zone: NoFlyZone
    from_m: float
    to_m: float


def zones_along(line: FloatArray) -> list[ZoneStretch]:
    """line of shape (k, 2), lon lat [deg]; in the order of the line."""
    path = LineString(line.tolist(), srid=4326)
    fields = ("name", "geometry", "lower_limit_m", "lower_reference", "upper_limit_m", "upper_reference")
    found = []
    for zone in NoFlyZone.objects.filter(geometry__intersects=path).only(*fields)[:MOST_ZONES]:
        for from_m, to_m in stretches_inside(line, shapely.from_wkb(bytes(zone.geometry.wkb))):
            found.append(ZoneStretch(zone, from_m, to_m))
    return sorted(found, key=lambda stretch: (stretch.from_m, stretch.zone.pk))


def box_of_line(line: FloatArray) -> tuple[float, float, float, float]:
    (west, south), (east, north) = np.min(line, axis=0).tolist(), np.max(line, axis=0).tolist()
    return west, south, east, north
