"""The zones near routes, and the one that finished routes come nearest to."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from inspection.geodesy import distance_m
from inspection.geodesy.local_frame import LocalFrame
from inspection.zones.reach import ZoneTable
from planning.clearance.zone_clearance import FloatArray, FlownRoute, Margins, ZoneFacts

MIN_DEGREE_M = 110_574.0  # metres in a degree of latitude, on the equator
MAX_SHRINKING_LAT_DEG = 89.0
LOOK_M = 5_000.0  # the nearest zone is looked for so far from routes


def zones_near(
    table: ZoneTable, positions: FloatArray, margins: Margins, window: tuple[float, float] | None = None
) -> tuple[ZoneTable, ZoneFacts]:
    """The rows of the table whose boxes come near that of the positions, shape (n, 2), lon lat [deg], and what they state.

    window: from when to when the routes are flown, in seconds since the epoch; without one the zones count as in force always.
    """
    near = table.only(_are_near(table, positions, margins.lateral_m))
    spans: list[tuple[tuple[float, float], ...] | None] = [None] * len(near)
    if window is not None:
        spans = list(near.stated_spans(window[0] - margins.time_s, window[1] + margins.time_s))
    return near, ZoneFacts.of(near.polygons, near.limits, spans)


def _are_near(table: ZoneTable, positions: FloatArray, lateral_m: float) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    if not len(positions) or not len(table):
        return np.zeros(len(table), dtype=bool)
    farthest_lat = min(float(np.abs(positions[:, 1]).max()), MAX_SHRINKING_LAT_DEG)
    high = lateral_m / MIN_DEGREE_M
    wide = high / math.cos(math.radians(farthest_lat))
    (west, south), (east, north) = positions.min(axis=0).tolist(), positions.max(axis=0).tolist()
    near: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = (
        (table.box[:, 0] <= east + wide) & (table.box[:, 2] >= west - wide)
        & (table.box[:, 1] <= north + high) & (table.box[:, 3] >= south - high)
    )  # fmt: skip
    return near


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
        near, facts = zones_near(table, route.position, Margins(lateral_m=LOOK_M), route.window_s)
        reached = near.reaching(0.0, float(np.nanmax(route.agl_m)))
        for row in np.flatnonzero(reached).tolist():
            spans = facts.spans[row]
            if spans is None or len(spans):
                metres = _metres(route, facts.polygons[row])
                found.append(NearestZone(int(near.ids[row]), near.names[row], metres, number))
    nearest = min(found, key=lambda one: one.metres, default=None)
    return None if nearest is None or nearest.metres > LOOK_M else nearest


def _metres(route: FlownRoute, polygon: BaseGeometry) -> float:
    """Geodesic metres between the nearest places, which are looked for in a plane around the zone."""
    frame = LocalFrame.around(polygon.centroid.x, polygon.centroid.y)
    flat = frame.to_metres(route.position)
    line = shapely.LineString(flat) if len(flat) > 1 else shapely.Point(flat[0])
    ours, theirs = nearest_points(line, shapely.transform(polygon, frame.to_metres))
    ends = frame.to_degrees(np.array([[ours.x, ours.y], [theirs.x, theirs.y]]))
    return float(distance_m(ends[:1], ends[1:])[0])
