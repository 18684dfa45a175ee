"""The last look before a plan leaves: no leg may meet a zone in space, height and time. Knows nothing of the graph, shares no code with it.

A leg is straight in lon/lat and as high as its ends and what lies between, give or take the terrain tolerance. Leg k leads from waypoint k
to waypoint k + 1; leg -1 is the column from the ground up to the first waypoint, and the leg after the last waypoint the column down to
the ground, or the place where the UAV stays.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

BoolArray = NDArray[np.bool_]
FloatArray = NDArray[np.float64]
Geometries = NDArray[np.object_]
Limits = tuple[float | None, str, float | None, str]  # lower [m] and from where it counts, upper [m] and from where

TAKE_OFF = -1  # number of the leg up to the first waypoint
EQUATOR_RADIUS_M, ECCENTRICITY_SQUARED = 6_378_137.0, 0.006694380  # WGS84
MIN_DEGREE_M = 110_574.0  # in a degree of latitude, on the equator
STRETCHED_EXCESS = 1.5  # a leg a degree of latitude from the others is off by less than that up to 70 degrees


class RouteMeetsZone(Exception):
    """A leg of a finished route meets a no-fly zone."""

    def __init__(self, zone: int, start: tuple[float, float], end: tuple[float, float]) -> None:
        super().__init__(f"the leg from {start} to {end} meets zone number {zone}")
        self.zone = zone
        self.start = start
        self.end = end


@dataclass(frozen=True)
class Margins:
    """What is kept from zones: metres to the side, metres below and above, seconds before and after; and how far heights may stray."""

    lateral_m: float = 0.0
    height_m: float = 0.0
    time_s: float = 0.0
    terrain_tolerance_m: float = 0.0


@dataclass(frozen=True, eq=False)
class FlownRoute:
    """A finished route, waypoint by waypoint; what is not known is None or NaN and may be anything.

    position float64 (n, 2), lon lat [deg]; agl_m and amsl_m float64 (n,); arrival_s float64 (n,), seconds since the epoch at which each
    waypoint is reached, departs_s when the UAV leaves the ground and ends_s when the route is over. lands: the route ends on the ground.
    """

    position: FloatArray
    agl_m: FloatArray
    amsl_m: FloatArray | None = None
    arrival_s: FloatArray | None = None
    departs_s: float | None = None
    ends_s: float | None = None
    lands: bool = False

    @property
    def window_s(self) -> tuple[float, float] | None:
        """From take-off to the end, in seconds since the epoch; None where any of it is not known."""
        if self.arrival_s is None or self.departs_s is None or self.ends_s is None or np.isnan(self.arrival_s).any():
            return None
        moments = [self.departs_s, self.ends_s, float(self.arrival_s.min()), float(self.arrival_s.max())]
        return min(moments), max(moments)


@dataclass(frozen=True, eq=False)
class ZoneFacts:
    """What zones state, row by row, both limits as heights above ground and above the sea; -inf and inf where they do not limit.

    polygons (z,) in lon/lat; the limits float64 (z,); spans: for each zone when it applies, (from, to) in seconds since the epoch without
    its end and without margin, None for always. They have to tell of all the time in which the routes are flown, and of the margin.
    """

    polygons: Geometries
    lower_agl_m: FloatArray
    lower_amsl_m: FloatArray
    upper_agl_m: FloatArray
    upper_amsl_m: FloatArray
    spans: tuple[tuple[tuple[float, float], ...] | None, ...]

    @classmethod
    def of(
        cls,
        polygons: Sequence[BaseGeometry] | Geometries,
        limits: Sequence[Limits],
        spans: Sequence[Sequence[tuple[float, float]] | None],
    ) -> "ZoneFacts":
        """From limits as zones state them: a limit that counts neither from the ground nor from the sea limits nothing."""
        if not len(polygons) == len(limits) == len(spans):
            raise ValueError("polygons, limits and spans are of the same length")
        lower = {reference: np.array([_stated(m, own, reference, -math.inf) for m, own, _, _ in limits]) for reference in ("AGL", "AMSL")}
        upper = {reference: np.array([_stated(m, own, reference, math.inf) for _, _, m, own in limits]) for reference in ("AGL", "AMSL")}
        return cls(
            np.array(polygons, dtype=object).reshape(-1),
            lower["AGL"], lower["AMSL"], upper["AGL"], upper["AMSL"],
            tuple(None if own is None else tuple((start, end) for start, end in own) for own in spans),
        )  # fmt: skip

    def __len__(self) -> int:
        return len(self.polygons)


@dataclass(frozen=True)
class Breach:
    """A leg that meets a zone or comes too near. zone is its row; heights above ground and times are the leg's, not the zone's.

    from_s and to_s: when both are there, margins included; None where the leg's time is not known.
    """

    leg: int
    zone: int
    low_agl_m: float
    high_agl_m: float
    distance_m: float
    from_s: float | None
    to_s: float | None


def breaches(route: FlownRoute, zones: ZoneFacts, margins: Margins) -> list[Breach]:
    """Every leg of a route that meets a zone, in the order of the route."""
    if not len(route.position) or not len(zones):
        return []
    near = _near_rows(route.position, zones.polygons, margins.lateral_m)
    if not len(near):
        return []
    legs = _Legs.of(route, margins)
    meets = legs.in_band(zones, near, margins.height_m)
    for place, row in enumerate(near.tolist()):
        meets[place] &= legs.in_time(zones.spans[row], margins.time_s)
    found = []
    for place, leg, distance_m in _meetings(legs.start, legs.end, zones.polygons[near], margins.lateral_m, meets):
        row = int(near[place])
        for from_s, to_s in legs.times_in(leg, zones.spans[row], margins.time_s):
            found.append(Breach(leg + TAKE_OFF, row, float(legs.low_agl_m[leg]), float(legs.high_agl_m[leg]), distance_m, from_s, to_s))
    return sorted(found, key=lambda breach: (breach.leg, breach.zone, breach.from_s or 0.0))


def legs_that_meet(line: FloatArray, zones: Sequence[BaseGeometry] | Geometries) -> list[tuple[int, int]]:
    """Pairs (leg, zone) that have a point in common at any height and time; line has shape (n, 2), a leg is straight in lon/lat."""
    polygons = np.array(zones, dtype=object).reshape(-1)
    if len(line) < 2 or not len(polygons):
        return []
    near = _near_rows(line, polygons, 0.0)
    anything = np.ones((len(near), len(line) - 1), dtype=bool)
    return [(leg, int(near[place])) for place, leg, _ in _meetings(line[:-1], line[1:], polygons[near], 0.0, anything)]


def refuse_legs_in_zones(line: FloatArray, zones: Sequence[BaseGeometry] | Geometries) -> None:
    """Raises RouteMeetsZone for the first leg on the way that meets a zone."""
    for leg, zone in sorted(legs_that_meet(line, zones)):
        raise RouteMeetsZone(zone, (float(line[leg][0]), float(line[leg][1])), (float(line[leg + 1][0]), float(line[leg + 1][1])))


@dataclass(frozen=True, eq=False)
class _Legs:
    """Legs with the columns at both ends, each between lowest and highest, earliest and latest; -inf and inf where that is not known."""

    start: FloatArray  # (legs, 2)
    end: FloatArray
    low_agl_m: FloatArray  # (legs,)
    high_agl_m: FloatArray
    low_amsl_m: FloatArray
    high_amsl_m: FloatArray
    from_s: FloatArray
    to_s: FloatArray

    @classmethod
    def of(cls, route: FlownRoute, margins: Margins) -> "_Legs":
        position = route.position[[0, *range(len(route.position)), -1]]
        agl_m = np.concatenate([[0.0], route.agl_m, [0.0 if route.lands else route.agl_m[-1]]])
        low_agl_m, high_agl_m = _between(agl_m, margins.terrain_tolerance_m)
        if route.amsl_m is None:
            amsl_m = np.full(len(agl_m), np.nan)
        else:
            ground_m = route.amsl_m[[0, -1]] - route.agl_m[[0, -1]]
            amsl_m = np.concatenate([ground_m[:1], route.amsl_m, ground_m[1:] if route.lands else route.amsl_m[-1:]])
        low_amsl_m, high_amsl_m = _between(amsl_m, margins.terrain_tolerance_m)
        from_s, to_s = _times(route)
        return cls(position[:-1], position[1:], low_agl_m, high_agl_m, low_amsl_m, high_amsl_m, from_s, to_s)

    def in_band(self, zones: ZoneFacts, rows: NDArray[np.intp], margin_m: float) -> BoolArray:
        """(rows, legs): whether each leg may be at a height of each zone."""

        def limit(values: FloatArray, margin: float) -> FloatArray:
            return values[rows][:, None] + margin

        in_band: BoolArray = (
            (self.high_agl_m >= limit(zones.lower_agl_m, -margin_m))
            & (self.high_amsl_m >= limit(zones.lower_amsl_m, -margin_m))
            & (self.low_agl_m <= limit(zones.upper_agl_m, margin_m))
            & (self.low_amsl_m <= limit(zones.upper_amsl_m, margin_m))
        )
        return in_band

    def in_time(self, spans: Sequence[tuple[float, float]] | None, margin_s: float) -> BoolArray:
        """(legs,): whether each may be flown while a zone applies."""
        if spans is None:
            return np.ones(len(self.from_s), dtype=bool)
        applies = np.zeros(len(self.from_s), dtype=bool)
        for start, end in spans:
            applies |= (self.from_s < end + margin_s) & (self.to_s >= start - margin_s)
        return applies | ~np.isfinite(self.from_s) & ~np.isfinite(self.to_s)

    def times_in(
        self, leg: int, spans: Sequence[tuple[float, float]] | None, margin_s: float
    ) -> Iterator[tuple[float | None, float | None]]:
        """When a leg is flown while the zone applies."""
        from_s, to_s = float(self.from_s[leg]), float(self.to_s[leg])
        if not math.isfinite(from_s) and not math.isfinite(to_s):
            yield None, None
            return
        for start, end in [(-math.inf, math.inf)] if spans is None else spans:
            if from_s < end + margin_s and to_s >= start - margin_s:
                first, last = max(from_s, start - margin_s), min(to_s, end + margin_s)
                yield first if math.isfinite(first) else None, last if math.isfinite(last) else None


def _stated(limit_m: float | None, own: str, reference: str, otherwise: float) -> float:
    return limit_m if limit_m is not None and own == reference and math.isfinite(limit_m) else otherwise


def _between(heights_m: FloatArray, tolerance_m: float) -> tuple[FloatArray, FloatArray]:
    low_m = np.minimum(heights_m[:-1], heights_m[1:]) - tolerance_m
    high_m = np.maximum(heights_m[:-1], heights_m[1:]) + tolerance_m
    return np.where(np.isnan(low_m), -np.inf, low_m), np.where(np.isnan(high_m), np.inf, high_m)


def _times(route: FlownRoute) -> tuple[FloatArray, FloatArray]:
    if route.arrival_s is None:
        count = len(route.position) + 1
        return np.full(count, -np.inf), np.full(count, np.inf)
    departs_s = np.nan if route.departs_s is None else route.departs_s
    ends_s = np.nan if route.ends_s is None else route.ends_s
    moments = np.concatenate([[departs_s], route.arrival_s, [ends_s]])
    start_s, end_s = np.where(np.isnan(moments[:-1]), -np.inf, moments[:-1]), np.where(np.isnan(moments[1:]), np.inf, moments[1:])
    return np.minimum(start_s, end_s), np.maximum(start_s, end_s)


def _near_rows(line: FloatArray, polygons: Geometries, lateral_m: float) -> NDArray[np.intp]:
    """Rows of the zones whose box comes within the clearance of the line's."""
    wide = _reach_deg(line, lateral_m)
    west, south = (line.min(axis=0) - wide).tolist()
    east, north = (line.max(axis=0) + wide).tolist()
    boxes = shapely.bounds(polygons)
    return np.flatnonzero((boxes[:, 0] <= east) & (boxes[:, 2] >= west) & (boxes[:, 1] <= north) & (boxes[:, 3] >= south))


