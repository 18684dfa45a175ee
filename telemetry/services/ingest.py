"""Stores records of all links in the log, in bulk and each once."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from datetime import datetime, timedelta
from functools import partial
from uuid import UUID

import numpy as np
from django.db import connection, transaction

from inspection.selectors import ground_heights_m
from mavlink.decoding.measurement import Measurement, believable
from missions.models import MissionState
from missions.selectors.commands import SENT_LAST
from missions.services.fleet.uavs import ReportedPosition, note_reported_positions
from telemetry.services.flight_events import note_take_offs_and_landings
from telemetry.services.latest import note_latest
from telemetry.services.waypoints import LoadedList, lists_on
from workspace.live.changes import publish_live

FUTURE_S = 60.0  # after receipt: such records are stored, but never shown as the latest
FLYING = (MissionState.ACTIVE, MissionState.DISPATCHED)  # the first takes precedence


@dataclass(frozen=True, slots=True)
class NewRecord:
    """One incoming report.

    `stream` is the key of the sender's counter, at most 64 characters; `sequence` is its number. A record with a stored stream and sequence
    is dropped. Without a mission it belongs to the one that the UAV flies or was sent.
    """

    uav_id: int
    link: str  # LinkKind
    stream: str
    sequence: int
    measured_at: datetime
    received_at: datetime
    measurement: Measurement
    mission_id: UUID | None = None


@dataclass(frozen=True)
class StoredCount:
    """Counts of records: stored, of these from the future and late, and not stored."""

    stored: int = 0
    from_future: int = 0
    late: int = 0
    duplicates: int = 0
    of_unknown_uavs: int = 0


@dataclass(frozen=True, slots=True)
class _Row:
    record: NewRecord
    is_from_future: bool
    is_late: bool


@transaction.atomic
def store_records(records: Sequence[NewRecord]) -> StoredCount:
    """Store new records in the given order, and advance the UAVs' reported positions. Idempotent for the same records."""
    known, organisations = known_with_missions({record.uav_id for record in records})
    lists = lists_on({record.uav_id for record in records if record.measurement.mission_item is not None})
    kept = [_attributed(record, known[record.uav_id], lists.get(record.uav_id)) for record in records if record.uav_id in known]
    if not kept:
        return StoredCount(of_unknown_uavs=len(records))
    rows = _flagged(_with_heights_above_ground(kept), _newest_measured(kept))
    stored = _insert(rows)
    note_reported_positions(reports=_newest_positions(stored))
    reported = [row.record for row in stored if not row.is_from_future]
    note_take_offs_and_landings(reported)
    note_latest(reported)
    for organisation_id in organisations:
        transaction.on_commit(partial(publish_live, organisation_id))
    return StoredCount(
        stored=len(stored),
        from_future=sum(row.is_from_future for row in stored),
        late=sum(row.is_late for row in stored),
        duplicates=len(kept) - len(stored),
        of_unknown_uavs=len(records) - len(kept),
    )


def known_with_missions(uav_ids: set[int]) -> tuple[dict[int, UUID | None], set[int]]:
    """Return existing UAVs with the missions that they fly, and their organisations. Locks the UAVs against deletion."""
    with connection.cursor() as cursor:
        cursor.execute("SELECT id, organisation_id FROM missions_uav WHERE id = ANY(%s) ORDER BY id FOR KEY SHARE", [sorted(uav_ids)])
        found = cursor.fetchall()
        known: dict[int, UUID | None] = {uav_id: None for uav_id, _ in found}
        cursor.execute(
            f"""
            SELECT DISTINCT ON (place.uav_id) place.uav_id, mission.id
            FROM missions_missionuav place JOIN missions_mission mission ON mission.id = place.mission_id
            JOIN missions_route route ON route.mission_uav_id = place.id AND route.geometry IS NOT NULL
            {SENT_LAST}
            WHERE place.uav_id = ANY(%s) AND mission.state = ANY(%s) AND mission.deleted_at IS NULL
            ORDER BY place.uav_id, route.continued_by_id IS NOT NULL, sent.mission_id IS NOT DISTINCT FROM mission.id DESC,
                array_position(%s, mission.state::text), mission.updated_at DESC
            """,  # noqa: S608 - a constant
            [list(known), list(FLYING), list(FLYING)],
        )
        known.update(dict(cursor.fetchall()))
    return known, {organisation_id for _, organisation_id in found}


