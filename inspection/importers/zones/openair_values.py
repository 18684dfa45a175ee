"""Values of OpenAir lines: positions, heights, lengths."""

import re
from math import isfinite

from inspection.geodesy import LonLat
from inspection.geodesy.geometry_validator import GeometryFault, checked_position
from inspection.importers.zones.circles import checked_radius_m
from inspection.importers.zones.height_bands import MAX_LIMIT_M
from inspection.importers.zones.records import FOOT_M

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
    """A position such as 48:47:27 N 016:53:33 E; minutes and seconds may be left out or have decimals. See `has_sixty`."""
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
    """Metres and their reference; (None, "") for what is not stated or has no limit. Feet above sea level unless it says otherwise."""
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
    """A radius in metres; nautical miles unless it says otherwise."""
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