def _reach_deg(line: FloatArray, lateral_m: float) -> FloatArray:
    """How many degrees of longitude and latitude the clearance is at most."""
    farthest_lat = min(float(np.abs(line[:, 1]).max()), 89.0)
    reach: FloatArray = np.array([1.0 / math.cos(math.radians(farthest_lat)), 1.0]) * lateral_m / MIN_DEGREE_M
    return reach


def _meetings(
    start: FloatArray, end: FloatArray, polygons: Geometries, lateral_m: float, asked: BoolArray
) -> Iterator[tuple[int, int, float]]:
    """(zone, leg, metres between) of the pairs asked for, (zones, legs), that meet or are nearer than the clearance."""
    wide = _reach_deg(np.concatenate([start, end]), lateral_m)
    low, high = np.minimum(start, end) - wide, np.maximum(start, end) + wide
    boxes = shapely.bounds(polygons)
    asked = asked & (
        (low[:, 0] <= boxes[:, 2, None]) & (high[:, 0] >= boxes[:, 0, None])
        & (low[:, 1] <= boxes[:, 3, None]) & (high[:, 1] >= boxes[:, 1, None])
    )  # fmt: skip
    for zone in np.flatnonzero(asked.any(axis=1)).tolist():
        legs = np.flatnonzero(asked[zone])
        drawn = _drawn(start[legs], end[legs])
        own = shapely.transform(polygons[zone], np.array)  # prepared polygons are for one thread at a time
        shapely.prepare(own)
        meets = shapely.intersects(own, drawn)
        for leg in legs[meets].tolist():
            yield zone, leg, 0.0
        if lateral_m > 0 and not meets.all():
            beside, apart_m = _beside(own, drawn[~meets], lateral_m)
            for leg, distance_m in zip(legs[~meets][beside].tolist(), apart_m.tolist(), strict=True):
                if distance_m < lateral_m:
                    yield zone, leg, distance_m


