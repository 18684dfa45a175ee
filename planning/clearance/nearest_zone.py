"""The zone that finished routes come nearest to, of those in force while they are flown and at heights that they have."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from inspection.geodesy import distance_m
from inspection.geodesy.local_frame import LocalFrame
from inspection.zones.reach import ZoneTable
from planning.clearance.nearby_zones import zones_near
from planning.clearance.zone_clearance import FlownRoute, Margins

LOOK_M = 5_000.0  # zones beyond are not looked at


@dataclass(frozen=True)
class NearestZone:
    """route: its place among those given; metres are horizontal, 0 inside, above or below the zone."""

    zone: int
    name: str
    metres: float
    route: int


def nearest_zone(routes: Sequence[FlownRoute], table: ZoneTable) -> NearestZone | None:
    """Return the nearest zone, or None without one within LOOK_M. A route without times counts at any time."""
    found: list[NearestZone] = []
    for number, route in enumerate(routes):
        if not len(route.position):
            continue
        near, facts = zones_near(table, route.position, Margins(lateral_m=LOOK_M), _window(route))
        reached = near.reaching(0.0, float(np.nanmax(route.agl_m)))
        for row in np.flatnonzero(reached).tolist():
            spans = facts.spans[row]
            if spans is None or len(spans):
                metres = _metres(route, facts.polygons[row])
                found.append(NearestZone(int(near.ids[row]), near.names[row], metres, number))
    nearest = min(found, key=lambda one: one.metres, default=None)
    return None if nearest is None or nearest.metres > LOOK_M else nearest


def _window(route: FlownRoute) -> tuple[float, float] | None:
    return None if route.departs_s is None or route.ends_s is None else (route.departs_s, route.ends_s)


def _metres(route: FlownRoute, polygon: BaseGeometry) -> float:
    """Geodesic metres between the nearest places, which are looked for in a plane around the zone."""
    frame = LocalFrame.around(polygon.centroid.x, polygon.centroid.y)
    flat = frame.to_metres(route.position)
    line = shapely.LineString(flat) if len(flat) > 1 else shapely.Point(flat[0])
    ours, theirs = nearest_points(line, shapely.transform(polygon, frame.to_metres))
    ends = frame.to_degrees(np.array([[ours.x, ours.y], [theirs.x, theirs.y]]))
    return float(distance_m(ends[:1], ends[1:])[0])
