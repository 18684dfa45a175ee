"""Last contact and state of UAVs on the HTTP link."""

from datetime import datetime

from django.utils import timezone

from missions.models import LinkKind, Uav
from missions.services.commands.flight_progress import mark_waypoint_reached
from telemetry.models import UavLink
from telemetry.selectors.log import newest_of
from workspace.prepared_statements import prepared_rows

_RECEIVED = """
    WITH quick AS (SELECT set_config('synchronous_commit', 'off', true))
    UPDATE telemetry_uavlink SET heard_at = statement_timestamp(), address = %s FROM quick WHERE uav_id = %s RETURNING uav_id"""


def note_received_over_http(*, uav_id: int, address: str) -> None:
    """Store the contact without waiting for the disk: the next request repeats it."""
    words = f"http {address}"[:100]
    if not prepared_rows(_RECEIVED, [words, uav_id]):
        UavLink.objects.get_or_create(uav_id=uav_id, defaults={"last_message_at": timezone.now(), "address": words})


def note_state_over_http(*, uav_id: int, received_at: datetime) -> None:
    """Update the UAV's state after storing reports received at this time, if the newest report is among them.

    For UAVs with a MAVLink link the gateway does this.
    """
    newest = newest_of(uav_id)
    if newest is None or newest.received_at != received_at or not Uav.objects.filter(pk=uav_id, link=LinkKind.HTTP).exists():
        return
    waypoint = newest.waypoint_sequence
    before = UavLink.objects.filter(uav_id=uav_id).values_list("waypoint_sequence", flat=True).first()
    UavLink.objects.filter(uav_id=uav_id).update(
        mode=newest.mode, is_armed=newest.is_armed, is_in_air=newest.is_in_air, waypoint_sequence=waypoint
    )
    if newest.mission_id is not None and waypoint is not None and waypoint != before:
        mark_waypoint_reached(mission_id=newest.mission_id, uav_id=uav_id, waypoint=waypoint)


def note_on_ground_over_http(*, uav_id: int) -> None:
    """Mark the UAV as on the ground after its flight was reported as ended, which not every companion includes in a report.

    The next report updates the state again.
    """
    UavLink.objects.filter(uav_id=uav_id).update(is_in_air=False)
