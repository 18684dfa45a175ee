"""Attitudes of gimbals and cameras: quaternions as angles, and the frame of their yaw."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.autopilot_type import AutopilotType
from mavlink.frames import Message

MAX_NORM_ERROR = 0.1
POLE_SINE = 0.999_999  # within 0.1° of straight up or down only the sum of roll and yaw is known


class YawFrame(StrEnum):
    """From where a yaw is measured."""

    EARTH = "earth"  # true north
    VEHICLE = "vehicle"  # the nose


@dataclass(frozen=True, slots=True)
class ReportedAttitude:
    """Angles [deg], None if unknown: pitch from the horizon (negative down), roll right side down, yaw clockwise in its frame."""

    roll_deg: float | None = None
    pitch_deg: float | None = None
    yaw_deg: float | None = None
    frame: YawFrame | None = None

    def in_earth(self, heading_deg: float | None) -> "ReportedAttitude":
        """Return the attitude with its yaw from north where the vehicle's heading is known."""
        if self.frame is not YawFrame.VEHICLE or self.yaw_deg is None or heading_deg is None:
            return self
        return replace(self, yaw_deg=compass(self.yaw_deg + heading_deg), frame=YawFrame.EARTH)


def compass(angle_deg: float) -> float:
    """Return an angle from 0 to less than 360."""
    return angle_deg % 360.0 % 360.0  # twice: the first gives 360 for a tiny negative angle


def attitude_of_quaternion(q: Sequence[float], frame: YawFrame | None) -> ReportedAttitude | None:
    """Return the angles of w, x, y, z in the order yaw, pitch, roll.

    None for what is no rotation, and for the exact identity: senders that know no attitude send it, and a measured one has fractions.
    """
    if len(q) != 4 or not all(map(math.isfinite, q)):
        return None
    norm = math.sqrt(sum(part * part for part in q))
    if abs(norm - 1.0) > MAX_NORM_ERROR or tuple(q) == (1.0, 0.0, 0.0, 0.0):
        return None
    w, x, y, z = (part / norm for part in q)
    sine = max(-1.0, min(1.0, 2.0 * (w * y - z * x)))
    if abs(sine) > POLE_SINE:
        roll, yaw = 0.0, -math.copysign(2.0, sine) * math.atan2(x, w)
    else:
        roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
        yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return _with_yaw(math.degrees(roll), math.degrees(math.asin(sine)), math.degrees(yaw), frame)


def attitude_of_angles(roll_deg: float, pitch_deg: float, yaw_deg: float, frame: YawFrame) -> ReportedAttitude | None:
    """Return the attitude of three angles; None if one is impossible, or if all are exactly 0, as senders without one send."""
    angles = (roll_deg, pitch_deg, yaw_deg)
    if not all(math.isfinite(angle) and abs(angle) <= 360.0 for angle in angles) or not any(angles) or abs(pitch_deg) > 180.0:
        return None
    return _with_yaw(roll_deg, pitch_deg, yaw_deg, frame)


def _with_yaw(roll_deg: float, pitch_deg: float, yaw_deg: float, frame: YawFrame | None) -> ReportedAttitude:
    return ReportedAttitude(roll_deg, pitch_deg, compass(yaw_deg) if frame is not None else None, frame)


def gimbal_attitude(message: Message, autopilot_type: AutopilotType | None) -> ReportedAttitude | None:
    """Return the attitude that a gimbal's message has; None for other messages and impossible values."""
    read = _READ.get(message.get_type())
    return None if read is None else read(message, autopilot_type)


def _device(message: Message, autopilot_type: AutopilotType | None) -> ReportedAttitude | None:
    return attitude_of_quaternion(message.q, _frame(message, autopilot_type))


def _frame(message: Message, autopilot_type: AutopilotType | None) -> YawFrame | None:
    """Return the frame by the flags; without them as MAVLink has it: the earth's if the yaw is locked.

    ArduPilot before 4.6 sends no frame, and always a yaw from the nose. PX4 itself (OutputRC) sends no frame with the angles of its motors,
    whose yaw is then unknown.
    """
    flags = message.flags
    if flags & mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME:
        return YawFrame.VEHICLE
    if flags & mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_EARTH_FRAME:
        return YawFrame.EARTH
    if message.get_srcComponent() == AUTOPILOT:
        return YawFrame.VEHICLE if autopilot_type is AutopilotType.ARDUPILOT else None
    return YawFrame.EARTH if flags & mavlink.GIMBAL_DEVICE_FLAGS_YAW_LOCK else YawFrame.VEHICLE


def _orientation(message: Message, autopilot_type: AutopilotType | None) -> ReportedAttitude | None:
    """MOUNT_ORIENTATION: its yaw_absolute is from north, and is exactly 0 where the sender does not have that field."""
    absolute_deg = getattr(message, "yaw_absolute", 0.0)
    if math.isfinite(absolute_deg) and absolute_deg != 0.0:
        return attitude_of_angles(message.roll, message.pitch, absolute_deg, YawFrame.EARTH)
    return attitude_of_angles(message.roll, message.pitch, message.yaw, YawFrame.VEHICLE)


def _status(message: Message, autopilot_type: AutopilotType | None) -> ReportedAttitude | None:
    """MOUNT_STATUS of ArduPilot before 4.3: centidegrees, its yaw from the nose."""
    roll, pitch, yaw = (value / 100.0 for value in (message.pointing_b, message.pointing_a, message.pointing_c))
    return attitude_of_angles(roll, pitch, yaw, YawFrame.VEHICLE)


_READ: dict[str, Callable[[Message, AutopilotType | None], ReportedAttitude | None]] = {
    "GIMBAL_DEVICE_ATTITUDE_STATUS": _device,
    "MOUNT_ORIENTATION": _orientation,
    "MOUNT_STATUS": _status,
}
