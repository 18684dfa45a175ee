"""XMP of camera makers: where each writes position, heights, attitude and time, and by which convention.

DJI: pitch -90 is straight down, angles against true north and the horizon; Autel's newer firmware writes the same namespace.
Parrot: developer.parrot.com/docs/groundsdk-tools/photo-metadata.html. Skydio: structures in north, east, down.
senseFly, Parrot Sequoia and Autel's older firmware: Pix4D's namespace, where pitch 0 is straight down and roll is the body's.
"""

import math
import re
from collections.abc import Sequence
from datetime import UTC, datetime

from results.media_metadata.record import Attitude, CameraHeightReference, Height, Position
from results.media_metadata.xmp import Properties

DJI = "dji.com/drone-dji/1.0"
PARROT = "parrot.com/drone-parrot/1.0"
SKYDIO = "skydio.com/drone-skydio/1.0"
PIX4D = "pix4d.com/camera/1.0"
SENSEFLY = "ns.sensefly.com/Camera/1.0"
FLIR = "ns.flir.com/FLIR/1.0"
_STRAIGHT = 1e-6  # of a cosine, below which the optical axis is vertical
_LEADING_NUMBER = re.compile(r"^[+-]?\d+(\.\d+)?([eE][+-]?\d+)?")

Vector = tuple[float, float, float]


def position_of(xmp: Properties) -> Position | None:
    """Return where the camera was; DJI's longitude is misspelt by some models."""
    for namespace, latitude, longitudes in (
        (DJI, "GpsLatitude", ("GpsLongitude", "GpsLongtitude")),
        (SKYDIO, "Latitude", ("Longitude",)),
    ):
        for longitude in longitudes:
            found = plausible_position(_number(xmp, namespace, longitude), _number(xmp, namespace, latitude), _label(namespace))
            if found is not None:
                return found
    return None


def plausible_position(lon: float | None, lat: float | None, source: str) -> Position | None:
    """Return a position; None outside of the earth's and at 0, 0, which receivers without a fix write."""
    if lon is None or lat is None or not (abs(lon) <= 180.0 and abs(lat) <= 90.0) or (lon == 0.0 and lat == 0.0):
        return None
    return Position(lon, lat, source)


def heights_of(xmp: Properties) -> tuple[Height, ...]:
    """Return the heights that the makers' own tags state.

    With RTK, DJI's absolute height is above the ellipsoid or the sea, by a setting that the file does not state (OpenAthenaAndroid #100).
    """
    heights = []
    for namespace in (DJI, SKYDIO):
        absolute, relative = _number(xmp, namespace, "AbsoluteAltitude"), _number(xmp, namespace, "RelativeAltitude")
        has_rtk = namespace == DJI and ((DJI, "RtkFlag") in xmp or xmp.get((DJI, "AltitudeType"), "").lower().startswith("rtk"))
        if absolute is not None:
            reference = CameraHeightReference.UNKNOWN if has_rtk else CameraHeightReference.AMSL
            heights.append(Height(absolute, reference, f"{_label(namespace)}:AbsoluteAltitude"))
        if relative is not None:
            heights.append(Height(relative, CameraHeightReference.TAKE_OFF, f"{_label(namespace)}:RelativeAltitude"))
    return tuple(heights)


def attitude_of(xmp: Properties) -> Attitude | None:
    """Return the camera's attitude, of the first maker whose three angles are there."""
    for namespace, names in (
        (DJI, ("GimbalYawDegree", "GimbalPitchDegree", "GimbalRollDegree")),
        (PARROT, ("CameraYawDegree", "CameraPitchDegree", "CameraRollDegree")),
        (SKYDIO, ("CameraOrientationNED/Yaw", "CameraOrientationNED/Pitch", "CameraOrientationNED/Roll")),
    ):
        if (angles := _angles(xmp, namespace, names)) is not None:
            yaw_deg, pitch_deg, roll_deg = angles
            return Attitude(yaw_deg % 360.0, pitch_deg, roll_deg, _label(namespace))
    for namespace in (PIX4D, SENSEFLY):
        if (angles := _angles(xmp, namespace, ("Yaw", "Pitch", "Roll"))) is not None:
            return attitude_of_body(*angles, source=_label(namespace))
    return None


def attitude_of_body(yaw_deg: float, pitch_deg: float, roll_deg: float, *, source: str) -> Attitude:
    """Return the attitude of a camera that looks down along a body's z axis, its picture's top ahead, from the body's angles.

    The body turns by yaw, pitch and roll from north, east, down. Source: Pix4D, "Yaw, Pitch, Roll and Omega, Phi, Kappa angles".
    """
    yaw, pitch, roll = (math.radians(angle) for angle in (yaw_deg, pitch_deg, roll_deg))
    cy, sy, cp, sp, cr, sr = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
    top: Vector = (cp * cy, cp * sy, -sp)  # where the body's x axis points
    axis: Vector = (cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp)  # its z axis
    right: Vector = (sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp)  # its y axis
    level = math.hypot(axis[0], axis[1])
    axis_pitch_deg = math.degrees(math.atan2(-axis[2], level))
    if level < _STRAIGHT:
        ahead = top if axis[2] > 0.0 else (-top[0], -top[1], -top[2])
        return Attitude(math.degrees(math.atan2(ahead[1], ahead[0])) % 360.0, axis_pitch_deg, 0.0, source)
    axis_yaw_deg = math.degrees(math.atan2(axis[1], axis[0])) % 360.0
    return Attitude(axis_yaw_deg, axis_pitch_deg, math.degrees(math.atan2(right[2], -top[2])), source)


def exposure_time_of(xmp: Properties) -> datetime | None:
    """Return when DJI says that the photo was exposed, in UTC."""
    try:
        found = datetime.fromisoformat(xmp.get((DJI, "UTCAtExposure"), "").replace(" ", "T", 1))
    except ValueError:
        return None
    return found.replace(tzinfo=UTC) if found.tzinfo is None else found


def is_thermal(xmp: Properties) -> bool:
    return "infrared" in xmp.get((DJI, "ImageSource"), "").lower() or any(namespace == FLIR for namespace, _name in xmp)


def serial_numbers_of(xmp: Properties) -> dict[str, str]:
    found = {
        "uav": xmp.get((DJI, "DroneSerialNumber")) or xmp.get((PARROT, "SerialNumber")) or xmp.get((SKYDIO, "VehicleSerialNumber")),
        "camera": xmp.get((DJI, "CameraSerialNumber")) or xmp.get((SKYDIO, "CameraSerialNumber")),
    }
    return {name: value[:100] for name, value in found.items() if value}


def _angles(xmp: Properties, namespace: str, names: Sequence[str]) -> tuple[float, float, float] | None:
    yaw, pitch, roll = (_number(xmp, namespace, name) for name in names)
    return None if yaw is None or pitch is None or roll is None else (yaw, pitch, roll)


def _number(xmp: Properties, namespace: str, name: str) -> float | None:
    """Return a number; also one that is written as a fraction, with a sign or with its unit."""
    text = xmp.get((namespace, name), "")
    numerator, _, denominator = text.partition("/")
    matches = _LEADING_NUMBER.match(numerator.strip())
    if matches is None:
        return None
    try:
        value = float(matches[0]) / (float(denominator) if denominator else 1.0)
    except (ValueError, ZeroDivisionError):
        return None
    return value if math.isfinite(value) else None


def _label(namespace: str) -> str:
    return {DJI: "drone-dji", PARROT: "drone-parrot", SKYDIO: "drone-skydio", PIX4D: "Camera", SENSEFLY: "sensefly"}[namespace]
