"""Tables as text (CSV): encoding, delimiter and decimal sign are detected; the geometry is in two columns, or in one as WKT."""

import codecs
import csv
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import shapely

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.rows import (
    MAX_COLUMNS,
    MAX_ROW_CHARACTERS,
    MAX_TEXT,
    Columns,
    RawRow,
    RowSource,
    plain_cell,
    refused,
    unique_names,
)

_CHUNK = 64 * 1024
_SAMPLE_ROWS = 20
_DELIMITERS = ";,\t|"
_NUMBER = re.compile(r"[+-]?\d{1,12}(?:\.\d{0,20})?(?:[eE][+-]?\d{1,2})?", re.ASCII)
_WKT = re.compile(r"\s*(?:SRID=\d{1,6};)?\s*((MULTI)?(POINT|LINESTRING|POLYGON))(\s+Z?M?)?\s*\(", re.IGNORECASE)
_MAX_WKT_DEPTH = 3
_LON = ("lon", "lng", "long", "longitude", "longitud", "lon_wgs84", "laenge", "länge", "x", "x_coord", "easting", "ost", "rechtswert", "e")
_LAT = ("lat", "latitude", "latitud", "lat_wgs84", "breite", "y", "y_coord", "northing", "nord", "hochwert", "n")
_WKT_NAMES = ("wkt", "geom", "geometry", "the_geom", "geometrie", "shape", "wkt_geom")

csv.field_size_limit(max(csv.field_size_limit(), MAX_ROW_CHARACTERS))  # process-wide: a polygon as WKT exceeds the default


def delimited_source(path: Path, geometry_columns: Any) -> RowSource:
    """Open a table. geometry_columns is {"lon", "lat"} or {"wkt"} with column names; missing ones are guessed. Raises AssetFileError."""
    encoding = _encoding(path)
    delimiter = _delimiter(path, encoding)
    columns, first = _columns(path, encoding, delimiter)
    chosen = _geometry_columns(geometry_columns, columns, first)
    notes = [f"{encoding.upper()}, columns parted by {'tab' if delimiter == chr(9) else delimiter}"]
    source = RowSource("csv", lambda: _rows(path, encoding, delimiter, columns, chosen), notes=notes, geometry_columns=chosen)
    source.columns, source.first_cells = columns, dict(zip(columns, first, strict=False))
    return source


def number_of(text: str) -> float | None:
    """Return a number in usual notations: 8.54, 8,54, 2'600'000.5, 1 200 000; None for anything else, including "nan" and "inf"."""
    plain = text.strip().replace("'", "").replace("’", "").replace("\u00a0", "").replace("\u202f", "").replace(" ", "")
    if plain.count(",") == 1 and "." not in plain:
        plain = plain.replace(",", ".")
    elif "," in plain and "." in plain:
        plain = plain.replace(",", "") if plain.rindex(".") > plain.rindex(",") else plain.replace(".", "").replace(",", ".")
    return float(plain) if _NUMBER.fullmatch(plain) else None


def _encoding(path: Path) -> str:
    with path.open("rb") as file:
        start = file.read(4)
        if start.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            return "utf-16"
        decoder = codecs.getincrementaldecoder("utf-8")()
        file.seek(0)
        try:
            while chunk := file.read(_CHUNK):
                decoder.decode(chunk)
            decoder.decode(b"", final=True)
        except UnicodeDecodeError:
            return "windows-1252"
    return "utf-8-sig" if start.startswith(codecs.BOM_UTF8) else "utf-8"


def _delimiter(path: Path, encoding: str) -> str:
    """Return the delimiter that splits most of the first rows into the same number of cells, more than one."""
    lines = []
    for _, line in zip(range(_SAMPLE_ROWS), _lines(path, encoding), strict=False):
        lines.append(line)
    best, best_score = ",", 0.0
    for delimiter in _DELIMITERS:
        try:
            widths = Counter(len(row) for row in csv.reader(lines, delimiter=delimiter) if row)
        except csv.Error:
            continue
        if widths:
            width, rows = widths.most_common(1)[0]
            score = rows / sum(widths.values()) + width / 1_000 if width > 1 else 0.0
            if score > best_score:
                best, best_score = delimiter, score
    return best


def _lines(path: Path, encoding: str) -> Iterator[str]:
    """Yield lines; an endless one is refused before it fills the memory."""
    with path.open(encoding=encoding, errors="replace" if encoding == "windows-1252" else "strict", newline="") as file:
        number = 0
        try:
            while line := file.readline(MAX_ROW_CHARACTERS):
                number += 1
                if len(line) >= MAX_ROW_CHARACTERS:
                    raise refused(f"line {number}", f"the line has more than {MAX_ROW_CHARACTERS} characters")
                if "\0" in line:
                    raise refused(f"line {number}", "there is a null character; this is no text, or a text in an encoding that is not told")
                yield line
        except UnicodeDecodeError as error:
            raise refused(f"line {number + 1}", f"the text is not {encoding.upper()}") from error


