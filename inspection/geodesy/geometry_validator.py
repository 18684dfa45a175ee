"""The one gate for geometry from any door: finite, on earth, closed, valid and of bounded size, or refused with the place of the fault.

Nothing is repaired: what a user drew is either what is stored or is sent back. (make_valid and buffer(0) on a hostile ring run for
minutes, and in PostGIS end the server.) The one change made is a cut: an area across the antimeridian is stored as two, either side of it.
Points repeated one after the other are allowed, as the standard allows them.
"""

import re
from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any

import numpy as np
import shapely
from shapely import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry

from inspection.geodesy import LonLat
from inspection.geodesy.wgs84 import FloatArray
from operation.reasons import Reason

MAX_POLYGON_VERTICES = 10_000
MAX_TOTAL_VERTICES = 500_000
MAX_POLYGONS = 20_000
MAX_LINE_VERTICES = 10_000


class GeometryFault(ValueError):
    """What is wrong, where in the document (such as features[3].geometry.coordinates[0][12]) and, if known, at which position."""

    def __init__(self, place: str, message: Reason | str, position: LonLat | None = None) -> None:
        super().__init__(place, message, position)
        self.place = place
        self.why = message
        self.message = str(message)
        self.position = position

    def __str__(self) -> str:
        where = f" at {self.position.lon:.7g}, {self.position.lat:.7g}" if self.position else ""
        return f"{self.place}: {self.message}{where}" if self.place else f"{self.message}{where}"


class TooMuch(GeometryFault):
    """More than is taken of one document: it is refused as a whole, whatever is wrong with single records."""


class VertexBudget:
    """How many vertices and polygons one document may have in all."""

    def __init__(self, vertices: int = MAX_TOTAL_VERTICES, polygons: int = MAX_POLYGONS) -> None:
        self.max_vertices, self.max_polygons = vertices, polygons
        self.vertices = self.polygons = 0

    def take(self, vertices: int, place: str) -> None:
        self.vertices += vertices
        self.polygons += 1
        if self.vertices > self.max_vertices:
            raise TooMuch(place, f"the document has more than {self.max_vertices} vertices")
        if self.polygons > self.max_polygons:
            raise TooMuch(place, f"the document has more than {self.max_polygons} polygons")


def checked_position(value: Any, place: str = "position") -> LonLat:
    """A [longitude, latitude] pair in degrees; a third number (a height) is allowed and left out."""
    if not isinstance(value, list | tuple):
        raise GeometryFault(place, "a position is a list of longitude and latitude")
    if not 2 <= len(value) <= 4:
        raise GeometryFault(place, f"a position has longitude and latitude, not {len(value)} numbers")
    for number in value:
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise GeometryFault(place, f"{_shown(number)} is no number")
        if isinstance(number, float) and not isfinite(number):
            raise GeometryFault(place, f"{number} is not finite")
    lon, lat = value[0], value[1]
    if -180 <= lon <= 180 and -90 <= lat <= 90:
        return LonLat(float(lon), float(lat))
    hint = "; longitude comes first: are the two swapped?" if -180 <= lat <= 180 and -90 <= lon <= 90 else ""
    if not -90 <= lat <= 90:
        raise GeometryFault(place, f"latitude {_shown(lat)} is beyond ±90{hint}")
    raise GeometryFault(place, f"longitude {_shown(lon)} is beyond ±180{hint}")


def checked_geometry(value: Any, place: str = "geometry") -> Point | LineString | MultiPolygon:
    """A GeoJSON Point, LineString, Polygon or MultiPolygon as a shapely geometry; areas always as MultiPolygon."""
    kind = _kind_of(value, place)
    if kind == "Point":
        return Point(checked_position(value.get("coordinates"), f"{place}.coordinates"))
    if kind == "LineString":
        return checked_line(value.get("coordinates"), f"{place}.coordinates")
    if kind in {"Polygon", "MultiPolygon"}:
        return checked_area(value, place)
    raise GeometryFault(place, f"{_shown(kind)} is not one of Point, LineString, Polygon, MultiPolygon")


