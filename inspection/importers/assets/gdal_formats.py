"""GML, FlatGeobuf, DXF and File Geodatabases, which GDAL reads in a process with limits."""

import base64
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path, PurePosixPath
from typing import IO, Any
from xml.parsers import expat

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.archive import Archive
from inspection.importers.assets.reference_systems import system_of_wkt
from inspection.importers.assets.wkb import geometry_of_wkb
from inspection.importers.gdal_process import GdalRefusal, gdal_process
from inspection.importers.rows import (
    MAX_ROW_CHARACTERS,
    MAX_ROWS,
    AssetFileError,
    Columns,
    RawRow,
    RowSource,
    plain_cell,
    refused,
    unique_names,
)
from inspection.importers.xml_root import leads_elsewhere, root_of
from operation.reasons import Reason

_DRIVERS = {"gml": "GML", "flatgeobuf": "FlatGeobuf", "dxf": "DXF", "filegdb": "OpenFileGDB"}
_GML_NAMESPACE = b"http://www.opengis.net/gml"
_DXF_START = re.compile(rb"(?:\s*999[ \t]*\r?\n[^\n]*\n)*\s*0[ \t]*\r?\n[ \t]*SECTION\b")
_TABLE_OF_TABLES = "a00000001.gdbtable"
_GDB_MEMBER = re.compile(r"a[0-9a-f]{8}\.gdbtabl[ex]")
_MAX_GDB_MEMBERS = 400  # two of each table


def format_of_start(start: bytes) -> str:
    """Return gml, flatgeobuf or dxf for the first bytes of such a file, else an empty text. Raises AssetFileError."""
    if start.startswith(b"fgb\x03fgb"):
        return "flatgeobuf"
    if _DXF_START.match(start):
        return "dxf"
    root, declaration_line = root_of(start)
    if reason := leads_elsewhere(root):
        raise refused("line 1", reason)
    if root in {"", "kml"} or _GML_NAMESPACE not in start.replace(b"\0", b""):
        return ""
    if declaration_line:
        raise refused(f"line {declaration_line}", "the GML declares a document type or entities; such files are not read")
    return "gml"


@contextmanager
def gdal_file_source(path: Path, file_format: str, layer: str, *, has_system: bool) -> Iterator[RowSource]:
    """Open a layer of a file. has_system: the user names the reference system. Raises AssetFileError."""
    with path.open("rb") as file:
        if file_format == "gml":
            _check_numbers(file)
        yield _source(file_format, {f"file.{file_format}": file}, layer, has_system=has_system)


def has_geodatabase(archive: Archive) -> bool:
    return any(PurePosixPath(name).name.lower() == _TABLE_OF_TABLES for name in archive.names)


@contextmanager
def geodatabase_source(archive: Archive, layer: str, *, has_system: bool) -> Iterator[RowSource]:
    """Open a layer of a zipped File Geodatabase. Raises AssetFileError."""
    folders = {PurePosixPath(name).parent for name in archive.names if PurePosixPath(name).name.lower() == _TABLE_OF_TABLES}
    if len(folders) > 1:
        raise refused("", "the archive holds several geodatabases; send them one by one")
    folder = folders.pop()
    members = {
        name: PurePosixPath(name).name.lower()
        for name in archive.names
        if PurePosixPath(name).parent == folder and _GDB_MEMBER.fullmatch(PurePosixPath(name).name.lower())
    }
    if len(members) > _MAX_GDB_MEMBERS:
        raise refused("", f"the geodatabase has {len(members) // 2} tables; at most {_MAX_GDB_MEMBERS // 2} are read")
    with ExitStack() as stack:
        files = {f"file.gdb/{member}": stack.enter_context(archive.unpacked(name)) for name, member in members.items()}
        yield _source("filegdb", files, layer, has_system=has_system)


