"""How near flights came to no-fly zones: each moment against each zone as it is stated, at its time and height.

Shares no code with the planner's own look (planning/clearance/zone_clearance.py): a moment is a point, not a leg, and heights are the
flown ones, above the ground that is below them then.
"""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from inspection.geodesy.local_frame import LocalFrame
from inspection.zones.reach import Limits, ZoneTable
from simulation.assessment.flown import BoolArray, FloatArray, FlownTrack

NEAR_DEG = 0.02  # some 2 km: farther zones are not told of


@dataclass(frozen=True)
class ZoneApproach:
    """The nearest that a flight came to a zone while it was in force.

    beside_m is across the ground, 0 over, under or in it; height_m how far below or above its limits, 0 within them. Both 0: in it.
    """

    zone: int
    name: str
    beside_m: float
    height_m: float
    t_s: float
    waypoint: int

    @property
    def away_m(self) -> float:
        return math.hypot(self.beside_m, self.height_m)

    @property
    def is_inside(self) -> bool:
        return self.beside_m == 0.0 and self.height_m == 0.0


def zone_approaches(track: FlownTrack, ground_amsl_m: FloatArray, table: ZoneTable, departs_s: float | None) -> list[ZoneApproach]:
    """The nearest moment of each zone near the flight, the nearest zone first.

    ground_amsl_m (n,): below each moment, NaN where it is not known. departs_s: the mission's departure, seconds since the epoch; None:
    it may fly at any time, so every zone is taken to be in force.
    """
    rows = np.flatnonzero(track.is_in_air)
    if not len(rows) or not len(table):
        return []
    places = track.position[rows]
    (west, south), (east, north) = places.min(axis=0) - NEAR_DEG, places.max(axis=0) + NEAR_DEG
    box = table.box
    near = np.flatnonzero((box[:, 0] <= east) & (box[:, 2] >= west) & (box[:, 1] <= north) & (box[:, 3] >= south))
    if not len(near):
        return []
    table = table.only(np.isin(np.arange(len(table)), near))
    frame = LocalFrame.around(*places.mean(axis=0).tolist())
    points = shapely.points(frame.to_metres(places))
    amsl_m, agl_m = track.amsl_m[rows], track.amsl_m[rows] - ground_amsl_m[rows]
    in_force = _in_force(table, track.t_s[rows], departs_s)
    found = []
    for zone, polygon in enumerate(table.polygons):
        if not in_force[zone].any():
            continue
        flat = shapely.transform(polygon, frame.to_metres)
        beside_m = shapely.distance(flat, points)
        height_m = _outside_m(table.limits[zone], amsl_m, agl_m)
        away_m = np.where(in_force[zone], np.hypot(beside_m, height_m), np.inf)
        row = int(np.argmin(away_m))
        found.append(
            ZoneApproach(
                int(table.ids[zone]), table.names[zone], float(beside_m[row]), float(height_m[row]), float(track.t_s[rows[row]]),
                int(track.waypoint[rows[row]]),
            )
        )  # fmt: skip
    return sorted(found, key=lambda approach: approach.away_m)


def _in_force(table: ZoneTable, t_s: FloatArray, departs_s: float | None) -> BoolArray:
    """(zones, n): whether each is in force, as its schedule states, at each moment."""
    if departs_s is None:
        return np.ones((len(table), len(t_s)), dtype=bool)
    moments = departs_s + t_s
    found = np.zeros((len(table), len(t_s)), dtype=bool)
    for zone, spans in enumerate(table.stated_spans(float(moments.min()) - 1.0, float(moments.max()) + 1.0)):
        for span in spans:
            found[zone] |= (moments >= span.from_s) & (moments < span.to_s)
    return found


def _outside_m(limits: Limits, amsl_m: FloatArray, agl_m: FloatArray) -> FloatArray:
    """(n,): how far below the lower or above the upper limit; a limit that cannot be compared reaches everywhere."""
    below = np.zeros(len(amsl_m))
    above = np.zeros(len(amsl_m))
    if (height_m := _height(limits.lower_reference, amsl_m, agl_m)) is not None and limits.lower_m is not None:
        below = np.nan_to_num(limits.lower_m - height_m, nan=0.0)
    if (height_m := _height(limits.upper_reference, amsl_m, agl_m)) is not None and limits.upper_m is not None:
        above = np.nan_to_num(height_m - limits.upper_m, nan=0.0)
    outside: FloatArray = np.maximum(np.maximum(below, above), 0.0)
    return outside


def _height(reference: str, amsl_m: FloatArray, agl_m: FloatArray) -> FloatArray | None:
    return agl_m if reference == "AGL" else amsl_m if reference == "AMSL" else None
