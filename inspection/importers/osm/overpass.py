"""Overpass requests for an area's infrastructure, with a limit of the area."""

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isfinite, radians, sin
from pathlib import Path
from typing import Any, TextIO

import osmium
from osmium.osm import mutable

from inspection.importers.osm.file_validator import OsmFileError, OsmFormat, open_unpacked
from inspection.importers.osm.records import Extent
from inspection.importers.strict_json import STRICT_DECODER, NotANumber

EARTH_RADIUS_KM = 6_371.0088  # IUGG mean radius
QUERY_TIMEOUT_S = 180
# What reader.py makes assets of, including life-cycle states, which it distinguishes itself.
_RAILWAYS = "rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature|disused|abandoned|construction"
_FILTERS = (
    'node["power"~"^(tower|pole|portal)$"]', 'way["power"~"^(line|minor_line|cable|minor_cable|portal|tower)$"]',
    f'way["railway"~"^({_RAILWAYS})$"]', 'way["bridge"]["bridge"!="no"]', 'way["man_made"="bridge"]',
    'relation["man_made"="bridge"]["type"="multipolygon"]',
)  # fmt: skip
_REMARK = re.compile(r'"remark"\s*:\s*"((?:[^"\\]|\\.){0,500})"')


class WrongArea(ValueError):
    """Raised for a box that is invalid, or larger than one request allows."""


def checked_box(value: object, most_km2: float) -> Extent:
    """Return west, south, east, north [deg]. Raises WrongArea."""
    if not isinstance(value, list | tuple) or len(value) != 4 or not all(_is_finite_number(number) for number in value):
        raise WrongArea("The area is four numbers: west, south, east, north.")
    west, south, east, north = (float(number) for number in value)
    if not (-180 <= west < east <= 180 and -90 <= south < north <= 90):
        raise WrongArea("West lies before east and south before north, from -180 to 180 and from -90 to 90 degrees.")
    size_km2 = area_km2((west, south, east, north))
    if size_km2 > most_km2:
        raise WrongArea(f"The area has {size_km2:,.0f} km²; at most {most_km2:,.0f} km² are taken at once. Zoom in.")
    return west, south, east, north


def area_km2(box: Extent) -> float:
    """Return the area of west, south, east, north [deg] on the sphere [km²]."""
    west, south, east, north = box
    return EARTH_RADIUS_KM**2 * radians(east - west) * (sin(radians(north)) - sin(radians(south)))


def question(box: Extent, *, most_bytes: int) -> str:
    """Return the Overpass QL query for everything in the box with whole ways, as JSON; the server stops at our own size limit."""
    west, south, east, north = box
    parts = "".join(f"{part};" for part in _FILTERS)
    area = f"{south:.7f},{west:.7f},{north:.7f},{east:.7f}"
    return f"[out:json][timeout:{QUERY_TIMEOUT_S}][maxsize:{most_bytes}][bbox:{area}];({parts});out meta;>;out meta qt;"


def complaint(tail: str) -> str:
    """Return the error remark at the end of a response, such as an exceeded time or memory limit, or ""."""
    remark = _REMARK.search(tail)
    return remark[1] if remark and "error" in remark[1].lower() else ""


def _is_finite_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


MAX_ELEMENT_CHARACTERS = 16 * 1024 * 1024
MAX_REMARK_CHARACTERS = 10_000
_CHUNK = 1024 * 1024
_MEMBER_TYPES = {"node": "n", "way": "w", "relation": "r"}
_SPACE = " \t\r\n"


def rewrite_as_pbf(source: Path, file_format: OsmFormat, target: Path) -> str | None:
    """Write the elements of an Overpass response to a PBF file and return the stated age of its data.

    Raises OsmFileError with the place of the first fault.
    """
    writer = osmium.SimpleWriter(osmium.io.File(str(target), "pbf"), overwrite=True)
    try:
        with open_unpacked(source, file_format) as file:
            scanner = _ElementScanner(io.TextIOWrapper(file, encoding="utf-8-sig"))
            timestamp = _timestamp(scanner.text_before_elements())
            for index, element in enumerate(scanner.elements()):
                _write(writer, element, f"elements[{index}]")
            if fault := complaint(scanner.text_after_elements()):
                raise OsmFileError(f"Overpass did not give all of it: {fault}. Take a smaller area.")
    except UnicodeDecodeError as error:
        raise OsmFileError("The JSON is not UTF-8.") from error
    finally:
        writer.close()
    return timestamp


