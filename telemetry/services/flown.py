"""What was flown of an approved flight, told to the mission."""

from uuid import UUID

from mavlink.mission_sync.flown_items import FlownMissionItem
from missions.models import Approval, LinkKind, Uav
from missions.services.commands.dispatch import DamagedApproval, approved_load
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_waypoint_reached
from telemetry.services.links.onboard_lists import Doubt, loaded_on

OTHERS = frozenset({Doubt.OTHER_STATION, Doubt.OTHER_LENGTH})


def note_flown(*, uav_id: int, flown: FlownMissionItem) -> None:
    """Of the flight that was last read back from the vehicle; of anything else it may have flown nothing is known, and nothing once
    another list may have been put on it.

    Safe to call again. A flight that was broken off is neither flown nor failed: it can be started again. One that ended away from its
    plan is told by note_down_off_plan.
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
    """A vehicle is down for good where its flight does not end: crashed, or landed by itself. The flight has failed. Safe to call again.

    Companion computers report the ends of their flights themselves.
    """
    approval = Approval.objects.filter(pk=approval_id, revoked_at=None).first()
    if approval is not None and Uav.objects.filter(pk=uav_id, link=LinkKind.MAVLINK).exists():
        mark_flight_ended(mission_id=approval.mission_id, uav_id=uav_id, flight=flight, end=FlightEnd.FAILED)
