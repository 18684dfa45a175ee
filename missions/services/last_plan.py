"""Summary of a replaced plan: enough to compare it with the next one and to draw its strips."""

from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from inspection.geodesy import distance_m
from missions.models import InspectionTarget, Mission, Route, Waypoint
from missions.services.manual_edits.legs import hand_legs_json
from planning.request import EndAction
from planning.trajectory.waypoints import WaypointKind

OFF_NETWORK = {WaypointKind.START, WaypointKind.END}


def summary_of_plan(*, mission: Mission) -> dict[str, Any] | None:
    """Return a summary of the mission's current plan; None for a draft."""
    if mission.planned_at is None:
        return None
    targets = {target.pk: target for target in mission.targets.all()}
    routes = mission.routes.select_related("mission_uav").prefetch_related("waypoints").order_by("mission_uav__sequence")
    summaries = [_route(mission, route, targets) for route in routes]
    return {
        "planned_at": mission.planned_at.isoformat(),
        "objective": mission.objective,
        "return_to_start": mission.return_to_start,
        "locks": len(mission.locks),
        "quality": mission.plan_quality,
        "total_length_m": mission.total_length_m,
        "duration_s": max((route.departs_s + route.duration_s for route in routes), default=0.0),
        "routes": summaries,
        "unassigned": [_target(target) for target in targets.values() if target.unassigned_reason],
        "by_hand": hand_legs_json(mission),
    }


def _route(mission: Mission, route: Route, targets: dict[int, InspectionTarget]) -> dict[str, Any]:
    waypoints = sorted(route.waypoints.all(), key=lambda waypoint: waypoint.sequence)
    along_m = _along_m(waypoints, route.length_m)
    return {
        "uav": route.mission_uav.name,
        "uav_id": route.mission_uav.uav_id,
        "start": list(route.mission_uav.start.coords),
        "end_action": EndAction.RETURN if mission.return_to_start else route.mission_uav.end_action,
        "base": route.base_name or None,
        "length_m": route.length_m,
        "duration_s": route.duration_s,
        "stops": [
            _target(targets[waypoint.target_id]) | {"at_m": round(at_m, 1)}
            for waypoint, at_m in zip(waypoints, along_m, strict=True)
            if waypoint.kind == WaypointKind.TARGET and waypoint.target_id is not None
        ],
        "off_network": _off_network(waypoints, along_m),
    }


def _along_m(waypoints: list[Waypoint], length_m: float) -> list[float]:
    """Return the metres flown to each waypoint, scaled so that the sum is the route's own length."""
    if len(waypoints) < 2:
        return [0.0] * len(waypoints)
    places = np.array([waypoint.position.coords for waypoint in waypoints])
    legs_m = distance_m(places[:-1], places[1:])
    scale = length_m / float(legs_m.sum()) if legs_m.sum() > 0 else 1.0
    return [metres * scale for metres in accumulate([0.0, *legs_m.tolist()])]


def _off_network(waypoints: list[Waypoint], along_m: list[float]) -> list[list[float]]:
    """Return the parts in which the route leaves the network, with adjacent ones merged."""
    is_off = [waypoint.kind in OFF_NETWORK or waypoint.asset_id is None for waypoint in waypoints]
    found: list[list[float]] = []
    for (first_off, second_off), (from_m, to_m) in zip(pairwise(is_off), pairwise(along_m), strict=True):
        if not (first_off or second_off) or from_m == to_m:
            continue
        if found and found[-1][1] == round(from_m, 1):
            found[-1][1] = round(to_m, 1)
        else:
            found.append([round(from_m, 1), round(to_m, 1)])
    return found


def _target(target: InspectionTarget) -> dict[str, Any]:
    """Return what identifies a target on the page, and its name."""
    return {
        "asset": target.asset_id,
        "position": list(target.position.coords) if target.position else None,
        "stretch": [list(end) for end in target.stretch.coords] if target.stretch else None,
        "label": target.label,
    }
