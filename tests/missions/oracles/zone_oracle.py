"""Judges where, how high and when legs meet zones, by the rows of the database: geometry in metres of a plane around the region."""

import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, timedelta
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import shapely

from inspection.models import NoFlyZone
from tests.missions.oracles.schedule_oracle import applies_at
from tests.missions.plane import EARTH_M

STEP_S = 30  # between the moments that are looked at
Between = tuple[float, float]


class Margins(NamedTuple):
    """What is to be kept from zones."""

    lateral_m: float
    height_m: float
    time_s: float


KEPT = Margins(11.3, 19.9, 299.0)  # of 12 m, of 10 m and 10 m that a height may stray, of 5 min; the rest is what the plane is wrong by
# What keeps off may be as wide as that: waypoints may lie 10 m higher than they have to, and another formula of the sun is 4 min off at
# both ends.
WIDER = Margins(13.2, 30.2, 800.0)


class Leg(NamedTuple):
    """A straight piece of a route, lon lat [deg], between lowest and highest above ground and above the sea, earliest and latest.

    amsl_m None: not known; times None: at any time.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    agl_m: Between
    amsl_m: Between | None
    times: tuple[datetime, datetime] | None


class ZoneJudge:
    """Of the zones that are in the database now."""

    def __init__(self) -> None:
        self.zones = list(NoFlyZone.objects.order_by("pk"))
        shapes = [shapely.from_wkb(bytes(zone.geometry.wkb)) for zone in self.zones]
        west, south, east, north = shapely.total_bounds(shapes)
        self.origin = np.array([(west + east) / 2, (south + north) / 2])
        self.shapes = np.array([shapely.transform(shape, self.metres) for shape in shapes], dtype=object)
        self.tree = shapely.STRtree(self.shapes)
        self.centres = [(shape.centroid.x, shape.centroid.y) for shape in shapes]
        self.seen_beside_height = 0
        self.seen_beside_time = 0
        self._applies: dict[tuple[int, int, bool], bool] = {}

    def metres(self, places: Any) -> Any:
        degree_m = math.radians(1.0) * EARTH_M
        return (np.asarray(places) - self.origin) * (degree_m * math.cos(math.radians(self.origin[1])), degree_m)

    def met(self, legs: Sequence[Leg], margins: Margins = KEPT) -> Iterator[tuple[int, NoFlyZone]]:
        """Each leg, by its number, with each zone that it meets or comes too near."""
        if not legs:
            return
        lines = shapely.linestrings(self.metres(np.array([[leg.start, leg.end] for leg in legs])).reshape(-1, 2, 2))
        near, zones = self.tree.query(lines, predicate="dwithin", distance=margins.lateral_m)
        for number, zone in zip(near.tolist(), zones.tolist(), strict=True):
            leg = legs[number]
            if not self.is_at_height(self.zones[zone], leg.agl_m, leg.amsl_m, margins):
                self.seen_beside_height += 1
            elif leg.times is not None and not self.applies_between(zone, *leg.times, margins):
                self.seen_beside_time += 1
            else:
                yield number, self.zones[zone]

    def is_at_height(self, zone: NoFlyZone, agl_m: Between, amsl_m: Between | None, margins: Margins = KEPT) -> bool:
        """What cannot be compared is at every height."""
        counted = {"AGL": agl_m, "AMSL": amsl_m}
        lower, upper = counted.get(zone.lower_reference), counted.get(zone.upper_reference)
        is_below = zone.lower_limit_m is not None and lower is not None and lower[1] + margins.height_m < zone.lower_limit_m
        is_above = zone.upper_limit_m is not None and upper is not None and upper[0] - margins.height_m > zone.upper_limit_m
        return not is_below and not is_above

    def applies_between(self, zone: int, begin: datetime, end: datetime, margins: Margins = KEPT) -> bool:
        """At the first moment, at the last, or at a half minute between."""
        schedule = self.zones[zone].schedule
        if schedule is None:
            return True
        first, last = begin - timedelta(seconds=margins.time_s), end + timedelta(seconds=margins.time_s)
        is_wide = margins.time_s > KEPT.time_s
        if any(applies_at(schedule, moment, *self.centres[zone], is_wide=is_wide) for moment in (first, last)):
            return True
        halves = range(math.ceil(first.timestamp() / STEP_S), math.floor(last.timestamp() / STEP_S) + 1)
        return any(self._applies_at_half(zone, half, is_wide) for half in halves)

    def _applies_at_half(self, zone: int, half: int, is_wide: bool) -> bool:
        """The same of a half minute since the epoch, kept."""
        found = self._applies.get((zone, half, is_wide))
        if found is None:
            moment = datetime.fromtimestamp(half * STEP_S, UTC)
            found = self._applies[zone, half, is_wide] = applies_at(self.zones[zone].schedule, moment, *self.centres[zone], is_wide=is_wide)
        return found

    def lie_near(self, shape: Any, distance_m: float) -> list[int]:
        """Zones, by their numbers, within so many metres of a shape in lon/lat."""
        found: list[int] = self.tree.query(shapely.transform(shape, self.metres), predicate="dwithin", distance=distance_m).tolist()
        return found


def legs_of(route: dict[str, Any], departs_at: datetime | None, ends_s: float, tops_m: dict[int, float]) -> list[Leg]:
    """The legs of a route with the columns at both ends and at the towers where it charges, whose tops above ground are by their waypoints.

    ends_s: until when after the departure it is in the air.
    """
    waypoints = route["waypoints"]
    if not waypoints:
        return []
    places = [tuple(waypoint["position"]) for waypoint in waypoints]
    agl_m = [waypoint["altitude_agl_m"] for waypoint in waypoints]
    amsl_m = [waypoint["altitude_amsl_m"] for waypoint in waypoints]
    is_known = None not in amsl_m
    lands = route["end_action"] != "hover"
    ground = (amsl_m[0] - agl_m[0], amsl_m[-1] - agl_m[-1]) if is_known else (None, None)
    places = [places[0], *places, places[-1]]
    agl_m = [0.0, *agl_m, 0.0 if lands else agl_m[-1]]
    amsl_m = [ground[0], *amsl_m, ground[1] if lands else amsl_m[-1]]
    moments: list[datetime] = []
    if departs_at is not None:
        assert len(route["arrival_s"]) == len(waypoints)
        seconds = [route["departs_s"], *route["arrival_s"], max(ends_s, route["departs_s"] + route["duration_s"])]
        assert all(later >= sooner - 0.11 for sooner, later in pairwise(seconds)), seconds
        moments = [departs_at + timedelta(seconds=second) for second in seconds]

    def between(values: list[Any], leg: int) -> Between | None:
        return (min(values[leg : leg + 2]), max(values[leg : leg + 2])) if values[leg] is not None else None

    legs = []
    for leg in range(len(places) - 1):
        above_sea = between(amsl_m, leg) if is_known else None
        legs.append(Leg(places[leg], places[leg + 1], between(agl_m, leg), above_sea, tuple(moments[leg : leg + 2]) or None))
    for stop in route["charging"]:
        number = stop["waypoint"] + 1
        down_m = agl_m[number] - tops_m[stop["waypoint"]]
        column = (tops_m[stop["waypoint"]], agl_m[number])
        above_sea = (amsl_m[number] - down_m, amsl_m[number]) if is_known else None
        times = (moments[number], moments[number] + timedelta(seconds=stop["stopped_s"])) if moments else None
        legs.append(Leg(places[number], places[number], column, above_sea, times))
    return legs
