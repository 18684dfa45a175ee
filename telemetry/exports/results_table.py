"""Results of a mission as a table: CSV for programs, XLSX for people."""

import csv
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from io import BytesIO, StringIO

import xlsxwriter

from inspection.exporters.text_pieces import without_formula
from telemetry.exports.logged_record import time_text
from telemetry.exports.results import MissionResults, ResultRow

Cell = str | int | float | datetime | None

COLUMNS: dict[str, Callable[[ResultRow], Cell]] = {
    "number": lambda row: row.number,
    "asset": lambda row: row.asset,
    "asset_id": lambda row: row.asset_id,
    "external_id": lambda row: row.external_id,
    "line": lambda row: row.line,
    "result": lambda row: row.result,
    "reason": lambda row: row.reason,
    "reason_at": lambda row: row.reason_at,
    "uav": lambda row: row.uav,
    "reached_at": lambda row: row.reached_at,
    "planned_hold_s": lambda row: _rounded(row.planned_hold_s),
    "held_s": lambda row: _rounded(row.held_s),
    "distance_m": lambda row: _rounded(row.distance_m),
    "altitude_relative_m": lambda row: _rounded(row.altitude_relative_m),
    "longitude_deg": lambda row: None if row.position is None else round(row.position.lon, 7),
    "latitude_deg": lambda row: None if row.position is None else round(row.position.lat, 7),
}
MIN_WIDTH, MAX_WIDTH = 9, 60  # of a column, in characters


def results_csv(results: MissionResults) -> bytes:
    """Return comma-separated values (RFC 4180), with units in the column names and times in UTC."""
    written = StringIO()
    writer = csv.writer(written)
    writer.writerow(COLUMNS)
    for row in results.rows:
        writer.writerow([_text(read(row)) for read in COLUMNS.values()])
    return written.getvalue().encode()


def results_xlsx(results: MissionResults, headings: Mapping[str, str], sheet: str) -> bytes:
    """Return a workbook with one filtered sheet. headings: by column, in the reader's language."""
    file = BytesIO()
    book = xlsxwriter.Workbook(file, {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False})
    page = book.add_worksheet(sheet)
    head, moment = book.add_format({"bold": True, "bottom": 1}), book.add_format({"num_format": "yyyy-mm-dd hh:mm:ss"})
    for column, name in enumerate(COLUMNS):
        page.write_string(0, column, headings[name], head)
        longest = len(headings[name])
        for number, row in enumerate(results.rows, start=1):
            value = row.result_words if name == "result" else COLUMNS[name](row)
            longest = max(longest, len(_text(value)))
            if isinstance(value, datetime):
                page.write_datetime(number, column, value.astimezone(UTC).replace(tzinfo=None), moment)
            elif isinstance(value, str):
                page.write_string(number, column, value)
            elif value is not None:
                page.write_number(number, column, value)
        page.set_column(column, column, min(max(longest + 1, MIN_WIDTH), MAX_WIDTH))
    page.autofilter(0, 0, max(len(results.rows), 1), len(COLUMNS) - 1)
    page.freeze_panes(1, 2)
    book.close()
    return file.getvalue()


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 1)


def _text(value: Cell) -> str:
    if value is None:
        return ""
    if isinstance(value, datetime):
        return time_text(value)
    return without_formula(value) if isinstance(value, str) else str(value)
