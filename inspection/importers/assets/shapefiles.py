"""Shapefiles in a zip file. The library that reads them trusts every length, so all lengths are validated first."""

import codecs
import struct
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from itertools import pairwise
from pathlib import PurePosixPath
from typing import IO, Any

import shapefile

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.archive import Archive
from inspection.importers.assets.reference_systems import MAX_WKT_CHARACTERS, system_of_wkt
from inspection.importers.rows import MAX_ROWS, Columns, RawRow, RowSource, plain_cell, refused, unique_names

_HEADER_BYTES = 100
_MAX_RECORD_BYTES = 1024 * 1024  # of one geometry; 10,000 vertices with height and measure take a third of it
_MAX_PARTS = 2_000
_WITH_PARTS = {3, 5, 13, 15, 23, 25}
_WITH_POINTS = _WITH_PARTS | {8, 18, 28}
_KNOWN = _WITH_POINTS | {0, 1, 11, 21}
_DAMAGED = (shapefile.ShapefileException, struct.error, ValueError, KeyError, IndexError, TypeError, OverflowError)


@contextmanager
def shapefile_source(archive: Archive, layer: str, *, has_system: bool) -> Iterator[RowSource]:
    """Open a layer. has_system: the user names the reference system, so a missing .prj is no fault. Raises AssetFileError."""
    members = {name.lower(): name for name in archive.names if not PurePosixPath(name).name.startswith(".")}
    stems = sorted(name[:-4] for name in members if name.endswith(".shp") and not name.startswith("__macosx/"))
    layers = tuple(PurePosixPath(members[f"{stem}.shp"]).stem for stem in stems)
    if not stems:
        raise refused("", "the archive has no .shp file")
    stem = stems[layers.index(layer)] if layer in layers else stems[0]
    shape_name = members[f"{stem}.shp"]
    system = None
    if f"{stem}.prj" in members:
        system = system_of_wkt(archive.text(members[f"{stem}.prj"], 4 * MAX_WKT_CHARACTERS), members[f"{stem}.prj"])
    elif not has_system:
        raise refused(
            shape_name, "the .prj file is missing, so nobody knows where the coordinates are: put it into the archive, "
            "or name the reference system, such as EPSG:2056",
        )  # fmt: skip
    with ExitStack() as stack:
        shapes = stack.enter_context(archive.unpacked(shape_name))
        offsets = _looked_over(shapes, shape_name)
        table = stack.enter_context(archive.unpacked(members[f"{stem}.dbf"])) if f"{stem}.dbf" in members else None
        encoding = "utf-8"
        if table is not None:
            _look_table_over(table, members[f"{stem}.dbf"])
            stated = archive.text(members[f"{stem}.cpg"], 100) if f"{stem}.cpg" in members else ""
            encoding = _encoding(stated, table)
        source = RowSource("shapefile", lambda: _rows(shapes, offsets, table, encoding, shape_name), crs=system)
        source.layer, source.layers = PurePosixPath(shape_name).stem, layers
        yield source


def _looked_over(file: IO[bytes], name: str) -> list[tuple[int, int]]:
    """Return offset and length of each record. Lengths stay within the file and go forward, and counts fit into their records."""
    size = file.seek(0, 2)
    if size < _HEADER_BYTES:
        raise refused(name, "the file is cut off")
    file.seek(0)
    if file.read(4) != b"\x00\x00\x27\x0a":
        raise refused(name, "this is no shapefile")
    records: list[tuple[int, int]] = []
    at = _HEADER_BYTES
    while at < size:
        place = f"{name}, record {len(records) + 1}"
        file.seek(at)
        head = file.read(8 + 4 + 32 + 8)
        if len(head) < 12:
            raise refused(place, "the file is cut off")
        length = 2 * struct.unpack_from(">i", head, 4)[0]
        if length < 4 or at + 8 + length > size:
            raise refused(place, "the record goes past the end of the file, or back")
        if length > _MAX_RECORD_BYTES:
            raise refused(place, f"the geometry has {length} bytes; at most {_MAX_RECORD_BYTES} are taken")
        _check_counts(head, length, place)
        if len(records) >= MAX_ROWS:
            raise refused(place, f"the file has more than {MAX_ROWS} records")
        records.append((at, length))
        at += 8 + length
    return records


