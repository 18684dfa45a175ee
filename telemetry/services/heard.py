"""When a UAV was last heard over HTTP. Nobody waits for the disk: the next request says it again."""

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
    prepared_rows(_HEARD, [uav_id, f"http {address}"[:100]])