def _attributed(record: NewRecord, flies_mission: UUID | None, loaded: LoadedList | None) -> NewRecord:
    measurement = believable(record.measurement)
    mission_id = record.mission_id or flies_mission
    if loaded is not None and measurement.waypoint_sequence is None:
        waypoint = loaded.waypoint_at(measurement.mission_item, record.measured_at, mission_id)
        measurement = measurement if waypoint is None else replace(measurement, waypoint_sequence=waypoint)
    if measurement is record.measurement and mission_id == record.mission_id:
        return record
    return replace(record, measurement=measurement, mission_id=mission_id)


def _with_heights_above_ground(records: Sequence[NewRecord]) -> list[NewRecord]:
    """Return the records with their height above ground: as measured, else above the terrain model where available."""
    nan = float("nan")
    place = ("longitude_deg", "latitude_deg", "altitude_amsl_m")
    reported = np.array(
        [[nan if (value := getattr(record.measurement, name)) is None else value for name in place] for record in records], dtype=np.float64
    )
    above = np.full(len(reported), nan)
    has_no_height = np.array([record.measurement.altitude_agl_m is None for record in records], dtype=bool)
    asked = np.asarray(np.isfinite(reported).all(axis=1)) & has_no_height
    if asked.any():
        above[asked] = reported[asked, 2] - ground_heights_m(reported[asked, :2])
    return [
        record if math.isnan(height) else replace(record, measurement=replace(record.measurement, altitude_agl_m=height))
        for record, height in zip(records, above.tolist(), strict=True)
    ]


def _newest_measured(records: Sequence[NewRecord]) -> dict[int, datetime]:
    """Return by UAV the time of its newest stored record that is not from the future."""
    latest_possible = max(record.received_at for record in records) + timedelta(seconds=FUTURE_S)
    with connection.cursor() as cursor:
        cursor.execute(
            """
            SELECT uav.id, newest.measured_at FROM unnest(%s::bigint[]) AS uav(id), LATERAL (
                SELECT measured_at FROM telemetry_telemetryrecord
                WHERE uav_id = uav.id AND NOT is_from_future AND measured_at <= %s
                ORDER BY measured_at DESC LIMIT 1
            ) newest
            """,
            [list({record.uav_id for record in records}), latest_possible],
        )
        return dict(cursor.fetchall())


def _flagged(records: Sequence[NewRecord], newest: dict[int, datetime]) -> list[_Row]:
    rows = []
    for record in records:
        is_from_future = record.measured_at > record.received_at + timedelta(seconds=FUTURE_S)
        before = newest.get(record.uav_id)
        is_late = not is_from_future and before is not None and record.measured_at < before
        if not is_from_future and not is_late:
            newest[record.uav_id] = record.measured_at
        rows.append(_Row(record, is_from_future, is_late))
    return rows


def _newest_positions(rows: Sequence[_Row]) -> list[ReportedPosition]:
    newest: dict[int, ReportedPosition] = {}
    for row in rows:
        record, reported = row.record, row.record.measurement
        if row.is_from_future or reported.longitude_deg is None or reported.latitude_deg is None:
            continue
        before = newest.get(record.uav_id)
        if before is None or before.measured_at < record.measured_at:
            newest[record.uav_id] = ReportedPosition(
                record.uav_id,
                record.measured_at,
                reported.longitude_deg,
                reported.latitude_deg,
                reported.heading_deg,
                reported.battery_percent,
            )
    return list(newest.values())


