"""Whether the database is sound by itself: no orphans, nothing stuck, no mission of two plans, histories and alerts that add up."""

from collections.abc import Callable
from typing import Any

from deploy.load.day.kept_promises import rows
from missions.models import Approval
from missions.services.approval.document import content_sha256

STUCK_AFTER_S = 90.0  # the sweep comes each second or so, leases are 15 to 30 s, and a new try may need a worker that starts
MAX_VIOLATIONS = 20  # violations of one kind that are told
MAX_APPROVALS = 2_000

Check = Callable[[], list[str]]


def _reported(sql: str, words: str, values: dict[str, Any] | None = None) -> list[str]:
    """Each row put into the words by its place."""
    found = rows(sql, values)
    more = len(found) - MAX_VIOLATIONS
    return [words.format(*row) for row in found[:MAX_VIOLATIONS]] + ([f"and {more} more"] if more > 0 else [])


def no_orphans() -> list[str]:
    """Every foreign key of every table, by the database's own catalogue."""
    keys = rows(
        "SELECT conrelid::regclass::text, a.attname, confrelid::regclass::text, b.attname FROM pg_constraint c "
        "JOIN pg_attribute a ON a.attrelid = conrelid AND a.attnum = conkey[1] "
        "JOIN pg_attribute b ON b.attrelid = confrelid AND b.attnum = confkey[1] "
        "WHERE contype = 'f' AND cardinality(conkey) = 1 AND connamespace = 'public'::regnamespace"
    )
    found = []
    for table, column, other, key in keys:
        [(number,)] = rows(
            f"SELECT count(*) FROM {table} one WHERE one.{column} IS NOT NULL "  # noqa: S608 (names from the catalogue)
            f"AND NOT EXISTS (SELECT 1 FROM {other} whole WHERE whole.{key} = one.{column})"
        )
        if number:
            found.append(f"{number} rows of {table} point by {column} at what is not in {other}")
    return found


def no_mission_of_two_plans() -> list[str]:
    """Routes on another graph than their mission's, or with somebody else's UAV, targets or approval."""
    return [
        *_reported(
            "SELECT route.id, mission.id FROM missions_route route JOIN missions_mission mission ON mission.id = route.mission_id "
            "WHERE route.graph_version IS DISTINCT FROM mission.graph_version", "route {} of mission {} is of another plan",
        ),
        *_reported(
            "SELECT route.id, route.mission_id FROM missions_route route JOIN missions_missionuav place ON place.id = route.mission_uav_id "
            "WHERE place.mission_id <> route.mission_id", "route {} of mission {} has another mission's UAV",
        ),
        *_reported(
            "SELECT route.mission_id, target.mission_id, count(*) FROM missions_waypoint waypoint "
            "JOIN missions_route route ON route.id = waypoint.route_id "
            "JOIN missions_inspectiontarget target ON target.id = waypoint.target_id "
            "WHERE target.mission_id <> route.mission_id GROUP BY 1, 2", "mission {} flies to targets of mission {}: {}",
        ),
        *_reported(
            "SELECT command.id, command.mission_id FROM missions_uavcommand command JOIN missions_approval approval "
            "ON approval.id = command.approval_id WHERE approval.mission_id <> command.mission_id",
            "command {} of mission {} has another mission's approval",
        ),
        *_reported(
            "SELECT mission.id, mission.state FROM missions_mission mission WHERE state IN ('approved', 'dispatched', 'active') "
            "AND NOT EXISTS (SELECT 1 FROM missions_approval a WHERE a.mission_id = mission.id AND a.revoked_at IS NULL)",
            "mission {} is {} without an approval in force",
        ),
        *_reported(
            "SELECT id, state FROM missions_mission mission WHERE state <> 'draft' "
            "AND NOT EXISTS (SELECT 1 FROM missions_route WHERE mission_id = mission.id)", "mission {} is {} without a route",
        ),
    ]  # fmt: skip


def approvals_match_their_hashes() -> list[str]:
    """The newest ones: each document anew."""
    newest = Approval.objects.order_by("-approved_at")[:MAX_APPROVALS]
    return [f"approval {one.pk} has another hash than its document" for one in newest if content_sha256(one.document) != one.content_sha256]


