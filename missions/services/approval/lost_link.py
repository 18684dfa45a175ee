"""From where on their routes UAVs that lose their link could not do what is wished."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from django.conf import settings

from inspection.network.build.network import Network
from inspection.network.spans import spans_of
from inspection.selectors.graph import zones_of_table
from inspection.selectors.planning import heights_at, planning_read
from inspection.zones.reach import ZoneTable
from missions.models import Mission
from missions.selectors.zones import zone_margins
from missions.services.planning.plan_json import PlannedRoute
from missions.services.planning.requests import PlanRequest, lost_link_to_json
from missions.services.planning.zone_choice import zone_choice
from missions.services.stored_routes import stored_routes
from planning.clearance.lost_link import LostLink, LostLinkPlan, checked_returns
from planning.clearance.nearby_zones import zones_near
from planning.trajectory.heights import GroundHeights


def lost_link_check(
    request: PlanRequest, routes: Sequence[PlannedRoute], table: ZoneTable, network: Network, heights: GroundHeights | None
) -> dict[str, Any]:
    """The wish, and every waypoint from which it fails, in the shape of the API; who goes on flies what was checked already.

    highest_m: for each route at which height above its start a UAV returns where it returns highest, but not too high.

    What stands and hangs on the network is in the way. heights: of the terrain model; None: there is none.
    """
    wished = request.lost_link
    failed: list[dict[str, Any]] = []
    highest_m: list[float | None] = [None] * len(routes)
    if wished.behaviour is not LostLink.GO_ON:
        for number, route in enumerate(routes):
            own, highest_m[number] = _checked(request, number, route, table, network, heights)
            failed += own
    in_zones = [] if wished.behaviour is LostLink.GO_ON else _rally_points_in_zones(request, table)
    return {**lost_link_to_json(wished), "failed": failed, "highest_m": highest_m, "rally_points_in_zones": in_zones}


def _rally_points_in_zones(request: PlanRequest, table: ZoneTable) -> list[dict[str, Any]]:
    """Those that lie in a zone that can be in force during the flight, between the ground and the heights of flights; from 1 on."""
    flight, clearance_m = settings.FLIGHT_RULES, settings.GRAPH_RULES.zone_clearance_m
    zones = zones_of_table(table, zone_choice(table, request.departs_at, flight).widest)
    found = []
    for number, place in enumerate(request.lost_link.rally_points, start=1):
        if len(zones) and zones.contains([place], clearance_m, 0.0, flight.transit_agl_m)[0]:
            zone = zones.zone_at(place, 0.0, flight.transit_agl_m)
            found.append({"rally_point": number, "zone": "" if zone is None else zone[1]})
    return found


def lost_link_of_stored(mission: Mission, request: PlanRequest) -> dict[str, Any] | None:
    """The same for the stored routes of a mission, with the zones of now; None where there are none, or their times are not known.

    request: what the mission holds. Raises NoGraph.
    """
    routes = stored_routes(mission)
    if routes is None:
        return None
    ground = planning_read().ground()
    return lost_link_check(request, routes, ground.table, ground.network(), heights_at(ground.edition))


def _checked(
    request: PlanRequest, number: int, route: PlannedRoute, table: ZoneTable, network: Network, heights: GroundHeights | None
) -> tuple[list[dict[str, Any]], float | None]:
    if route.waypoints is None or route.timing is None:
        return [], None
    asked, margins = request.uavs[number], zone_margins()
    departs_s = None if request.departs_at is None else request.departs_at.timestamp() + route.departs_s
    window = None if departs_s is None else (departs_s, departs_s + route.duration_s + settings.FLIGHT_RULES.longest_flight_s)
    positions = np.concatenate([route.waypoints.points.position, np.array(request.lost_link.rally_points, dtype=np.float64).reshape(-1, 2)])
    near, facts = zones_near(table, positions, margins, window)
    found = checked_returns(
        route.waypoints,
        route.timing,
        LostLinkPlan(request.lost_link.behaviour, request.lost_link.rally_points, request.lost_link.hold_s),
        cruise_speed_mps=asked.cruise_speed_mps,
        performance=asked.performance,
        conditions=request.conditions,
        rules=settings.FLIGHT_RULES,
        zones=facts,
        margins=margins,
        departs_s=departs_s,
        ground_heights_m=None if route.is_flat else heights,
        spans=spans_of(network),
        home=asked.home,
    )
    failed = [
        {
            "route": number,
            "waypoint": one.waypoint,
            "haven": one.haven,
            "trouble": one.trouble.value,
            "missing_wh": None if one.missing_wh is None else round(one.missing_wh, 2),
            "zone": None if one.zone is None else near.names[one.zone],
            "zone_id": None if one.zone is None else int(near.ids[one.zone]),
            "over_m": None if one.over_m is None else round(one.over_m, 1),
        }
        for one in found.failed
    ]
    return failed, None if found.highest_m is None else round(found.highest_m, 1)
