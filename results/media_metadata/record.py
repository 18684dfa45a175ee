"""What a photo states about itself, independent of the camera's maker."""

from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any


class CameraHeightReference(StrEnum):
    """What a height is above."""

    AMSL = "amsl"
    ELLIPSOID = "ellipsoid"  # of WGS 84
    TAKE_OFF = "take_off"
    UNKNOWN = "unknown"  # AMSL or the ellipsoid: the file does not state it


class TimeSource(StrEnum):
    GPS = "gps"  # UTC of the receiver
    CAMERA = "camera"  # the camera's clock with its offset from UTC
    LOCAL = "local"  # the camera's clock, whose zone the file does not state


@dataclass(frozen=True)
class Height:
    value_m: float
    reference: CameraHeightReference
    source: str  # the tag


@dataclass(frozen=True)
class Position:
    lon: float
    lat: float
    source: str  # the tag's group


@dataclass(frozen=True)
class Attitude:
    """Attitude of the camera against true north and the horizon.

    yaw_deg: of the optical axis, clockwise from true north, 0 to 360; straight up and down it is that of the picture's top or bottom.
    pitch_deg: of the optical axis above the horizon, -90 straight down. roll_deg: around it, clockwise positive.
    """

    yaw_deg: float
    pitch_deg: float
    roll_deg: float
    source: str  # the tag's group


@dataclass(frozen=True)
class MediaRecord:
    """Facts of one photo; None or empty where it states nothing."""

    camera_make: str = ""
    camera_model: str = ""
    focal_length_mm: float | None = None
    focal_length_35mm_mm: float | None = None
    orientation: int = 1  # EXIF
    is_thermal: bool = False
    position: Position | None = None
    heights: tuple[Height, ...] = ()
    attitude: Attitude | None = None
    taken_at: datetime | None = None  # aware
    taken_local: datetime | None = None  # by the camera's clock, without a zone
    time_source: TimeSource | None = None
    serial_numbers: dict[str, str] = field(default_factory=dict)  # of "uav" and "camera"
    faults: tuple[str, ...] = ()  # codes of metadata that cannot be read


def record_to_json(record: MediaRecord) -> dict[str, Any]:
    """Return a record as JSON values."""
    values = dict(vars(record))
    for name in ("taken_at", "taken_local"):
        values[name] = None if values[name] is None else values[name].isoformat()
    for name in ("position", "attitude"):
        values[name] = None if values[name] is None else dict(vars(values[name]))
    values["heights"] = [dict(vars(height)) for height in record.heights]
    values["faults"] = list(record.faults)
    return values


def record_from_json(values: dict[str, Any]) -> MediaRecord:
    """Return the record that `record_to_json` wrote. Raises KeyError, TypeError or ValueError for anything else."""
    found = dict(values)
    for name in ("taken_at", "taken_local"):
        found[name] = None if found[name] is None else datetime.fromisoformat(found[name])
    found["position"] = None if found["position"] is None else Position(**found["position"])
    found["attitude"] = None if found["attitude"] is None else Attitude(**found["attitude"])
    found["heights"] = tuple(
        Height(height["value_m"], CameraHeightReference(height["reference"]), height["source"]) for height in found["heights"]
    )
    found["time_source"] = None if found["time_source"] is None else TimeSource(found["time_source"])
    found["faults"] = tuple(found["faults"])
    return MediaRecord(**found)
