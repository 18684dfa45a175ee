"""The last look before a plan leaves: its finished routes against the zones of now, at the height and time of every leg."""

from collections.abc import Iterable, Sequence
from datetime import datetime

import numpy as np
from django.conf import settings

from inspection.zones.reach import ZoneTable
from missions.flight_plan.clearance import FlownRoute, Margins, ZoneFacts, breaches
from missions.models import EndAction
from missions.services.plan_json import PlannedRoute

KEPT_SHARE = 0.98  # of the planner's clearance is asked for: the two measure in different planes
NEAR_DEG = 0.01  # a kilometre: wider than any clearance


def zones_met(routes: Sequence[PlannedRoute], departs_at: datetime | None, table: ZoneTable) -> frozenset[int]:
    """Primary keys of the zones that a route meets; without a departure at any time."""
    flown = [route for route in routes if route.waypoints is not None and route.line is not None]
    near = table.only(_near(flown, table)) if flown and len(table) else None
    if near is None or not len(near):
        return frozenset()
    facts = ZoneFacts.of(near.polygons, near.limits, _spans(flown, departs_at, near))
    margins = last_look_margins()
    met = (breach for route in flown for breach in breaches(flown_route(route, departs_at), facts, margins))
    return frozenset(int(near.ids[breach.zone]) for breach in met)


def last_look_margins() -> Margins:
    """Times are not among them: the spans of a table of zones contain theirs."""
    return Margins(
        lateral_m=KEPT_SHARE * settings.GRAPH_RULES.zone_clearance_m,
        height_m=settings.ZONE_RULES.height_margin_m,
        terrain_tolerance_m=settings.FLIGHT_RULES.terrain_tolerance_m,
    )


def flown_route(route: PlannedRoute, departs_at: datetime | None) -> FlownRoute:
    """As the last look takes it; the route is one that is flown."""
    assert route.waypoints is not None  # noqa: S101 - said above
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
        ends_s=start_s + route.duration_s,
        lands=lands,
    )


def _near(routes: Iterable[PlannedRoute], table: ZoneTable) -> np.ndarray:
    lines = np.concatenate([route.line for route in routes if route.line is not None])
    (west, south), (east, north) = lines.min(axis=0) - NEAR_DEG, lines.max(axis=0) + NEAR_DEG
    box = table.box
    return (box[:, 0] <= east) & (box[:, 2] >= west) & (box[:, 1] <= north) & (box[:, 3] >= south)


def _spans(routes: Sequence[PlannedRoute], departs_at: datetime | None, table: ZoneTable) -> Sequence[Sequence[tuple[float, float]] | None]:
    if departs_at is None:
        return [None] * len(table)
    from_s = departs_at.timestamp()
    return table.spans(from_s, from_s + max(route.departs_s + route.duration_s for route in routes) + 1.0)
