"""The last look before a plan leaves: its finished routes against the zones of now, at the height and time of every leg."""

from collections.abc import Sequence
from datetime import datetime

from django.conf import settings

from inspection.zones.reach import ZoneTable
from missions.models import EndAction
from missions.selectors.zones import zones_met
from missions.services.planning.plan_json import PlannedRoute
from planning.clearance.zone_clearance import FlownRoute


def keys_of_zones_met(routes: Sequence[PlannedRoute], departs_at: datetime | None, table: ZoneTable) -> frozenset[int]:
    """Primary keys of the zones that a route meets; without a departure at any time."""
    flown = [flown_route(route, departs_at) for route in routes if route.waypoints is not None]
    return frozenset(meeting.zone for met in zones_met(flown, table) for meeting in met)


def flown_route(route: PlannedRoute, departs_at: datetime | None) -> FlownRoute:
    """As the last look takes it; the route is one that is flown."""
    assert route.waypoints is not None and route.timing is not None  # noqa: S101 - only routes that are flown
    points, lands = route.waypoints.points, route.end_action is not EndAction.HOVER
    if departs_at is None:
        return FlownRoute(points.position, points.agl_m, route.waypoints.amsl_m, lands=lands)
    start_s = departs_at.timestamp() + route.departs_s
    return FlownRoute(
        points.position,
        points.agl_m,
        route.waypoints.amsl_m,
        arrival_s=start_s + route.timing.arrival_s,
        departs_s=start_s,
        ends_s=start_s + in_the_air_s(route),
        lands=lands,
    )


def in_the_air_s(route: PlannedRoute) -> float:
    """From take-off; who hovers at the end does so until the longest flight is over."""
    if route.end_action is not EndAction.HOVER or route.waypoints is None:
        return route.duration_s
    return max(route.duration_s, settings.FLIGHT_RULES.longest_flight_s)