@dataclass
class _ElementScanner:
    """A sliding window on the text, with one element at a time in memory."""

    file: TextIO
    window: str = field(default="", init=False)

    def text_before_elements(self) -> str:
        while '"elements"' not in self.window:
            if len(self.window) > MAX_ELEMENT_CHARACTERS or not self._read_on():
                raise OsmFileError('This JSON is no Overpass answer: it has no "elements".')
        before, self.window = self.window.split('"elements"', 1)
        return before

    def elements(self) -> Iterator[Any]:
        if self._next_character() != ":" or self._next_character() != "[":
            raise OsmFileError('The "elements" of this JSON are no list.')
        if self._peek() == "]":
            return
        index = 0
        while True:
            yield self._element(index)
            index += 1
            mark = self._next_character()
            if mark == "]":
                return
            if mark != ",":
                raise OsmFileError(f"The JSON breaks off or is damaged after elements[{index - 1}].")

    def text_after_elements(self) -> str:
        """Return the text after the list, up to the length of a remark."""
        while len(self.window) < MAX_REMARK_CHARACTERS and self._read_on():
            pass
        return self.window[:MAX_REMARK_CHARACTERS]

    def _read_on(self) -> bool:
        text = self.file.read(max(_CHUNK, len(self.window)))
        self.window += text
        return bool(text)

    def _peek(self) -> str:
        self.window = self.window.lstrip(_SPACE)
        while not self.window and self._read_on():
            self.window = self.window.lstrip(_SPACE)
        return self.window[:1]

    def _next_character(self) -> str:
        character = self._peek()
        self.window = self.window[1:]
        return character

    def _element(self, index: int) -> Any:
        if self._peek() != "{":
            raise OsmFileError(f"elements[{index}] is no object.")
        while True:
            try:
                element, end = STRICT_DECODER.raw_decode(self.window)
            except NotANumber as error:
                raise OsmFileError(f"elements[{index}] has {error}, which is no number.") from error
            except RecursionError as error:
                raise OsmFileError(f"elements[{index}] is nested too deeply.") from error
            except ValueError as error:
                if len(self.window) > MAX_ELEMENT_CHARACTERS:
                    raise OsmFileError(f"elements[{index}] is damaged or longer than {MAX_ELEMENT_CHARACTERS} characters.") from error
                if not self._read_on():
                    raise OsmFileError(f"elements[{index}] is damaged or cut off: {error}") from error
            else:
                self.window = self.window[end:]
                return element


def _timestamp(preamble: str) -> str | None:
    """Return osm3s.timestamp_osm_base from the preamble, which ends where the elements begin."""
    try:
        stated = STRICT_DECODER.decode(preamble.rstrip().rstrip(",") + "}")["osm3s"]["timestamp_osm_base"]
    except (ValueError, KeyError, TypeError, RecursionError, NotANumber):
        return None
    return stated if isinstance(stated, str) else None


def _write(writer: Any, element: dict[str, Any], place: str) -> None:
    try:
        kind = element.get("type")
        if kind not in _MEMBER_TYPES:
            return  # areas, counts and remarks have no infrastructure
        osm_id = _whole(element["id"])
        tags = {_text(key): _text(value) for key, value in element.get("tags", {}).items()}
        if kind == "node":
            writer.add_node(mutable.Node(id=osm_id, location=_location(element), tags=tags))
        elif kind == "way":
            refs = [_whole(ref) for ref in element.get("nodes", [])]
            for ref, point in zip(refs, element.get("geometry", []), strict=False):  # "out geom" puts node positions into the way
                if point is not None:
                    writer.add_node(mutable.Node(id=ref, location=_location(point)))
            writer.add_way(mutable.Way(id=osm_id, nodes=refs, tags=tags))
        else:
            members = [
                (_MEMBER_TYPES[member["type"]], _whole(member["ref"]), _text(member.get("role", "")))
                for member in element.get("members", [])
            ]
            writer.add_relation(mutable.Relation(id=osm_id, members=members, tags=tags))
    except (KeyError, TypeError, ValueError, AttributeError, RuntimeError) as error:
        raise OsmFileError(f"{place} is no OSM element: {error}") from error


def _text(value: Any) -> str:
    """Return a text without null characters: libosmium stores C strings."""
    return str(value).replace("\0", "")


def _whole(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or abs(value) >= 2**62:
        raise ValueError(f"{str(value)[:40]} is no id")
    return value


def _location(holder: dict[str, Any]) -> tuple[float, float]:
    lon, lat = holder["lon"], holder["lat"]
    for value, bound in ((lon, 180.0), (lat, 90.0)):
        if not isinstance(value, int | float) or isinstance(value, bool) or not isfinite(value) or abs(value) > bound:
            raise ValueError(f"position {str(lon)[:20]}, {str(lat)[:20]} is not on earth")
    return float(lon), float(lat)
