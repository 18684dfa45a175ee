"""Reads and checks reports and photos of companion computers from the HTTP link, and names each fault. Pure."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

MAX_SEQUENCE = 2**63 - 1
EARLIEST_YEAR, LATEST_YEAR = 1970, 9998  # 1970: the time of a clock that was never set; 9998: within the range of Python and PostgreSQL
MAX_MODE_LENGTH = 30
NEAR_KM, FAR_KM = 50.0, 500.0  # a position this far away that is near with its numbers swapped was sent latitude first
EARTH_RADIUS_KM = 6_371.0088  # IUGG mean radius

NUMBERS: Mapping[str, tuple[float, float]] = {  # inclusive
    "altitude_amsl_m": (-1_000, 20_000),
    "altitude_relative_m": (-5_000, 20_000),
    "altitude_agl_m": (-1_000, 20_000),
    "velocity_north_mps": (-200, 200),
    "velocity_east_mps": (-200, 200),
    "velocity_down_mps": (-200, 200),
    "airspeed_mps": (0, 200),
    "roll_deg": (-180, 180),
    "pitch_deg": (-180, 180),
    "heading_deg": (0, 360),
    "battery_percent": (0, 100),
    "battery_v": (0, 1_000),
    "battery_a": (-1_000, 1_000),
    "link_quality_percent": (0, 100),
    "hdop": (0, 1_000),
    "wind_north_mps": (-100, 100),
    "wind_east_mps": (-100, 100),
}
INTEGERS: Mapping[str, tuple[int, int]] = {"gps_fix": (0, 8), "satellites": (0, 255), "waypoint_sequence": (0, 65_535)}
FLAGS = ("is_armed", "is_in_air")
CAPTURE_NUMBERS: Mapping[str, tuple[float, float]] = {
    **{name: NUMBERS[name] for name in ("altitude_amsl_m", "altitude_relative_m", "altitude_agl_m", "roll_deg", "pitch_deg")},
    "yaw_deg": (-360, 360),
    "position_bound_m": (0, 100_000),
}
CAPTURE_INTEGERS: Mapping[str, tuple[int, int]] = {
    "image_index": (0, 2**31 - 1), "camera": (0, 255), "waypoint_sequence": INTEGERS["waypoint_sequence"],
}  # fmt: skip
MAX_URL_LENGTH = 205  # as in CAMERA_IMAGE_CAPTURED
CAPTURE_KNOWN = frozenset(
    {"sequence", "taken_at", "mission", "position", "is_taken", "file_url", *CAPTURE_NUMBERS, *CAPTURE_INTEGERS}
)  # fmt: skip
KNOWN = frozenset({"sequence", "measured_at", "mission", "position", "mode", *NUMBERS, *INTEGERS, *FLAGS})
IDENTIFIER = re.compile(r"[0-9a-fA-F]{8}(-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}")
BARE_HEIGHTS = ("altitude", "altitude_m", "height", "height_m")


@dataclass(frozen=True)
class CompanionReport:
    """One report. `position` is longitude, latitude [deg]; `values` are the other fields sent, under their names in the log."""

    sequence: int
    measured_at: datetime
    mission: str | None = None
    position: tuple[float, float] | None = None
    values: Mapping[str, float | int | bool | str] = field(default_factory=dict)


@dataclass(frozen=True)
class CompanionCapture:
    """One photo. `position` is longitude, latitude [deg]; `values` are the other fields sent, its angles those of the camera."""

    sequence: int
    taken_at: datetime
    mission: str | None = None
    position: tuple[float, float] | None = None
    values: Mapping[str, float | int | bool | str] = field(default_factory=dict)


class FaultyReport(Exception):
    """The report is invalid. `faults` holds a text for each field."""

    def __init__(self, faults: dict[str, str]) -> None:
        super().__init__("; ".join(f"{name}: {words}" for name, words in faults.items()))
        self.faults = faults


def read_report(sent: Any, *, known_place: tuple[float, float] | None = None) -> CompanionReport:
    """Return the report in decoded JSON. `known_place` is the UAV's last position (longitude, latitude [deg]). Raises FaultyReport."""
    read = _fields(sent, KNOWN, ("sequence", "measured_at"), known_place)
    return CompanionReport(
        sequence=read.pop("sequence"),
        measured_at=read.pop("measured_at"),
        mission=read.pop("mission", None),
        position=read.pop("position", None),
        values=read,
    )


def read_capture(sent: Any, *, known_place: tuple[float, float] | None = None) -> CompanionCapture:
    """Return the photo in decoded JSON, as read_report does a report. Raises FaultyReport."""
    read = _fields(sent, CAPTURE_KNOWN, ("sequence", "taken_at"), known_place)
    return CompanionCapture(
        sequence=read.pop("sequence"),
        taken_at=read.pop("taken_at"),
        mission=read.pop("mission", None),
        position=read.pop("position", None),
        values=read,
    )


