"""What UAVs have been given to fly: the outbox and the approvals, read for one UAV."""

from uuid import UUID

from missions.models import CommandKind, Waypoint


def targets_given_to(uav_id: int, mission_id: UUID) -> frozenset[int]:
    """Keys of the targets on this UAV's route of a mission that was sent to it; empty where none was."""
    visits = Waypoint.objects.filter(
        route__mission_id=mission_id,
        route__mission_uav__uav_id=uav_id,
        route__mission__commands__uav_id=uav_id,
        route__mission__commands__kind=CommandKind.UPLOAD_MISSION,
        target__isnull=False,
    )
    return frozenset(visits.values_list("target_id", flat=True).distinct())
