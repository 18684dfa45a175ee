"""Well-known binary: points, lines and areas, read without recursion by the data and without memory for counts that are not there."""

import struct
from typing import Any

from inspection.geodesy.geometry_validator import GeometryFault

_TYPES = {1: "Point", 2: "LineString", 3: "Polygon", 4: "MultiPoint", 5: "MultiLineString", 6: "MultiPolygon"}
_MEMBERS = {"MultiPoint": "Point", "MultiLineString": "LineString", "MultiPolygon": "Polygon"}
_EWKB_Z, _EWKB_M, _EWKB_SRID = 0x80000000, 0x40000000, 0x20000000


def geometry_of_wkb(data: bytes, place: str) -> dict[str, Any]:
    """Return a point, line or area, or several of one kind, without heights and measures. Raises GeometryFault."""
    try:
        geometry, end = _read_geometry(memoryview(data), 0, place)
    except struct.error as error:
        raise GeometryFault(place, "the geometry (WKB) is damaged or cut off") from error
    if end != len(data):
        raise GeometryFault(place, "the geometry (WKB) goes on after its end")
    return geometry


def _read_geometry(data: memoryview, at: int, place: str, member_of: str = "") -> tuple[dict[str, Any], int]:
    order = {0: ">", 1: "<"}.get(struct.unpack_from("B", data, at)[0])
    if order is None:
        raise GeometryFault(place, "the geometry is no WKB")
    (code,) = struct.unpack_from(f"{order}I", data, at + 1)
    at += 5
    if code & _EWKB_SRID:
        at += 4
    base = code & 0x0FFFFFFF
    has_z = bool(code & _EWKB_Z) or base // 1000 in {1, 3}
    has_m = bool(code & _EWKB_M) or base // 1000 in {2, 3}
    kind = _TYPES.get(base % 1000 if base < 4000 else 0)
    if kind is None or (member_of and kind != _MEMBERS[member_of]):
        raise GeometryFault(place, "the geometry is neither points, lines nor polygons (curves and collections are not read)")
    dimensions = 2 + has_z + has_m
    if kind == "Point":
        positions, at = _positions(data, at, 1, order, dimensions)
        return {"type": kind, "coordinates": positions[0]}, at
    (count,) = struct.unpack_from(f"{order}I", data, at)
    at += 4
    if kind == "LineString":
        coordinates, at = _positions(data, at, count, order, dimensions)
    elif kind == "Polygon":
        coordinates, at = _rings(data, at, count, order, dimensions)
    else:
        coordinates = []
        _check_room(data, at, count, 9)
        for _ in range(count):
            part, at = _read_geometry(data, at, place, member_of=kind)
            coordinates.append(part["coordinates"])
    return {"type": kind, "coordinates": coordinates}, at


def _rings(data: memoryview, at: int, count: int, order: str, dimensions: int) -> tuple[list[Any], int]:
    _check_room(data, at, count, 4)
    rings = []
    for _ in range(count):
        (number,) = struct.unpack_from(f"{order}I", data, at)
        ring, at = _positions(data, at + 4, number, order, dimensions)
        rings.append(ring)
    return rings, at


def _positions(data: memoryview, at: int, count: int, order: str, dimensions: int) -> tuple[list[list[float]], int]:
    _check_room(data, at, count, 8 * dimensions)
    numbers = struct.unpack_from(f"{order}{count * dimensions}d", data, at)
    positions = [[numbers[start], numbers[start + 1]] for start in range(0, len(numbers), dimensions)]
    return positions, at + 8 * dimensions * count


def _check_room(data: memoryview, at: int, count: int, least_bytes: int) -> None:
    """Raise struct.error for a count that exceeds the rest of the data, before any memory is allocated for it."""
    if count * least_bytes > len(data) - at:
        raise struct.error
