"""Closest approach of a flight to obstacles and zones."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.zones.reach import HeightLimits, ZoneTable
from mavlink.approved_route import photo_clearances_m
from simulation.assessment.flown import BoolArray, FloatArray, FlownFlight, FlownTrack

LOOK_M = 60.0  # horizontal; approaches beyond it are not reported


@dataclass(frozen=True, eq=False)
class Standing:
    """k spans from top to top; a single object has equal ends. Wires are assumed straight between the tops, their highest position.

    start, end (k, 2) lon, lat [deg]; start_top_m, end_top_m (k,) AMSL, or above the assumed flat ground.
    """

    start: FloatArray
    end: FloatArray
    start_top_m: FloatArray
    end_top_m: FloatArray

    def __len__(self) -> int:
        return len(self.start)


@dataclass(frozen=True)
class Approach:
    """The closest moment: distance, time, and the waypoint flown to.

    is_column: above its take-off or landing place. kept_m: what a flight through photos has to keep there.
    """

    away_m: float
    t_s: float
    waypoint: int
    position: LonLat
    is_column: bool = False
    kept_m: float | None = None


@dataclass(frozen=True)
class StandingApproaches:
    """The closest approaches to a tower or wire: en route, above the places of take-off and landing, and in flights through photos.

    Of the latter it is where most is missing of what they have to keep. None beyond LOOK_M, or where nothing of the kind is flown.
    """

    way: Approach | None = None
    column: Approach | None = None
    photos: Approach | None = None

    def __iter__(self) -> Iterator[Approach]:
        return (one for one in (self.way, self.column, self.photos) if one is not None)


def lowest_of(flown: FlownFlight, ground_amsl_m: FloatArray, *, column_m: float, photos: bool) -> Approach | None:
    """Return the lowest height above ground outside the columns of take-off and landing; None if the ground is unknown there.

    photos: of flights through photos, else of all but these.
    """
    track = flown.track
    if track is None:
        return None
    kept_m = photo_clearances_of(flown, track)
    own = track.is_in_air & ~in_columns(flown, column_m) & (np.isnan(kept_m) != photos)
    away_m = np.where(own, track.amsl_m - ground_amsl_m, np.nan)
    if np.isnan(away_m).all():
        return None
    row = int(np.nanargmin(away_m))
    return replace(_approach(track, row, float(away_m[row])), kept_m=float(kept_m[row]) if photos else None)


def photo_clearances_of(flown: FlownFlight, track: FlownTrack) -> FloatArray:
    """Return (n,) what the flight through photos keeps from wires and supports at each moment; NaN outside of these."""
    kept_m = photo_clearances_m(flown.flight.waypoints)
    return np.array([kept_m.get(waypoint, np.nan) for waypoint in track.waypoint.tolist()], dtype=np.float64)


def nearest_standing(flown: FlownFlight, standing: Standing, *, column_m: float) -> StandingApproaches:
    """Return the closest approaches to towers and wires.

    As sags are unknown, an obstacle is a wall from the ground to its top: above it the vertical distance counts, beside it the horizontal.
    """
    track = flown.track
    if track is None or not len(standing) or not track.is_in_air.any():
        return StandingApproaches()
    rows = np.flatnonzero(track.is_in_air)
    frame = LocalFrame.around(*track.position[rows].mean(axis=0).tolist())
    flat, start, end = (frame.to_metres(places) for places in (track.position[rows], standing.start, standing.end))
    (west, south), (east, north) = flat.min(axis=0) - LOOK_M, flat.max(axis=0) + LOOK_M
    low, high = np.minimum(start, end), np.maximum(start, end)
    near = np.flatnonzero((low[:, 0] <= east) & (high[:, 0] >= west) & (low[:, 1] <= north) & (high[:, 1] >= south))
    if not len(near):
        return StandingApproaches()
    lines = np.array(shapely.linestrings(np.stack([start[near], end[near]], axis=1)), dtype=object).reshape(-1)
    moment, span = shapely.STRtree(lines).query(shapely.points(flat), predicate="dwithin", distance=LOOK_M)
    if not len(moment):
        return StandingApproaches()
    away_m = _from_obstacles(flat[moment], track.amsl_m[rows[moment]], start, end, standing, near[span])
    at = rows[moment]
    is_column, kept_m = in_columns(flown, column_m)[at], photo_clearances_of(flown, track)[at]
    is_photo = ~np.isnan(kept_m)

    def nearest(mask: BoolArray, short_m: FloatArray) -> Approach | None:
        own = np.where(mask, short_m, math.inf)
        best = int(np.argmin(own))
        return None if math.isinf(own[best]) else _approach(track, int(at[best]), float(away_m[best]))

    way, column, photo = nearest(~is_column & ~is_photo, away_m), nearest(is_column & ~is_photo, away_m), nearest(is_photo, away_m - kept_m)
    return StandingApproaches(
        way,
        None if column is None else replace(column, is_column=True),
        None if photo is None else replace(photo, kept_m=photo_clearances_m(flown.flight.waypoints)[photo.waypoint]),
    )


def in_columns(flown: FlownFlight, column_m: float) -> BoolArray:
    """Return (n,) whether each moment is above the flight's take-off or landing place."""
    track = flown.track
    assert track is not None  # noqa: S101 - checked by callers
    ends = [np.array(flown.flight.take_off.position)]
    if track.is_coming_down.any():
        ends.append(track.position[np.flatnonzero(track.is_coming_down)[-1]])
    frame = LocalFrame.around(*flown.flight.take_off.position)
    flat = frame.to_metres(track.position)
    inside = np.zeros(len(track), dtype=bool)
    for end in ends:
        inside |= np.hypot(*(flat - frame.to_metres(end[None, :])).T) <= column_m
    return inside


