"""Keys and versions of what live pages show now, cheap enough to poll several times a second.

Whole objects are in live/objects.py, and read only when their version has changed.
"""

from collections.abc import Collection
from dataclasses import dataclass
from uuid import UUID

from missions.selectors.commands import SENT_LAST
from workspace.prepared_statements import prepared_rows

Key = tuple[str, str]  # kind and id
KINDS = ("uavs", "missions", "alerts", "commands", "offers")


@dataclass(frozen=True, slots=True)
class ShownObject:
    """One object, with a new version after each change. Pages of the organisation show it if `is_in_whole`, those of `missions` always."""

    version: int
    is_in_whole: bool
    missions: tuple[UUID, ...]

    def is_for(self, mission: UUID | None) -> bool:
        return self.is_in_whole if mission is None else mission in self.missions


MAX_CLOSED = 100
# Shown are: UAVs that fly a mission or were received within a day; missions under way or ended within the hour; open alerts, the newest
# critical ones that ended unacknowledged, and the newest closed within the hour, for the organisation and for each requested mission;
# commands and offers that are open or ended within ten minutes. In addition, everything of the requested missions, including UAVs with a
# route of theirs that fly no other mission. A UAV flies the mission whose route it was sent last (missions/selectors/commands.py).
_LOOK = f"""
WITH asked AS (SELECT %s::bigint AS organisation_id, %s::uuid[] AS missions),
flown AS (
    SELECT DISTINCT ON (place.uav_id) place.uav_id, mission.id AS mission_id, place.sequence
    FROM missions_mission mission JOIN missions_missionuav place ON place.mission_id = mission.id
    JOIN missions_route route ON route.mission_uav_id = place.id AND route.geometry IS NOT NULL
    {SENT_LAST}
    WHERE mission.organisation_id = (SELECT organisation_id FROM asked) AND mission.state IN ('dispatched', 'active')
        AND mission.deleted_at IS NULL AND place.uav_id IS NOT NULL
    ORDER BY place.uav_id, route.continued_by_id IS NOT NULL, sent.mission_id IS NOT DISTINCT FROM mission.id DESC,
        mission.state, mission.updated_at DESC
),
member AS (
    SELECT place.uav_id, array_agg(DISTINCT mission.id ORDER BY mission.id) AS missions
    FROM asked JOIN missions_mission mission ON mission.id = ANY(asked.missions) AND mission.organisation_id = asked.organisation_id
        AND mission.deleted_at IS NULL
    JOIN missions_missionuav place ON place.mission_id = mission.id
    LEFT JOIN missions_route route ON route.mission_uav_id = place.id
    LEFT JOIN flown ON flown.uav_id = place.uav_id
    WHERE place.uav_id IS NOT NULL AND (mission.state = 'draft' OR route.geometry IS NOT NULL)
        AND (flown.mission_id IS NULL OR flown.mission_id = mission.id)
    GROUP BY place.uav_id
),
reported AS (
    SELECT id, bool_or(is_in_whole) AS is_in_whole FROM (
        SELECT alert.id, true AS is_in_whole FROM asked JOIN telemetry_alert alert ON alert.organisation_id = asked.organisation_id
        WHERE alert.closed_at IS NULL
        UNION ALL
        SELECT waits.id, true FROM asked, LATERAL (
            SELECT alert.id FROM telemetry_alert alert
            WHERE alert.organisation_id = asked.organisation_id AND alert.level = 'critical' AND alert.acknowledged_at IS NULL
                AND alert.closed_at IS NOT NULL  -- by alert_waits_to_be_seen_idx
            ORDER BY alert.closed_at DESC LIMIT {MAX_CLOSED}
        ) waits
        UNION ALL
        SELECT newest.id, true FROM asked, LATERAL (
            SELECT alert.id FROM telemetry_alert alert
            WHERE alert.organisation_id = asked.organisation_id AND alert.closed_at > now() - interval '1 hour'
            ORDER BY alert.closed_at DESC LIMIT {MAX_CLOSED}
        ) newest
        UNION ALL
        SELECT newest.id, false FROM asked, unnest(asked.missions) AS mission(id), LATERAL (
            SELECT alert.id FROM telemetry_alert alert
            WHERE alert.organisation_id = asked.organisation_id AND alert.mission_id = mission.id
                AND alert.closed_at > now() - interval '1 hour'
            ORDER BY alert.closed_at DESC LIMIT {MAX_CLOSED}
        ) newest
    ) found GROUP BY id
)
SELECT 'uavs', uav.id::text, hashtextextended(ROW(watch.version, floor(extract(epoch FROM link.heard_at)), link.mode, link.is_armed,
        link.is_in_air, link.autopilot, link.loaded_sha256, link.loaded_approval, link.loaded_flight, link.loaded_read_at,
        link.loaded_doubt, link.waypoint_sequence, round(link.clock_rate::numeric, 1), uav.name, uav.link, uav.is_simulated,
        flown.mission_id, flown.sequence)::text, 0),
    flown.uav_id IS NOT NULL OR received.recently, coalesce(member.missions, '{{}}')
FROM asked JOIN missions_uav uav ON uav.organisation_id = asked.organisation_id
    LEFT JOIN telemetry_uavlink link ON link.uav_id = uav.id LEFT JOIN telemetry_uavwatch watch ON watch.uav_id = uav.id
    LEFT JOIN flown ON flown.uav_id = uav.id LEFT JOIN member ON member.uav_id = uav.id,
    LATERAL (SELECT coalesce(greatest(link.heard_at, watch.updated_at) > now() - interval '1 day', false) AS recently) received
WHERE flown.uav_id IS NOT NULL OR member.uav_id IS NOT NULL OR received.recently
UNION ALL
SELECT 'missions', mission.id::text, hashtextextended(ROW(mission.revision, mission.state, mission.name, mission.departs_at,
        mission.started_at, mission.ended_at, digest.targets)::text, 0),
    mission.state IN ('dispatched', 'active') OR coalesce(mission.ended_at > now() - interval '1 hour', false), ARRAY[mission.id]
FROM asked JOIN missions_mission mission ON mission.organisation_id = asked.organisation_id, LATERAL (
        SELECT sum(hashtext(ROW(target.sequence, target.label, target.state, target.state_at, target.state_reason)::text)) AS targets
        FROM missions_inspectiontarget target WHERE target.mission_id = mission.id
    ) digest
WHERE mission.deleted_at IS NULL AND (mission.state IN ('dispatched', 'active') OR mission.ended_at > now() - interval '1 hour'
    OR mission.id = ANY(asked.missions))
UNION ALL
SELECT 'alerts', alert.id::text, hashtextextended(ROW(alert.revision, alert.level, alert.code, alert.message, alert.values, alert.details,
        alert.closed_at, alert.acknowledged_at, (SELECT count(*) FROM telemetry_alertnote note WHERE note.alert_id = alert.id))::text, 0),
    reported.is_in_whole, CASE WHEN alert.mission_id IS NULL THEN coalesce(member.missions, '{{}}') ELSE ARRAY[alert.mission_id] END
FROM reported JOIN telemetry_alert alert ON alert.id = reported.id LEFT JOIN member ON member.uav_id = alert.uav_id
UNION ALL
SELECT 'commands', command.id::text, hashtextextended(ROW(command.state, command.attempts, command.expires_at, command.sent_at,
        command.acknowledged_at, command.finished_at, command.progress, command.outcome_code, command.outcome)::text, 0),
    true, CASE WHEN command.mission_id IS NULL THEN coalesce(member.missions, '{{}}') ELSE ARRAY[command.mission_id] END
FROM asked JOIN missions_uavcommand command ON command.organisation_id = asked.organisation_id
    LEFT JOIN member ON member.uav_id = command.uav_id
WHERE command.finished_at IS NULL OR command.finished_at > now() - interval '10 minutes'
UNION ALL
SELECT 'offers', offer.id::text, hashtextextended(ROW(offer.state, offer.code, offer.cause, offer.difference, offer.decided_at,
        offer.outcome, offer.continuation_id)::text, 0), true, ARRAY[offer.mission_id]
FROM asked JOIN missions_mission mission ON mission.organisation_id = asked.organisation_id AND mission.deleted_at IS NULL
    JOIN missions_replanoffer offer ON offer.mission_id = mission.id
WHERE offer.state IN ('computing', 'open') OR coalesce(offer.decided_at, offer.created_at) > now() - interval '10 minutes'
"""  # noqa: S608 - a constant number


def shown_live(organisation_id: int, missions: Collection[UUID] = ()) -> dict[Key, ShownObject]:
    """Return the objects shown, with those of the requested missions that exist in the organisation."""
    rows = prepared_rows(_LOOK, [organisation_id, list(missions)])
    return {(kind, key): ShownObject(version, is_in_whole, tuple(own)) for kind, key, version, is_in_whole, own in rows}
