"""When a UAV was last heard over HTTP, and how it does."""

from datetime import datetime

from missions.services.flying import mark_waypoint_reached
from telemetry.models import UavLink
from telemetry.selectors.log import newest_of
from workspace.prepared import prepared_rows

TOLD_EVERY_S = 2  # a row is not written oftener

_HEARD = f"""
    WITH quick AS (SELECT set_config('synchronous_commit', 'off', true))
    INSERT INTO telemetry_uavlink AS link
        (uav_id, heard_at, address, holder, autopilot, firmware, mode, loaded_sha256, signing, losses)
    SELECT %s::bigint, statement_timestamp(), %s::text, '', '', '', '', '', '{{}}'::jsonb, '{{}}'::jsonb FROM quick
    ON CONFLICT (uav_id) DO UPDATE SET heard_at = excluded.heard_at, address = excluded.address
    WHERE link.heard_at IS NULL OR link.heard_at < excluded.heard_at - make_interval(secs => {TOLD_EVERY_S})
        OR link.address <> excluded.address"""  # noqa: S608 - of constants


def note_heard_over_http(*, uav_id: int, address: str) -> None:
    """Nobody waits for the disk: the next request says it again."""
    prepared_rows(_HEARD, [uav_id, f"http {address}"[:100]])


def note_state_over_http(*, uav_id: int, received_at: datetime) -> None:
    """After reports that came at this time were stored: the newest of all says how the UAV does, unless it came before."""
    newest = newest_of(uav_id)
    if newest is None or newest.received_at != received_at:
        return
    before = UavLink.objects.filter(uav_id=uav_id).values_list("mission_item", flat=True).first()
    UavLink.objects.filter(uav_id=uav_id).update(
        mode=newest.mode, is_armed=newest.is_armed, is_in_air=newest.is_in_air, mission_item=newest.mission_item
    )
    if newest.mission_id is not None and newest.mission_item is not None and newest.mission_item != before:
        mark_waypoint_reached(mission_id=newest.mission_id, uav_id=uav_id, waypoint=newest.mission_item)