def _from_obstacles(
    flat: FloatArray, amsl_m: FloatArray, start: FloatArray, end: FloatArray, standing: Standing, span: FloatArray
) -> FloatArray:
    along = end[span] - start[span]
    squared = (along**2).sum(axis=1)
    share = np.clip(((flat - start[span]) * along).sum(axis=1) / np.maximum(squared, 1e-9), 0.0, 1.0)
    beside_m = np.hypot(*(flat - (start[span] + share[:, None] * along)).T)
    top_m = standing.start_top_m[span] + share * (standing.end_top_m[span] - standing.start_top_m[span])
    away_m: FloatArray = np.hypot(beside_m, np.maximum(np.nan_to_num(amsl_m - top_m, nan=0.0), 0.0))
    return away_m


def _approach(track: FlownTrack, row: int, away_m: float) -> Approach:
    lon, lat = track.position[row].tolist()
    return Approach(away_m, float(track.t_s[row]), int(track.waypoint[row]), LonLat(lon, lat))


NEAR_DEG = 0.02  # some 2 km: zones beyond it are not reported


@dataclass(frozen=True)
class ZoneApproach:
    """The closest approach of a flight to a zone in force.

    beside_m is the horizontal distance, 0 above, below or inside it. height_m is the distance below or above its limits, 0 within them.
    Both are 0 inside the zone.
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
    """Return the closest approach to each zone near the flight, the nearest zone first.

    ground_amsl_m (n,): below each moment, NaN if unknown. departs_s: the mission's departure [Unix s]; None: it may fly at any time, so
    every zone counts as in force.
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
    """Return (zones, n) whether each zone is in force at each moment, by its schedule."""
    if departs_s is None:
        return np.ones((len(table), len(t_s)), dtype=bool)
    moments = departs_s + t_s
    found = np.zeros((len(table), len(t_s)), dtype=bool)
    for zone, spans in enumerate(table.stated_spans(float(moments.min()) - 1.0, float(moments.max()) + 1.0)):
        for span in spans:
            found[zone] |= (moments >= span.from_s) & (moments < span.to_s)
    return found


def _outside_m(limits: HeightLimits, amsl_m: FloatArray, agl_m: FloatArray) -> FloatArray:
    """Return (n,) the distance below the lower or above the upper limit; a limit that cannot be compared is unbounded."""
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
