"""No-fly zones around UAVs in the air: the present ones, including those saved since the mission was approved."""

import math
import threading
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from inspection.geodesy import LonLat
from inspection.selectors.zone_table import zone_table
from inspection.zones.reach import ZoneTable
from telemetry.alerting.surroundings import NearZone

SPANS_FOR_S = 600.0  # schedules are evaluated this far ahead, plus the prediction horizon
LOOK_AHEAD_S = 600.0
DEGREE_M = 110_574.0  # of latitude at the equator, the minimum
_own = threading.local()  # prepared polygons must stay in one thread


@dataclass(frozen=True)
class ZonesAbout:
    """A table of zones, prepared for a limited time."""

    table: ZoneTable
    until_s: float
    polygons: Any
    spans: tuple[tuple[tuple[float, float], ...] | None, ...]

    @classmethod
    def of(cls, table: ZoneTable, now_s: float) -> "ZonesAbout":
        polygons = table.polygons
        shapely.prepare(polygons)
        until_s = now_s + SPANS_FOR_S
        stated = table.stated_spans(now_s - 1.0, until_s + LOOK_AHEAD_S)
        spans = [
            None if schedule is None else tuple((span[0], span[1]) for span in spans)
            for schedule, spans in zip(table.schedules, stated, strict=True)
        ]
        return cls(table, until_s, polygons, tuple(spans))

    def within(self, position: LonLat, reach_m: float) -> tuple[NearZone, ...]:
        """Return the zones whose boxes are within this distance."""
        box = self.table.box
        high = reach_m / DEGREE_M
        wide = high / max(math.cos(math.radians(position.lat)), 0.01)
        near = (box[:, 0] <= position.lon + wide) & (box[:, 2] >= position.lon - wide)
        near &= (box[:, 1] <= position.lat + high) & (box[:, 3] >= position.lat - high)
        return tuple(self._zone(int(row)) for row in np.flatnonzero(near))

    def _zone(self, row: int) -> NearZone:
        table = self.table
        return NearZone(
            zone_id=int(table.ids[row]),
            name=table.names[row],
            polygon=self.polygons[row],
            floor_agl_m=float(table.floor_agl_m[row]),
            ceiling_agl_m=float(table.ceiling_agl_m[row]),
            spans=self.spans[row],
        )


def zones_about(now_s: float) -> ZonesAbout:
    """Return the prepared zones. Costs one small query until zones change."""
    table, known = zone_table(), getattr(_own, "zones", None)
    if known is None or known.table is not table or now_s >= known.until_s:
        known = _own.zones = ZonesAbout.of(table, now_s)
    return known
