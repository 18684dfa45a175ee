"""The routes of one plan, and those of missions flown at the same time, kept apart."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from planning.checks.zones import in_the_air_s, keys_of_zones_met
from planning.context import OtherFlights, PlanningContext
from planning.energy.power import NoHeadway
from planning.plan import PlannedRoute
from planning.request import EndAction, PlanRequest
from planning.separation.separation import Separation, TimedRoute, keep_apart, raised_agl_m, timed_route
from planning.trajectory.sorties import timing_of_route, wh_of_sorties
from planning.trajectory.waypoints import RoutePoints, Waypoints

MAX_WINDOWS = 6  # of other missions' flights, each at least twice as long as the one before


@dataclass(frozen=True, eq=False)
class SeparatedRoutes:
    """The routes put off or higher where others are too near, and the zones, by their keys, that they meet so."""

    routes: list[PlannedRoute]
    separation: Separation
    others: OtherFlights
    met: frozenset[int]


def separated(request: PlanRequest, alone: Sequence[PlannedRoute], context: PlanningContext) -> SeparatedRoutes:
    """Separate the routes of a plan from each other and from other missions' flights."""
    found = _separated(request, alone, context, may_raise=True)
    if found.met and any(found.separation.layers_m):  # higher and put off, a route may meet what higher alone it does not
        return _separated(request, alone, context, may_raise=False)
    return found


def _separated(request: PlanRequest, alone: Sequence[PlannedRoute], context: PlanningContext, *, may_raise: bool) -> SeparatedRoutes:
    """A route that is put off until after the flights that were looked up may meet those that come later: these are looked up, too."""
    flight = context.rules.flight
    window_s = flight.longest_flight_s
    for _ in range(MAX_WINDOWS):
        others = context.other_flights(window_s)
        routes, separation = routes_apart(request, alone, context, others.routes, may_raise=may_raise)
        ends_s = max((route.departs_s + in_the_air_s(route, flight) for route in routes), default=0.0)
        if ends_s <= window_s:
            break
        window_s = 2.0 * ends_s
    return SeparatedRoutes(routes, separation, others, keys_of_zones_met(routes, request.departs_at, context))


def routes_apart(
    request: PlanRequest,
    routes: Sequence[PlannedRoute],
    context: PlanningContext,
    fixed: Sequence[TimedRoute] = (),
    *,
    may_raise: bool = True,
) -> tuple[list[PlannedRoute], Separation]:
    """The routes with the delays and heights that keep them apart from each other and from `fixed`, and how that came out.

    A route is only flown higher where it then meets no zone and its battery still does.
    """
    flying = [number for number, route in enumerate(routes) if route.waypoints is not None]
    higher: dict[tuple[int, float], PlannedRoute] = {}

    def raised(place: int, layer_m: float) -> TimedRoute | None:
        number = flying[place]
        route = _raised(request, number, routes[number], layer_m, context)
        if route is None:
            return None
        higher[number, layer_m] = route
        return _timed(request, number, route)

    separation = keep_apart(
        [_timed(request, number, routes[number]) for number in flying],
        fixed,
        rules=context.rules.separation,
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


def _raised(request: PlanRequest, number: int, route: PlannedRoute, layer_m: float, context: PlanningContext) -> PlannedRoute | None:
    """The route flown so much higher between its targets; None where it may not be."""
    assert route.waypoints is not None  # noqa: S101 - only routes that are flown
    asked, flight = request.uavs[number], context.rules.flight
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
    return None if keys_of_zones_met([higher], request.departs_at, context) else higher
