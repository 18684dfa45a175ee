"""The part of their routes that the UAVs of a flying mission still have ahead, with times."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

from inspection.geodesy import LonLat
from missions.models import InspectionTarget, Mission, Route, TargetState, Uav, Waypoint
from missions.selectors.zones import flown_route
from planning.clearance.zone_clearance import TAKE_OFF, FlownRoute
from planning.trajectory.remaining_route import PassedPoint, PlaceOnRoute, place_on_route
from planning.trajectory.waypoints import WaypointKind

RECEIVED_WITHIN_S = 30.0  # an older position counts as unknown
OFF_ROUTE_M = 100.0
REACHED = (TargetState.IN_PROGRESS, TargetState.COMPLETE)


@dataclass(frozen=True, eq=False)
class WayAhead:
    """A route with its current times; the legs before `first_leg` are already flown."""

    route: Route
    flown: FlownRoute
    first_leg: int


def ways_ahead(mission: Mission, now: datetime) -> list[WayAhead]:
    """Return the remaining routes of a mission as selectors load it.

    A UAV with a recent position near its route is as late or early as it is there. For others only the targets reached are known, and they
    keep the mission's times.
    """
    targets = {target.pk: target for target in mission.targets.all()}
    routes = [
        route for route in mission.routes.all() if route.geometry is not None and not route.has_failed and route.continued_by_id is None
    ]
    uavs = Uav.objects.in_bulk([route.mission_uav.uav_id for route in routes if route.mission_uav.uav_id is not None])
    found = (_way_ahead(mission, route, targets, uavs.get(route.mission_uav.uav_id), now) for route in routes)
    return [way for way in found if way is not None]


def _way_ahead(mission: Mission, route: Route, targets: Mapping[int, InspectionTarget], uav: Uav | None, now: datetime) -> WayAhead | None:
    rows = list(route.waypoints.all())
    changes = [place for place, row in enumerate(rows) if row.kind == WaypointKind.BASE]
    if len(rows) < 2 or route.flights_flown > len(changes):
        return None
    begun = mission.started_at or mission.departs_at
    began_s = None if begun is None else begun.timestamp()
    after_base = changes[route.flights_flown - 1] + 1 if route.flights_flown else 0
    first = max(first_ahead(rows, targets), after_base + 1)
    points = [passed_point(row, targets) for row in rows]
    here = _place(points, uav, now, first)
    if here is not None and all(row.arrival_s is not None for row in rows):
        shifted_s = now.timestamp() - here.at_s(points)
        began_s = shifted_s if began_s is None or here.ahead > 1 else max(began_s, shifted_s)  # a UAV waiting on the ground is not early
    ahead = first if here is None else here.ahead
    return WayAhead(route, flown_route(route, began_s), TAKE_OFF if ahead == 1 else ahead - 1)


def _place(points: Sequence[PassedPoint], uav: Uav | None, now: datetime, first: int) -> PlaceOnRoute | None:
    """Return the UAV's place on its route; None where it is unknown."""
    if uav is None or uav.located_at is None or abs((now - uav.located_at).total_seconds()) > RECEIVED_WITHIN_S:
        return None
    here = place_on_route(points, LonLat(*uav.location.coords[:2]), first=first)
    return here if here.away_m <= OFF_ROUTE_M else None


def passed_point(row: Waypoint, targets: Mapping[int, InspectionTarget]) -> PassedPoint:
    """Return a waypoint as a passed point. targets: of the mission, by their keys."""
    return PassedPoint(
        LonLat(*row.position.coords[:2]),
        row.altitude_agl_m,
        row.arrival_s or 0.0,
        (row.task or {}).get("hold_s", 0.0),
        None if row.target_id is None else targets[row.target_id].sequence,
    )


def first_ahead(rows: Sequence[Waypoint], targets: Mapping[int, InspectionTarget]) -> int:
    """Return the index of the waypoint after the last target reached."""
    reached = [
        place
        for place, row in enumerate(rows)
        if row.kind == WaypointKind.TARGET and row.target_id is not None and targets[row.target_id].state in REACHED
    ]
    return max(reached, default=0) + 1