def checked_line(coordinates: Any, place: str) -> LineString:
    points = _checked_path(coordinates, place, minimum=2, maximum=MAX_LINE_VERTICES)
    if (points == points[0]).all():
        raise GeometryFault(place, "the line has no length", LonLat(*points[0].tolist()))
    if np.abs(np.diff(points[:, 0])).max() > 180.0:
        raise GeometryFault(place, "the line crosses the antimeridian; draw it as two")
    return LineString(points)


def checked_area(value: Any, place: str = "geometry", budget: VertexBudget | None = None) -> MultiPolygon:
    """A GeoJSON Polygon or MultiPolygon as a valid MultiPolygon, cut at the antimeridian where it crosses that."""
    kind = _kind_of(value, place)
    coordinates = value.get("coordinates")
    if kind not in {"Polygon", "MultiPolygon"}:
        raise GeometryFault(place, f"a {_shown(kind)} is no area; Polygon or MultiPolygon is expected")
    if not isinstance(coordinates, list) or not coordinates:
        raise GeometryFault(f"{place}.coordinates", "the geometry is empty")
    budget = budget or VertexBudget()
    if kind == "Polygon":
        polygons = checked_polygon(coordinates, f"{place}.coordinates", budget)
    else:
        polygons = [
            polygon for index, part in enumerate(coordinates) for polygon in checked_polygon(part, f"{place}.coordinates[{index}]", budget)
        ]
    area = MultiPolygon(polygons)
    if len(polygons) > 1:
        _check_valid(area, f"{place}.coordinates")
    return area


def checked_polygon(rings: Any, place: str, budget: VertexBudget) -> list[Polygon]:
    """The polygon of these rings, or its parts either side of the antimeridian."""
    if not isinstance(rings, list) or not rings:
        raise GeometryFault(place, "the polygon is empty")
    number = sum(len(ring) for ring in rings if isinstance(ring, list))
    if number > MAX_POLYGON_VERTICES:
        raise TooMuch(place, f"the polygon has {number} vertices; at most {MAX_POLYGON_VERTICES} are taken")
    budget.take(number, place)
    paths = [_checked_ring(ring, f"{place}[{index}]") for index, ring in enumerate(rings)]
    return polygons_of_rings(paths, place)


def polygons_of_rings(paths: Sequence[FloatArray], place: str) -> list[Polygon]:
    """From closed rings, shell first, whose steps of more than 180° mean the short way round, over the antimeridian."""
    unrolled = [_unrolled(path, place if len(paths) == 1 else f"{place}[{index}]") for index, path in enumerate(paths)]
    shell = unrolled[0]
    west, east = shell[:, 0].min(), shell[:, 0].max()
    if east - west > 360.0:
        raise GeometryFault(place, "the polygon goes more than once round the earth")
    polygon = Polygon(shell, [_shifted_between(hole, west, east) for hole in unrolled[1:]])
    _check_valid(polygon, place)
    if polygon.area <= 0.0:
        raise GeometryFault(place, "the polygon has no area", LonLat(*paths[0][0].tolist()))
    if west >= -180.0 and east <= 180.0:
        return [polygon]
    return list(_cut(polygon, place))


def _kind_of(value: Any, place: str) -> str:
    if not isinstance(value, dict):
        raise GeometryFault(place, "a geometry is an object with type and coordinates" if value is not None else "there is no geometry")
    kind = value.get("type")
    return kind if isinstance(kind, str) else _shown(kind)


def _checked_path(coordinates: Any, place: str, *, minimum: int, maximum: int) -> FloatArray:
    if not isinstance(coordinates, list) or not coordinates:
        raise GeometryFault(place, "the geometry is empty")
    if len(coordinates) > maximum:
        raise TooMuch(place, f"there are {len(coordinates)} vertices; at most {maximum} are taken")
    points = _all_at_once(coordinates)
    if points is None:
        points = np.array([checked_position(position, f"{place}[{index}]") for index, position in enumerate(coordinates)], dtype=np.float64)
    if len(points) < minimum:
        raise GeometryFault(place, f"there are {len(points)} positions; at least {minimum} are needed")
    return points


