"""Missions from rows to the shapes of the API."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from inspection.selectors import asset_detail, label_now
from missions.models import InspectionTarget, Mission, MissionUav, Route, Waypoint
from missions.reason_texts import with_texts
from missions.selectors.mission_list import ListedMission, sketch
from missions.selectors.missions import approval_in_force, open_plan_of_mission
from missions.selectors.stale_plans import cause_json, has_lost_base, is_stale, stale_causes, stale_reason
from missions.selectors.uav_changes import uav_change_json, uav_changes
from missions.serializers.commands import approval_json
from missions.services import FLAT_GROUND, NO_QUALITY, NO_SHORTFALL, TERRAIN_MODEL, locked_targets
from missions.services.missions import EDITABLE
from planning.energy.conditions import conditions_from_json, conditions_to_json
from planning.energy.performance import performance_from_json, performance_to_json
from planning.plan_json import straight_json
from planning.request import EndAction, lost_link_from_json, lost_link_to_json
from planning.trajectory.waypoints import KINDS, NONE, WaypointKind
from workspace.reason_texts import why_text


def mission_json(mission: Mission) -> dict[str, Any]:
    """Return a mission with all its parts, as loaded by selectors.mission_of_organisation."""
    changes = uav_changes(mission.pk)
    causes = stale_causes(mission, changes)
    return {
        "id": str(mission.pk),
        "name": mission.name,
        "external_id": mission.external_id,
        "attributes": mission.attributes,
        "state": mission.state,
        "author": mission.author.username if mission.author else None,
        "objective": mission.objective,
        "return_to_start": mission.return_to_start,
        "departs_at": mission.departs_at,
        "simulates": mission.simulates_id,
        "campaign": mission.campaign_id,
        "conditions": conditions_to_json(conditions_from_json(mission.conditions)),
        "charging_w": mission.charging_w,
        "lost_link": lost_link_to_json(lost_link_from_json(mission.lost_link)),
        "revision": mission.revision,
        "created_at": mission.created_at,
        "updated_at": mission.updated_at,
        "planned_at": mission.planned_at,
        "graph_version": mission.graph_version,
        "is_stale": bool(causes),
        "stale_reason": stale_reason(causes),
        "stale_causes": [cause_json(cause) for cause in causes],
        "uav_changes": [uav_change_json(change) for change in changes],
        "flat_ground_assumed": mission.flat_ground_assumed,
        "locks": mission.locks,
        "colours": mission.colours,
        "uavs": [_uav(row) for row in mission.mission_uavs.all()],
        "targets": [_target(row) for row in mission.targets.all()],
        "plan": _plan(mission),
        "last_plan": mission.last_plan and {name: value for name, value in mission.last_plan.items() if name != "by_hand"},
        "planning_job": open_plan_of_mission(mission),
        "approval": _approval(mission),
    }


def mission_summary(
    mission: ListedMission,
    revision: int,
    drawing: dict[str, Any],
    bases: frozenset[tuple[float, ...]],
    *,
    has_other_uavs: bool,
    has_failed_rehearsal: bool,
) -> dict[str, Any]:
    """Return a line of the list, as loaded by list_selectors.mission_rows.

    `revision` is the current dataset version, `drawing` the surroundings, `bases` comes from stale_selectors.bases_landed_at,
    `has_other_uavs` from uav_change_selectors, `has_failed_rehearsal` from hooks.rehearsals.
    """
    return {
        "id": str(mission.pk),
        "name": mission.name,
        "external_id": mission.external_id,
        "state": mission.state,
        "author": mission.author.username if mission.author else None,
        "revision": mission.revision,
        "updated_at": mission.updated_at,
        "planned_at": mission.planned_at,
        "deleted_at": mission.deleted_at,
        "target_count": mission.target_count,
        "unassigned_count": mission.unassigned_count,
        "uav_count": mission.uav_count,
        "is_simulated": mission.is_simulated,
        "is_demo": mission.is_demo,
        "total_length_m": mission.total_length_m,
        "longest_route_m": mission.longest_route_m,
        "duration_s": mission.duration_s,
        "is_stale": is_stale(mission, revision, has_lost_base=has_lost_base(mission, bases), has_other_uavs=has_other_uavs),
        "has_other_uavs": has_other_uavs,
        "has_failed_rehearsal": has_failed_rehearsal,
        "sketch": sketch(mission),
        "places": drawing["places"],
        "lines": drawing["lines"],
    }


def _approval(mission: Mission) -> dict[str, Any] | None:
    """Return the approval with the number of flights of each UAV, and how many of them it has flown."""
    found = None if mission.state in EDITABLE else approval_json(approval_in_force(mission))
    if found is not None:
        found["flights"] = [
            {
                "uav": route.mission_uav.sequence,
                "flights": 1 + sum(waypoint.kind == WaypointKind.BASE for waypoint in route.waypoints.all()),
                "flown": route.flights_flown,
                "has_failed": route.has_failed,
            }
            for route in mission.routes.all()
            if route.geometry is not None
        ]
    return found


def _uav(row: MissionUav) -> dict[str, Any]:
    return {
        "id": row.uav_id,
        "name": row.name,
        "position": list(row.start.coords),
        "max_range_m": row.max_range_m,
        "cruise_speed_mps": row.cruise_speed_mps,
        "end_action": row.end_action,
        "most_targets": row.most_targets,
        "sensors": row.sensors,
        "sorties": row.sorties,
        "is_simulated": row.uav is not None and row.uav.is_simulated,
        "own_figures": row.own_figures,
        **performance_to_json(performance_from_json(row.performance)),
    }


def _target(row: InspectionTarget) -> dict[str, Any]:
    asset = row.asset
    at = row.place
    return {
        "asset": row.asset_id,
        "label": row.label if asset is None else label_now(asset, row.label),
        "detail": "" if asset is None else asset_detail(asset),
        "kind": None if asset is None else asset.kind,
        "line": None if asset is None else asset.line_id,
        "length_m": None if asset is None else asset.length_m,
        "position": None if at is None else list(at.coords),
        "stretch": [list(end) for end in row.stretch.coords] if row.stretch else None,
        "is_point": row.position is not None,
        "task": row.task,
        "priority": row.priority,
        "uav": row.uav_name or None,
        "sensor": row.sensor,
        "external_id": row.external_id,
        "attributes": row.attributes,
        "state": row.state,
        "unassigned_reason": row.unassigned_reason,
        "unassigned_message": why_text(row.unassigned_why, row.unassigned_message),
    }


def _plan(mission: Mission) -> dict[str, Any] | None:
    """Return the stored plan in the shape of the planner's answer; None for a draft."""
    if mission.planned_at is None:
        return None
    sequence_of: dict[int | None, int] = {target.pk: target.sequence for target in mission.targets.all()}
    return {
        "objective": mission.objective,
        "return_to_start": mission.return_to_start,
        "total_length_m": mission.total_length_m,
        "longest_route_m": mission.longest_route_m,
        "total_duration_s": round(sum(route.duration_s for route in mission.routes.all()), 1),
        "total_energy_wh": mission.total_energy_wh,
        "departs_at": mission.departs_at,
        "conditions": conditions_to_json(conditions_from_json(mission.conditions)),
        "separation": mission.separation,
        "lost_link": _lost_link_check_json(mission.lost_link_check),
        "graph_version": mission.graph_version,
        "ground_revision": mission.ground_revision,
        "flat_ground_assumed": mission.flat_ground_assumed,
        "terrain": FLAT_GROUND if mission.flat_ground_assumed else TERRAIN_MODEL,
        **(NO_QUALITY | {name: value for name, value in (mission.plan_quality or {}).items() if name in NO_QUALITY or name == "proof"}),
        "locks": mission.locks,
        "warnings": with_texts(mission.plan_warnings),
        "routes": [_route(route, mission, sequence_of) for route in mission.routes.all()],
        "unassigned": [
            {
                "target": target.sequence,
                "reason": target.unassigned_reason,
                "message": why_text(target.unassigned_why, target.unassigned_message),
                "why": target.unassigned_why,
                **(NO_SHORTFALL | target.unassigned_missing),
            }
            for target in mission.targets.all()
            if target.unassigned_reason
        ],
    }


