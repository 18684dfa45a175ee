"""No-fly zones as a geofence in the autopilot, and rally points.

The fence is a last safeguard: the route is checked against all zones before. An autopilot's zone has no heights and few vertices. A zone
that the route passes over or under is therefore omitted, and a detailed one is enlarged. Omitted zones are reported.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from shapely import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from mavlink.approved_route import FrozenRoute
from mavlink.mission_items import RELATIVE, position_e7
from mavlink.vehicle_plan import MissionItem

SHARP = 2.0  # longest spike at a corner, in multiples of the growth
E7 = 1e7


@dataclass(frozen=True)
class FenceRules:
    """Limits of a fence.

    A zone has at most `most_vertices` (ArduPilot's guide), the fence at most `most_items` (PX4's storage for it). A zone grows in steps up
    to `most_growth_m`. It stays `keeps_clear_m` from the route: more than ArduPilot's FENCE_MARGIN (2 m) plus position errors. Zones beyond
    `reach_m` of the route are not sent.
    """

    most_vertices: int = 70
    most_items: int = 64
    most_growth_m: float = 32.0
    keeps_clear_m: float = 8.0
    reach_m: float = 3_000.0


@dataclass(frozen=True)
class FenceZone:
    """The outline of a no-fly zone, without repeating its first vertex. A zone of several parts is several of these."""

    name: str
    outline: tuple[LonLat, ...]


@dataclass(frozen=True)
class OmittedZone:
    """A zone that is not in the fence. `code` is crosses-route, too-detailed, no-space or not-simple."""

    zone: str
    code: str
    words: str


@dataclass(frozen=True)
class Fence:
    items: tuple[MissionItem, ...]
    left_out: tuple[OmittedZone, ...]


def fence_of(zones: Sequence[FenceZone], route: FrozenRoute, rules: FenceRules | None = None) -> Fence:
    """Return the fence, with the zones nearest to the route first. Each polygon contains its zone, up to the wire's 1e-7 degrees."""
    rules = rules or FenceRules()
    if not route.waypoints:
        return Fence((), ())
    frame = LocalFrame.around(*route.take_off.position)
    line = _line(route, frame)
    left_out: list[OmittedZone] = []
    near: list[tuple[float, FenceZone, Polygon]] = []
    for zone in zones:
        area = Polygon(frame.to_metres(np.array(zone.outline))) if len(zone.outline) >= 3 else Polygon()
        if not area.is_valid or area.is_empty or area.area == 0:
            left_out.append(OmittedZone(zone.name, "not-simple", f"{zone.name}: its outline crosses itself or has no area."))
        elif area.distance(line) < rules.keeps_clear_m:
            left_out.append(OmittedZone(zone.name, "crosses-route", f"{zone.name}: the route passes over, under or close to it."))
        elif area.distance(line) <= rules.reach_m:
            near.append((float(area.distance(line)), zone, area))
    items: list[MissionItem] = []
    for number, (_, zone, area) in enumerate(sorted(near, key=lambda one: one[0])):
        share = (rules.most_items - len(items)) // (len(near) - number)
        most = min(rules.most_vertices, max(share, min(len(zone.outline), 4)))
        if len(items) + min(most, len(zone.outline)) > rules.most_items:
            left_out.append(OmittedZone(zone.name, "no-space", f"{zone.name}: the fence is full with {len(items)} vertices."))
            continue
        outline = zone.outline if len(zone.outline) <= most else _larger(area, line, most, frame, rules)
        if outline is None:
            words = f"{zone.name}: its {len(zone.outline)} vertices cannot be drawn by {most} clear of the route."
            left_out.append(OmittedZone(zone.name, "too-detailed", words))
        else:
            items += _exclusion(outline)
    return Fence(tuple(items), tuple(left_out))


def rally_items(points: Sequence[tuple[LonLat, float]]) -> tuple[MissionItem, ...]:
    """Return rally points with their altitude above take-off, rounded up to whole metres as ArduPilot stores them."""
    return tuple(
        MissionItem(mavlink.MAV_CMD_NAV_RALLY_POINT, RELATIVE, (0.0, 0.0, 0.0, 0.0), *position_e7(place), float(math.ceil(relative_m)))
        for place, relative_m in points
    )


def _line(route: FrozenRoute, frame: LocalFrame) -> BaseGeometry:
    positions = [route.take_off.position, *(waypoint.position for waypoint in route.waypoints)]
    line = LineString(frame.to_metres(np.array(positions)))
    return Point(line.coords[0]) if line.length == 0 else line


def _larger(area: Polygon, line: BaseGeometry, most: int, frame: LocalFrame, rules: FenceRules) -> tuple[LonLat, ...] | None:
    """Return an outline of at most `most` vertices that contains the area: grown in steps, and simplified by less than it grew."""
    growth_m = 0.5
    while growth_m <= rules.most_growth_m:
        grown = area.buffer(growth_m, join_style="mitre", mitre_limit=SHARP)
        drawn = Polygon(grown.exterior).simplify(growth_m * 0.98)
        if isinstance(drawn, Polygon) and drawn.is_valid and len(drawn.exterior.coords) - 1 <= most:
            outline = tuple(LonLat(*place) for place in frame.to_degrees(np.array(drawn.exterior.coords[:-1])).tolist())
            on_the_wire = Polygon(frame.to_metres(np.array([position_e7(place) for place in outline]) / E7))
            if on_the_wire.is_valid and on_the_wire.covers(area):
                return outline if on_the_wire.distance(line) >= rules.keeps_clear_m else None
        growth_m *= 2
    return None


def _exclusion(outline: Sequence[LonLat]) -> list[MissionItem]:
    command, vertices = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, float(len(outline))
    return [MissionItem(command, mavlink.MAV_FRAME_GLOBAL, (vertices, 0.0, 0.0, 0.0), *position_e7(place)) for place in outline]