def _all_at_once(coordinates: list[Any]) -> FloatArray | None:
    """The positions of a path without a fault; None if any is not what checked_position takes, which then tells where and why."""
    if not all(type(position) is list and 2 <= len(position) <= 4 for position in coordinates):
        return None
    if not {type(number) for position in coordinates for number in position} <= {int, float}:
        return None
    if not all(-180 <= position[0] <= 180 and -90 <= position[1] <= 90 for position in coordinates):
        return None
    if not all(abs(number) < 1e9 for position in coordinates for number in position[2:]):
        return None
    return np.array([position[:2] for position in coordinates], dtype=np.float64)


def _checked_ring(coordinates: Any, place: str) -> FloatArray:
    points = _checked_path(coordinates, place, minimum=4, maximum=MAX_POLYGON_VERTICES)
    if (points[0] != points[-1]).any():
        last = LonLat(*points[-1].tolist())
        raise GeometryFault(f"{place}[{len(points) - 1}]", "the ring is not closed: its last position is not its first", last)
    if len(set(map(tuple, points.tolist()))) < 3:
        raise GeometryFault(place, "the ring has fewer than three different positions", LonLat(*points[0].tolist()))
    return points


def _unrolled(points: FloatArray, place: str) -> FloatArray:
    """The ring with longitudes that run on past ±180 instead of jumping; refused if it then does not close."""
    steps = np.diff(points[:, 0])
    if np.abs(steps).max() <= 180.0:
        return points
    if (np.abs(steps) == 360.0).any():
        raise GeometryFault(place, "a step from longitude -180 to 180 can mean no step or the whole way round; put a vertex between")
    turns = np.concatenate([[0.0], np.cumsum(-360.0 * np.round(steps / 360.0))])
    if turns[-1] != 0.0:
        raise GeometryFault(place, "the ring goes round the earth: an area with a pole inside cannot be taken")
    return np.column_stack([points[:, 0] + turns, points[:, 1]])


def _shifted_between(hole: FloatArray, west: float, east: float) -> FloatArray:
    """The hole moved by whole turns to where the shell is."""
    for turn in (0.0, 360.0, -360.0):
        if west <= hole[:, 0].min() + turn and hole[:, 0].max() + turn <= east:
            return np.column_stack([hole[:, 0] + turn, hole[:, 1]])
    return hole


def _check_valid(area: BaseGeometry, place: str) -> None:
    if area.is_valid:
        return
    reason = shapely.is_valid_reason(area)
    match = re.fullmatch(r"(.*?)\s*\[(\S+) (\S+)\]", reason)
    if match is None:
        raise GeometryFault(place, reason.lower())
    lon, lat = float(match[2]), float(match[3])
    raise GeometryFault(place, match[1].lower(), LonLat((lon + 180.0) % 360.0 - 180.0 if abs(lon) > 180.0 else lon, lat))


def _cut(polygon: Polygon, place: str) -> Iterable[Polygon]:
    """The parts in each turn of longitude, moved back to ±180."""
    found = False
    for turn in (-360.0, 0.0, 360.0):
        strip = polygon.intersection(shapely.box(-180.0 + turn, -90.0, 180.0 + turn, 90.0))
        for part in shapely.get_parts(strip):
            if isinstance(part, Polygon) and part.area > 0.0:
                moved = _turned_back(part, turn)
                _check_valid(moved, place)
                found = True
                yield moved
    if not found:
        raise GeometryFault(place, "the polygon has no area")


def _turned_back(part: Polygon, turn: float) -> Polygon:
    def turned(points: FloatArray) -> FloatArray:
        return np.column_stack([np.clip(points[:, 0] - turn, -180.0, 180.0), points[:, 1]])

    return shapely.transform(part, turned)


def _shown(value: Any) -> str:
    text = str(value) if not isinstance(value, int) or abs(value) < 10**40 else "a number of more than 40 digits"
    return text if len(text) <= 40 else f"{text[:40]}…"