def _source(file_format: str, files: Mapping[str, IO[bytes]], layer: str, *, has_system: bool) -> RowSource:
    try:
        with gdal_process(_DRIVERS[file_format], files, layer=layer, most=0) as process:
            head = process.line()
            process.line()
    except GdalRefusal as refusal:
        raise _refused("", refusal) from refusal
    name = str(head["layer"])
    columns = unique_names(head["columns"])
    Columns().check(columns, name[:60])
    if head["wkt"] is None and not has_system:
        raise refused(name[:60], "the layer does not say in which reference system it is: name it, such as EPSG:2056")
    system = None if has_system else system_of_wkt(head["wkt"], name[:60])
    return RowSource(
        file_format, lambda: _rows(_DRIVERS[file_format], files, name, columns), crs=system, layer=name, layers=tuple(head["layers"]),
        columns=columns,
    )  # fmt: skip


def _rows(driver: str, files: Mapping[str, IO[bytes]], layer: str, columns: tuple[str, ...]) -> Iterator[RawRow]:
    number = 0
    try:
        with gdal_process(driver, files, layer=layer, most=MAX_ROWS + 1) as process:
            process.line()
            while isinstance(answer := process.line(), list):
                number += 1
                place = f"{layer[:60]}, row {number}"
                geometry, *values = answer
                properties = {name: plain_cell(value, place) for name, value in zip(columns, values, strict=True)}
                yield RawRow(place, properties, _geometry(geometry, place))
    except GdalRefusal as refusal:
        raise _refused(f"{layer[:60]}, after row {number}", refusal) from refusal


def _geometry(value: str | bool | None, place: str) -> dict[str, Any] | GeometryFault | None:
    if value is None:
        return None
    if isinstance(value, bool):
        return GeometryFault(place, "the geometry is in another reference system than its layer")
    try:
        return geometry_of_wkb(base64.b64decode(value), place)
    except GeometryFault as fault:
        return fault


def _refused(place: str, refusal: GdalRefusal) -> AssetFileError:
    reason = refusal.reason
    return refused(place, reason if isinstance(reason, Reason) else f"GDAL does not read it: {reason}")


_CHUNK = 64 * 1024
_MAX_TOKEN_BYTES = 1024 * 1024  # of one tag or comment
_DEEPEST = 64
_NUMBERS = {"pos", "posList", "coordinates", "X", "Y", "Z"}
_SEPARATORS = str.maketrans(",", " ")


def _check_numbers(file: IO[bytes]) -> None:
    """Check that the file is XML, not deeply nested, and that its coordinates are numbers. Raises AssetFileError with the line.

    GDAL would take "nan" or "x" for 0.
    """
    checker = _GmlChecker()
    fed = 0
    file.seek(0)
    while chunk := file.read(_CHUNK):
        checker.feed(chunk)
        fed += len(chunk)
        if fed - checker.parser.CurrentByteIndex > _MAX_TOKEN_BYTES:
            raise refused(checker.here(), "a tag or comment does not end")
    checker.feed(b"", is_last=True)


class _GmlChecker:
    def __init__(self) -> None:
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._begin
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self._depth = 0
        self._words: list[str] | None = None  # of an element with numbers
        self._characters = 0

    def here(self) -> str:
        return f"line {self.parser.CurrentLineNumber}"

    def feed(self, chunk: bytes, *, is_last: bool = False) -> None:
        try:
            self.parser.Parse(chunk, is_last)
        except expat.ExpatError as error:
            raise refused(f"line {error.lineno}", f"this is no GML: {expat.ErrorString(error.code)}") from error

    def _begin(self, tag: str, _: dict[str, str]) -> None:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise refused(self.here(), f"elements are nested more than {_DEEPEST} deep")
        self._words, self._characters = [] if tag.rpartition(":")[2] in _NUMBERS else None, 0

    def _text(self, text: str) -> None:
        self._characters += len(text)
        if self._characters > MAX_ROW_CHARACTERS:
            raise refused(self.here(), f"a text is longer than {MAX_ROW_CHARACTERS} characters")
        if self._words is not None:
            self._words.append(text)

    def _end(self, _: str) -> None:
        self._depth -= 1
        if self._words is not None:
            for word in "".join(self._words).translate(_SEPARATORS).split():
                if not _is_number(word):
                    raise refused(self.here(), f"{word[:40]!r} is no number")
        self._words, self._characters = None, 0


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
