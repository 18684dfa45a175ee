"""Targets that count as complete because their UAV went on are looked at again: was it there, and for long enough?

What a UAV reports of a target itself is the last word on it, and is not looked at.
"""

from dataclasses import dataclass, field
from typing import Any
from uuid import UUID

from django.db import connection

from missions.mavlink.frozen import route_from_json
from missions.models import Approval, Mission
from missions.services.flying import NOT_HELD, NOT_REACHED, mark_missed
from telemetry.mission_report.visits import visits_of
from telemetry.selectors.mission_record import fastest_mps, fixes_of

SETTLED_S = 3.0  # by then the reports about it are stored
LOOKED_BACK_S = 120.0  # missions that have just ended are looked at, too
_COMPLETE = """
SELECT mission.id, approval.id, place.uav_id, array_agg(DISTINCT target.sequence), max(target.state_at)
FROM missions_inspectiontarget target
JOIN missions_mission mission ON mission.id = target.mission_id
JOIN missions_approval approval ON approval.mission_id = mission.id AND approval.revoked_at IS NULL
JOIN missions_waypoint waypoint ON waypoint.target_id = target.id
JOIN missions_route route ON route.id = waypoint.route_id
JOIN missions_missionuav place ON place.id = route.mission_uav_id
WHERE target.state = 'complete'
    AND target.state_at BETWEEN now() - make_interval(secs => %(back_s)s) AND now() - make_interval(secs => %(settled_s)s)
    AND mission.deleted_at IS NULL AND place.uav_id = ANY(%(uav_ids)s)
    AND NOT EXISTS (SELECT 1 FROM telemetry_inspectionresult result WHERE result.target_id = target.id)
GROUP BY mission.id, approval.id, place.uav_id
"""


@dataclass
class TargetChecks:
    """What one watch has looked at already. After a start everything recent is looked at again, which changes nothing twice."""

    _looked_at: dict[tuple[UUID, int], Any] = field(default_factory=dict)  # when the newest target became complete

    def check(self, uav_ids: list[int]) -> int:
        """Targets of these UAVs that have become complete. Returns how many of them were missed."""
        with connection.cursor() as cursor:
            cursor.execute(_COMPLETE, {"uav_ids": uav_ids, "back_s": LOOKED_BACK_S, "settled_s": SETTLED_S})
            found = cursor.fetchall()
        missed, looked_at = 0, {}
        for mission_id, approval_id, uav_id, places, newest in found:
            if self._looked_at.get((mission_id, uav_id)) != newest:
                missed += _skip_missed(mission_id, approval_id, uav_id, set(places))
            looked_at[mission_id, uav_id] = newest
        self._looked_at = looked_at  # what is no longer recent is not found again
        return missed


def _skip_missed(mission_id: UUID, approval_id: UUID, uav_id: int, places: set[int]) -> int:
    routes = Approval.objects.values_list("document", flat=True).get(pk=approval_id)["routes"]
    approved = next((route for route in routes if route["uav"] == uav_id), None)
    if approved is None:
        return 0
    route = route_from_json(approved["route"])
    fixes = fixes_of(Mission(pk=mission_id), uav_id)
    if not fixes:  # nothing tells where it was
        return 0
    return sum(
        mark_missed(mission_id=mission_id, target=visit.target, reason=NOT_HELD if visit.can_have_reached else NOT_REACHED)
        for visit in visits_of(route, fixes, fastest_mps=fastest_mps(route, approved["figures"]))
        if visit.target in places and not visit.is_done
    )
