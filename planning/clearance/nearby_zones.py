"""The zones near routes, as the last look at them wants to have them."""

import math

import numpy as np

from inspection.zones.reach import ZoneTable
from planning.clearance.zone_clearance import FloatArray, Margins, ZoneFacts

MIN_DEGREE_M = 110_574.0  # metres in a degree of latitude, on the equator
MAX_SHRINKING_LAT_DEG = 89.0


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