def _lost_link_check_json(check: dict[str, Any] | None) -> dict[str, Any] | None:
    """Return the stored check. An older version, which an approval may have frozen, calls the return point `haven`."""
    if check is None:
        return None
    failed = [{("return_point" if name == "haven" else name): value for name, value in one.items()} for one in check["failed"]]
    return {**check, "failed": failed}


def _straight(waypoints: Sequence[Waypoint], length_m: float) -> dict[str, float]:
    position = np.array([waypoint.position.coords[:2] for waypoint in waypoints], dtype=np.float64)
    kind = np.array([KINDS.index(WaypointKind(waypoint.kind).value) for waypoint in waypoints], dtype=np.int64)
    target = np.array([NONE if waypoint.target_id is None else waypoint.target_id for waypoint in waypoints], dtype=np.int64)
    return straight_json(position, kind, target, length_m)


def _route(route: Route, mission: Mission, sequence_of: dict[int | None, int]) -> dict[str, Any]:
    waypoints = list(route.waypoints.all())
    uav = route.mission_uav
    targets = [sequence_of[waypoint.target_id] for waypoint in waypoints if waypoint.kind == WaypointKind.TARGET]
    return {
        "uav": uav.name,
        "uav_id": uav.uav_id,
        "end_action": EndAction.RETURN if mission.return_to_start else uav.end_action,
        "base": route.base_name or None,
        "length_m": route.length_m,
        "duration_s": route.duration_s,
        "departs_s": route.departs_s,
        "energy_wh": route.energy_wh,
        "battery_percent": route.battery_percent,
        "arrival_s": [waypoint.arrival_s for waypoint in waypoints],
        "used_wh": None if route.energy_wh is None else [waypoint.used_wh for waypoint in waypoints],
        "battery_left_percent": None if route.energy_wh is None else [waypoint.battery_left_percent for waypoint in waypoints],
        "charging": route.charging,
        "by_hand": [place for place, waypoint in enumerate(waypoints) if waypoint.is_by_hand],
        "speeds_by_hand": [
            {"waypoint": place, "speed_mps": waypoint.speed_mps}
            for place, waypoint in enumerate(waypoints)
            if waypoint.speed_mps is not None
        ],
        "hand_steps": len(route.before_hand),
        "targets": targets,
        "locked": locked_targets(targets, (lock["targets"] for lock in mission.locks if lock["uav"] == uav.name)),
        "explanation": _straight(waypoints, route.length_m) if waypoints else None,
        "geometry": {"type": "LineString", "coordinates": [list(at) for at in route.geometry.coords]} if route.geometry else None,
        "waypoints": [
            {
                "position": list(waypoint.position.coords),
                "kind": waypoint.kind,
                "asset": waypoint.asset_id,
                "target": sequence_of.get(waypoint.target_id),
                "task": waypoint.task,
                "altitude_agl_m": waypoint.altitude_agl_m,
                "altitude_amsl_m": waypoint.altitude_amsl_m,
                "altitude_relative_m": waypoint.altitude_relative_m,
            }
            for waypoint in waypoints
        ],
    }
