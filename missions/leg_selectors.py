"""A single leg against zones and heights, while it is being dragged."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any, NamedTuple

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.selectors import ground_heights_m, has_terrain
from inspection.selectors.zone_table import zone_table
from inspection.zones.reach import ZoneTable
from missions.flight_plan.clearance import FlownRoute
from missions.flight_plan.conditions import Conditions
from missions.flight_plan.heights import with_heights
from missions.flight_plan.leg_speeds import SpeedRange, speeds_out_of_range
from missions.flight_plan.performance import Performance
from missions.flight_plan.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from missions.zone_selectors import zones_met


class LegEnd(NamedTuple):
    """arrival_s counts from the departure; None: at any time of the flight."""

    position: LonLat
    agl_m: float
    arrival_s: float | None


class Leg(NamedTuple):
    """speed_mps: over ground; None: as the UAV does."""

    start: LegEnd
    end: LegEnd
    speed_mps: float | None = None


class LegFlyer(NamedTuple):
    """Who flies legs with a speed, and in which air."""

    name: str
    cruise_speed_mps: float
    performance: Performance
    conditions: Conditions


def faults_of_legs(legs: Sequence[Leg], departs_at: datetime | None, flyer: LegFlyer | None = None) -> list[dict[str, Any]]:
    """What is wrong with each; flyer: who flies them, needed where one has a speed."""
    table, has_ground = zone_table(), has_terrain()
    return [_faults(leg.start, leg.end, departs_at, table, has_ground=has_ground) or _speed_fault(leg, flyer) or _NO_FAULT for leg in legs]


def speed_words(possible: SpeedRange, flyer: LegFlyer) -> str:
    """Why a speed cannot be flown over a leg."""
    low, high = (f"{speed_mps:.1f}" for speed_mps in possible)
    if flyer.performance.max_airspeed_mps is None:
        values = {"low": low, "high": high, "uav": flyer.name}
        return _("Between %(low)s and %(high)s m/s: the top airspeed of %(uav)s is not stated.") % values
    return _("Between %(low)s and %(high)s m/s over ground here, in this wind.") % {"low": low, "high": high}


def _speed_fault(leg: Leg, flyer: LegFlyer | None) -> dict[str, Any] | None:
    if leg.speed_mps is None or flyer is None:
        return None
    start, end = (RoutePoint(one.position, WaypointKind.PASS, one.agl_m) for one in (leg.start, leg.end))
    points = RoutePoints.of([start, end._replace(speed_mps=leg.speed_mps)])
    waypoints = Waypoints(points, None, points.agl_m)
    found = speeds_out_of_range(
        waypoints, cruise_speed_mps=flyer.cruise_speed_mps, performance=flyer.performance, conditions=flyer.conditions
    )
    return _fault(None, speed_words(found[1], flyer)) if found else None


def _faults(start: LegEnd, end: LegEnd, departs_at: datetime | None, table: ZoneTable, *, has_ground: bool) -> dict[str, Any] | None:
    """The first thing that is wrong with a leg; the columns down to the ground at its ends are not looked at."""
    flight = settings.FLIGHT_RULES
    if max(start.agl_m, end.agl_m) > flight.max_agl_m:
        return _fault(None, _("It is above the limit of %(limit)s m.") % {"limit": f"{flight.max_agl_m:.0f}"})
    points = RoutePoints.of([RoutePoint(one.position, WaypointKind.PASS, one.agl_m) for one in (start, end)])
    flown, _is_flat = with_heights(points, ground_heights_m if has_ground else None, flight)  # over a hill it is several legs
    position = flown.points.position
    arrival_s = departs_s = ends_s = None
    if departs_at is not None and start.arrival_s is not None and end.arrival_s is not None:
        departs_s, ends_s = (departs_at.timestamp() + moment_s for moment_s in sorted((start.arrival_s, end.arrival_s)))
        way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(position, axis=0).T))])
        arrival_s = departs_s + (ends_s - departs_s) * (way / way[-1] if way[-1] > 0 else np.linspace(0.0, 1.0, len(way)))
    leg = FlownRoute(position, flown.points.agl_m, flown.amsl_m, arrival_s, departs_s, ends_s)
    for meeting in zones_met([leg], table)[0]:
        if 0 <= meeting.breach.leg < len(position) - 1:
            return _fault(meeting.zone, _("It meets %(zone)s.") % {"zone": meeting.name})
    return None


_NO_FAULT: dict[str, Any] = {"is_clear": True, "zone": None, "message": ""}


def _fault(zone: int | None, message: str) -> dict[str, Any]:
    return {"is_clear": False, "zone": zone, "message": message}
