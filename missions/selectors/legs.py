"""Checks of a single leg against zones and heights, while it is dragged."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any, NamedTuple

import numpy as np
from django.conf import settings
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import FloatArray
from inspection.network.spans import DECK, Spans, spans_between, spans_of
from inspection.selectors import NoGraph
from inspection.selectors.ground import ground_dataset_version
from inspection.selectors.planning import planning_read
from inspection.selectors.zone_table import zone_table
from inspection.zones.reach import ZoneTable
from missions.selectors.planning_context import terrain_under
from missions.selectors.zones import zones_met
from planning.clearance.obstacle_clearance import spans_near
from planning.clearance.zone_clearance import FlownRoute
from planning.energy.conditions import Conditions
from planning.energy.performance import Performance
from planning.trajectory.heights import GroundModel, with_heights
from planning.trajectory.leg_speeds import SpeedRange, speeds_out_of_range
from planning.trajectory.obstacles import too_low
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind, Waypoints
from workspace.locale_negotiation import number_text

AT_DEG = 1e-5  # a metre


class LegEnd(NamedTuple):
    """An end of a leg. arrival_s counts from the departure; None: at any time of the flight."""

    position: LonLat
    agl_m: float
    arrival_s: float | None


class Leg(NamedTuple):
    """A leg. speed_mps is over ground; None: the UAV's own speed."""

    start: LegEnd
    end: LegEnd
    speed_mps: float | None = None


class LegFlyer(NamedTuple):
    """The UAV that flies legs at a given speed, and the conditions."""

    name: str
    cruise_speed_mps: float
    performance: Performance
    conditions: Conditions


def faults_of_legs(legs: Sequence[Leg], departs_at: datetime | None, flyer: LegFlyer | None = None) -> list[dict[str, Any]]:
    """Return what is wrong with each leg. flyer is needed where a leg has a speed."""
    table, ground, spans = zone_table(), terrain_under(ground_dataset_version()), _all_spans()
    return [_faults(leg.start, leg.end, departs_at, table, spans, ground) or _speed_fault(leg, flyer) or _NO_FAULT for leg in legs]


def speed_words(possible: SpeedRange, flyer: LegFlyer) -> str:
    """Return the text why a speed cannot be flown over a leg."""
    low, high = (number_text(speed_mps, 1) for speed_mps in possible)
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


def _faults(
    start: LegEnd, end: LegEnd, departs_at: datetime | None, table: ZoneTable, spans: Spans, ground: GroundModel | None
) -> dict[str, Any] | None:
    """Return the first fault of a leg, or None; the vertical columns to the ground at its ends are not checked."""
    flight = settings.FLIGHT_RULES
    if max(start.agl_m, end.agl_m) > flight.max_agl_m:
        return _fault(None, _("It is above the limit of %(limit)s m.") % {"limit": f"{flight.max_agl_m:.0f}"})
    points = RoutePoints.of([RoutePoint(one.position, WaypointKind.PASS, one.agl_m) for one in (start, end)])
    flown, _is_flat = with_heights(points, ground, flight, points.agl_m)  # several legs over a hill
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
    low = too_low(flown, _spans_elsewhere(spans, position), ground, flight)
    return None if low is None else _fault(None, too_low_text(float(low.agl_m.max())))


_NO_FAULT: dict[str, Any] = {"is_clear": True, "zone": None, "message": ""}


def too_low_text(agl_m: float) -> str:
    """Return the text for a leg that needs this height above ground over an obstacle; inf: the terrain under it is unknown."""
    limit_m = settings.FLIGHT_RULES.max_agl_m
    if agl_m == np.inf:
        return _("How high the ground is under what stands here is not known: go round it.")
    if agl_m > limit_m:
        return _("What stands here cannot be flown over below %(limit)s m: go round it.") % {"limit": f"{limit_m:.0f}"}
    return _("Something tall stands here: fly at %(height)s m above ground over it.") % {"height": f"{np.ceil(agl_m):.0f}"}


def _all_spans() -> Spans:
    """Return the spans of the network; empty where there is none."""
    try:
        return spans_of(planning_read().ground().network())
    except NoGraph:
        return spans_between(*(np.zeros((0, 2)),) * 2, *(np.zeros(0),) * 2)


def _spans_elsewhere(spans: Spans, position: FloatArray) -> Spans:
    """Return the spans near a leg except those attached at its ends: whether these are inspected is unknown during a drag."""
    near = spans_near(spans, position, 0.0)
    is_attached = np.zeros(len(near), dtype=np.bool_)
    for at in (position[0], position[-1]):
        for ends in (spans.start[near], spans.end[near]):
            is_attached |= (np.abs(ends - at) <= AT_DEG).all(axis=1)
    return spans.where(near[~is_attached | (spans.asset[near] == DECK)])


def _fault(zone: int | None, message: str) -> dict[str, Any]:
    return {"is_clear": False, "zone": zone, "message": message}
