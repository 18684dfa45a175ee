"""Reads of the estimator: UAVs on missions, and their new reports."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from django.db import connection

from inspection.geodesy import LonLat
from mavlink.decoding.measurement import Measurement
from missions.models import ENDED_STATES, MissionState
from missions.selectors.commands import SENT_LAST
from telemetry.estimation.link_model import PROMPT_S
from telemetry.estimation.report import Report, VehicleBoot
from telemetry.exports.logged_record import REPORTED

ON_ITS_WAY = (MissionState.ACTIVE, MissionState.DISPATCHED)  # the first takes precedence
STILL_IN_THE_AIR_S = 4 * 3_600.0  # after its mission ended; a last message older than this does not count


@dataclass(frozen=True, slots=True)
class WatchedFlight:
    """A UAV and its approved flight. `flight` counts from 1, and is one past the last after all were flown.

    The fields from `home` on are those of UavLink; `last_message_at` is set for UAVs with a gateway. `clock_rate` is None for a real UAV,
    whose rate would be estimated wrongly while its link lags or catches up.
    """

    uav_id: int
    organisation_id: int
    name: str
    mission_id: UUID
    approval_id: UUID
    flight: int
    home: LonLat | None
    last_message_at: datetime | None
    mode: str
    is_armed: bool | None
    is_in_air: bool | None
    waypoint_sequence: int | None
    clock_rate: float | None
    is_twin: bool


_FLYING = f"""
SELECT DISTINCT ON (place.uav_id) place.uav_id, mission.organisation_id, uav.name, mission.id, approval.id,
    CASE WHEN link.loaded_approval = approval.id AND link.loaded_flight IS NOT NULL THEN link.loaded_flight
        ELSE route.flights_flown + 1 END,
    ST_X(link.home), ST_Y(link.home), CASE WHEN link.autopilot <> '' THEN link.heard_at END,
    coalesce(link.mode, ''), link.is_armed, link.is_in_air, link.waypoint_sequence, CASE WHEN uav.is_simulated THEN link.clock_rate END,
    uav.twin_of_id IS NOT NULL
FROM missions_mission mission
JOIN missions_missionuav place ON place.mission_id = mission.id AND place.uav_id IS NOT NULL
JOIN missions_uav uav ON uav.id = place.uav_id
JOIN missions_route route ON route.mission_uav_id = place.id AND route.geometry IS NOT NULL
JOIN missions_approval approval ON approval.mission_id = mission.id AND approval.revoked_at IS NULL
LEFT JOIN telemetry_uavlink link ON link.uav_id = place.uav_id
{SENT_LAST}
WHERE mission.deleted_at IS NULL AND (mission.state = ANY(%(on_its_way)s)
    OR (mission.state = ANY(%(over)s) AND coalesce(mission.ended_at, mission.updated_at) > now() - make_interval(secs => %(longest_s)s)
        AND link.is_in_air AND link.heard_at > now() - make_interval(secs => %(longest_s)s)))
ORDER BY place.uav_id, route.continued_by_id IS NOT NULL, mission.state = ANY(%(over)s),
    sent.mission_id IS NOT DISTINCT FROM mission.id DESC, coalesce(array_position(%(on_its_way)s, mission.state::text), 9),
    mission.updated_at DESC
