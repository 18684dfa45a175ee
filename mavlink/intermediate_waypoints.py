"""Points put in on the legs of a flight, for vehicles that refuse legs which are longer."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat, path_length_m
from mavlink.vehicle_plan import FlightLoad, MissionItem

FLOWN = frozenset({mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_LAND})
SPHERE_M = 6_371_000.0  # the radius of the earth that PX4 measures on
MIN_LEG_M = 1.0  # below which points, kept to a centimetre, would lie on each other


def with_points_between(load: FlightLoad, most_m: float) -> FlightLoad:
    """With waypoints put in on each leg that is longer, so that none is.

    The points lie on the straight line on the chart at heights in between, to the centimetre that items are kept to: the vehicle flies
    where it was to fly without them. Before a landing, whose altitude is the ground's, it stays as high as it was.

    This makes another load with another hash, and a vehicle is ready only by its hash. So it is made when a mission is approved, and
    frozen, never on the way to the vehicle. Raises ValueError for legs below `MIN_LEG_M`.
    """
    if not most_m >= MIN_LEG_M:
        raise ValueError(f"most_m must be at least {MIN_LEG_M}")
    mission: list[MissionItem] = []
    last: MissionItem | None = None
    for item in load.mission:
        if item.command in FLOWN:
            if last is not None:
                mission += _between(last, item, most_m)
            last = item
        mission.append(item)
    return replace(load, mission=tuple(mission))


def leg_length_m(left: MissionItem, right: MissionItem) -> float:
    """Over the ground; the longer of what it is on the ellipsoid and on the sphere, which are up to 0.6 % apart."""
    start, end = position_of(left), position_of(right)
    return max(path_length_m(np.array([start, end])), length_on_sphere_m(start, end))


def length_on_sphere_m(start: LonLat, end: LonLat) -> float:
    """As PX4 measures, whose limits are in these metres."""
    one, other = math.radians(start.lat), math.radians(end.lat)
    east = math.radians(end.lon - start.lon)
    chord = math.sin((other - one) / 2) ** 2 + math.cos(one) * math.cos(other) * math.sin(east / 2) ** 2
    return 2 * SPHERE_M * math.asin(math.sqrt(min(chord, 1.0)))


def position_of(item: MissionItem) -> LonLat:
    return LonLat(item.longitude_e7 / 1e7, item.latitude_e7 / 1e7)


def _between(left: MissionItem, right: MissionItem, most_m: float) -> list[MissionItem]:
    """Parts that are equal on the chart are not quite so on the ground: where one is too long, there is one part more."""
    parts = max(1, math.ceil(leg_length_m(left, right) / most_m))
    while True:
        points = [_point(left, right, number / parts) for number in range(1, parts)]
        ends = [left, *points, right]
        if all(leg_length_m(one, other) <= most_m for one, other in pairwise(ends)):
            return points
        parts += 1


def _point(left: MissionItem, right: MissionItem, share: float) -> MissionItem:
    rise_m = 0.0 if right.command == mavlink.MAV_CMD_NAV_LAND else right.altitude_m - left.altitude_m
    return MissionItem(
        mavlink.MAV_CMD_NAV_WAYPOINT,
        left.frame,
        (0.0, 0.0, 0.0, math.nan),
        left.longitude_e7 + round(share * (right.longitude_e7 - left.longitude_e7)),
        left.latitude_e7 + round(share * (right.latitude_e7 - left.latitude_e7)),
        round(left.altitude_m + share * rise_m, 2),
        right.waypoint,
    )
