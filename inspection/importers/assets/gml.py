"""What GDAL does not refuse in GML: its first element is looked at, and its coordinates, of which GDAL takes "nan" or "x" for 0."""

import math
from contextlib import suppress
from typing import IO, Any
from xml.parsers import expat

from inspection.importers.rows import MAX_ROW_CHARACTERS, refused

_CHUNK = 64 * 1024
_MAX_TOKEN_BYTES = 1024 * 1024  # of one tag or comment
_DEEPEST = 64
_NUMBERS = {"pos", "posList", "coordinates", "X", "Y", "Z"}
_SEPARATORS = str.maketrans(",", " ")


class _RootFound(Exception):
    pass


def root_of(start: bytes) -> tuple[str, int]:
    """Return the name of an XML document's first element, and the line of its document type; empty and 0 where there is none."""
    parser = expat.ParserCreate()
    name, line = "", 0

    def begin(tag: str, _: dict[str, str]) -> None:
        nonlocal name
        name = tag.rpartition(":")[2]
        raise _RootFound

    def declare(*_: Any) -> None:
        nonlocal line
        line = parser.CurrentLineNumber

    parser.StartElementHandler = begin
    parser.StartDoctypeDeclHandler = declare
    with suppress(_RootFound, expat.ExpatError, LookupError, ValueError):  # the reader of the format has the words for what is wrong
        parser.Parse(start)
    return name, line


def check_numbers(file: IO[bytes]) -> None:
    """Check that the file is XML, not deeply nested, and that its coordinates are numbers. Raises AssetFileError with the line."""
    checker = _Checker()
    fed = 0
    file.seek(0)
    while chunk := file.read(_CHUNK):
        checker.feed(chunk)
        fed += len(chunk)
        if fed - checker.parser.CurrentByteIndex > _MAX_TOKEN_BYTES:
            raise refused(checker.here(), "a tag or comment does not end")
    checker.feed(b"", is_last=True)


class _Checker:
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
