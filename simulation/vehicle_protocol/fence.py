"""The geofence of a simulated vehicle."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from inspection.geodesy import LonLat
from mavlink.vehicle_plan import MissionItem
from simulation.flight.states import FlightMode, RallyPoint
from simulation.vehicle_protocol.item_rules import ABOVE_SEA, CIRCLES, POLYGONS
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.parameters import Parameters

E7 = 1e7
METRES_PER_DEGREE = 111_195.0  # on a sphere; fences are small
EXCLUSIONS = frozenset({mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION})


@dataclass(frozen=True)
class _Polygon:
    corners: tuple[tuple[float, float], ...]
    is_exclusion: bool

    def covers(self, place: LonLat) -> bool:
        """Return whether the place is inside, by counting edges to its east."""
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
class SimulatedFence:
    """A fence: the UAV must be inside all inclusions and outside all exclusions."""

    areas: tuple[_Polygon | _Circle, ...] = ()

    def is_broken_at(self, place: LonLat) -> bool:
        return any(area.covers(place) == area.is_exclusion for area in self.areas)


def fence_of(items: Sequence[MissionItem]) -> SimulatedFence:
    """Return the fence of items accepted as a fence (see item_rules)."""
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
    return SimulatedFence(tuple(areas))


INTERVAL_S = 0.4  # of simulated time


class FenceAction(StrEnum):
    NONE = "none"
    WARN = "warn"
    HOLD = "hold"
    LAND = "land"
    RETURN = "return"


MODES = {FenceAction.HOLD: FlightMode.HOLD, FenceAction.LAND: FlightMode.LAND, FenceAction.RETURN: FlightMode.RETURN}
PX4_ACTIONS = {0: FenceAction.NONE, 1: FenceAction.WARN, 2: FenceAction.HOLD, 3: FenceAction.RETURN}
COPTER_ACTIONS = {
    0: FenceAction.WARN, 1: FenceAction.RETURN, 2: FenceAction.LAND, 3: FenceAction.RETURN, 4: FenceAction.HOLD,
}  # fmt: skip


@dataclass
class FenceWatch:
    """Monitors the fence and returns the action to take."""

    autopilot_type: SimulatedAutopilot
    parameters: Parameters
    fence: SimulatedFence = field(default_factory=SimulatedFence)
    is_broken: bool = False
    _next_s: float = 0.0

    def check(self, place: LonLat, at_s: float, *, is_in_air: bool) -> FenceAction:
        """Check the UAV's position. at_s: simulated seconds."""
        if at_s < self._next_s:
            return FenceAction.NONE
        self._next_s = at_s + INTERVAL_S
        was_broken = self.is_broken
        self.is_broken = is_in_air and self.is_enabled and self.fence.is_broken_at(place)
        return self.action if self.is_broken and not was_broken else FenceAction.NONE

    def switch(self, wanted: int | None) -> int:
        """Apply DO_FENCE_ENABLE and return its MAV_RESULT. PX4 does not support it."""
        if self.autopilot_type is SimulatedAutopilot.PX4:
            return int(mavlink.MAV_RESULT_UNSUPPORTED)
        if wanted not in (0, 1):
            return int(mavlink.MAV_RESULT_DENIED)
        self.parameters.show("FENCE_ENABLE", float(wanted))
        return int(mavlink.MAV_RESULT_ACCEPTED)

    @property
    def is_enabled(self) -> bool:
        if self.autopilot_type is SimulatedAutopilot.PX4:
            return self.action is not FenceAction.NONE
        return bool(self.parameters["FENCE_ENABLE"])

    @property
    def action(self) -> FenceAction:
        if self.autopilot_type is SimulatedAutopilot.PX4:
            return PX4_ACTIONS.get(int(self.parameters["GF_ACTION"]), FenceAction.WARN)
        return COPTER_ACTIONS.get(int(self.parameters["FENCE_ACTION"]), FenceAction.WARN)


def rally_points_of(items: Sequence[MissionItem], home_amsl_m: float) -> tuple[RallyPoint, ...]:
    """Return the rally points of items accepted as such (see item_rules)."""
    return tuple(
        RallyPoint(
            LonLat(item.longitude_e7 / E7, item.latitude_e7 / E7),
            item.altitude_m - home_amsl_m if item.frame in ABOVE_SEA else item.altitude_m,
        )
        for item in items
    )
