"""Routes against the zones in force: where, when and how high they meet one, and when they may depart."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from django.conf import settings

from inspection.selectors.zone_table import zone_table
from inspection.zones.activity import TimeSpan, active_spans, merged
from inspection.zones.reach import ZoneTable
from inspection.zones.schedule import Schedule
from missions.models import Mission, Route
from missions.selectors.planning_context import planning_rules
from planning.checks.zones import MetZone
from planning.checks.zones import zones_met as checked_zones_met
from planning.clearance.nearby_zones import NearestZone, nearest_zone, zones_near
from planning.clearance.zone_clearance import TAKE_OFF, FlownRoute, Margins, breaches
from planning.request import EndAction

LegTime = tuple[float, float]  # from when to when a leg is flown, in seconds after departure, end included


def blocked_departures(
    legs: Iterable[LegTime], spans: Iterable[tuple[float, float]], margin_s: float, from_s: float, to_s: float
) -> tuple[TimeSpan, ...]:
    """Return the departures between two moments at which a leg would be flown while a zone applies, margin included.

    A leg flown from a to b after departure meets a span from s to e (e excluded) if the departure is in [s - b, e - a). The margin extends
    both sides. Rounded outwards to whole seconds.
    """
    times = set(legs)
    return merged(
        TimeSpan(max(float(math.floor(start - margin_s - last_s)), from_s), min(float(math.ceil(end + margin_s - first_s)), to_s))
        for start, end in spans
        for first_s, last_s in times
    )


def free_between(blocked: Iterable[TimeSpan], from_s: float, to_s: float) -> tuple[TimeSpan, ...]:
    """Return the time between two moments that the spans leave free."""
    free: list[TimeSpan] = []
    open_s = from_s
    for span in merged(blocked):
        if span.from_s > open_s:
            free.append(TimeSpan(open_s, min(span.from_s, to_s)))
        open_s = max(open_s, span.to_s)
    if open_s < to_s:
        free.append(TimeSpan(open_s, to_s))
    return tuple(free)


def zone_margins() -> Margins:
    """Return the margins from zones in the settings."""
    return planning_rules().margins


def flown_route(route: Route, departs_s: float | None) -> FlownRoute:
    """Return a stored route as flown. departs_s: when its mission begins, in seconds since the epoch; None: at any time."""
    waypoints = list(route.waypoints.all())
    arrival_s = np.array([np.nan if waypoint.arrival_s is None else waypoint.arrival_s for waypoint in waypoints], dtype=np.float64)
    is_timed = departs_s is not None and not np.isnan(arrival_s).all()
    began_s = 0.0 if departs_s is None else departs_s
    lands = route.mission.return_to_start or route.mission_uav.end_action != EndAction.HOVER
    lasts_s = route.duration_s if lands else max(route.duration_s, settings.FLIGHT_RULES.longest_flight_s)  # a hovering UAV stays
    return FlownRoute(
        position=np.array([waypoint.position.coords[:2] for waypoint in waypoints], dtype=np.float64).reshape(-1, 2),
        agl_m=np.array([waypoint.altitude_agl_m for waypoint in waypoints], dtype=np.float64),
        amsl_m=np.array(
            [np.nan if waypoint.altitude_amsl_m is None else waypoint.altitude_amsl_m for waypoint in waypoints], dtype=np.float64
        ),
        arrival_s=began_s + arrival_s if is_timed else None,
        departs_s=None if departs_s is None else began_s + route.departs_s,
        ends_s=None if departs_s is None else began_s + route.departs_s + lasts_s,
        lands=lands,
    )


def zones_met(routes: Sequence[FlownRoute], table: ZoneTable | None = None) -> list[list[MetZone]]:
    """Return for each route the zones that it meets, current ones or those of the table; a route without times counts at any time."""
    return checked_zones_met(routes, zone_table() if table is None else table, zone_margins())


def nearest_zone_of_mission(mission: Mission) -> NearestZone | None:
    """Return the zone that the plan comes nearest to. mission: with its routes and waypoints loaded."""
    routes = [route for route in mission.routes.all() if route.geometry is not None]
    return nearest_zone([flown_route(route, departure_s(mission)) for route in routes], zone_table())


def departure_s(mission: Mission) -> float | None:
    return None if mission.departs_at is None else float(mission.departs_at.timestamp())


@dataclass(frozen=True)
class BlockingZone:
    """A zone that routes meet in space and height. blocked: departures that meet it in time as well; legs: (route, leg) pairs."""

    zone: int
    name: str
    schedule: Schedule | None
    blocked: tuple[TimeSpan, ...]
    legs: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class LegalWindows:
    """Departure windows between two moments, and the zones that block the rest."""

    windows: tuple[TimeSpan, ...]
    zones: tuple[BlockingZone, ...]


def legal_windows(routes: Sequence[FlownRoute], *, from_s: float, to_s: float) -> LegalWindows:
    """Return when the routes may depart between two moments, in seconds since the epoch.

    The routes' times are seconds after departure. A leg without a time may be flown at any time from the route's take-off to its end.
    Routes keep the margins of the settings in space, height and time.
    """
    margins, table = zone_margins(), zone_table()
    met: dict[int, list[tuple[int, int]]] = {}
    rows: dict[int, tuple[ZoneTable, int]] = {}
    for number, route in enumerate(routes):
        near, facts = zones_near(table, route.position, margins)
        for breach in breaches(replace(route, arrival_s=None), facts, margins):
            key = int(near.ids[breach.zone])
            met.setdefault(key, []).append((number, breach.leg))
            rows.setdefault(key, (near, breach.zone))
    times = [_leg_times(route) for route in routes]
    found = []
    for key, legs in met.items():
        near, row = rows[key]
        flown = [times[number][leg - TAKE_OFF] for number, leg in legs]
        earliest, latest = from_s + min(first for first, _ in flown), to_s + max(last for _, last in flown)
        spans = active_spans(near.schedules[row], _box_of(near, row), earliest - margins.time_s - 1.0, latest + margins.time_s + 1.0)
        blocked = blocked_departures(flown, spans, margins.time_s, from_s, to_s)
        found.append(BlockingZone(key, near.names[row], near.schedules[row], blocked, tuple(legs)))
    free = free_between((span for zone in found for span in zone.blocked), from_s, to_s)
    return LegalWindows(free, tuple(found))


def _leg_times(route: FlownRoute) -> list[tuple[float, float]]:
    """Return the time span of each leg, the climb to the first waypoint first; an unknown one spans the whole flight."""
    departs_s = route.departs_s or 0.0
    known = [] if route.arrival_s is None else route.arrival_s[~np.isnan(route.arrival_s)].tolist()
    ends_s = max([departs_s, *known] if route.ends_s is None else [departs_s, route.ends_s, *known])
    arrival_s = [np.nan] * len(route.position) if route.arrival_s is None else route.arrival_s.tolist()
    moments = [departs_s, *arrival_s, ends_s]
    return [
        (departs_s, ends_s) if np.isnan(start) or np.isnan(end) else (min(start, end), max(start, end)) for start, end in pairwise(moments)
    ]


def _box_of(table: ZoneTable, row: int) -> tuple[float, float, float, float]:
    west, south, east, north = table.box[row].tolist()
    return west, south, east, north
