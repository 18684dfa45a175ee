"""Judges finished plans by the rows of the database and arithmetic of its own: it shares no code with the planner or its last look.

Geometry is done in metres of a plane around the region, heights and times waypoint by waypoint, schedules instant by instant, the sun by
the short sunrise equation.
"""

import math
from collections.abc import Iterator
from datetime import UTC, date, datetime, timedelta
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from django.contrib.gis.geos import Polygon

from inspection.models import Asset, NoFlyZone
from missions.services import PlanRequest
from tests.missions.clock_judge import too_near, wrong_clocks
from tests.missions.plane import EARTH_M, apart_m

LATERAL_M = 4.7  # of the 5 m that are kept; the rest is what the plane is wrong by
HEIGHT_M = 19.9  # of 10 m of margin and 10 m that a height may stray
TIME_S = 299.0
STEP_S = 30.0  # between the moments that are looked at
DIRECT_M = 4_900.0  # of the 5 km that a UAV may fly straight
ACCESS_M = 9_800.0  # of the 10 km that it may fly to the network
OFF_NETWORK_FACTOR = 2.0  # what a metre away from infrastructure costs
LONGEST_FLIGHT_S = 4 * 3_600.0
DAYS = ("MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN")
HIGHEST_AGL_M = 120.0
TALLEST_M = 105.0  # an asset that is flown over with 15 m to spare


