"""EXIF of an opened picture, and the record that it makes together with XMP."""

import math
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

from PIL.ExifTags import GPS, IFD, Base
from PIL.Image import Exif

from results.media_metadata import dialects
from results.media_metadata.record import CameraHeightReference, Height, MediaRecord, Position, TimeSource
from results.media_metadata.xmp import Properties

MAX_TEXT_LENGTH = 100
MAX_OFFSET = timedelta(hours=15)
_ALTITUDE_REFERENCES = {  # EXIF 3.0, table "GPSAltitudeRef"
    0: (1.0, CameraHeightReference.AMSL),
    1: (-1.0, CameraHeightReference.AMSL),
    2: (1.0, CameraHeightReference.ELLIPSOID),
    3: (-1.0, CameraHeightReference.ELLIPSOID),
}

Tags = Mapping[int, Any]


def record_of(exif: Exif, xmp: Properties, faults: tuple[str, ...] = ()) -> MediaRecord:
    """Return what EXIF and XMP state together; XMP precedes, as its positions are finer."""
    camera, gps = _directory(exif, IFD.Exif), _directory(exif, IFD.GPSInfo)
    make, model = _text(exif, Base.Make), _text(exif, Base.Model)
    taken_at, taken_local, source = _time_of(exif, camera, gps, xmp)
    altitude = _altitude_of(gps, make, model)
    orientation = exif.get(Base.Orientation, 1)
    return MediaRecord(
        camera_make=make,
        camera_model=model,
        focal_length_mm=_positive(camera, Base.FocalLength),
        focal_length_35mm_mm=_positive(camera, Base.FocalLengthIn35mmFilm),
        orientation=orientation if orientation in range(1, 9) else 1,
        is_thermal=dialects.is_thermal(xmp),
        position=dialects.position_of(xmp) or _position_of(gps),
        heights=(*dialects.heights_of(xmp), *(() if altitude is None else (altitude,))),
        attitude=dialects.attitude_of(xmp),
        taken_at=taken_at,
        taken_local=taken_local,
        time_source=source,
        serial_numbers=dialects.serial_numbers_of(xmp),
        faults=faults,
    )


def _directory(exif: Exif, tag: int) -> Tags:
    try:
        return exif.get_ifd(tag)
    except (ValueError, TypeError, KeyError, SyntaxError, OSError):  # a damaged directory
        return {}


def _text(tags: Tags | Exif, tag: int) -> str:
    value = tags.get(tag)
    text = value.decode("ascii", "ignore") if isinstance(value, bytes) else value if isinstance(value, str) else ""
    return "".join(character for character in text if character.isprintable()).strip()[:MAX_TEXT_LENGTH]


def _number(value: object) -> float | None:
    """Return a finite number; None for anything else, such as a fraction over zero."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def _positive(tags: Tags, tag: int) -> float | None:
    found = _number(tags.get(tag))
    return found if found is not None and 0.0 < found < 1e5 else None


def _position_of(gps: Tags) -> Position | None:
    if _text(gps, GPS.GPSStatus).upper() == "V":  # the receiver's own word for no fix
        return None
    lon = _degrees(gps.get(GPS.GPSLongitude), _text(gps, GPS.GPSLongitudeRef), "EW")
    lat = _degrees(gps.get(GPS.GPSLatitude), _text(gps, GPS.GPSLatitudeRef), "NS")
    return dialects.plausible_position(lon, lat, "exif")


def _degrees(value: object, reference: str, known: str) -> float | None:
    parts = [_number(part) for part in value] if isinstance(value, tuple) else []
    if len(parts) != 3 or None in parts or reference[:1].upper() not in known or not reference:
        return None
    degrees, minutes, seconds = (part or 0.0 for part in parts)
    return (degrees + minutes / 60.0 + seconds / 3_600.0) * (-1.0 if reference[:1].upper() == known[1] else 1.0)


def _altitude_of(gps: Tags, make: str, model: str) -> Height | None:
    """Return the height of EXIF.

    Parrot's ANAFI Ai writes the ellipsoid's as if above the sea (developer.parrot.com/docs/groundsdk-tools/photo-metadata.html), Autel's
    firmware one of the two by version.
    """
    value = _number(gps.get(GPS.GPSAltitude))
    if value is None:
        return None
    stated = gps.get(GPS.GPSAltitudeRef, 0)
    sign, reference = _ALTITUDE_REFERENCES.get(
        stated[0] if isinstance(stated, bytes) and stated else stated, (1.0, CameraHeightReference.UNKNOWN)
    )
    if "parrot" in make.lower() and "anafiai" in model.lower().replace(" ", ""):
        reference = CameraHeightReference.ELLIPSOID
    elif "autel" in make.lower() or make.lower().startswith("dji"):  # DJI writes its absolute height here, too
        reference = CameraHeightReference.UNKNOWN
    return Height(abs(value) * sign if value >= 0.0 else value, reference, "exif:GPSAltitude")


def _time_of(exif: Exif, camera: Tags, gps: Tags, xmp: Properties) -> tuple[datetime | None, datetime | None, TimeSource | None]:
    """Return the time with its zone, else the local one, and its source."""
    local = _camera_time(_text(camera, Base.DateTimeOriginal) or _text(exif, Base.DateTime), _text(camera, Base.SubsecTimeOriginal))
    by_gps = dialects.exposure_time_of(xmp) or _gps_time(gps)
    if by_gps is not None:
        return by_gps, local, TimeSource.GPS
    zone = _zone_of(_text(camera, Base.OffsetTimeOriginal) or _text(camera, Base.OffsetTime))
    if local is None:
        return None, None, None
    return (None, local, TimeSource.LOCAL) if zone is None else (local.replace(tzinfo=zone), local, TimeSource.CAMERA)


def _camera_time(text: str, subseconds: str) -> datetime | None:
    try:
        at = datetime.strptime(text[:19], "%Y:%m:%d %H:%M:%S")
    except ValueError:
        return None
    return at + timedelta(seconds=float(f"0.{subseconds}")) if subseconds.isascii() and subseconds.isdigit() else at


def _gps_time(gps: Tags) -> datetime | None:
    parts = gps.get(GPS.GPSTimeStamp)
    numbers = [_number(part) for part in parts] if isinstance(parts, tuple) else []
    try:
        day = datetime.strptime(_text(gps, GPS.GPSDateStamp), "%Y:%m:%d").replace(tzinfo=UTC)
    except ValueError:
        return None
    if len(numbers) != 3 or None in numbers:
        return None
    hours, minutes, seconds = (number or 0.0 for number in numbers)
    is_possible = 0.0 <= hours < 24.0 and 0.0 <= minutes < 60.0 and 0.0 <= seconds < 61.0 and day.year >= 1980
    return day + timedelta(hours=hours, minutes=minutes, seconds=seconds) if is_possible else None


def _zone_of(text: str) -> timezone | None:
    try:
        sign = {"+": 1, "-": -1}[text[:1]]
        offset = timedelta(hours=int(text[1:3]), minutes=int(text[4:6]))
    except (KeyError, ValueError):
        return None
    return timezone(sign * offset) if offset <= MAX_OFFSET else None