_TYPES = {
    "mode": "text", "is_armed": "bool", "is_in_air": "bool", "gps_fix": "int2", "satellites": "int2",
    "mission_item": "int4", "waypoint_sequence": "int4",
}  # fmt: skip
_MEASURED = tuple(field.name for field in fields(Measurement))
_STORED_AS_THEY_ARE = tuple(name for name in _MEASURED if name not in {"longitude_deg", "latitude_deg"})
_COLUMNS: dict[str, str] = {
    "number": "int8", "stream": "int8", "sequence": "int8", "uav_id": "int8", "mission_id": "uuid",
    "measured_at": "timestamptz", "received_at": "timestamptz", "is_from_future": "bool", "is_late": "bool",
    **{name: _TYPES.get(name, "float8") for name in _MEASURED},
}  # fmt: skip
_INSERT = f"""
INSERT INTO telemetry_telemetryrecord
    (stream_id, sequence, uav_id, mission_id, measured_at, received_at, is_from_future, is_late, position, {", ".join(_STORED_AS_THEY_ARE)})
SELECT stream, sequence, uav_id, mission_id, measured_at, received_at, is_from_future, is_late,
    ST_SetSRID(ST_MakePoint(longitude_deg, latitude_deg), 4326), {", ".join(_STORED_AS_THEY_ARE)}
FROM unnest({", ".join(f"%s::{kind}[]" for kind in _COLUMNS.values())}) AS r({", ".join(_COLUMNS)})
ORDER BY number
ON CONFLICT (stream_id, sequence) DO NOTHING
RETURNING stream_id, sequence
"""  # noqa: S608 (column names, all from here)


def _insert(rows: Sequence[_Row]) -> list[_Row]:
    """Return the rows that were stored."""
    records = [row.record for row in rows]
    streams = stream_ids({(record.uav_id, record.link, record.stream) for record in records})
    columns: dict[str, list[object]] = {name: [getattr(record.measurement, name) for record in records] for name in _MEASURED}
    columns |= {name: [getattr(record, name) for record in records] for name in ("sequence", "uav_id", "mission_id")}
    columns |= {name: [getattr(record, name) for record in records] for name in ("measured_at", "received_at")}
    columns |= {name: [getattr(row, name) for row in rows] for name in ("is_from_future", "is_late")}
    columns["number"] = list(range(len(rows)))
    columns["stream"] = [streams[record.uav_id, record.link, record.stream] for record in records]
    with connection.cursor() as cursor:
        cursor.execute(_INSERT, [columns[name] for name in _COLUMNS])
        stored = set(cursor.fetchall())
    first = {(stream, row.record.sequence): row for stream, row in zip(reversed(columns["stream"]), reversed(rows), strict=True)}
    return [row for key, row in first.items() if key in stored]


def stream_ids(streams: set[tuple[int, str, str]]) -> dict[tuple[int, str, str], int]:
    uavs, links, keys = (list(column) for column in zip(*sorted(streams), strict=True))
    wanted = "unnest(%s::bigint[], %s::text[], %s::text[]) AS wanted(uav_id, link, key)"
    with connection.cursor() as cursor:
        cursor.execute(
            f"INSERT INTO telemetry_telemetrystream (uav_id, link, key) SELECT * FROM {wanted} "  # noqa: S608
            "WHERE NOT EXISTS (SELECT 1 FROM telemetry_telemetrystream stream "
            "WHERE stream.uav_id = wanted.uav_id AND stream.link = wanted.link AND stream.key = wanted.key) "
            "ON CONFLICT (uav_id, link, key) DO NOTHING",
            [uavs, links, keys],
        )
        cursor.execute(
            f"SELECT stream.uav_id, stream.link, stream.key, stream.id FROM telemetry_telemetrystream stream JOIN {wanted} "  # noqa: S608
            "USING (uav_id, link, key)",
            [uavs, links, keys],
        )
        return {(uav_id, link, key): stream_id for uav_id, link, key, stream_id in cursor.fetchall()}
