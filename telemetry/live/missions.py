"""Missions as live pages show them: their state, and that of each target."""

from collections import defaultdict
from collections.abc import Iterable
from typing import Any
from uuid import UUID

from missions.models import InspectionTarget, Mission, MissionUav, TargetState, Waypoint, WaypointKind


def missions_json(mission_ids: Iterable[UUID]) -> list[dict[str, Any]]:
    missions = list(Mission.objects.filter(pk__in=list(mission_ids)))
    ids = [mission.pk for mission in missions]
    targets: dict[UUID, list[InspectionTarget]] = defaultdict(list)
    for target in InspectionTarget.objects.filter(mission__in=ids).defer("position", "stretch", "task"):
        targets[target.mission_id].append(target)
    uavs: dict[UUID, list[dict[str, Any]]] = defaultdict(list)
    flying = MissionUav.objects.filter(mission__in=ids, route__geometry__isnull=False)
    for mission, place, name, uav in flying.values_list("mission", "sequence", "name", "uav"):
        uavs[mission].append({"place": place, "name": name, "uav": uav})
    places = _places(ids)
    return [_mission_json(mission, uavs[mission.pk], targets[mission.pk], places) for mission in missions]


def _places(mission_ids: list[UUID]) -> dict[int, int]:
    """By target the place of the UAV that flies to it."""
    visits = Waypoint.objects.filter(route__mission__in=mission_ids, kind=WaypointKind.TARGET)
    return dict(visits.order_by().values_list("target", "route__mission_uav__sequence"))


def _mission_json(mission: Mission, uavs: list[dict[str, Any]], targets: list[InspectionTarget], places: dict[int, int]) -> dict[str, Any]:
    return {
        "id": mission.pk,
        "name": mission.name,
        "call_number": mission.call_number,
        "colours": mission.colours,
        "state": mission.state,
        "revision": mission.revision,
        "departs_at": mission.departs_at,
        "started_at": mission.started_at,
        "ended_at": mission.ended_at,
        "uavs": uavs,
        "targets": [
            {
                "place": target.sequence,
                "label": target.label,
                "state": target.state,
                "state_at": target.state_at,
                "state_reason": target.state_reason,
                "uav": places.get(target.pk),
            }
            for target in targets
        ],
        "counts": {"complete": sum(target.state == TargetState.COMPLETE for target in targets), "all": len(targets)},
    }
