"""Flights of an organisation's other missions."""

from collections import defaultdict
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import UUID

import numpy as np
from django.conf import settings
from django.db.models import DateTimeField, DurationField, ExpressionWrapper, F, Value

from missions.models import Mission, MissionState, Route, Waypoint
from planning.context import OtherFlights
from planning.request import EndAction
from planning.separation.separation import TimedRoute
from planning.trajectory.waypoints import WaypointKind

FLYING_STATES = (MissionState.APPROVED, MissionState.DISPATCHED, MissionState.ACTIVE)
STILL_FLOWN: dict[str, Any] = {"geometry__isnull": False, "continued_by": None}  # of routes; the rest belongs to another mission
NO_TWIN: dict[str, Any] = {"mission_uav__uav__twin_of": None}  # twins fly copies of missions in simulation and obstruct no UAV
COLUMNS = ("position", "altitude_amsl_m", "altitude_agl_m", "arrival_s", "task", "kind")
_SECOND = Value(timedelta(seconds=1))
_FLOWN = ExpressionWrapper((F("departs_s") + F("duration_s")) * _SECOND, output_field=DurationField())
_ENDS_AT = ExpressionWrapper(F("mission__departs_at") + _FLOWN, output_field=DateTimeField())


def flights_at_the_same_time(organisation_id: int, from_s: float, to_s: float, *, but: UUID | str | None = None) -> OtherFlights:
    """Return routes of approved, dispatched and active missions that are in the air during a window, in seconds since the epoch.

    Those of a mission without a departure may be in the air at any time.
    `but` is a mission to leave out. The returned times count from from_s.
    A UAV that hovers at its end is assumed to do so until the longest flight is over.
    """
    window_from, window_to = (datetime.fromtimestamp(moment_s, UTC) for moment_s in (from_s, to_s))
    longest = timedelta(seconds=settings.FLIGHT_RULES.longest_flight_s)
    missions = Mission.objects.filter(organisation=organisation_id, deleted_at=None, state__in=FLYING_STATES, departs_at__lt=window_to)
    routes = (
        Route.objects.filter(mission__in=missions if but is None else missions.exclude(pk=but), **STILL_FLOWN, **NO_TWIN)
        .alias(ends_at=_ENDS_AT)
        .filter(ends_at__gt=window_from - longest)  # a hovering UAV stays that long
        .select_related("mission", "mission_uav")
        .order_by("mission__departs_at", "mission_id", "mission_uav__sequence")
    )
    flying = [route for route in routes if from_s < _departs_s(route) + _in_the_air_s(route) and _departs_s(route) < to_s]
    points: dict[int, list[tuple[Any, ...]]] = defaultdict(list)
    for route, *point in Waypoint.objects.filter(route__in=flying).order_by("route", "sequence").values_list("route", *COLUMNS):
        points[route].append(tuple(point))
    timed = {
        route: _timed_route(
            route,
            points[route.pk],
            _departure_s(route) - from_s,
            lands_s=_departs_s(route) - from_s + _in_the_air_s(route),
            mission=str(route.mission_id),
        )
        for route in flying
    }
    whenever = _routes_without_departure(organisation_id, but)
    return OtherFlights(
        tuple(found for found in timed.values() if found is not None),
        tuple(
            (str(route.mission_id), route.mission_uav.name)
            for route in [*(route for route, found in timed.items() if found is None), *whenever]
        ),
    )


def _routes_without_departure(organisation_id: int, but: UUID | str | None) -> list[Route]:
    missions = Mission.objects.filter(organisation=organisation_id, deleted_at=None, state__in=FLYING_STATES, departs_at=None)
    routes = Route.objects.filter(mission__in=missions if but is None else missions.exclude(pk=but), **STILL_FLOWN, **NO_TWIN)
    return list(routes.select_related("mission_uav").order_by("mission_id", "mission_uav__sequence"))


def routes_of_mission_in_time(mission: Mission) -> list[TimedRoute | None]:
    """Return the mission's flown routes in order, in seconds after its departure; None for a route without known times."""
    routes = mission.routes.select_related("mission", "mission_uav").filter(geometry__isnull=False)
    return [route_in_time(route) for route in routes]


def route_in_time(route: Route) -> TimedRoute | None:
    """Return a route in seconds after its mission's departure; None where a waypoint has no time. The route has mission and UAV loaded."""
    lands_s = route.departs_s + route.duration_s if _lands(route) else None
    return _timed_route(route, list(route.waypoints.values_list(*COLUMNS)), 0.0, lands_s=lands_s)


def _departure_s(route: Route) -> float:
    departs_at = route.mission.departs_at
    if departs_at is None:
        raise ValueError("flights are looked for where their mission's departure is stated")
    return departs_at.timestamp()


def _departs_s(route: Route) -> float:
    return _departure_s(route) + route.departs_s


def _lands(route: Route) -> bool:
    return route.mission.return_to_start or route.mission_uav.end_action != EndAction.HOVER


def _in_the_air_s(route: Route) -> float:
    return route.duration_s if _lands(route) else max(route.duration_s, settings.FLIGHT_RULES.longest_flight_s)


def _timed_route(
    route: Route, points: Sequence[tuple[Any, ...]], departure_s: float, *, lands_s: float | None, mission: str | None = None
) -> TimedRoute | None:
    """Return a route from its waypoints. departure_s is the mission's; lands_s is when the route is over, None for never.

    Returns None where the time of a waypoint is unknown.
    """
    if not points or any(point[3] is None for point in points):
        return None
    amsl_m, agl_m = (np.array([point[column] for point in points], dtype=np.float64) for column in (1, 2))
    hold_s = np.array([(point[4] or {}).get("hold_s", 0.0) for point in points], dtype=np.float64)
    for stop in route.charging:
        hold_s[stop["waypoint"]] += stop["stopped_s"]
    held_s = np.cumsum(hold_s) - hold_s
    flown_s = np.array([point[3] for point in points], dtype=np.float64) - held_s
    take_off_s = departure_s + route.departs_s
    # Times are stored to a tenth of a second: after rounding, a short leg may seem to end before it begins.
    arrival_s = np.maximum(departure_s + held_s + np.maximum.accumulate(flown_s), take_off_s)
    ground_m = amsl_m - agl_m
    return TimedRoute(
        uav=route.mission_uav.name,
        position=np.array([point[0].coords for point in points], dtype=np.float64),
        height_m=amsl_m,
        arrival_s=arrival_s,
        hold_s=hold_s,
        take_off_s=take_off_s,
        take_off_m=float(ground_m[0] if route.begun_by is None else amsl_m[0]),
        lands_s=None if lands_s is None else max(lands_s, float(arrival_s[-1] + hold_s[-1])),
        landing_m=float(ground_m[-1] if _lands(route) else amsl_m[-1]),
        mission=mission,
        on_ground=np.array([point[5] == WaypointKind.BASE for point in points], dtype=bool),
    )
