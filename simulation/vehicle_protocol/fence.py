"""Whether a place lies outside the fence that a vehicle was given."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.vehicle_protocol.item_rules import CIRCLES, POLYGONS

E7 = 1e7
METRES_PER_DEGREE = 111_195.0  # of a sphere; a fence is small
EXCLUSIONS = frozenset({mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION})


@dataclass(frozen=True)
class _Polygon:
    corners: tuple[tuple[float, float], ...]
    is_exclusion: bool

    def covers(self, place: LonLat) -> bool:
        """By the number of edges to the east of it."""
        is_inside = False
        before = self.corners[-1]
        for corner in self.corners:
            if (corner[1] > place.lat) != (before[1] > place.lat):
                edge_lon = corner[0] + (place.lat - corner[1]) / (before[1] - corner[1]) * (before[0] - corner[0])
                is_inside ^= place.lon < edge_lon
            before = corner
        return is_inside


@dataclass(frozen=True)
class _Circle:
    centre: LonLat
    radius_m: float
    is_exclusion: bool

    def covers(self, place: LonLat) -> bool:
        north_m = (place.lat - self.centre.lat) * METRES_PER_DEGREE
        east_m = (place.lon - self.centre.lon) * METRES_PER_DEGREE * math.cos(math.radians(self.centre.lat))
        return math.hypot(north_m, east_m) <= self.radius_m


@dataclass(frozen=True)
class Fence:
    """A UAV is to be in all inclusions and in no exclusion."""

    areas: tuple[_Polygon | _Circle, ...] = ()

    def is_broken_at(self, place: LonLat) -> bool:
        return any(area.covers(place) == area.is_exclusion for area in self.areas)


def fence_of(items: Sequence[MissionItem]) -> Fence:
    """Of items that were taken as a fence (see item_rules)."""
    areas: list[_Polygon | _Circle] = []
    place = 0
    while place < len(items):
        item = items[place]
        is_exclusion = item.command in EXCLUSIONS
        if item.command in POLYGONS:
            corners = items[place : place + int(item.parameters[0])]
            areas.append(_Polygon(tuple((corner.longitude_e7 / E7, corner.latitude_e7 / E7) for corner in corners), is_exclusion))
            place += len(corners)
            continue
        if item.command in CIRCLES:
            areas.append(_Circle(LonLat(item.longitude_e7 / E7, item.latitude_e7 / E7), item.parameters[0], is_exclusion))
        place += 1
    return Fence(tuple(areas))
