"""Legs of vehicles' missions: waypoints added on long ones, and a vehicle's position relative to the one that it would resume."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat, path_length_m
from inspection.geodesy.local_frame import LocalFrame
from mavlink.vehicle_plan import FlightLoad, MissionItem

FLOWN = frozenset({mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_LAND})
SPHERE_M = 6_371_000.0  # the Earth's radius in PX4
MIN_LEG_M = 1.0  # below this, points rounded to a centimetre would coincide


def with_points_between(load: FlightLoad, most_m: float) -> FlightLoad:
    """Return the load with intermediate waypoints, so that no leg is longer than `most_m`.

    The points lie on the straight line on the chart, with interpolated heights rounded to the centimetre like all items, so the flown path
    stays the same. Before a landing, whose altitude is the ground's, the height stays constant.

    The result has another hash, and a vehicle is ready only by its hash. The points are therefore added when a mission is approved, never
    during upload. Raises ValueError if `most_m` is below `MIN_LEG_M`.
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
    """Return the length over the ground: the longer of ellipsoid and sphere, which differ by up to 0.6 %."""
    start, end = position_of(left), position_of(right)
    return max(path_length_m(np.array([start, end])), length_on_sphere_m(start, end))


def length_on_sphere_m(start: LonLat, end: LonLat) -> float:
    """Return the length as PX4 computes it, whose limits use it."""
    one, other = math.radians(start.lat), math.radians(end.lat)
    east = math.radians(end.lon - start.lon)
    chord = math.sin((other - one) / 2) ** 2 + math.cos(one) * math.cos(other) * math.sin(east / 2) ** 2
    return 2 * SPHERE_M * math.asin(math.sqrt(min(chord, 1.0)))


def position_of(item: MissionItem) -> LonLat:
    return LonLat(item.longitude_e7 / 1e7, item.latitude_e7 / 1e7)


def _between(left: MissionItem, right: MissionItem, most_m: float) -> list[MissionItem]:
    """Return the intermediate points. Parts equal on the chart differ on the ground: if one is too long, one more part is used."""
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


@dataclass(frozen=True)
class BesideLeg:
    """Offset from a leg.

    `away_m` is the distance over the ground. `above_m` is the height above the higher end, negative below the lower end, 0 in between.
    """

    away_m: float
    above_m: float


def beside_leg(load: FlightLoad, item: int, take_off: LonLat, position: LonLat, relative_m: float) -> BesideLeg | None:
    """Return the offset of a vehicle at `position`, `relative_m` above home, from the leg to the mission item `item`.

    The leg begins at the previous item with a position, else at the take-off. Returns None if no such item is left. The way to the leg is
    unchecked.
    """
    flown = [(place, position_of(one), one.altitude_m) for place, one in enumerate(load.mission) if one.command in FLOWN]
    ahead = next((number for number, (place, _, _) in enumerate(flown) if place >= item), None)
    if ahead is None:
        return None
    _, end, end_m = flown[ahead]
    _, start, start_m = flown[ahead - 1] if ahead else (0, take_off, 0.0)
    lowest_m, highest_m = min(start_m, end_m), max(start_m, end_m)
    above_m = relative_m - highest_m if relative_m > highest_m else min(relative_m - lowest_m, 0.0)
    return BesideLeg(_away_m(position, start, end), above_m)


def beside_place(item: MissionItem, position: LonLat, relative_m: float) -> BesideLeg:
    """Return the offset from a single place in the air."""
    at = position_of(item)
    return BesideLeg(_away_m(position, at, at), relative_m - item.altitude_m)


def _away_m(position: LonLat, start: LonLat, end: LonLat) -> float:
    here, one, other = LocalFrame.around(*position).to_metres(np.array([position, start, end]))
    along = other - one
    length_m2 = float(along @ along)
    share = 0.0 if length_m2 == 0 else min(max(float((here - one) @ along) / length_m2, 0.0), 1.0)
    return float(np.hypot(*(one + share * along - here)))
