"""KML, plain or zipped (KMZ), read placemark by placemark; documents that declare entities are refused."""

import re
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import IO, Any
from xml.parsers import expat

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.rows import MAX_ROW_CHARACTERS, AssetFileError, Columns, RawRow, RowSource, plain_cell, refused

_CHUNK = 64 * 1024
_MAX_TOKEN_LENGTH = 256 * 1024  # bytes of one tag or comment
_DEEPEST = 64
_MAX_GEOMETRIES = 10_000  # of one placemark
_SHAPES = {"Point", "LineString", "LinearRing", "Polygon", "Model", "Track"}
_FACTS = {"name", "description", "address", "phoneNumber"}
_BLANK = re.compile(r"\s+")

Opener = Callable[[], AbstractContextManager[IO[bytes]]]


def kml_source(opened: Opener, file_format: str = "kml") -> RowSource:
    """Open a KML document. KML is always in WGS84, longitude first."""
    return RowSource(file_format, lambda: _rows(opened))


def _rows(opened: Opener) -> Iterator[RawRow]:
    reader = _KmlReader()
    fed = 0
    with opened() as file:
        while chunk := file.read(_CHUNK):
            reader.feed(chunk)
            fed += len(chunk)
            if fed - reader.parser.CurrentByteIndex > _MAX_TOKEN_LENGTH:
                raise refused(reader.here(), "a tag or comment does not end")
            yield from reader.take()
        reader.feed(b"", is_last=True)
        yield from reader.take()


class _KmlReader:
    def __init__(self) -> None:
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._refuse_declaration
        self.parser.EntityDeclHandler = self._refuse_declaration
        self._columns = Columns()
        self._path: list[str] = []
        self._folders: list[str] = []
        self._words: list[str] = []
        self._characters = 0
        self._placemarks = 0
        self._rows: list[RawRow] = []
        self._forget()

    def feed(self, chunk: bytes, *, is_last: bool = False) -> None:
        try:
            self.parser.Parse(chunk, is_last)
        except expat.ExpatError as error:
            raise refused(f"line {error.lineno}", f"this is no KML: {expat.ErrorString(error.code)}") from error
        except AssetFileError:
            raise
        except (LookupError, ValueError) as error:
            raise refused("line 1", f"the encoding that the KML states is not known: {error}") from error

    def take(self) -> list[RawRow]:
        rows, self._rows = self._rows, []
        return rows

    def here(self) -> str:
        return f"line {self.parser.CurrentLineNumber}"

    def _forget(self) -> None:
        self._place = ""
        self._properties: dict[str, Any] = {}
        self._shapes: list[dict[str, Any]] = []
        self._rings: list[list[list[float]]] = []
        self._coordinates: list[list[float]] = []
        self._fault: GeometryFault | None = None
        self._data_name = ""
        self._row_characters = 0

    def _refuse_declaration(self, *_: Any) -> None:
        raise refused(self.here(), "the KML declares a document type or entities; such files are not read")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        name = tag.rpartition(":")[2]
        if not self._path and name != "kml":
            raise refused(self.here(), f"this XML is no KML: it begins with {name[:40]!r}")
        if len(self._path) >= _DEEPEST:
            raise refused(self.here(), f"elements are nested more than {_DEEPEST} deep")
        self._path.append(name)
        self._words, self._characters = [], 0
        if name == "Placemark":
            self._placemarks += 1
            self._forget()
            self._place = f"placemark {self._placemarks} ({self.here()})"
        elif name in {"Folder", "Document"}:
            self._folders.append("")
        elif name in {"Data", "SimpleData"}:
            self._data_name = attributes.get("name", "")
        elif name in _SHAPES:
            self._coordinates = []
            if name == "Polygon":
                self._rings = []

    def _text(self, text: str) -> None:
        self._characters += len(text)
        self._row_characters += len(text)
        if self._characters > MAX_ROW_CHARACTERS or self._row_characters > MAX_ROW_CHARACTERS:
            raise refused(self._place or self.here(), f"a text is longer than {MAX_ROW_CHARACTERS} characters")
        self._words.append(text)

    def _end(self, tag: str) -> None:
        name = self._path.pop()
        parent = self._path[-1] if self._path else ""
        text, self._words = "".join(self._words), []
        if name == "Placemark":
            self._finish()
        elif name in {"Folder", "Document"}:
            self._folders.pop()
            self._row_characters = 0
        elif not self._place:
            if name == "name" and parent in {"Folder", "Document"}:
                self._folders[-1] = text.strip()
            self._row_characters = 0
        elif parent == "Placemark" and name in _FACTS:
            self._report(name, text)
        elif (name == "value" and parent == "Data") or name == "SimpleData":
            self._report(self._data_name, text)
        elif name == "coordinates":
            self._coordinates = self._positions(text)
        elif name in _SHAPES:
            self._finish_shape(name, parent)

    def _report(self, name: str, text: str) -> None:
        name = " ".join(name.split())
        if name and text.strip():
            self._columns.check([name], self._place)
            self._properties[name] = plain_cell(text, self._place)

    def _positions(self, text: str) -> list[list[float]]:
        positions = []
        for word in _BLANK.split(text.strip()):
            try:
                numbers = [float(number) for number in word.split(",")[:3] if number]
            except ValueError:
                numbers = []
            if len(numbers) < 2:
                self._fault = self._fault or GeometryFault(self._place, f"{word[:40]!r} is no position; longitude,latitude is expected")
                return []
            positions.append(numbers[:2])
        return positions

    def _finish_shape(self, name: str, parent: str) -> None:
        if len(self._shapes) >= _MAX_GEOMETRIES or len(self._rings) >= _MAX_GEOMETRIES:
            raise refused(self._place, f"the placemark has more than {_MAX_GEOMETRIES} geometries")
        if name == "LinearRing" and parent in {"outerBoundaryIs", "innerBoundaryIs"}:
            if parent == "outerBoundaryIs":
                self._rings.insert(0, self._coordinates)
            else:
                self._rings.append(self._coordinates)
        elif name == "Point":
            self._shapes.append({"type": "Point", "coordinates": self._coordinates[0] if self._coordinates else []})
        elif name in {"LineString", "LinearRing"}:
            self._shapes.append({"type": "LineString", "coordinates": self._coordinates})
        elif name == "Polygon":
            self._shapes.append({"type": "Polygon", "coordinates": self._rings})
        else:
            self._fault = self._fault or GeometryFault(self._place, f"a {name} is no point, line or area")

    def _finish(self) -> None:
        if folder := " / ".join(name for name in self._folders if name):
            self._columns.check(["folder"], self._place)
            self._properties.setdefault("folder", plain_cell(folder, self._place))
        self._rows.append(RawRow(self._place, self._properties, self._fault or together(self._shapes)))
        self._forget()


def together(shapes: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Return several geometries as one, of a single kind where possible."""
    if len(shapes) < 2:
        return shapes[0] if shapes else None
    kinds = {shape["type"] for shape in shapes}
    if len(kinds) == 1:
        return {"type": f"Multi{kinds.pop()}", "coordinates": [shape["coordinates"] for shape in shapes]}
    return {"type": "GeometryCollection", "geometries": shapes}
