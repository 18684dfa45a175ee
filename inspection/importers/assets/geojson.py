"""GeoJSON, read feature by feature, so that memory depends on the largest feature only."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

from inspection.importers.assets.reference_systems import system_of_code
from inspection.importers.rows import MAX_ROW_CHARACTERS, Columns, RawRow, RowSource, plain_cell, refused
from inspection.importers.strict_json import STRICT_DECODER, JsonFault, NotANumber, parse_strict_json
from operation.reasons import reason_of

_CHUNK = 256 * 1024
_START = re.compile(r'"features"\s*:\s*\[')
_CRS_NAME = re.compile(r'"crs"\s*:\s*\{[^{}]{0,200}"properties"\s*:\s*\{[^{}]{0,200}"name"\s*:\s*"([^"]{1,100})"')
_BLANKS = re.compile(r"[ \t\r\n]*")


def geojson_source(path: Path) -> RowSource:
    """Open a FeatureCollection, a Feature or a bare geometry. Raises AssetFileError."""
    with path.open(encoding="utf-8-sig") as file:
        head = _head(file, path)
    stated = _CRS_NAME.search(head)
    source = RowSource("geojson", lambda: _rows(path))
    if stated is not None:  # from the standard of 2008; some programs still write it
        source.crs = system_of_code(stated[1], "crs")
    return source


def _head(file: TextIO, path: Path) -> str:
    try:
        head = file.read(_CHUNK)
    except UnicodeDecodeError as error:
        raise refused("", "the JSON is not UTF-8") from error
    match = _START.search(head)
    return head[: match.start()] if match else head[:10_000]


def _rows(path: Path) -> Iterator[RawRow]:
    columns = Columns()
    try:
        with path.open(encoding="utf-8-sig") as file:
            for index, feature in enumerate(_features(file)):
                place = f"features[{index}]"
                yield _row(feature, place, columns)
    except UnicodeDecodeError as error:
        raise refused("", "the JSON is not UTF-8") from error


def _row(feature: Any, place: str, columns: Columns) -> RawRow:
    if not isinstance(feature, dict) or feature.get("type") != "Feature":
        raise refused(place, "this is no GeoJSON feature")
    stated = feature.get("properties")
    properties = dict(stated) if isinstance(stated, dict) else {}
    if isinstance(feature.get("id"), str | int) and "id" not in properties:
        properties = {"id": feature["id"], **properties}
    columns.check(properties, place)
    geometry = feature.get("geometry")
    if geometry is not None and not isinstance(geometry, dict):
        raise refused(f"{place}.geometry", "this is no GeoJSON geometry")
    return RawRow(place, {name: _cell(value, f"{place}.properties") for name, value in properties.items()}, geometry)


def _cell(value: Any, place: str) -> Any:
    try:
        return plain_cell(json.dumps(value, ensure_ascii=False) if isinstance(value, dict | list) else value, place)
    except RecursionError as error:
        raise refused(place, "a value is nested too deeply") from error


def _features(file: TextIO) -> Iterator[Any]:
    window = ""
    while (match := _START.search(window)) is None:
        text = file.read(_CHUNK)
        window += text
        if not text:
            yield from _single(window)
            return
        if len(window) > MAX_ROW_CHARACTERS:
            raise refused("", 'this JSON has no "features", or they come very late')
    yield from _FeatureScanner(file, window, match.end()).features()


def _single(text: str) -> Iterator[Any]:
    try:
        value = parse_strict_json(text, max_bytes=MAX_ROW_CHARACTERS)
    except JsonFault as fault:
        raise refused("", reason_of(fault)) from fault
    kind = value.get("type") if isinstance(value, dict) else None
    if kind == "Feature":
        yield value
    elif isinstance(kind, str) and ("coordinates" in value or "geometries" in value):
        yield {"type": "Feature", "properties": {}, "geometry": value}
    else:
        raise refused("", "this JSON is no GeoJSON")


class _FeatureScanner:
    """A sliding window on the text, with one feature at a time in memory."""

    def __init__(self, file: TextIO, window: str, at: int) -> None:
        self.file, self.window, self.at = file, window, at

    def features(self) -> Iterator[Any]:
        if self._peek() == "]":
            return
        index = 0
        while True:
            yield self._feature(f"features[{index}]")
            mark = self._peek()
            self.at += 1
            if mark == "]":
                return
            if mark != ",":
                raise refused(f"features[{index}]", "the JSON breaks off or is damaged after this feature")
            index += 1

    def _read_on(self) -> bool:
        left = self.window[self.at :]
        text = self.file.read(max(_CHUNK, len(left)))
        self.window, self.at = left + text, 0
        return bool(text)

    def _peek(self) -> str:
        while True:
            self.at = _BLANKS.match(self.window, self.at).end()  # type: ignore[union-attr]
            if self.at < len(self.window) or not self._read_on():
                return self.window[self.at : self.at + 1]

    def _feature(self, place: str) -> Any:
        if self._peek() != "{":
            raise refused(place, "this is no GeoJSON feature")
        while True:
            try:
                feature, end = STRICT_DECODER.raw_decode(self.window, self.at)
            except NotANumber as error:
                raise refused(place, f"{error} is no number in JSON") from error
            except RecursionError as error:
                raise refused(place, "the feature is nested too deeply") from error
            except ValueError as error:
                if len(self.window) - self.at >= MAX_ROW_CHARACTERS:
                    raise refused(place, f"the feature is damaged or longer than {MAX_ROW_CHARACTERS} characters") from error
                if not self._read_on():
                    raise refused(place, f"the feature is damaged or cut off: {error}") from error
            else:
                self.at = end
                return feature
