"""CSV (RFC 4180) and GeoJSON (RFC 7946), in pieces that are made while they are sent."""

import csv
import re
from collections.abc import Iterable, Iterator
from io import StringIO
from itertools import islice

ROWS_A_PIECE = 500
# Spreadsheets read a cell as a formula if it begins so, also after blanks and in full width. A semicolon as separator begins a cell.
_FORMULA = re.compile(r"^(?=[\t\r])|(?:^|(?<=[;\t\r\n]))(?=[\s\u200b\ufeff]*[=+\-@\uff1d\uff0b\uff0d\uff20])")

Value = float | int | bool | str | None


def csv_pieces(names: Iterable[str], rows: Iterable[Iterable[Value]]) -> Iterator[str]:
    """Yield a table with the names of its columns. Texts in the rows are written as they are: cell() makes foreign ones safe."""
    piece = StringIO()
    writer = csv.writer(piece)
    writer.writerow(names)
    for number, row in enumerate(rows, start=1):
        writer.writerow(row)
        if number % ROWS_A_PIECE == 0:
            yield piece.getvalue()
            piece.seek(0)
            piece.truncate()
    yield piece.getvalue()


def cell(value: Value) -> Value:
    """Return the value in a form that no spreadsheet reads as a formula; truth values as in JSON."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return without_formula(value) if isinstance(value, str) else value


def without_formula(value: str) -> str:
    """Return the text in a form that no spreadsheet reads as a formula."""
    return _FORMULA.sub("'", value)


def collection_pieces(features: Iterable[str]) -> Iterator[str]:
    """Yield a FeatureCollection of features that are GeoJSON texts already."""
    yield '{"type":"FeatureCollection","features":['
    rest, before = iter(features), "\n"
    while piece := list(islice(rest, ROWS_A_PIECE)):
        yield before + ",\n".join(piece)
        before = ",\n"
    yield "\n]}\n"