def nothing_is_stored_twice() -> list[str]:
    return [
        *_reported(
            "SELECT stream_id, sequence, count(*) FROM telemetry_telemetryrecord GROUP BY 1, 2 HAVING count(*) > 1",
            "record {1} of stream {0} is there {2} times",
        ),
        *_reported(
            "SELECT stream_id, sequence, count(*) FROM telemetry_inspectionresult GROUP BY 1, 2 HAVING count(*) > 1",
            "result {1} of stream {0} is there {2} times",
        ),
        *_reported(
            "SELECT uav_id, sequence, count(*) FROM missions_uavcommand GROUP BY 1, 2 HAVING count(*) > 1",
            "command {1} of UAV {0} is there {2} times",
        ),
        *_reported(
            "SELECT mission_id, count(*) FROM missions_approval WHERE revoked_at IS NULL GROUP BY 1 HAVING count(*) > 1",
            "mission {} has {} approvals in force",
        ),
        *_reported(
            "SELECT uav_id, code, subject, count(*) FROM telemetry_alert WHERE closed_at IS NULL GROUP BY 1, 2, 3 HAVING count(*) > 1",
            "UAV {} has alert {} {} open {} times at once",
        ),
    ]  # fmt: skip


def no_job_is_stuck() -> list[str]:
    """Open, and nobody has held it for longer than the sweep needs; or open for ever after it was to be cancelled."""
    return _reported(
        "SELECT id, task, state FROM workspace_job WHERE state IN ('queued', 'running') "
        "AND COALESCE(lease_expires_at, created_at) < now() - make_interval(secs => %(stuck_s)s)",
        "job {} ({}) is {} and nobody holds it", {"stuck_s": STUCK_AFTER_S},
    )  # fmt: skip


def no_command_is_stuck() -> list[str]:
    """Open past its time, or open and unheld although its UAV is heard."""
    return _reported(
        "SELECT command.id, command.kind, command.state, command.uav_id FROM missions_uavcommand command "
        "LEFT JOIN telemetry_uavlink link ON link.uav_id = command.uav_id "
        "WHERE command.state IN ('queued', 'sent', 'acknowledged') "
        "AND COALESCE(command.lease_expires_at, command.created_at) < now() - make_interval(secs => %(stuck_s)s) "
        "AND (command.expires_at < now() - make_interval(secs => %(stuck_s)s) "
        "     OR (command.created_at < now() - make_interval(secs => %(stuck_s)s) AND link.heard_at > now() - interval '10 seconds'))",
        "command {} ({}) is {} for UAV {} and nobody holds it", {"stuck_s": STUCK_AFTER_S},
    )  # fmt: skip


def commands_have_whole_histories() -> list[str]:
    """Queued first, each step by one attempt or a later one, the last step the state that it is in, nothing after its end."""
    return _reported(
        """
        WITH steps AS (
            SELECT command_id, array_agg(state::text ORDER BY id) AS states, array_agg(attempt ORDER BY id) AS attempts
            FROM missions_uavcommandevent GROUP BY 1
        )
        SELECT command.id, command.state, COALESCE(array_to_string(steps.states, ' '), 'nothing')
        FROM missions_uavcommand command LEFT JOIN steps ON steps.command_id = command.id
        WHERE steps.states IS NULL OR steps.states[1] <> 'queued' OR steps.states[cardinality(steps.states)] <> command.state
            OR (SELECT count(*) FROM unnest(steps.states) state WHERE state IN ('applied', 'failed', 'expired')) > 1
            OR steps.attempts IS DISTINCT FROM (SELECT array_agg(attempt ORDER BY attempt) FROM unnest(steps.attempts) attempt)
            OR (command.state IN ('applied', 'failed', 'expired')) <> (command.finished_at IS NOT NULL)
        """,
        "command {} is {}, and its history: {}",
    )


