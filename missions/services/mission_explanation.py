"""Why the stored plan of a mission is as it is: each route that is flown and each target that is not."""

from collections.abc import Collection
from typing import Any

from missions.models import Mission, WaypointKind
from missions.services.requests import InvalidRequest, PlanRequest
from missions.services.why_route import explain_route
from missions.services.why_target import explain_unreached_target

MOST_EXPLAINED = 20  # routes, and targets, of one answer
SHORTEST_WAYS = "shortest_ways"


def explain_mission(
    *, mission: Mission, request: PlanRequest, uavs: Collection[int] | None = None, targets: Collection[int] | None = None
) -> dict[str, Any]:
    """On the ground of now, as explain_route and explain_unreached_target tell; mission: with its routes, waypoints and targets loaded.

    uavs, targets: those that are asked about, by their places in the mission; None: all of them, up to MOST_EXPLAINED of each. A route
    that can no longer be explained, as the ground has changed, tells why under `fault`. Raises NoGraph.
    """
    place_of = {target.pk: target.sequence for target in mission.targets.all()}
    orders: list[list[int]] = [[] for _ in request.uavs]
    for route in mission.routes.all():
        visited = [waypoint.target_id for waypoint in route.waypoints.all() if waypoint.kind == WaypointKind.TARGET]
        orders[route.mission_uav.sequence] = [place_of[target] for target in visited if target is not None]
    is_by_length = any(warning["code"] == SHORTEST_WAYS for warning in mission.plan_warnings)
    flown = [uav for uav, order in enumerate(orders) if order and (uavs is None or uav in uavs)]
    left_out = [
        target.sequence for target in mission.targets.all() if target.unassigned_reason and (targets is None or target.sequence in targets)
    ]
    return {
        "routes": [_route(request, orders, uav, is_by_length=is_by_length) for uav in flown[:MOST_EXPLAINED]],
        "targets": [
            explain_unreached_target(request=request, target=target, organisation=mission.organisation)
            for target in left_out[:MOST_EXPLAINED]
        ],
        "more_routes": max(0, len(flown) - MOST_EXPLAINED),
        "more_targets": max(0, len(left_out) - MOST_EXPLAINED),
    }


def _route(request: PlanRequest, orders: list[list[int]], uav: int, *, is_by_length: bool) -> dict[str, Any]:
    try:
        found = explain_route(request=request, routes=orders, uav=uav, is_by_length=is_by_length)
    except InvalidRequest as error:
        return {"uav": uav, "fault": next(iter(error.faults.values())), "explanation": None}
    return {"uav": uav, "fault": "", "explanation": found}