def _fields(sent: Any, known: frozenset[str], required: Sequence[str], known_place: tuple[float, float] | None) -> dict[str, Any]:
    if not isinstance(sent, dict):
        raise FaultyReport({"": "A record is an object."})
    faults = {str(name): _unknown(str(name)) for name in sent if name not in known}
    read: dict[str, Any] = {}
    for name in sorted(known & sent.keys()):
        if sent[name] is None:
            continue
        try:
            read[name] = _value(name, sent[name], known_place)
        except ValueError as error:
            faults[name] = str(error)
    for name in required:
        if sent.get(name) is None:
            faults[name] = "This field is required."
    if faults:
        raise FaultyReport(faults)
    return read


def _value(name: str, value: Any, known_place: tuple[float, float] | None) -> Any:
    if name == "position":
        return _position(value, known_place)
    if name in ("measured_at", "taken_at"):
        return instant(value)
    if name == "mission":
        return _identifier(value)
    if name == "mode":
        return _words(value, MAX_MODE_LENGTH)
    if name == "file_url":
        return _words(value, MAX_URL_LENGTH)
    if name in FLAGS or name == "is_taken":
        if not isinstance(value, bool):
            raise ValueError("true or false is needed.")
        return value
    limits = NUMBERS.get(name) or CAPTURE_NUMBERS.get(name)
    if limits is not None:
        found = _number(value, *limits)
        return found % 360.0 % 360.0 if name in ("heading_deg", "yaw_deg") else found
    return whole_number(value, *(INTEGERS.get(name) or CAPTURE_INTEGERS.get(name) or (0, MAX_SEQUENCE)))


def instant(value: Any) -> datetime:
    """Return an RFC 3339 time with a zone as UTC. Raises ValueError."""
    fault = "A time with its zone is needed, such as 2026-11-22T09:30:00.250Z."
    if not isinstance(value, str):
        raise ValueError(fault)
    try:
        found = datetime.fromisoformat(value)
    except ValueError as error:
        raise ValueError(fault) from error
    if found.tzinfo is None or not EARLIEST_YEAR <= found.year <= LATEST_YEAR:
        raise ValueError(fault)
    return found.astimezone(UTC)


def whole_number(value: Any, lowest: int, highest: int) -> int:
    """Return the value if it is a whole number within the limits. Raises ValueError."""
    if isinstance(value, bool) or not isinstance(value, int) or not lowest <= value <= highest:
        raise ValueError(f"A whole number from {lowest} to {highest} is needed.")
    return value


def _number(value: Any, lowest: float, highest: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not lowest <= value <= highest:  # false for NaN, too
        raise ValueError(f"A number from {lowest:g} to {highest:g} is needed.")
    return float(value)


def _words(value: Any, most: int) -> str:
    if not isinstance(value, str) or len(value) > most or not value.isprintable():
        raise ValueError(f"At most {most} printable characters.")
    return value


def _identifier(value: Any) -> str:
    if not isinstance(value, str) or not IDENTIFIER.fullmatch(value):
        raise ValueError("A mission's id is needed.")
    return value.lower()


def _position(value: Any, known_place: tuple[float, float] | None) -> tuple[float, float]:
    fault = "Longitude and latitude in degrees are needed, longitude first."
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(fault)
    if any(isinstance(number, bool) or not isinstance(number, int | float) for number in value):
        raise ValueError(fault)
    if not (abs(value[0]) <= 180 and abs(value[1]) <= 90):  # false for NaN, too
        raise ValueError(fault)
    longitude, latitude = float(value[0]), float(value[1])
    if longitude == latitude == 0.0:
        raise ValueError("0, 0 is what a receiver says that has no fix: send null.")
    if known_place and _is_turned_round((longitude, latitude), known_place):
        raise ValueError(f"{fault} These two lie near the UAV only the other way round.")
    return longitude, latitude


def _is_turned_round(place: tuple[float, float], known: tuple[float, float]) -> bool:
    longitude, latitude = place
    if abs(longitude) > 90.0 or _distance_km(place, known) < FAR_KM:
        return False
    return _distance_km((latitude, longitude), known) < NEAR_KM


def _distance_km(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Return the distance on a sphere, accurate enough to separate 50 km from 500 km."""
    (lon_a, lat_a), (lon_b, lat_b) = ((math.radians(lon), math.radians(lat)) for lon, lat in (a, b))
    half = math.sin((lat_b - lat_a) / 2) ** 2 + math.cos(lat_a) * math.cos(lat_b) * math.sin((lon_b - lon_a) / 2) ** 2
    return 2 * EARTH_RADIUS_KM * math.asin(min(1.0, math.sqrt(half)))


def _unknown(name: str) -> str:
    if name in BARE_HEIGHTS:
        return "A height names its reference: altitude_amsl_m, altitude_relative_m or altitude_agl_m."
    if name == "mission_item":
        return "Only an autopilot's own list has items: send waypoint_sequence, the sequence of the waypoint in its route."
    return "There is no such field."
