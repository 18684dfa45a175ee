"""Records of zone files, with validated texts, height bands and circles."""

from dataclasses import dataclass, field
from math import cos, pi
from typing import Any

import numpy as np
import shapely
from shapely import MultiPolygon, Polygon

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import GeometryFault, VertexBudget, polygons_of_rings
from inspection.geodesy.wgs84 import WGS84, FloatArray

FOOT_M = 0.3048
NO_CEILING = 99_999  # written by some sources (Switzerland) where there is no upper limit
HEIGHT_REFERENCES = ("AGL", "AMSL", "WGS84")
UNITS_M = {"M": 1.0, "FT": FOOT_M}


@dataclass(frozen=True)
class HeightBand:
    """Limits in metres with their references; None and "" mean not stated. as_stated is the file's own text with its unit."""

    lower_limit_m: float | None = None
    lower_reference: str = ""
    upper_limit_m: float | None = None
    upper_reference: str = ""
    as_stated: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ZoneRecord:
    """One layer of a zone; a zone of several layers has several records with one identifier."""

    identifier: str
    layer: int
    name: str
    geometry: MultiPolygon
    band: HeightBand = HeightBand()
    restriction: str = ""
    reason: str = ""
    circle: dict[str, Any] | None = None  # {"centre": [lon, lat], "radius_m": number}; geometry encloses it
    schedule: list[Any] | None = None  # None: permanent
    properties: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class UnreadRecord:
    """A record with a fault. bbox: west, south, east, north [deg] of its readable positions; None without any."""

    fault: GeometryFault
    name: str = ""
    identifier: str = ""
    bbox: tuple[float, float, float, float] | None = None


MAX_IDENTIFIER = 100
MAX_NAME = 255


def checked_text(value: Any, place: str, maximum: int) -> str:
    """Return a string, or a number as text; "" if missing."""
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise GeometryFault(place, "a text is expected")
    text = str(value).strip() if not isinstance(value, int) or abs(value) < 10**40 else ""
    if len(text) > maximum:
        raise GeometryFault(place, f"the text has {len(text)} characters; at most {maximum} are taken")
    if "\0" in text or any("\ud800" <= character <= "\udfff" for character in text):
        raise GeometryFault(place, "the text has characters that are none")
    return text


BAND_KEYS = ("uomDimensions", "lowerLimit", "lowerVerticalReference", "upperLimit", "upperVerticalReference")
MAX_LIMIT_M = 100_000.0


def height_band(holder: dict[str, Any], place: str) -> HeightBand:
    """Return the band of an object; a limit that is missing or null is not stated, which differs from 0."""
    stated = {key: holder[key] for key in BAND_KEYS if holder.get(key) is not None}
    unit = stated.get("uomDimensions", "M")
    if not isinstance(unit, str) or unit not in UNITS_M:
        raise GeometryFault(f"{place}.uomDimensions", f"the unit is M or FT, not {str(unit)[:40]!r}")
    lower, upper = (_limit_m(stated, key, UNITS_M[unit], place) for key in ("lowerLimit", "upperLimit"))
    lower_reference, upper_reference = (_reference(stated, key, place) for key in ("lowerVerticalReference", "upperVerticalReference"))
    if lower is not None and upper is not None and lower_reference == upper_reference and upper < lower:
        raise GeometryFault(f"{place}.upperLimit", f"the upper limit {upper:g} m lies below the lower limit {lower:g} m")
    return HeightBand(lower, lower_reference if lower is not None else "", upper, upper_reference if upper is not None else "", stated)


def _limit_m(stated: dict[str, Any], key: str, unit_m: float, place: str) -> float | None:
    value = stated.get(key)
    if value is None or value == NO_CEILING:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= MAX_LIMIT_M:
        raise GeometryFault(f"{place}.{key}", "a limit is a number of metres or feet")
    return float(value) * unit_m


def _reference(stated: dict[str, Any], key: str, place: str) -> str:
    reference = stated.get(key, "")
    if reference not in ("", *HEIGHT_REFERENCES):
        raise GeometryFault(f"{place}.{key}", f"the reference is AGL, AMSL or WGS84, not {str(reference)[:40]!r}")
    return str(reference)


CORNERS = 64
CHECKS_PER_SIDE = 16
MAX_RADIUS_M = 500_000.0


def checked_radius_m(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value <= MAX_RADIUS_M:
        raise GeometryFault(place, f"a radius is a number of metres above 0, up to {MAX_RADIUS_M:.0f}")
    return float(value)


def enclosing_polygon(centre: LonLat, radius_m: float, place: str, budget: VertexBudget | None = None) -> MultiPolygon:
    """Return a regular polygon of 64 corners around the circle of points radius_m from the centre along the ellipsoid.

    Its sides are straight in longitude and latitude, as everywhere. It is widened until they clear the circle, which takes about a
    centimetre per kilometre of radius at middle latitudes.
    """
    (budget or VertexBudget()).take(CORNERS + 1, place)
    pole_m = min(WGS84.inv(centre.lon, centre.lat, centre.lon, latitude)[2] for latitude in (90.0, -90.0))
    if pole_m <= radius_m * 1.2:
        raise GeometryFault(place, "the circle comes too near to a pole", centre)
    checks = _circle(centre, radius_m, CORNERS * CHECKS_PER_SIDE, offset=0.0)
    margin = 1e-5
    while margin < 0.1:
        ring = _circle(centre, radius_m / cos(pi / CORNERS) * (1.0 + margin), CORNERS, offset=0.5)
        polygon = Polygon(ring)
        if shapely.contains_xy(polygon, checks[:, 0], checks[:, 1]).all():
            wrapped = np.column_stack([(ring[:, 0] + 180.0) % 360.0 - 180.0, ring[:, 1]]) if np.abs(ring[:, 0]).max() > 180.0 else ring
            return MultiPolygon(polygons_of_rings([wrapped], place))
        margin *= 2.0
    raise GeometryFault(place, "the circle cannot be drawn as a polygon there", centre)


def _circle(centre: LonLat, radius_m: float, corners: int, offset: float) -> FloatArray:
    """Return a closed ring of points at a distance; longitudes continue past ±180. offset shifts the first corner by a share of a side."""
    bearings = (np.arange(corners) + offset) * (360.0 / corners)
    lon, lat, _ = WGS84.fwd(np.full(corners, centre.lon), np.full(corners, centre.lat), bearings, np.full(corners, radius_m))
    east = (np.asarray(lon) - centre.lon + 180.0) % 360.0 - 180.0
    ring = np.column_stack([centre.lon + east, np.asarray(lat)])
    return np.vstack([ring, ring[:1]])
