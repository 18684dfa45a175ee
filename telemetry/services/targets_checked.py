"""Checks targets that count as complete because their UAV continued: did it reach them and hold long enough?

A UAV's own report on a target has precedence. The time of reaching and the hold are stored for all targets.
"""

from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any
from uuid import UUID

from django.db import connection
from django.db.models import Exists, OuterRef
from django.utils import timezone

from mavlink.approved_route import route_from_json
from missions.models import Approval, InspectionTarget, Mission
from missions.services.commands.flight_progress import NOT_HELD, NOT_REACHED, SETTLED, mark_missed, store_visit
from telemetry.mission_report.visits import ReportedVisit, visits_of
from telemetry.selectors.mission_record import approval_on_record, at, fastest_mps, fixes_of, routes_on_record

SETTLED_S = 3.0  # by then their reports are stored
LATELY = timedelta(days=2)
LOOKBACK_S = 120.0  # includes missions that have just ended
_SETTLED = """
SELECT mission.id, approval.id, place.uav_id, max(target.state_at), array_agg(DISTINCT target.sequence) FILTER (
    WHERE target.state = 'complete'
        AND NOT EXISTS (SELECT 1 FROM telemetry_inspectionresult result WHERE result.target_id = target.id)
)
FROM missions_inspectiontarget target
JOIN missions_mission mission ON mission.id = target.mission_id
JOIN missions_approval approval ON approval.mission_id = mission.id AND approval.revoked_at IS NULL
JOIN missions_waypoint waypoint ON waypoint.target_id = target.id
JOIN missions_route route ON route.id = waypoint.route_id
JOIN missions_missionuav place ON place.id = route.mission_uav_id
WHERE target.state IN ('complete', 'skipped', 'failed')
    AND target.state_at BETWEEN now() - make_interval(secs => %(back_s)s) AND now() - make_interval(secs => %(settled_s)s)
    AND mission.deleted_at IS NULL AND place.uav_id = ANY(%(uav_ids)s)
GROUP BY mission.id, approval.id, place.uav_id
"""


@dataclass
class TargetChecks:
    """Targets already checked by one estimator. After a restart all recent ones are checked again, with the same result."""

    _checked_at: dict[tuple[UUID, int], Any] = field(default_factory=dict)  # when the newest target was settled

    def check(self, uav_ids: list[int]) -> int:
        """Check newly settled targets of these UAVs. Returns how many were missed."""
        with connection.cursor() as cursor:
            cursor.execute(_SETTLED, {"uav_ids": uav_ids, "back_s": LOOKBACK_S, "settled_s": SETTLED_S})
            found = cursor.fetchall()
        missed, checked_at = 0, {}
        for mission_id, approval_id, uav_id, newest, places in found:
            if self._checked_at.get((mission_id, uav_id)) != newest:
                missed += _note_targets_checked(mission_id, approval_id, uav_id, set(places or ()))
            checked_at[mission_id, uav_id] = newest
        self._checked_at = checked_at  # older entries are not found again
        return missed


def _note_targets_checked(mission_id: UUID, approval_id: UUID, uav_id: int, unreported: set[int]) -> int:
    """Mark missed targets at these places, which have no report, as skipped, and store the visits of the UAV's whole route."""
    routes = Approval.objects.values_list("document", flat=True).get(pk=approval_id)["routes"]
    approved = next((route for route in routes if route["uav"] == uav_id), None)
    if approved is None:
        return 0
    route = route_from_json(approved["route"])
    fixes = fixes_of(Mission(pk=mission_id), uav_id)
    if not fixes:  # its positions are unknown
        return 0
    missed = 0
    for visit in visits_of(route, fixes, fastest_mps=fastest_mps(route, approved["figures"])):
        if visit.target in unreported and not visit.is_done:
            reason = NOT_HELD if visit.can_have_reached else NOT_REACHED
            missed += mark_missed(mission_id=mission_id, target=visit.target, reason=reason)
        _store(mission_id, visit)
    return missed


def store_missing_visits() -> int:
    """Store visits of recently ended missions that no running estimator has stored. Returns how many."""
    lately = timezone.now() - LATELY
    settled = InspectionTarget.objects.filter(mission=OuterRef("pk"), state__in=SETTLED, visit_stored_at=None)
    ended = Mission.objects.filter(Exists(settled), ended_at__gte=lately, ended_at__lt=timezone.now() - timedelta(seconds=LOOKBACK_S))
    stored = 0
    for mission in ended.order_by("ended_at").iterator():
        for route in routes_on_record(mission, approval_on_record(mission)):
            stored += sum(_store(mission.pk, visit) for visit in route.visits)
    return stored


def _store(mission_id: UUID, visit: ReportedVisit) -> bool:
    """Return whether a new visit was stored; nothing is stored without a position report."""
    if visit.closest_m is None:
        return False
    return store_visit(mission_id=mission_id, target=visit.target, reached_at=at(visit.reached_s), held_s=visit.held_s)
