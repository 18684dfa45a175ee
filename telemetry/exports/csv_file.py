"""Records as comma-separated values (RFC 4180), one line each, with units in the column names."""

import csv
from collections.abc import Iterable, Iterator
from io import StringIO

from inspection.exporters.spreadsheet_cells import without_formula
from telemetry.exports.logged_record import FLAGS, REPORTED, LoggedRecord, Value, time_text

COLUMNS = (
    "measured_at", "received_at", "stored_at", "uav", "uav_name", "mission", "stream", "sequence", "longitude_deg", "latitude_deg",
    *REPORTED, *FLAGS,
)  # fmt: skip
LINES_A_PIECE = 500


def csv_pieces(records: Iterable[LoggedRecord]) -> Iterator[str]:
    piece = StringIO()
    writer = csv.writer(piece)
    writer.writerow(COLUMNS)
    for number, record in enumerate(records, start=1):
        longitude, latitude = record.position or (None, None)
        times = (time_text(instant) for instant in (record.measured_at, record.received_at, record.stored_at))
        whose = (record.uav, without_formula(record.uav_name), record.mission, without_formula(record.stream), record.sequence)
        writer.writerow([*times, *whose, longitude, latitude, *(_cell(value) for value in record.values)])
        if number % LINES_A_PIECE == 0:
            yield piece.getvalue()
            piece.seek(0)
            piece.truncate()
    yield piece.getvalue()


def _cell(value: Value) -> Value:
    if isinstance(value, bool):
        return "true" if value else "false"
    return without_formula(value) if isinstance(value, str) else value
