"""Reports the progress of approved flights to their missions."""

from uuid import UUID

from mavlink.mission_sync.flown_items import FlownMissionItem
from missions.models import Approval, LinkKind, Uav
from missions.services.commands.dispatch import DamagedApproval, approved_load
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_waypoint_reached
from telemetry.services.links.onboard_lists import Doubt, loaded_on

OTHERS = frozenset({Doubt.OTHER_STATION, Doubt.OTHER_LENGTH})


def note_flown(*, uav_id: int, flown: FlownMissionItem) -> None:
    """Record progress of the flight last read back from the vehicle; ignored if another list may have been uploaded since.

    Idempotent. An interrupted flight is neither flown nor failed: it can start again. note_down_off_plan records one that ended off plan.
    """
    loaded = loaded_on(uav_id)
    approval = None if loaded is None else Approval.objects.filter(pk=loaded.approval, revoked_at=None).first()
    if loaded is None or approval is None or loaded.doubt in OTHERS:
        return
    try:
        approved = approved_load(approval, uav_id=uav_id, flight=loaded.flight)
    except (DamagedApproval, LookupError, StopIteration):
        return
    if approved.load is None or flown.item >= len(approved.load.mission):
        return
    waypoint = approved.load.mission[flown.item].waypoint
    if flown.is_reached and waypoint is not None:
        mark_waypoint_reached(mission_id=approved.mission, uav_id=uav_id, waypoint=waypoint)
    if flown.is_whole(approved.load):
        mark_flight_ended(mission_id=approved.mission, uav_id=uav_id, flight=approved.flight, end=FlightEnd.FLOWN)


def note_down_off_plan(*, uav_id: int, approval_id: UUID, flight: int) -> None:
    """Record a vehicle that is down off plan, crashed or landed by itself: its flight has failed. Idempotent.

    Companion computers report the end of their flights themselves.
    """
    approval = Approval.objects.filter(pk=approval_id, revoked_at=None).first()
    if approval is not None and Uav.objects.filter(pk=uav_id, link=LinkKind.MAVLINK).exists():
        mark_flight_ended(mission_id=approval.mission_id, uav_id=uav_id, flight=flight, end=FlightEnd.FAILED)
