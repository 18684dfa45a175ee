"""Finished routes against the zones, at the height and time of every leg."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from inspection.zones.reach import ZoneTable
from planning.clearance.nearby_zones import zones_near
from planning.clearance.zone_clearance import Breach, FlownRoute, Margins, breaches
from planning.context import PlanningContext
from planning.plan import PlannedRoute
from planning.request import EndAction
from planning.rules import FlightRules


@dataclass(frozen=True)
class MetZone:
    """A breach, and the zone's key and name."""

    breach: Breach
    zone: int
    name: str


def zones_met(routes: Sequence[FlownRoute], table: ZoneTable, margins: Margins) -> list[list[MetZone]]:
    """For each route the zones of the table that it meets; a route without times at any time."""
    found: list[list[MetZone]] = []
    if not len(table):
        return [[] for _ in routes]
    for route in routes:
        near, facts = zones_near(table, route.position, margins, route.window_s)
        met = breaches(route, facts, margins)
        found.append([MetZone(breach, int(near.ids[breach.zone]), near.names[breach.zone]) for breach in met])
    return found


def keys_of_zones_met(routes: Sequence[PlannedRoute], departs_at: datetime | None, context: PlanningContext) -> frozenset[int]:
    """Primary keys of the zones that a route meets; without a departure at any time."""
    flown = [flown_route(route, departs_at, context.rules.flight) for route in routes if route.waypoints is not None]
    return frozenset(meeting.zone for met in zones_met(flown, context.zones, context.rules.margins) for meeting in met)


def flown_route(route: PlannedRoute, departs_at: datetime | None, flight: FlightRules) -> FlownRoute:
    """The route, which is one that is flown, as the check of zones takes it."""
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
        ends_s=start_s + in_the_air_s(route, flight),
        lands=lands,
    )


def in_the_air_s(route: PlannedRoute, flight: FlightRules) -> float:
    """From take-off; who hovers at the end does so until the longest flight is over."""
    if route.end_action is not EndAction.HOVER or route.waypoints is None:
        return route.duration_s
    return max(route.duration_s, flight.longest_flight_s)
