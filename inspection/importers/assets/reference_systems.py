"""Coordinate reference systems by name, and their transformation to longitude and latitude in WGS84, without network access."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from pyproj import CRS, Transformer, network
from pyproj.exceptions import CRSError, ProjError
from pyproj.transformer import TransformerGroup

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.rows import refused

MAX_WKT_CHARACTERS = 16 * 1024
ROUGH_M = 2.0  # a worse accuracy is reported
FAR_OUTSIDE_DEG = 10.0  # positions this far outside a system's area belong to another system
_CODE = re.compile(r"(?:urn:ogc:def:crs:)?(EPSG|ESRI|OGC)::?(?:[\d.]*:)?([0-9A-Za-z]{2,8})", re.IGNORECASE)
_WGS84 = CRS.from_user_input("OGC:CRS84")

network.set_network_enabled(False)


def system_of_code(text: Any, place: str) -> CRS | None:
    """Return the system of a code such as EPSG:2056; None for WGS84 itself. Raises AssetFileError."""
    match = _CODE.fullmatch(text.strip()) if isinstance(text, str) else None
    if match is None:
        raise refused(place, f"{str(text)[:60]!r} names no reference system; write a code such as EPSG:2056")
    return _checked(lambda: CRS.from_authority(match[1].upper(), match[2].upper()), place, text)


def system_of_wkt(text: str, place: str) -> CRS | None:
    if len(text) > MAX_WKT_CHARACTERS:
        raise refused(place, f"the description of the reference system has more than {MAX_WKT_CHARACTERS} characters")
    return _checked(lambda: CRS.from_wkt(text.strip()), place, text)


def name_of_system(system: CRS | None) -> str:
    if system is None:
        return "WGS 84"
    authority = system.to_authority(min_confidence=70)
    return f"{system.name} ({':'.join(authority)})" if authority else str(system.name)


class ToWgs84:
    """Transforms coordinates of a system to lon, lat [deg]; accuracy_m is the transformation's own, if it states one."""

    def __init__(self, system: CRS) -> None:
        group = TransformerGroup(system, _WGS84, always_xy=True, allow_ballpark=True)
        if not group.transformers:
            raise refused("reference system", f"nothing is known that leads from {system.name} to WGS 84")
        self._transformer: Transformer = group.transformers[0]
        self._system = system
        self._area = system.area_of_use
        accuracy_m = self._transformer.accuracy
        self.accuracy_m: float | None = accuracy_m if accuracy_m is not None and accuracy_m >= 0 else None

    def geometry(self, value: dict[str, Any], place: str) -> dict[str, Any]:
        """Return a GeoJSON geometry with transformed positions. Raises GeometryFault."""
        try:
            if "geometries" in value:
                members = [self.geometry(member, place) for member in value["geometries"]]
                return {"type": value.get("type"), "geometries": members}
            return {"type": value.get("type"), "coordinates": self._moved(value["coordinates"], place)}
        except (TypeError, KeyError, ValueError, IndexError, OverflowError) as error:
            if isinstance(error, GeometryFault):
                raise
            raise GeometryFault(place, "the coordinates are no positions") from error

    def _moved(self, coordinates: Any, place: str, depth: int = 0) -> Any:
        if depth > 3:
            raise GeometryFault(place, "the coordinates are nested too deeply")
        if not coordinates:
            return coordinates
        if isinstance(coordinates[0], int | float):
            return self._path([coordinates], place)[0]
        if isinstance(coordinates[0][0], int | float):
            return self._path(coordinates, place)
        return [self._moved(part, place, depth + 1) for part in coordinates]

    def _path(self, positions: list[Any], place: str) -> list[list[float]]:
        stated = np.array([position[:2] for position in positions], dtype=np.float64)
        lon, lat = self._transformer.transform(stated[:, 0], stated[:, 1])
        moved = np.column_stack([lon, lat])
        wrong = np.flatnonzero(~np.isfinite(moved).all(axis=1) | self._is_far_outside(moved))
        if wrong.size:
            x, y = stated[wrong[0]].tolist()
            found = LonLat(*moved[wrong[0]].tolist()) if np.isfinite(moved[wrong[0]]).all() else None
            words = f"{x:.10g}, {y:.10g} is nowhere near where {self._system.name} is used: is it another system, or are x and y swapped?"
            raise GeometryFault(place, words, found)
        return [[float(x), float(y)] for x, y in moved.tolist()]

    def _is_far_outside(self, moved: np.ndarray[Any, np.dtype[np.float64]]) -> Any:
        area = self._area
        if area is None or area.west > area.east:
            return np.zeros(len(moved), dtype=bool)
        margin = FAR_OUTSIDE_DEG
        return (
            (moved[:, 0] < area.west - margin) | (moved[:, 0] > area.east + margin)
            | (moved[:, 1] < area.south - margin) | (moved[:, 1] > area.north + margin)
        )  # fmt: skip


def _checked(make: Callable[[], CRS], place: str, text: Any) -> CRS | None:
    try:
        system = make()
    except (CRSError, ProjError, ValueError) as error:
        raise refused(place, f"{str(text)[:60]!r} is no reference system that is known") from error
    if not (system.is_geographic or system.is_projected or system.is_bound or system.is_compound):
        raise refused(place, f"{system.name} is no system of places on earth")
    return None if system.equals(_WGS84) or system.to_authority(min_confidence=100) == ("EPSG", "4326") else system
