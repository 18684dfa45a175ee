"""CSV (RFC 4180) and GeoJSON (RFC 7946), in pieces that are made while they are sent."""

import csv
import json
from collections.abc import Iterable, Iterator
from io import StringIO

from inspection.exporters.rows import Columns, ExportRow, Value
from inspection.exporters.spreadsheet_cells import without_formula

LINES_A_PIECE = 500


def csv_pieces(rows: Iterable[ExportRow], columns: Columns) -> Iterator[str]:
    """Yield a table with a position instead of the geometry."""
    piece = StringIO()
    writer = csv.writer(piece)
    writer.writerow(["id", *columns, "longitude_deg", "latitude_deg"])
    for number, row in enumerate(rows, start=1):
        cells = (_cell(row.values.get(name)) for name in columns)
        writer.writerow([row.key, *cells, f"{row.longitude:.7f}", f"{row.latitude:.7f}"])
        if number % LINES_A_PIECE == 0:
            yield piece.getvalue()
            piece.seek(0)
            piece.truncate()
    yield piece.getvalue()


def _cell(value: Value) -> Value:
    if isinstance(value, bool):
        return "true" if value else "false"
    return without_formula(value) if isinstance(value, str) else value


def geojson_pieces(rows: Iterable[ExportRow], columns: Columns) -> Iterator[str]:
    """Yield a FeatureCollection."""
    yield '{"type":"FeatureCollection","features":['
    for number, row in enumerate(rows):
        properties = json.dumps({name: row.values.get(name) for name in columns}, ensure_ascii=False)
        comma = "," if number else ""
        yield f'{comma}\n{{"type":"Feature","id":{row.key},"geometry":{row.geometry},"properties":{properties}}}'
    yield "\n]}\n"