def _cells(path: Path, encoding: str, delimiter: str) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(_lines(path, encoding), delimiter=delimiter)
    while True:
        line = reader.line_num + 1
        try:
            cells = next(reader, None)
        except csv.Error as error:
            raise refused(f"line {line}", f"the row cannot be read: {error}") from error
        if cells is None:
            return
        if any(cells):
            yield line, cells


def _columns(path: Path, encoding: str, delimiter: str) -> tuple[tuple[str, ...], list[str]]:
    rows = _cells(path, encoding, delimiter)
    line, names = next(rows, (1, []))
    if len(names) > MAX_COLUMNS:
        raise refused(f"line {line}", f"the file has more than {MAX_COLUMNS} columns")
    if len(names) < 2:
        raise refused(f"line {line}", "the first line names no columns parted by comma, semicolon, tab or |")
    if sum(number_of(name) is not None for name in names) * 2 > len(names):
        raise refused(f"line {line}", "the first line has numbers where the names of the columns are expected")
    Columns().check((" ".join(name.split()) for name in names), f"line {line}")
    return unique_names(names), next(rows, (0, []))[1]


def _geometry_columns(stated: Any, columns: tuple[str, ...], first: list[str]) -> dict[str, str]:
    if isinstance(stated, dict):
        chosen = {role: stated[role] for role in ("wkt", "lon", "lat") if stated.get(role)}
        for role, name in chosen.items():
            if name not in columns:
                raise refused(f"geometry.{role}", f"the file has no column {str(name)[:40]!r}")
        if "wkt" in chosen:
            return {"wkt": chosen["wkt"]}
        if {"lon", "lat"} <= chosen.keys():
            return chosen
    by_name = {name.lower().strip(): name for name in reversed(columns)}
    for name, cell in zip(columns, first, strict=False):
        if name.lower() in _WKT_NAMES or _WKT.match(cell):
            return {"wkt": name} if _WKT.match(cell) else {}
    lon = next((by_name[name] for name in _LON if name in by_name), None)
    lat = next((by_name[name] for name in _LAT if name in by_name), None)
    return {"lon": lon, "lat": lat} if lon and lat else {}


def _rows(path: Path, encoding: str, delimiter: str, columns: tuple[str, ...], chosen: dict[str, str]) -> Iterator[RawRow]:
    rows = _cells(path, encoding, delimiter)
    next(rows)
    shown = [name for name in columns if name not in chosen.values()]
    for line, cells in rows:
        place = f"line {line}"
        if any(cells[len(columns) :]):
            raise refused(place, f"the row has {len(cells)} cells, but there are {len(columns)} columns")
        values = dict(zip(columns, cells, strict=False))
        yield RawRow(place, {name: plain_cell(values.get(name, ""), place) for name in shown}, _geometry(values, chosen, place))


def _geometry(values: dict[str, str], chosen: dict[str, str], place: str) -> dict[str, Any] | GeometryFault | None:
    stated = {role: values.get(name, "").strip() for role, name in chosen.items()}
    if not any(stated.values()):
        return None
    if "wkt" in stated:
        return _geometry_of_wkt(stated["wkt"], f"{place}, {chosen['wkt']}")
    position = []
    for role in ("lon", "lat"):
        number = number_of(stated[role])
        if number is None:
            return GeometryFault(f"{place}, {chosen[role]}", f"{stated[role][:40]!r} is no number")
        position.append(number)
    return {"type": "Point", "coordinates": position}


def _geometry_of_wkt(text: str, place: str) -> dict[str, Any] | GeometryFault:
    """Return the geometry of WKT, or a fault; deep nesting is refused before parsing."""
    match = _WKT.match(text)
    depth = deepest = 0
    for character in re.sub(r"[^()]", "", text):
        depth += 1 if character == "(" else -1
        deepest = max(deepest, depth)
    if match is None or depth != 0 or deepest > _MAX_WKT_DEPTH:
        return GeometryFault(place, f"{text[: min(40, MAX_TEXT)]!r} is no point, line or area as WKT")
    try:
        geometry = shapely.from_wkt(text[match.start(1) :])
    except shapely.errors.GEOSException as error:
        return GeometryFault(place, f"the WKT cannot be read: {str(error)[:120]}")
    return _as_lists(geometry.__geo_interface__) if not geometry.is_empty else GeometryFault(place, "the geometry is empty")


def _as_lists(geometry: dict[str, Any]) -> dict[str, Any]:
    def lists(value: Any) -> Any:
        return [lists(part) for part in value] if isinstance(value, tuple | list) else value

    return {"type": geometry["type"], "coordinates": lists(geometry["coordinates"])}
