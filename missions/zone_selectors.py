"""Stored routes against the zones in force: where, when and how high they meet one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from django.conf import settings

from inspection.selectors.zone_table import zone_table
from missions.flight_plan.clearance import Breach, FlownRoute, Margins, breaches
from missions.flight_plan.zone_facts import zones_near
from missions.models import EndAction, Mission, Route

CLEARANCE_KEPT = 0.99  # routes keep their clearance; what they come short of it by is rounding


@dataclass(frozen=True)
class MetZone:
    """A breach, and the zone's key and name."""

    breach: Breach
    zone: int
    name: str


def zone_margins() -> Margins:
    """What the settings want to be kept from zones."""
    return Margins(
        lateral_m=CLEARANCE_KEPT * settings.GRAPH_RULES.zone_clearance_m,
        height_m=settings.ZONE_RULES.height_margin_m,
        time_s=settings.ZONE_RULES.time_margin_s,
        terrain_tolerance_m=settings.FLIGHT_RULES.terrain_tolerance_m,
    )


def flown_route(route: Route, departs_s: float | None) -> FlownRoute:
    """A stored route; departs_s: when its mission begins, in seconds since the epoch, None for at any time."""
    waypoints = list(route.waypoints.all())
    arrival_s = np.array([np.nan if waypoint.arrival_s is None else waypoint.arrival_s for waypoint in waypoints], dtype=np.float64)
    is_timed = departs_s is not None and not np.isnan(arrival_s).all()
    began_s = 0.0 if departs_s is None else departs_s
    return FlownRoute(
        position=np.array([waypoint.position.coords[:2] for waypoint in waypoints], dtype=np.float64).reshape(-1, 2),
        agl_m=np.array([waypoint.altitude_agl_m for waypoint in waypoints], dtype=np.float64),
        amsl_m=np.array(
            [np.nan if waypoint.altitude_amsl_m is None else waypoint.altitude_amsl_m for waypoint in waypoints], dtype=np.float64
        ),
        arrival_s=began_s + arrival_s if is_timed else None,
        departs_s=began_s + route.departs_s if is_timed else None,
        ends_s=began_s + route.departs_s + route.duration_s if is_timed else None,
        lands=route.mission_uav.end_action != EndAction.HOVER,
    )


def zones_met(routes: Sequence[FlownRoute]) -> list[list[MetZone]]:
    """For each route the zones in force that it meets; of a route without times at any time."""
    margins, table = zone_margins(), zone_table()
    found = []
    for route in routes:
        near, facts = zones_near(table, route.position, margins, _window(route))
        met = breaches(route, facts, margins)
        found.append([MetZone(breach, int(near.ids[breach.zone]), near.names[breach.zone]) for breach in met])
    return found


def departure_s(mission: Mission) -> float | None:
    return None if mission.departs_at is None else float(mission.departs_at.timestamp())


def _window(route: FlownRoute) -> tuple[float, float] | None:
    """From take-off to the end; None where any of it is not known."""
    if route.arrival_s is None or route.departs_s is None or route.ends_s is None or np.isnan(route.arrival_s).any():
        return None
    moments = [route.departs_s, route.ends_s, float(route.arrival_s.min()), float(route.arrival_s.max())]
    return min(moments), max(moments)