def _check_counts(head: bytes, length: int, place: str) -> None:
    (kind,) = struct.unpack_from("<i", head, 8)
    if kind not in _KNOWN:
        raise refused(place, f"shapes of type {kind} are not read; points, lines and areas are")
    if kind in _WITH_POINTS:
        counts = struct.unpack_from("<2i", head + b"\0" * 4, 44)
        parts, points = counts if kind in _WITH_PARTS else (0, counts[0])
        if parts < 0 or points < 0 or 4 + 32 + 4 * parts + 16 * points > length:
            raise refused(place, "the record holds fewer vertices than it says")
        if parts > _MAX_PARTS:
            raise refused(place, f"the geometry has {parts} parts; at most {_MAX_PARTS} are taken")


def _look_table_over(file: IO[bytes], name: str) -> None:
    size = file.seek(0, 2)
    file.seek(0)
    head = file.read(32)
    if len(head) < 32:
        raise refused(name, "the table is cut off")
    rows, head_bytes, row_bytes = struct.unpack_from("<LHH", head, 4)
    if rows > MAX_ROWS:
        raise refused(name, f"the table has more than {MAX_ROWS} rows")
    if head_bytes < 33 or row_bytes < 1 or head_bytes + rows * row_bytes > size + 1:
        raise refused(name, "the table is damaged or cut off")


def _encoding(stated: str, table: IO[bytes]) -> str:
    """Return the encoding of the .cpg file; else UTF-8 if the whole table is valid UTF-8, else that of older Windows programs."""
    word = stated.strip().lower()
    for name in (word, f"cp{word.removeprefix('ansi').strip()}") if word else ():
        try:
            return codecs.lookup(name).name
        except (LookupError, ValueError):
            continue
    decoder = codecs.getincrementaldecoder("utf-8")()
    table.seek(struct.unpack_from("<H", _start(table), 8)[0])
    try:
        while chunk := table.read(64 * 1024):
            decoder.decode(chunk)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _start(table: IO[bytes]) -> bytes:
    table.seek(0)
    return table.read(32)


def _rows(shapes: IO[bytes], offsets: list[tuple[int, int]], table: IO[bytes] | None, encoding: str, name: str) -> Iterator[RawRow]:
    try:
        reader = shapefile.ShpReader(shapes)
        facts = shapefile.DbfReader(table, encoding=encoding, encodingErrors="replace") if table is not None else None
        names = unique_names(field.name for field in facts.data_fields) if facts else ()
    except _DAMAGED as error:
        raise refused(name, "the head of the file is damaged") from error
    Columns().check(names, name)
    if facts is not None and len(facts) != len(offsets):
        raise refused(name, f"there are {len(offsets)} shapes, but {len(facts)} rows in the table")
    for index, (offset, length) in enumerate(offsets):
        place = f"record {index + 1}"
        try:
            record = facts.record(index) if facts else ()
            if record is None:
                continue  # deleted
            shape = reader.shape(index, offset, length)
            geometry = None if shape is None or shape.shapeType == 0 else _geometry(shape, place)
        except _DAMAGED as error:
            raise refused(place, "the record is damaged") from error
        yield RawRow(place, {column: plain_cell(_cell(value), place) for column, value in zip(names, record, strict=True)}, geometry)


def _cell(value: Any) -> Any:
    return value.rstrip("\0 ") if isinstance(value, str) else value


def _geometry(shape: Any, place: str) -> dict[str, Any] | GeometryFault | None:
    parts = list(shape.parts or [])
    overlap = any(after <= before for before, after in pairwise(parts))
    if overlap or (parts and (parts[0] != 0 or parts[-1] >= len(shape.points))):
        return GeometryFault(place, "the parts of the geometry overlap")
    value = shape.__geo_interface__
    if not value["coordinates"]:
        return None
    return {"type": value["type"], "coordinates": _as_lists(value["coordinates"])}


def _as_lists(value: Any) -> Any:
    return [_as_lists(part) for part in value] if isinstance(value, tuple | list) else float(value)
