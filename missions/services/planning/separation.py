"""The routes of one plan, and those of missions flown at the same time, kept apart."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from django.conf import settings

from inspection.zones.reach import ZoneTable
from missions.models import EndAction
from missions.services.planning.final_check import keys_of_zones_met
from missions.services.planning.plan_json import PlannedRoute
from missions.services.planning.requests import PlanRequest
from planning.energy.power import NoHeadway
from planning.separation.separation import Separation, TimedRoute, keep_apart, raised_agl_m, timed_route
from planning.trajectory.sorties import timing_of_route, wh_of_sorties
from planning.trajectory.waypoints import RoutePoints, Waypoints


def routes_apart(
    request: PlanRequest, routes: Sequence[PlannedRoute], table: ZoneTable, fixed: Sequence[TimedRoute] = (), *, may_raise: bool = True
) -> tuple[list[PlannedRoute], Separation]:
    """The routes with the delays and heights that keep them apart from each other and from `fixed`, and how that came out.

    A route is only flown higher where it then meets no zone of the table and its battery still does.
    """
    flying = [number for number, route in enumerate(routes) if route.waypoints is not None]
    higher: dict[tuple[int, float], PlannedRoute] = {}

    def raised(place: int, layer_m: float) -> TimedRoute | None:
        number = flying[place]
        route = _raised(request, number, routes[number], layer_m, table, request.departs_at)
        if route is None:
            return None
        higher[number, layer_m] = route
        return _timed(request, number, route)

    separation = keep_apart(
        [_timed(request, number, routes[number]) for number in flying],
        fixed,
        rules=settings.SEPARATION_RULES,
        raised=raised if may_raise else None,
    )
    apart = list(routes)
    for number, delay_s, layer_m in zip(flying, separation.delays_s, separation.layers_m, strict=True):
        apart[number] = replace(higher[number, layer_m] if layer_m else routes[number], departs_s=delay_s)
    return apart, separation


def _timed(request: PlanRequest, number: int, route: PlannedRoute) -> TimedRoute:
    assert route.waypoints is not None and route.timing is not None  # noqa: S101 - only routes that are flown
    lands_s = None if route.end_action is EndAction.HOVER else route.timing.total_s
    timed = timed_route(request.uavs[number].name, route.waypoints, route.timing.arrival_s, lands_s=lands_s)
    if not route.charging:
        return timed
    hold_s = timed.hold_s.copy()
    for stop in route.charging:
        hold_s[stop.place] += stop.stopped_s
    return replace(timed, hold_s=hold_s)


def _raised(
    request: PlanRequest, number: int, route: PlannedRoute, layer_m: float, table: ZoneTable, departs_at: datetime | None
) -> PlannedRoute | None:
    """The route flown so much higher between its targets; None where it may not be."""
    assert route.waypoints is not None  # noqa: S101 - only routes that are flown
    asked, flight = request.uavs[number], settings.FLIGHT_RULES
    lands = route.end_action is not EndAction.HOVER
    points = route.waypoints.points
    agl_m = raised_agl_m(points, layer_m, lands=lands, rules=flight)
    if agl_m is None or route.charging:
        return None
    more_m = agl_m - points.agl_m
    amsl_m = route.waypoints.amsl_m
    waypoints = Waypoints(
        RoutePoints(points.position, agl_m, points.kind, points.asset, points.target, points.task, points.speed_mps),
        None if amsl_m is None else amsl_m + more_m,
        agl_m if route.waypoints.relative_m is points.agl_m else route.waypoints.relative_m + more_m,
    )
    try:
        clock = timing_of_route(
            waypoints,
            cruise_speed_mps=asked.cruise_speed_mps,
            performance=asked.performance,
            conditions=request.conditions,
            lands=lands,
            rules=flight,
        )
    except NoHeadway:
        return None
    usable_wh = asked.performance.usable_wh
    if usable_wh is not None and max(wh_of_sorties(clock), default=0.0) > usable_wh:
        return None
    higher = replace(route, waypoints=waypoints, duration_s=clock.total_s, timing=clock)
    return None if keys_of_zones_met([higher], departs_at, table) else higher