"""  # noqa: S608 (constants)
_BOOT_MS = "CASE WHEN stream.link = 'mavlink' THEN record.sequence END"  # other links count something else
_VALUES = "ST_X(position), ST_Y(position), " + ", ".join(REPORTED)
_STREAMS = "JOIN telemetry_telemetrystream stream ON stream.id = record.stream_id"
_NEW = f"""
SELECT record.id, record.uav_id, measured_at, received_at, stream_id, {_BOOT_MS}, {_VALUES}
FROM telemetry_telemetryrecord record {_STREAMS}
WHERE record.id > %s AND record.id <> ALL(%s) AND record.uav_id = ANY(%s) AND NOT is_from_future ORDER BY record.id
"""  # noqa: S608 (column names, all from here)
_NEWEST = f"""
SELECT record.id, record.uav_id, measured_at, received_at, stream_id, {_BOOT_MS}, {_VALUES}
FROM unnest(%s::bigint[]) AS uav(id), LATERAL (
    SELECT * FROM telemetry_telemetryrecord WHERE uav_id = uav.id AND NOT is_from_future ORDER BY measured_at DESC LIMIT %s
) record {_STREAMS} ORDER BY measured_at
"""  # noqa: S608
_RECEIVED = """
SELECT ST_X(position), ST_Y(position) FROM (
    SELECT position, received_at - measured_at AS took, row_number() OVER () AS number FROM (
        SELECT position, measured_at, received_at FROM telemetry_telemetryrecord
        WHERE uav_id = %s AND NOT is_from_future AND position IS NOT NULL ORDER BY measured_at DESC LIMIT %s
    ) newest
) numbered WHERE took < make_interval(secs => %s) AND number %% %s = 0
"""


@dataclass(frozen=True, slots=True)
class StoredReport:
    id: int
    uav_id: int
    measured_at: datetime
    report: Report


def watched_flights() -> list[WatchedFlight]:
    """Return UAVs of missions under way, and those still in the air after their mission ended; each once."""
    with connection.cursor() as cursor:
        cursor.execute(_FLYING, {"on_its_way": list(ON_ITS_WAY), "over": list(ENDED_STATES), "longest_s": STILL_IN_THE_AIR_S})
        rows = cursor.fetchall()
    return [_flight(row) for row in rows]


def _flight(row: Sequence[Any]) -> WatchedFlight:
    """Return a row of _FLYING: the fields of WatchedFlight in order, with home as longitude and latitude."""
    lon, lat = row[6:8]
    home = None if lon is None or lat is None else LonLat(lon, lat)
    return WatchedFlight(*(*row[:6], home, *row[8:]))


def last_record_id() -> int:
    with connection.cursor() as cursor:
        cursor.execute("SELECT coalesce(max(id), 0) FROM telemetry_telemetryrecord")
        return int(cursor.fetchone()[0])


def reports_stored_after(last_id: int, *, but: Collection[int], uav_ids: Sequence[int]) -> list[StoredReport]:
    """Return new reports in the order of storage. `but`: ids after the last that are already known."""
    return _reports(_NEW, [last_id, sorted(but), list(uav_ids)])


def newest_reports(uav_ids: Sequence[int], *, most: int) -> list[StoredReport]:
    """Return the newest reports of each UAV, sorted by time of measurement."""
    return _reports(_NEWEST, [list(uav_ids), most])


def places_received(uav_id: int, *, most: int, every: int) -> list[LonLat]:
    """Return the positions of a UAV's newest promptly received records, one of every `every`."""
    with connection.cursor() as cursor:
        cursor.execute(_RECEIVED, [uav_id, most, PROMPT_S, every])
        return [LonLat(lon, lat) for lon, lat in cursor.fetchall()]


def _reports(statement: str, values: list[Any]) -> list[StoredReport]:
    with connection.cursor() as cursor:
        cursor.execute(statement, values)
        return [_report(*row) for row in cursor.fetchall()]


def _report(
    key: int,
    uav_id: int,
    measured_at: datetime,
    received_at: datetime,
    stream: int,
    boot_ms: int | None,
    lon: float | None,
    lat: float | None,
    *rest: Any,
) -> StoredReport:
    measurement = Measurement(lon, lat, **dict(zip(REPORTED, rest, strict=True)))
    boot = None if boot_ms is None else VehicleBoot(stream, boot_ms / 1_000.0)
    return StoredReport(key, uav_id, measured_at, Report(measured_at.timestamp(), received_at.timestamp(), measurement, boot))
