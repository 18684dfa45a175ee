"""From where on their routes UAVs that lose their link could not do what is asked for."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from inspection.network.spans import spans_of
from planning.airspace import zone_choice
from planning.clearance.lost_link import LostLink, LostLinkPlan, checked_returns
from planning.clearance.nearby_zones import zones_near
from planning.clearance.surroundings import Surroundings
from planning.context import PlanningContext
from planning.energy.path_cost import FlightClass
from planning.plan import PlannedRoute
from planning.request import PlanRequest, lost_link_to_json


def lost_link_check(request: PlanRequest, routes: Sequence[PlannedRoute], context: PlanningContext) -> dict[str, Any]:
    """Return what is asked for, and every waypoint from which it fails, in the shape of the API.

    A UAV that goes on flies what was checked already. highest_m: for each route at which height above its start a UAV returns where it
    returns highest, but not too high. What stands and hangs on the network is in the way.
    """
    wished = request.lost_link
    failed: list[dict[str, Any]] = []
    highest_m: list[float | None] = [None] * len(routes)
    if wished.behaviour is not LostLink.GO_ON:
        for number, route in enumerate(routes):
            own, highest_m[number] = _checked(request, number, route, context)
            failed += own
    in_zones = [] if wished.behaviour is LostLink.GO_ON else _rally_points_in_zones(request, context)
    return {**lost_link_to_json(wished), "failed": failed, "highest_m": highest_m, "rally_points_in_zones": in_zones}


def _rally_points_in_zones(request: PlanRequest, context: PlanningContext) -> list[dict[str, Any]]:
    """Those that lie in a zone that can be in force during the flight, between the ground and the heights of flights; from 1 on."""
    flight, clearance_m = context.rules.flight, context.rules.linking.zone_clearance_m
    zones = context.zone_index(zone_choice(context.zones, request.departs_at, flight).widest)
    found = []
    for number, place in enumerate(request.lost_link.rally_points, start=1):
        if len(zones) and zones.contains([place], clearance_m, 0.0, flight.transit_agl_m)[0]:
            zone = zones.zone_at(place, 0.0, flight.transit_agl_m)
            found.append({"rally_point": number, "zone": "" if zone is None else zone[1]})
    return found


def _checked(request: PlanRequest, number: int, route: PlannedRoute, context: PlanningContext) -> tuple[list[dict[str, Any]], float | None]:
    if route.waypoints is None or route.timing is None:
        return [], None
    asked, rules, margins = request.uavs[number], context.rules.flight, context.rules.margins
    departs_s = None if request.departs_at is None else request.departs_at.timestamp() + route.departs_s
    window = None if departs_s is None else (departs_s, departs_s + route.duration_s + rules.longest_flight_s)
    positions = np.concatenate([route.waypoints.points.position, np.array(request.lost_link.rally_points, dtype=np.float64).reshape(-1, 2)])
    near, facts = zones_near(context.zones, positions, margins, window)
    found = checked_returns(
        route.waypoints,
        route.timing,
        LostLinkPlan(request.lost_link.behaviour, request.lost_link.rally_points, request.lost_link.hold_s, asked.home),
        flying=FlightClass(asked.performance, asked.cruise_speed_mps),
        conditions=request.conditions,
        rules=rules,
        around=Surroundings(facts, margins, None if route.is_flat else context.heights_m, spans_of(context.network)),
        departs_s=departs_s,
    )
    failed = [
        {
            "route": number,
            "waypoint": one.waypoint,
            "return_point": one.return_point,
            "trouble": one.trouble.value,
            "missing_wh": None if one.missing_wh is None else round(one.missing_wh, 2),
            "zone": None if one.zone is None else near.names[one.zone],
            "zone_id": None if one.zone is None else int(near.ids[one.zone]),
            "over_m": None if one.over_m is None else round(one.over_m, 1),
        }
        for one in found.failed
    ]
    return failed, None if found.highest_m is None else round(found.highest_m, 1)
