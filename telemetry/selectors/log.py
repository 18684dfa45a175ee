"""Reads of the log, always within one organisation."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from django.db.models import QuerySet

from inspection.selectors import Box
from inspection.selectors.assets import area_of
from missions.models import Uav
from telemetry.exports.logged_record import FLAGS, REPORTED, LoggedRecord
from telemetry.models import TelemetryRecord
from telemetry.selectors.columns import latitude, longitude
from workspace.models import Organisation

ROWS_AT_ONCE = 2_000


@dataclass(frozen=True)
class LogFilter:
    """Filter of records; None: any. Times are those of measurement; `measured_before` is exclusive."""

    uav_id: int | None = None
    mission_id: UUID | None = None
    measured_from: datetime | None = None
    measured_before: datetime | None = None
    box: Box | None = None


def records_that_match(organisation: Organisation, wanted: LogFilter) -> QuerySet[TelemetryRecord]:
    """Return the matching records; none for a UAV or mission of another organisation."""
    uavs = Uav.objects.filter(organisation=organisation)
    if wanted.uav_id is not None:
        uavs = uavs.filter(pk=wanted.uav_id)
    found = TelemetryRecord.objects.filter(uav_id__in=list(uavs.values_list("pk", flat=True)))  # a list, so that each UAV's index is used
    if wanted.mission_id is not None:
        found = found.filter(mission_id=wanted.mission_id, mission__organisation=organisation)
    if wanted.measured_from is not None:
        found = found.filter(measured_at__gte=wanted.measured_from)
    if wanted.measured_before is not None:
        found = found.filter(measured_at__lt=wanted.measured_before)
    if wanted.box is not None:
        found = found.filter(position__intersects=area_of(wanted.box))
    return found


def in_time(records: QuerySet[TelemetryRecord]) -> QuerySet[TelemetryRecord]:
    """Return the records without those from the future."""
    return records.filter(is_from_future=False)


def on_track(records: QuerySet[TelemetryRecord]) -> QuerySet[TelemetryRecord]:
    """Return the records with a position and a possible time (LoggedRecord.is_on_track)."""
    return in_time(records).filter(position__isnull=False)


def latest_record(uav: Uav) -> TelemetryRecord | None:
    """Return the record that the UAV measured last, with its UAV and stream; never one from the future."""
    return newest_of(uav.pk, "uav", "stream")


def newest_of(uav_id: int, *related: str) -> TelemetryRecord | None:
    found = in_time(TelemetryRecord.objects.filter(uav_id=uav_id))
    return (found.select_related(*related) if related else found).order_by("-measured_at", "-pk").first()


_COLUMNS = ("pk", "uav_id", "uav__name", "mission_id", "stream__key", "sequence", "measured_at", "received_at", "stored_at")


def logged(records: QuerySet[TelemetryRecord], *order: str) -> Iterator[LoggedRecord]:
    """Yield the records in this order, with at most some thousand in memory."""
    rows = records.order_by(*order).values_list(*_COLUMNS, longitude(), latitude(), *REPORTED, *FLAGS)
    return (_from_columns(row) for row in rows.iterator(chunk_size=ROWS_AT_ONCE))


def as_logged(record: TelemetryRecord) -> LoggedRecord:
    """Return a row that was read with its UAV and stream."""
    place = record.position
    return LoggedRecord(
        id=record.pk,
        uav=record.uav_id,
        uav_name=record.uav.name,
        mission=None if record.mission_id is None else str(record.mission_id),
        stream=record.stream.key,
        sequence=record.sequence,
        measured_at=record.measured_at,
        received_at=record.received_at,
        stored_at=record.stored_at,
        position=None if place is None else (place.x, place.y),
        values=tuple(getattr(record, name) for name in (*REPORTED, *FLAGS)),
    )


def _from_columns(row: tuple[Any, ...]) -> LoggedRecord:
    key, uav, uav_name, mission, stream, sequence, measured_at, received_at, stored_at, longitude, latitude, *values = row
    return LoggedRecord(
        id=key,
        uav=uav,
        uav_name=uav_name,
        mission=None if mission is None else str(mission),
        stream=stream,
        sequence=sequence,
        measured_at=measured_at,
        received_at=received_at,
        stored_at=stored_at,
        position=None if longitude is None else (longitude, latitude),
        values=tuple(values),
    )