def missions_have_whole_histories() -> list[str]:
    """Each revision once, each change from the one before it, and the last one the mission's own."""
    return [
        *_reported(
            """
            SELECT subject_id, after->>'revision', count(*) FROM workspace_auditentry
            WHERE subject_type = 'mission' AND after ? 'revision' GROUP BY 1, 2
            HAVING count(*) FILTER (WHERE action IN ('create', 'rename', 'change', 'plan', 'approve', 'dispatch', 'start', 'complete')) > 1
            """,
            "revision {1} of mission {0} is in its history {2} times",
        ),
        *_reported(
            """
            WITH last AS (
                SELECT subject_id, max(GREATEST(
                    (after->>'revision')::int, (before->>'revision')::int + CASE WHEN action = 'delete' THEN 1 ELSE 0 END, 1)) AS revision
                FROM workspace_auditentry WHERE subject_type = 'mission' GROUP BY 1
            )
            SELECT mission.id, mission.revision, last.revision
            FROM missions_mission mission LEFT JOIN last ON last.subject_id = mission.id::text
            WHERE last.revision IS DISTINCT FROM mission.revision
            """,
            "mission {} is at revision {}, and its history at {}",
        ),
    ]  # fmt: skip


def alerts_add_up() -> list[str]:
    """What its row says is what its course and the history say."""
    return [
        *_reported(
            """
            SELECT id, code, (closed_at IS NULL) FROM telemetry_alert
            WHERE course->0->>'what' IS DISTINCT FROM 'opened'
                OR (SELECT count(*) FROM jsonb_array_elements(course) step WHERE step->>'what' = 'opened') <> 1
                OR (SELECT count(*) FROM jsonb_array_elements(course) step WHERE step->>'what' = 'closed')
                    <> (CASE WHEN closed_at IS NULL THEN 0 ELSE 1 END)
            """,
            "alert {} ({}) is open: {}, and its course says otherwise",
        ),
        *_reported(
            """
            SELECT alert.id, alert.code, alert.acknowledged_at FROM telemetry_alert alert
            WHERE (acknowledged_at IS NOT NULL) IS DISTINCT FROM ((
                SELECT step->>'what' FROM jsonb_array_elements(course) WITH ORDINALITY AS list(step, place)
                WHERE step->>'what' IN ('acknowledged', 'rose') ORDER BY place DESC LIMIT 1) IS NOT DISTINCT FROM 'acknowledged')
            """,
            "alert {} ({}) was acknowledged at {}, and its course says otherwise",
        ),
        *_reported(
            """
            SELECT alert.id, written.number, reported.number FROM telemetry_alert alert
            CROSS JOIN LATERAL (SELECT count(*) AS number FROM telemetry_alertnote WHERE alert_id = alert.id) written
            CROSS JOIN LATERAL (SELECT count(*) AS number FROM workspace_auditentry
                WHERE subject_type = 'alert' AND subject_id = alert.id::text AND action = 'note') reported
            WHERE written.number <> reported.number
            """,
            "alert {} has {} notes, and its history {}",
        ),
    ]  # fmt: skip


def latest_is_the_newest_record() -> list[str]:
    """What live pages show of a UAV is the newest that was stored, as far as it is not from the future."""
    return _reported(
        """
        SELECT watch.uav_id, watch.measured->>'measured_at', newest.measured_at FROM telemetry_uavwatch watch
        CROSS JOIN LATERAL (SELECT max(measured_at) AS measured_at FROM telemetry_telemetryrecord record
            WHERE record.uav_id = watch.uav_id AND NOT is_from_future) newest
        WHERE (watch.measured->>'measured_at')::timestamptz < newest.measured_at - interval '1 millisecond'
        """,
        "UAV {} is shown as of {}, and its newest record is of {}",
    )


def no_answer_is_half_kept() -> list[str]:
    return _reported("SELECT key, user_id FROM workspace_idempotencykey WHERE status IS NULL", "key {} of user {} has no answer")


CHECKS: dict[str, Check] = {
    "no orphans, by every foreign key": no_orphans,
    "no mission is mixed from two plans": no_mission_of_two_plans,
    "each approval has its document's hash": approvals_match_their_hashes,
    "nothing is stored twice": nothing_is_stored_twice,
    "no job is open without a lease": no_job_is_stuck,
    "no command is open without a lease": no_command_is_stuck,
    "each command has its whole history": commands_have_whole_histories,
    "each mission has its whole history": missions_have_whole_histories,
    "alerts, their courses and notes add up": alerts_add_up,
    "live pages are shown the newest records": latest_is_the_newest_record,
    "no kept answer is half written": no_answer_is_half_kept,
}
