"""Coordinates of GML are checked before GDAL reads them, as it takes "nan" or "x" for 0."""

import math
from typing import IO
from xml.parsers import expat

from inspection.importers.rows import MAX_ROW_CHARACTERS, refused

_CHUNK = 64 * 1024
_MAX_TOKEN_BYTES = 1024 * 1024  # of one tag or comment
_DEEPEST = 64
_NUMBERS = {"pos", "posList", "coordinates", "X", "Y", "Z"}
_SEPARATORS = str.maketrans(",", " ")


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