def _drawn(start: FloatArray, end: FloatArray) -> Geometries:
    """Legs as lines, and those that only climb or stay as points."""
    drawn = np.array(shapely.points(start), dtype=object)
    moves = (start != end).any(axis=1)
    if moves.any():
        drawn[moves] = shapely.linestrings(np.stack([start[moves], end[moves]], axis=1))
    return drawn


def _beside(polygon: BaseGeometry, legs: Geometries, lateral_m: float) -> tuple[NDArray[np.intp], FloatArray]:
    """Places of the legs that may be nearer to a polygon than the clearance, and the metres between.

    What is nearest is found in a plane stretched for the latitude where the legs are, and measured at its place.
    """
    middle = math.radians(float(np.median(shapely.get_coordinates(legs)[:, 1])))
    stretch = np.array([math.cos(middle), 1.0])
    flat_legs = shapely.transform(legs, lambda places: places * stretch)
    flat = shapely.transform(polygon, lambda places: places * stretch)
    shapely.prepare(flat)
    beside = np.flatnonzero(shapely.dwithin(flat, flat_legs, STRETCHED_EXCESS * lateral_m / MIN_DEGREE_M))
    ends = shapely.get_coordinates(shapely.shortest_line(flat, flat_legs[beside])).reshape(-1, 2, 2) / stretch
    latitude = np.radians(ends[:, :, 1].mean(axis=1))
    flattening = 1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2
    east_m = np.radians(ends[:, 1, 0] - ends[:, 0, 0]) * EQUATOR_RADIUS_M / np.sqrt(flattening) * np.cos(latitude)
    north_m = np.radians(ends[:, 1, 1] - ends[:, 0, 1]) * EQUATOR_RADIUS_M * (1.0 - ECCENTRICITY_SQUARED) / flattening**1.5
    return beside, np.hypot(east_m, north_m)
