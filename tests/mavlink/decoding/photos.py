"""Messages about photos for tests, as a vehicle's components send them."""

import math
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.autopilot_type import AutopilotType
from mavlink.decoding.boots import VehicleTime
from mavlink.decoding.captures import CaptureDecoder, CaptureMessage

NOW_S = 1_790_000_000.0
BOOTED_S = NOW_S - 100.0
LON_E7, LAT_E7 = 100_000_000, 550_000_000
CAMERA, GIMBAL, NAN = 100, 154, math.nan
LEVEL, VEHICLE, EARTH = 12, mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME, mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_EARTH_FRAME


def sent(message: Any, component: int = 1) -> Any:
    """As it arrives."""
    return mavlink.MAVLink(None).parse_char(bytes(message.pack(mavlink.MAVLink(None, srcSystem=1, srcComponent=component))))


def quaternion(pitch_deg: float, yaw_deg: float, roll_deg: float = 0.0) -> list[float]:
    (sr, cr), (sp, cp), (sy, cy) = (
        (math.sin(half), math.cos(half)) for half in (math.radians(a) / 2 for a in (roll_deg, pitch_deg, yaw_deg))
    )
    return [cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy]


def captured(
    index: int = 0, *, component: int = CAMERA, boot_s: float = 100.0, utc_s: float = 0.0, lon_e7: int = LON_E7, lat_e7: int = LAT_E7,
    alt_mm: int = 130_000, relative_mm: int = 30_000, q: list[float] | None = None, result: int = 1, url: bytes = b"",
) -> Any:  # fmt: skip
    return sent(
        mavlink.MAVLink_camera_image_captured_message(
            round(boot_s * 1e3),
            round(utc_s * 1e6),
            0,
            lat_e7,
            lon_e7,
            alt_mm,
            relative_mm,
            q or quaternion(-30.0, 200.0),
            index,
            result,
            url,
        ),
        component,
    )


def feedback(
    index: int = 1, *, time_us: float = NOW_S * 1e6, lon_e7: int = LON_E7, lat_e7: int = LAT_E7, alt_m: float = 130.0,
    relative_m: float = 30.0, angles: tuple[float, float, float] = (1.0, 2.0, 60.0), flags: int = 0, component: int = 1,
) -> Any:  # fmt: skip
    message = mavlink.MAVLink_camera_feedback_message(
        round(time_us), 0, 0, index, lat_e7, lon_e7, alt_m, relative_m, *angles, 0.0, flags, 0
    )
    return sent(message, component)


def trigger(number: int = 0, *, time_us: float = NOW_S * 1e6) -> Any:
    return sent(mavlink.MAVLink_camera_trigger_message(round(time_us), number))


def attitude(yaw_deg: float, roll_deg: float = 1.0) -> Any:
    return sent(mavlink.MAVLink_attitude_message(100_000, math.radians(roll_deg), 0.01, math.radians(yaw_deg), 0, 0, 0))


def position(*, vx: int = 0, lon_e7: int = LON_E7, lat_e7: int = LAT_E7) -> Any:
    return sent(mavlink.MAVLink_global_position_int_message(100_000, lat_e7, lon_e7, 130_000, 30_000, vx, 0, 0, 0))


def gimbal(pitch_deg: float, yaw_deg: float, flags: int, *, component: int = 1, device: int = 1) -> Any:
    message = mavlink.MAVLink_gimbal_device_attitude_status_message(
        0, 0, 100_000, flags, quaternion(pitch_deg, yaw_deg), NAN, NAN, NAN, 0, 0.0, 0.0, device
    )
    return sent(message, component)


def synchronised(epoch: bool = True) -> VehicleTime:
    """The time of a vehicle that booted 100 s ago and tells the right time of day."""
    clock = VehicleTime()
    for step in range(100):
        clock.receive(round(step * 1e3), BOOTED_S + step, unix_s=BOOTED_S + step if epoch else None)
    clock.receive(100_000, NOW_S, unix_s=NOW_S if epoch else None)
    return clock


def decoded(
    *messages: Any, autopilot: AutopilotType | None = AutopilotType.ARDUPILOT, clock: VehicleTime | None = None, now_s: float = NOW_S
) -> CaptureMessage:
    """The one photo that these messages tell of."""
    decoder = CaptureDecoder()
    reports = [decoder.receive(message, clock or synchronised(), autopilot, now_s) for message in messages]
    (report,) = [report for report in reports if report is not None]
    return report
