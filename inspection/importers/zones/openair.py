"""Zones from OpenAir, the text format of gliding: a record of lines for each airspace, each line with a two-letter command.

Defaults: distances are nautical miles, heights feet or flight levels, directions clockwise unless V D=- is set.
A record that only sets pen and brush for its class draws nothing; it is counted and not stored.
Source: OpenAir user airspace format, as XCSoar and SeeYou read it.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import acos, ceil, cos, isfinite, pi
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import MultiLineString, MultiPolygon, Polygon

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import (
    MAX_POLYGON_VERTICES,
    MAX_POLYGONS,
    GeometryFault,
    TooMuch,
    VertexBudget,
    checked_position,
    polygons_of_rings,
)
from inspection.geodesy.wgs84 import WGS84, FloatArray
from inspection.importers.rows import FaultList
from inspection.importers.zones.records import (
    FOOT_M,
    MAX_IDENTIFIER,
    MAX_LIMIT_M,
    MAX_NAME,
    HeightBand,
    UnreadRecord,
    ZoneRecord,
    checked_radius_m,
    checked_text,
)
from operation.reasons import Reason

NAUTICAL_MILE_M = 1_852.0
FLIGHT_LEVEL_M = 100 * FOOT_M
SIXTY = 60.0
_ANGLE = r"(\d{1,3}(?:\.\d+)?)(?::(\d{1,2}(?:\.\d+)?))?(?::(\d{1,2}(?:\.\d+)?))?"
_POSITION = re.compile(rf"{_ANGLE}\s*([NS])[\s,]*{_ANGLE}\s*([EW])", re.IGNORECASE)
_HEIGHT = re.compile(r"(-?\d{1,6}(?:\.\d+)?)\s*(FT|F|M)?\s*(AGL|ASFC|GND|SFC|AGND|AMSL|MSL|ASL|ALT|STD)?", re.IGNORECASE)
_FLIGHT_LEVEL = re.compile(r"FL\s*(\d{1,3})", re.IGNORECASE)
_GROUND = {"GND", "SFC", "GROUND", "SURFACE"}
_NO_CEILING = {"UNL", "UNLIM", "UNLIMITED", "UNLTD"}
_ABOVE_GROUND = {"AGL", "ASFC", "GND", "SFC", "AGND"}
_LENGTH = re.compile(r"(\d{1,5}(?:\.\d+)?)\s*(NM|KM|M)?", re.IGNORECASE)
_LENGTH_M = {"": NAUTICAL_MILE_M, "NM": NAUTICAL_MILE_M, "KM": 1_000.0, "M": 1.0}


def position_of(text: str, place: str) -> LonLat:
    """Return a position such as 48:47:27 N 016:53:33 E; minutes and seconds may be missing or have decimals. See `has_sixty`."""
    match = _POSITION.fullmatch(text.strip())
    if match is None:
        raise GeometryFault(place, f"{text.strip()[:60]!r} is no position such as 48:47:27 N 016:53:33 E")
    lat = _degrees(match[1], match[2], match[3], place) * (1 if match[4].upper() == "N" else -1)
    lon = _degrees(match[5], match[6], match[7], place) * (1 if match[8].upper() == "E" else -1)
    return checked_position([lon, lat], place)


def has_sixty(text: str) -> bool:
    """Whether minutes or seconds of a position are 60, as rounding writes them: they are the next degree or minute."""
    match = _POSITION.fullmatch(text.strip())
    return match is not None and any(part is not None and float(part) == SIXTY for part in (match[2], match[3], match[6], match[7]))


def height_of(text: str, place: str) -> tuple[float | None, str]:
    """Return metres and their reference; (None, "") for an unstated or unlimited height. The default is feet above sea level."""
    words = text.strip().upper()
    if not words or words in _NO_CEILING:
        return None, ""
    if words in _GROUND:
        return 0.0, "AGL"
    if match := _FLIGHT_LEVEL.fullmatch(words):
        return int(match[1]) * FLIGHT_LEVEL_M, "STD"
    match = _HEIGHT.fullmatch(words)
    if match is None:
        raise GeometryFault(place, f"{text.strip()[:40]!r} is no height such as 2500 MSL, 1000 AGL, FL 95, GND or UNL")
    value_m = float(match[1]) * (1.0 if match[2] == "M" else FOOT_M)
    if not abs(value_m) <= MAX_LIMIT_M:
        raise GeometryFault(place, f"the height {text.strip()[:40]!r} is beyond all flying")
    reference = match[3] or "AMSL"
    return value_m, "AGL" if reference in _ABOVE_GROUND else "STD" if reference == "STD" else "AMSL"


def length_m_of(text: str, place: str) -> float:
    """Return a radius in metres; the default unit is nautical miles."""
    match = _LENGTH.fullmatch(text.strip())
    if match is None:
        raise GeometryFault(place, f"{text.strip()[:40]!r} is no radius in nautical miles")
    return checked_radius_m(float(match[1]) * _LENGTH_M[(match[2] or "").upper()], place)


def number_of(text: str, place: str) -> float:
    try:
        number = float(text)
    except ValueError as error:
        raise GeometryFault(place, f"{text.strip()[:40]!r} is no number") from error
    if not isfinite(number) or abs(number) > 1_000:
        raise GeometryFault(place, f"{text.strip()[:40]!r} is no direction in degrees")
    return number


def _degrees(degrees: str, minutes: str | None, seconds: str | None, place: str) -> float:
    if float(minutes or 0) > SIXTY or float(seconds or 0) > SIXTY:
        raise GeometryFault(place, "minutes and seconds are at most 60")
    return float(degrees) + float(minutes or 0) / 60 + float(seconds or 0) / 3600


MAX_CROSSINGS = 8
_CHUNK = 256
MAX_DISTANCE_M = 0.5  # of a side from the curve; in aeronautical files radii themselves are rounded to 19 m and more
MAX_DIFFERENT_RADII = 0.2  # of the two ends of an arc; more means a wrong centre
_MIN_SIDES = 8
CLASSES = {
    "R": "Restricted", "Q": "Danger", "P": "Prohibited", "A": "Class A", "B": "Class B", "C": "Class C", "D": "Class D", "E": "Class E",
    "F": "Class F", "G": "Class G", "CTR": "Control zone", "GP": "Gliders prohibited", "GS": "Glider sector", "W": "Wave window",
    "RMZ": "Radio mandatory zone", "TMZ": "Transponder mandatory zone", "UNC": "Unclassified", "UNCLASSIFIED": "Unclassified",
}  # fmt: skip
MAX_LINE_CHARACTERS = 2_000
MAX_LISTED = 20  # in a note
HALF_ROUND_DEG = 180.0
_LOOKS = re.compile(rb"^\s*AC\s+\S", re.MULTILINE)
_COMMENT = re.compile(r"(^|\s)\*.*$")
_PEN = {"SP", "SB", "AT", "TO", "TC", "CO"}
_FACTS = {"AY": "type", "AF": "frequency", "AG": "station", "AX": "transponder", "AA": "activation", "AI": "identifier"}


def area_of_all_loops(ring: FloatArray) -> list[Polygon] | None:
    """Return the polygons that any loop of the closed ring of shape (n, 2) encloses; None if it crosses itself too often."""
    segments = shapely.get_parts(MultiLineString(list(np.stack([ring[:-1], ring[1:]], axis=1))))
    if _crossings(segments) > MAX_CROSSINGS:
        return None
    faces = shapely.get_parts(shapely.polygonize([shapely.unary_union(segments)]))
    if not len(faces):
        return None
    area = shapely.unary_union([Polygon(face.exterior) for face in faces])  # a hole inside of a loop is enclosed too
    parts = list(area.geoms) if isinstance(area, MultiPolygon) else [area]
    return [part for part in parts if isinstance(part, Polygon) and part.is_valid and part.area > 0.0] or None


def _crossings(segments: NDArray[np.object_]) -> int:
    """Return the number of intersecting sides that are not neighbours; counting stops above MAX_CROSSINGS."""
    tree = shapely.STRtree(segments)
    count, last = 0, len(segments) - 1
    for first in range(0, len(segments), _CHUNK):
        one, other = tree.query(segments[first : first + _CHUNK], predicate="intersects")
        gap = other - (one + first)
        count += int(((gap > 1) & (gap < last)).sum())
        if count > MAX_CROSSINGS:
            break
    return count


def arc(centre: LonLat, radius_m: float, start_deg: float, end_deg: float, is_clockwise: bool, place: str) -> FloatArray:
    """Return the arc from one direction to another (degrees from north), ends included; shape (n, 2), lon lat."""
    return _path(centre, radius_m, radius_m, start_deg, _turn(start_deg, end_deg, is_clockwise), place)


def arc_between(centre: LonLat, start: LonLat, end: LonLat, is_clockwise: bool, place: str) -> FloatArray:
    """Return the arc between two positions; where their distances from the centre differ, the radius changes gradually."""
    start_deg, _, start_m = WGS84.inv(centre.lon, centre.lat, start.lon, start.lat)
    end_deg, _, end_m = WGS84.inv(centre.lon, centre.lat, end.lon, end.lat)
    if min(start_m, end_m) < MAX_DISTANCE_M:
        raise GeometryFault(place, "an end of the arc lies in its centre", start)
    if abs(start_m - end_m) > MAX_DIFFERENT_RADII * max(start_m, end_m):
        raise GeometryFault(
            place, f"the ends of the arc are {start_m:.0f} m and {end_m:.0f} m from its centre: another centre is meant", start
        )
    path = _path(centre, start_m, end_m, start_deg, _turn(start_deg, end_deg, is_clockwise), place)
    path[0], path[-1] = start, end
    return path


def circle_ring(centre: LonLat, radius_m: float, place: str) -> FloatArray:
    """Return a closed ring that contains the whole circle, and is nowhere farther than MAX_DISTANCE_M outside."""
    sides = _sides(radius_m, 2 * pi)
    _check_not_at_a_pole(centre, radius_m, place)
    bearings = np.arange(sides, dtype=np.float64) * (360.0 / sides)
    points = _at(centre, np.full(sides, radius_m / cos(pi / sides)), bearings)
    return np.vstack([points, points[:1]])


def _turn(start_deg: float, end_deg: float, is_clockwise: bool) -> float:
    """Return the angle to turn through in degrees, positive clockwise; a whole turn for equal directions."""
    turn = (end_deg - start_deg) % 360.0
    if turn < 1e-9:
        turn = 360.0
    return turn if is_clockwise else turn - 360.0 if turn < 360.0 else -360.0


def _path(centre: LonLat, start_m: float, end_m: float, start_deg: float, turn_deg: float, place: str) -> FloatArray:
    _check_not_at_a_pole(centre, max(start_m, end_m), place)
    shares: FloatArray = np.linspace(0.0, 1.0, _sides(max(start_m, end_m), abs(turn_deg) * pi / 180.0) + 1, dtype=np.float64)
    return _at(centre, start_m + shares * (end_m - start_m), start_deg + shares * turn_deg)


def _sides(radius_m: float, angle_rad: float) -> int:
    """Return the number of sides that stay within MAX_DISTANCE_M of the curve."""
    step = 2.0 * acos(max(1.0 - MAX_DISTANCE_M / radius_m, 0.0))
    return max(ceil(angle_rad / step), ceil(_MIN_SIDES * angle_rad / (2 * pi)), 1)


def _at(centre: LonLat, distances_m: FloatArray, bearings_deg: FloatArray) -> FloatArray:
    lon, lat, _ = WGS84.fwd(np.full(len(bearings_deg), centre.lon), np.full(len(bearings_deg), centre.lat), bearings_deg, distances_m)
    return np.column_stack([np.asarray(lon), np.asarray(lat)])


def _check_not_at_a_pole(centre: LonLat, radius_m: float, place: str) -> None:
    pole_m = min(WGS84.inv(centre.lon, centre.lat, centre.lon, latitude)[2] for latitude in (90.0, -90.0))
    if pole_m <= radius_m * 1.2:
        raise GeometryFault(place, "the arc comes too near to a pole", centre)


def looks_like_openair(data: bytes) -> bool:
    return _LOOKS.search(data[:1_000_000]) is not None


@dataclass
class _Record:
    """One airspace during reading."""

    line: int
    airspace_class: str
    name: str = ""
    lower: str = ""
    upper: str = ""
    facts: dict[str, Any] = field(default_factory=dict)
    points: list[tuple[float, float]] = field(default_factory=list)
    circle: dict[str, Any] | None = None
    ring: FloatArray | None = None
    centre: LonLat | None = None
    is_clockwise: bool = True
    has_only_a_pen: bool = True


def zones_of_openair(text: str, faults: FaultList, unread: list[UnreadRecord]) -> tuple[list[ZoneRecord], list[str | Reason]]:
    """Return the zones, and notes for users on how the file was read; records with a fault are appended to unread."""
    reader = _OpenAirReader(faults)
    for number, line in enumerate(text.splitlines(), start=1):
        with faults.gathering():
            reader.take(number, line)
    with faults.gathering():
        reader.finish()
    notes: list[str | Reason] = [f"{reader.pens} records only set pen and brush; they draw nothing."] if reader.pens else []
    if names := reader.crossing_names:
        notes.append(f"The border crosses itself, so all that any of its loops encloses counts: {', '.join(names[:MAX_LISTED])}.")
    if carried := reader.carried_over:
        more = f" and {len(carried) - MAX_LISTED} more" if len(carried) > MAX_LISTED else ""
        notes.append(Reason("minutes_of_60", {"places": f"{', '.join(carried[:MAX_LISTED])}{more}"}))
    unread += reader.unread
    return reader.zones, notes


class _OpenAirReader:
    def __init__(self, faults: FaultList) -> None:
        self.faults = faults
        self.zones: list[ZoneRecord] = []
        self.pens = 0
        self.crossing_names: list[str] = []
        self.record: _Record | None = None
        self.carried_over: list[str] = []
        self.unread: list[UnreadRecord] = []
        self.fault: GeometryFault | None = None  # of the record: consequential faults are not reported
        self.budget = VertexBudget()
        self.commands: dict[str, Callable[[_Record, str, str], None]] = {
            "AN": self._name, "AL": self._lower, "AH": self._upper, "V": self._variable, "DP": self._point, "DA": self._arc,
            "DB": self._arc_between, "DC": self._circle,
        }  # fmt: skip

    def take(self, number: int, line: str) -> None:
        if len(line) > MAX_LINE_CHARACTERS:
            raise TooMuch(f"line {number}", f"the line has {len(line)} characters; at most {MAX_LINE_CHARACTERS} are read")
        words = _COMMENT.sub("", line).strip()
        if not words:
            return
        command, _, rest = words.partition(" ")
        command, rest = command.upper(), rest.strip()
        place = f"line {number}"
        if command == "AC":
            with self.faults.gathering():
                self.finish()
            if len(self.zones) + self.pens >= MAX_POLYGONS:
                raise TooMuch(place, f"there are more than {MAX_POLYGONS} records")
            self.record = _Record(number, checked_text(rest, place, 40).upper())
            self.fault = None
            return
        if self.record is None:
            raise GeometryFault(place, f"{command[:10]!r} stands before the first AC, the start of a record")
        try:
            self._do(self.record, command, rest, place)
        except GeometryFault as fault:
            if self.fault is None:
                self.fault = fault
                raise

    def _do(self, record: _Record, command: str, rest: str, place: str) -> None:
        if command in _PEN:
            return
        record.has_only_a_pen = False
        if command in _FACTS:
            record.facts[_FACTS[command]] = checked_text(rest, place, 255)
        elif command in self.commands:
            self.commands[command](record, rest, place)
        else:
            raise GeometryFault(place, f"the command {command[:10]!r} is not known")
        if len(record.points) > MAX_POLYGON_VERTICES:
            record.points.clear()  # nothing more of it is stored
            raise TooMuch(place, f"the airspace has more than {MAX_POLYGON_VERTICES} vertices")

    def finish(self) -> None:
        """End the record."""
        record, self.record = self.record, None
        if record is None:
            return
        if self.fault is not None:
            self.unread.append(_unread(record, self.fault))
        elif record.has_only_a_pen:
            self.pens += 1
        else:
            try:
                self.zones.append(self._zone(record))
            except GeometryFault as fault:
                self.unread.append(_unread(record, fault))
                raise

    def _zone(self, record: _Record) -> ZoneRecord:
        place = f"line {record.line}"
        name = record.name or f"{record.airspace_class} without a name"
        lower, upper = height_of(record.lower, place), height_of(record.upper, place)
        if lower[0] is not None and upper[0] is not None and lower[1] == upper[1] and upper[0] < lower[0]:
            raise GeometryFault(place, f"the upper limit {record.upper} of {name!r} lies below the lower limit {record.lower}")
        stated = {"lower": record.lower, "upper": record.upper}
        return ZoneRecord(
            identifier=str(record.facts.get("identifier") or name)[:MAX_IDENTIFIER], layer=0, name=name, geometry=self._area(record, place),
            band=HeightBand(lower[0], lower[1], upper[0], upper[1], {key: text for key, text in stated.items() if text}),
            restriction=CLASSES.get(record.airspace_class, record.airspace_class), reason=str(record.facts.get("type", "")),
            circle=record.circle, properties={"class": record.airspace_class, **record.facts},
        )  # fmt: skip

    def _area(self, record: _Record, place: str) -> MultiPolygon:
        if record.ring is not None:
            ring = record.ring
        elif len(record.points) >= 3:
            points = record.points if record.points[0] == record.points[-1] else [*record.points, record.points[0]]
            ring = np.array([point for index, point in enumerate(points) if index == 0 or point != points[index - 1]])
        else:
            raise GeometryFault(place, f"the airspace {record.name!r} has no area: neither a circle nor three points")
        if len(ring) < 4:
            raise GeometryFault(place, f"the airspace {record.name!r} has no area: its points are the same")
        self.budget.take(len(ring), place)
        try:
            return MultiPolygon(polygons_of_rings([ring], f"{place}, {record.name!r}"))
        except GeometryFault:
            repaired = area_of_all_loops(ring) if np.abs(np.diff(ring[:, 0])).max() < 180.0 else None
            if repaired is None:
                raise
        self.crossing_names.append(record.name)
        return MultiPolygon(repaired)

    def _name(self, record: _Record, rest: str, place: str) -> None:
        record.name = checked_text(rest, place, MAX_NAME)

    def _lower(self, record: _Record, rest: str, place: str) -> None:
        height_of(rest, place)
        record.lower = rest

    def _upper(self, record: _Record, rest: str, place: str) -> None:
        height_of(rest, place)
        record.upper = rest

    def _variable(self, record: _Record, rest: str, place: str) -> None:
        variable, _, value = (part.strip() for part in rest.partition("="))
        if variable.upper() == "X":
            record.centre = self._position(value, place)
        elif variable.upper() == "D" and value in {"+", "-"}:
            record.is_clockwise = value == "+"
        elif variable.upper() not in {"Z", "W", "T"}:  # zoom, width and label only affect drawing
            raise GeometryFault(place, f"the variable {rest[:20]!r} is not known")

    def _position(self, text: str, place: str) -> LonLat:
        position = position_of(text, place)
        if self.fault is None and has_sixty(text) and place not in self.carried_over[-1:]:
            self.carried_over.append(place)
        return position

    def _point(self, record: _Record, rest: str, place: str) -> None:
        position = self._position(rest, place)
        record.points.append((position.lon, position.lat))

    def _circle(self, record: _Record, rest: str, place: str) -> None:
        if record.points or record.ring is not None:
            raise GeometryFault(place, "a circle cannot be joined with points or another circle")
        radius_m = length_m_of(rest, place)
        centre = self._centre(record, place)
        record.ring = circle_ring(centre, radius_m, place)
        record.circle = {"centre": list(centre), "radius_m": radius_m}

    def _arc(self, record: _Record, rest: str, place: str) -> None:
        parts = rest.split(",")
        if len(parts) != 3:
            raise GeometryFault(place, "DA has a radius and two directions")
        radius_m = length_m_of(parts[0], place)
        start_deg, end_deg = number_of(parts[1], place), number_of(parts[2], place)
        self._add(record, arc(self._centre(record, place), radius_m, start_deg, end_deg, record.is_clockwise, place))

    def _arc_between(self, record: _Record, rest: str, place: str) -> None:
        parts = rest.split(",")
        if len(parts) != 2:
            raise GeometryFault(place, "DB has two positions with a comma between")
        start, end = self._position(parts[0], place), self._position(parts[1], place)
        self._add(record, arc_between(self._centre(record, place), start, end, record.is_clockwise, place))

    def _add(self, record: _Record, path: FloatArray) -> None:
        record.points += [(lon, lat) for lon, lat in path.tolist()]

    def _centre(self, record: _Record, place: str) -> LonLat:
        if record.centre is None:
            raise GeometryFault(place, "there is no centre: V X= is missing before this")
        return record.centre


def _unread(record: _Record, fault: GeometryFault) -> UnreadRecord:
    points = np.array(record.points, dtype=np.float64) if record.ring is None else record.ring
    bbox = None
    if len(points) and np.ptp(points[:, 0]) <= HALF_ROUND_DEG:  # not over the antimeridian
        (west, south), (east, north) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        bbox = (west, south, east, north)
    name = record.name or f"{record.airspace_class} without a name"
    return UnreadRecord(fault, name, str(record.facts.get("identifier") or record.name)[:MAX_IDENTIFIER], bbox)
