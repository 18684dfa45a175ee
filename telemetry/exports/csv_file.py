"""Records as comma-separated values (RFC 4180), one line each, with units in the column names."""

from collections.abc import Iterable, Iterator

from inspection.exporters.text_pieces import cell, csv_pieces
from telemetry.exports.logged_record import FLAGS, REPORTED, LoggedRecord, Value, time_text

COLUMNS = (
    "measured_at", "received_at", "stored_at", "uav", "uav_name", "mission", "stream", "sequence", "longitude_deg", "latitude_deg",
    *REPORTED, *FLAGS,
)  # fmt: skip


def csv_of_records(records: Iterable[LoggedRecord]) -> Iterator[str]:
    return csv_pieces(COLUMNS, map(_row, records))


def _row(record: LoggedRecord) -> Iterator[Value]:
    yield from (time_text(instant) for instant in (record.measured_at, record.received_at, record.stored_at))
    yield from (record.uav, cell(record.uav_name), record.mission, cell(record.stream), record.sequence)
    yield from record.position or (None, None)
    yield from map(cell, record.values)