class Judge:
    """Of all plans on the zones that are in the database now."""

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

    def metres(self, places: Any) -> Any:
        degree_m = math.radians(1.0) * EARTH_M
        return (np.asarray(places) - self.origin) * (degree_m * math.cos(math.radians(self.origin[1])), degree_m)

    def faults(self, request: PlanRequest, plan: dict[str, Any]) -> list[str]:
        """All that is wrong with a plan."""
        of_zones = [*self._crossings(request, plan), *self._untrue(request, plan)]
        return [*of_zones, *_wrong_routes(request, plan), *wrong_clocks(request, plan), *too_near(plan)]

    # --- no leg in a zone -----------------------------------------------------------------------------------------------------

    def _crossings(self, request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
        for route in plan["routes"]:
            legs = list(_legs(route, request.departs_at))
            if not legs:
                continue
            lines = shapely.linestrings(self.metres(np.array([[start, end] for start, end, *_ in legs])).reshape(-1, 2, 2))
            near, zones = self.tree.query(lines, predicate="dwithin", distance=LATERAL_M)
            for leg, zone in zip(near.tolist(), zones.tolist(), strict=True):
                start, _end, heights, times = legs[leg]
                if not self._is_at_height(self.zones[zone], *heights):
                    self.seen_beside_height += 1
                elif times is not None and not self._applies_between(zone, *times):
                    self.seen_beside_time += 1
                else:
                    yield f"{route['uav']} meets {self.zones[zone].name} on the leg from {start}, {heights}, {times}"

    def _is_at_height(self, zone: NoFlyZone, agl_m: tuple[float, float], amsl_m: tuple[float, float] | None) -> bool:
        """What cannot be compared is at every height."""
        counted = {"AGL": agl_m, "AMSL": amsl_m}
        lower, upper = counted.get(zone.lower_reference), counted.get(zone.upper_reference)
        is_below = zone.lower_limit_m is not None and lower is not None and lower[1] + HEIGHT_M < zone.lower_limit_m
        is_above = zone.upper_limit_m is not None and upper is not None and upper[0] - HEIGHT_M > zone.upper_limit_m
        return not is_below and not is_above

    def _applies_between(self, zone: int, begin: datetime, end: datetime) -> bool:
        schedule = self.zones[zone].schedule
        if schedule is None:
            return True
        moments = int(((end - begin).total_seconds() + 2 * TIME_S) // STEP_S) + 2
        first = begin - timedelta(seconds=TIME_S)
        last = end + timedelta(seconds=TIME_S)
        return any(
            applies_at(schedule, min(first + timedelta(seconds=STEP_S * number), last), *self.centres[zone]) for number in range(moments)
        )

    # --- what is refused cannot be done ---------------------------------------------------------------------------------------

    def _untrue(self, request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
        grounded = {warning["uav"] for warning in plan["warnings"] if warning["code"] == "uav_inside_zone"}
        for uav in grounded:
            if not self._bars(shapely.Point(request.uavs[uav].position), request, 0.0, HIGHEST_AGL_M):
                yield f"{request.uavs[uav].name} stands in no zone"
        for item in plan["unassigned"]:
            course = _course_of(request, item["target"])
            yield from (f"target {item['target']} is not {item['reason']}: {why}" for why in self._untrue_reason(request, item, course))
            if item["reason"] in {"no_path", "beyond_range", "beyond_energy", "too_far_from_network"} and course.geom_type == "Point":
                yield from self._could_be_done(request, plan, course, item, grounded)

    def _untrue_reason(self, request: PlanRequest, item: dict[str, Any], course: Any) -> Iterator[str]:
        reason = item["reason"]
        if reason == "inside_zone" and not self._bars(course, request, 0.0, HIGHEST_AGL_M):
            yield "no zone is there"
        elif reason == "beyond_range" and all(uav.max_range_m is None for uav in request.uavs):
            yield "no UAV has a range"
        elif reason == "above_height_limit" and _tallest_m(request, item["target"]) <= TALLEST_M:
            yield "it is not that tall"
        elif reason == "too_far_from_network" and course.geom_type == "Point" and self._network_near(course):
            yield "there is a free tower near it"
        elif reason == "beyond_energy" and all(uav.performance.battery_wh is None for uav in request.uavs):
            yield "no UAV has a battery"
        elif reason not in {"inside_zone", "beyond_range", "beyond_energy", "above_height_limit", "too_far_from_network", "no_path"}:
            yield "that is no reason here"

    def _bars(self, course: Any, request: PlanRequest, low_m: float, high_m: float) -> bool:
        """Whether a zone that a flight could meet there lies within its clearance, at some time of the flight."""
        drawn = shapely.transform(course, self.metres)
        near = self.tree.query(drawn, predicate="dwithin", distance=5.5)
        begin = request.departs_at
        return any(
            self._is_at_height(self.zones[zone], (low_m, high_m), None)
            and (begin is None or self._applies_between(zone, begin, begin + timedelta(seconds=LONGEST_FLIGHT_S)))
            for zone in near.tolist()
        )

    def _network_near(self, course: Any) -> bool:
        """Whether a tower outside all zones stands near enough to fly from."""
        lon, lat = course.x, course.y
        wide = 0.15
        towers = Asset.objects.filter(
            kind="tower", is_flyable=True, vanished_at=None, line__isnull=False, height_m=None,
            centre__within=_box(lon - wide, lat - wide, lon + wide, lat + wide),
        ).values_list("centre", flat=True)[:500]  # fmt: skip
        places = self.metres(np.array([tower.coords for tower in towers]).reshape(-1, 2))
        free = np.ones(len(places), dtype=bool)
        free[self.tree.query(shapely.points(places), predicate="dwithin", distance=10.0)[0]] = False
        return bool((np.hypot(*(places - self.metres((lon, lat))).T)[free] < ACCESS_M).any())

    def _could_be_done(
        self, request: PlanRequest, plan: dict[str, Any], course: Any, item: dict[str, Any], grounded: set[int]
    ) -> Iterator[str]:
        """A UAV that does nothing could fly there straight, free of all zones at all heights, and back where it has to.

        A way that the planner finds cheaper, along infrastructure, may be up to twice as long as the straight one.
        """
        place = np.array([course.x, course.y])
        for number, (uav, route) in enumerate(zip(request.uavs, plan["routes"], strict=True)):
            is_limited = uav.performance.battery_wh is not None or uav.performance.max_airspeed_mps is not None
            if route["targets"] or number in grounded or route["end_action"] == "base" or is_limited:
                continue
            start = np.array(uav.position)
            way_m = apart_m(start, place)
            needed_m = way_m * (2.0 if route["end_action"] == "return" else 1.0)
            if way_m > DIRECT_M or (uav.max_range_m is not None and needed_m * OFF_NETWORK_FACTOR * 1.005 > uav.max_range_m):
                continue
            if not len(self.tree.query(shapely.LineString(self.metres(np.array([start, place]))), predicate="dwithin", distance=10.0)):
                yield f"target {item['target']} is not {item['reason']}: {uav.name} is idle and could fly there straight, {way_m:.0f} m"


# --- routes -------------------------------------------------------------------------------------------------------------------


def _legs(route: dict[str, Any], departs_at: datetime | None) -> Iterator[tuple[Any, Any, Any, Any]]:
    """(start, end, ((lowest, highest) AGL, the same AMSL or None), (begin, end) or None), with the columns at both ends."""
    waypoints = route["waypoints"]
    if not waypoints:
        return
    places = [tuple(waypoint["position"]) for waypoint in waypoints]
    agl_m = [waypoint["altitude_agl_m"] for waypoint in waypoints]
    amsl_m = [waypoint["altitude_amsl_m"] for waypoint in waypoints]
    is_known = None not in amsl_m
    lands = route["end_action"] != "hover"
    places = [places[0], *places, places[-1]]
    ground = (amsl_m[0] - agl_m[0], amsl_m[-1] - agl_m[-1]) if is_known else (None, None)
    agl_m = [0.0, *agl_m, 0.0 if lands else agl_m[-1]]
    amsl_m = [ground[0], *amsl_m, ground[1] if lands else amsl_m[-1]]
    moments: list[datetime] = []
    if departs_at is not None:
        assert len(route["arrival_s"]) == len(waypoints)
        seconds = [route["departs_s"], *route["arrival_s"], route["departs_s"] + route["duration_s"]]
        assert all(later >= sooner - 0.11 for sooner, later in pairwise(seconds)), seconds
        moments = [departs_at + timedelta(seconds=second) for second in seconds]
    for leg in range(len(places) - 1):
        low_high = [
            (min(values[leg : leg + 2]), max(values[leg : leg + 2])) if values[leg] is not None else None for values in (agl_m, amsl_m)
        ]
        yield places[leg], places[leg + 1], (low_high[0], low_high[1] if is_known else None), tuple(moments[leg : leg + 2]) or None


def _wrong_routes(request: PlanRequest, plan: dict[str, Any]) -> Iterator[str]:
    """Each target once; targets where they are; lengths and ranges kept."""
    visited = [target for route in plan["routes"] for target in route["targets"]]
    if sorted(visited + [item["target"] for item in plan["unassigned"]]) != list(range(len(request.targets))):
        yield "a target is visited twice or forgotten"
    for uav, route in zip(request.uavs, plan["routes"], strict=True):
        places = [waypoint["position"] for waypoint in route["waypoints"]]
        flown_m = sum(apart_m(start, end) for start, end in pairwise(places))
        if abs(flown_m - route["length_m"]) > 0.006 * flown_m + 0.01:
            yield f"{uav.name} flies {flown_m:.0f} m, not {route['length_m']:.0f} m"
        if uav.max_range_m is not None and route["length_m"] > uav.max_range_m:
            yield f"{uav.name} flies farther than it can"
        if places and apart_m(places[0], uav.position) > 1.0:
            yield f"{uav.name} does not start where it stands"
        if places and route["end_action"] == "return" and apart_m(places[-1], uav.position) > 1.0:
            yield f"{uav.name} does not return"
        at = {waypoint["target"]: waypoint["position"] for waypoint in route["waypoints"] if waypoint["kind"] == "target"}
        if set(at) != set(route["targets"]):
            yield f"{uav.name} does not fly to its targets"
        for target, place in at.items():
            course = _course_of(request, target)
            if course.geom_type == "Point" and apart_m(place, course.coords[0]) > 120.0:  # a place is taken to the line that it is on
                yield f"target {target} is elsewhere"


def _course_of(request: PlanRequest, target: int) -> Any:
    """What is to be inspected: a point, or a whole line."""
    asked = request.targets[target]
    if asked.position is not None:
        return shapely.Point(asked.position)
    asset = Asset.objects.get(pk=asked.asset)
    if asset.kind in {"line", "railway"}:
        return shapely.from_wkb(bytes(asset.geometry.wkb))
    return shapely.Point(asset.centre.coords)


def _tallest_m(request: PlanRequest, target: int) -> float:
    asked = request.targets[target]
    if asked.asset is None:
        return 0.0
    heights = Asset.objects.filter(pk=asked.asset).values_list("height_m", "supports__height_m")
    return max((height for row in heights for height in row if height is not None), default=0.0)


def _box(*edges: float) -> Any:
    return Polygon.from_bbox(edges)


# --- schedules ----------------------------------------------------------------------------------------------------------------


def applies_at(schedule: list[dict[str, Any]], when: datetime, lon: float, lat: float) -> bool:
    """Whether a zone applies at a moment; where the sun bounds it, not within 4 min of that, which another formula may see otherwise."""
    for period in schedule:
        begin, end = (None if period[name] is None else datetime.fromisoformat(period[name]) for name in ("startDateTime", "endDateTime"))
        if (begin is not None and when < begin) or (end is not None and when >= end):
            continue
        if not period["schedule"]:
            return True
        for entry in period["schedule"]:
            for back in (0, 1):
                day = when.date() - timedelta(days=back)
                if ("ANY" in entry["day"] or DAYS[day.weekday()] in entry["day"]) and _is_in_entry(entry, day, when, lon, lat):
                    return True
    return False


def _is_in_entry(entry: dict[str, Any], day: date, when: datetime, lon: float, lat: float) -> bool:
    starts, ends = _moments(entry, "start", day, lon, lat), _moments(entry, "end", day, lon, lat)
    early, late = (timedelta(minutes=4 if entry[f"{side}Event"] else 0) for side in ("start", "end"))
    for start in starts:
        after = [end for end in ends if end > start]
        if after and start + early <= when < min(after) - late:
            return True
    return False


def _moments(entry: dict[str, Any], side: str, day: date, lon: float, lat: float) -> list[datetime]:
    """When an entry may begin on a day, or end after that."""
    midnight = datetime(day.year, day.month, day.day, tzinfo=UTC)
    event, time = entry[f"{side}Event"], entry[f"{side}Time"]
    if event:
        found = [sun(event, day + timedelta(days=more), lon, lat) for more in (-1, 0, 1, 2)]
        return [moment for moment in found if moment is not None and (side == "end" or moment.date() == day)]
    if time is None:
        return [midnight + timedelta(days=1 if side == "end" else 0)]
    hour, minute, second = (int(part) for part in time.rstrip("Z").split(":"))
    moment = midnight + timedelta(hours=hour, minutes=minute, seconds=second)
    return [moment, moment + timedelta(days=1)] if side == "end" else [moment]


def sun(event: str, day: date, lon: float, lat: float) -> datetime | None:
    """Sunrise equation: mean anomaly, equation of the centre, declination, hour angle; right within two minutes."""
    below_deg = -0.833 if event in {"SR", "SS"} else -6.0
    number = (day - date(2000, 1, 1)).days
    noon = number + 0.0009 - lon / 360.0
    anomaly = math.radians((357.5291 + 0.98560028 * noon) % 360)
    centre = 1.9148 * math.sin(anomaly) + 0.02 * math.sin(2 * anomaly) + 0.0003 * math.sin(3 * anomaly)
    ecliptic = math.radians((math.degrees(anomaly) + centre + 282.9372) % 360)
    transit = noon + 0.0053 * math.sin(anomaly) - 0.0069 * math.sin(2 * ecliptic)
    tilt = math.asin(math.sin(ecliptic) * math.sin(math.radians(23.4397)))
    north = math.radians(lat)
    angle = (math.sin(math.radians(below_deg)) - math.sin(north) * math.sin(tilt)) / (math.cos(north) * math.cos(tilt))
    if abs(angle) > 1:
        return None
    turn = math.degrees(math.acos(angle)) / 360.0
    moment = transit + (turn if event in {"SS", "EECT"} else -turn)
    return datetime(2000, 1, 1, 12, tzinfo=UTC) + timedelta(days=moment)
