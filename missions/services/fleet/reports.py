"""Updates of UAV rows from reports: last position, heading, battery."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from django.db import connection

MOVE_FORWARD = """
WITH reported AS (
    SELECT * FROM unnest(%s::bigint[], %s::timestamptz[], %s::float8[], %s::float8[], %s::float8[], %s::float8[])
        AS r(uav_id, measured_at, longitude_deg, latitude_deg, heading_deg, battery_percent)
), held AS (
    SELECT uav.id FROM missions_uav uav JOIN reported ON reported.uav_id = uav.id
    WHERE uav.located_at IS NULL OR uav.located_at < reported.measured_at
    ORDER BY uav.id FOR NO KEY UPDATE OF uav
)
UPDATE missions_uav uav
SET location = ST_SetSRID(ST_MakePoint(reported.longitude_deg, reported.latitude_deg), 4326), located_at = reported.measured_at,
    heading_deg = coalesce(reported.heading_deg, uav.heading_deg),
    battery_percent = coalesce(reported.battery_percent, uav.battery_percent)
FROM reported
WHERE uav.id = reported.uav_id AND uav.id IN (SELECT id FROM held)
    AND (uav.located_at IS NULL OR uav.located_at < reported.measured_at)
"""


@dataclass(frozen=True)
class ReportedPosition:
    uav_id: int
    measured_at: datetime
    longitude_deg: float
    latitude_deg: float
    heading_deg: float | None = None
    battery_percent: float | None = None


def note_reported_positions(*, reports: Sequence[ReportedPosition]) -> int:
    """Store at most one report per UAV, unless it is older than the row. Returns how many rows changed.

    A report is no edit: the row's revision stays.
    """
    if not reports:
        return 0
    columns = ("uav_id", "measured_at", "longitude_deg", "latitude_deg", "heading_deg", "battery_percent")
    with connection.cursor() as cursor:
        cursor.execute(MOVE_FORWARD, [[getattr(report, column) for report in reports] for column in columns])
        return int(cursor.rowcount)
