"""Cameras as they describe themselves by CAMERA_INFORMATION, the requests for it, and how one differs from the planned camera.

A camera component announces itself by heartbeats. ArduPilot answers for its cameras itself since 4.5 (AP_Camera_Backend.cpp, read
2026-11); most of its drivers report the names alone, with figures of NaN or 0.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.addressing import AUTOPILOT
from mavlink.frames import Message
from planning.views.camera import Camera

MAX_CAMERAS = 8  # of one vehicle
RETRY_DELAY_S, MAX_RETRY_DELAY_S = 5.0, 60.0  # without an answer; doubled with each request
ASK_AGAIN_S = 120.0  # after an answer: a payload may be changed without a reboot of the autopilot
FORGOTTEN_S = 600.0  # after the last answer
EARLIER_VALID_S = 120.0  # what another gateway had read, after a takeover
MIN_LENGTH_MM, MAX_FOCAL_LENGTH_MM, MAX_SENSOR_MM = 0.1, 5_000.0, 1_000.0
MAX_RATIO = 1.05  # of lengths that count as equal: data sheets round them


@dataclass(frozen=True, slots=True)
class ReportedCamera:
    """Figures that a camera reports of itself; None is unknown.

    component: that sent them. focal_length_mm: of a zoom at any of its steps.
    """

    component: int
    name: str
    focal_length_mm: float | None = None
    sensor_width_mm: float | None = None
    sensor_height_mm: float | None = None
    pixels_wide: int | None = None
    pixels_high: int | None = None

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "ReportedCamera":
        return cls(**{name: entry for name, entry in value.items() if name in cls.__slots__})

    @property
    def has_sensor(self) -> bool:
        """Whether its sensor or its pixels are known. A focal length alone does not tell cameras apart."""
        return self.sensor_width_mm is not None or self.pixels_wide is not None


@dataclass(frozen=True, slots=True)
class CameraDifference:
    """A figure that a camera reports otherwise than planned.

    figure: focal_length [mm], sensor (width and height, mm) or pixels (width and height).
    """

    figure: str
    reported: tuple[float, ...]
    planned: tuple[float, ...]


def reported_camera(message: Message) -> ReportedCamera:
    """Return the camera that a CAMERA_INFORMATION describes. Impossible figures are unknown."""
    vendor, model = _text(message.vendor_name), _text(message.model_name)
    wide, high = message.resolution_h, message.resolution_v
    width_mm, height_mm = (_length(value, MAX_SENSOR_MM) for value in (message.sensor_size_h, message.sensor_size_v))
    return ReportedCamera(
        message.get_srcComponent(), " ".join(filter(None, (vendor, model))), _length(message.focal_length, MAX_FOCAL_LENGTH_MM),
        *((width_mm, height_mm) if width_mm and height_mm else (None, None)), *((wide, high) if wide and high else (None, None)),
    )  # fmt: skip


def camera_differences(reported: ReportedCamera, planned: Camera) -> list[CameraDifference]:
    """Return the figures that differ by more than MAX_RATIO, and numbers of pixels that are not the same. A camera may be on its side."""
    found = []
    length_mm, steps_mm = reported.focal_length_mm, planned.focal_lengths_mm
    if length_mm is not None and not steps_mm[0] / MAX_RATIO <= length_mm <= steps_mm[-1] * MAX_RATIO:
        nearest_mm = min(steps_mm, key=lambda step_mm: abs(step_mm - length_mm))
        found.append(CameraDifference("focal_length", (length_mm,), (nearest_mm,)))
    if reported.sensor_width_mm is not None and reported.sensor_height_mm is not None:
        sides_mm = (reported.sensor_width_mm, reported.sensor_height_mm)
        planned_mm = (planned.sensor_width_mm, planned.sensor_height_mm)
        pairs = zip(sorted(sides_mm), sorted(planned_mm), strict=True)
        if any(max(pair) > MAX_RATIO * min(pair) for pair in pairs):
            found.append(CameraDifference("sensor", sides_mm, planned_mm))
    if reported.pixels_wide is not None and reported.pixels_high is not None:
        pixels, planned_pixels = (reported.pixels_wide, reported.pixels_high), (planned.pixels_wide, planned.pixels_high)
        if sorted(pixels) != sorted(planned_pixels):
            found.append(CameraDifference("pixels", pixels, planned_pixels))
    return found


@dataclass
class _Request:
    due_s: float
    delay_s: float = RETRY_DELAY_S  # until the next one, where there is no answer


@dataclass
class CameraReader:
    """Requests CAMERA_INFORMATION of one vehicle's cameras periodically and keeps the answers. Times are monotonic seconds.

    earlier: what another gateway had read, valid until EARLIER_VALID_S after began_s unless its component has answered since.
    """

    earlier: Sequence[ReportedCamera] = ()
    began_s: float = 0.0
    _reported: dict[tuple[int, int], tuple[ReportedCamera, float]] = field(default_factory=dict)  # by component and number of its device
    _requests: dict[int, _Request] = field(default_factory=dict)

    def receive(self, message: Message, now_s: float) -> None:
        kind, component = message.get_type(), message.get_srcComponent()
        if kind == "CAMERA_INFORMATION":
            key = component, message.camera_device_id
            if key in self._reported or len(self._reported) < MAX_CAMERAS:
                self._reported[key] = reported_camera(message), now_s
            if component in self._requests:
                self._requests[component] = _Request(now_s + ASK_AGAIN_S)
        elif kind == "HEARTBEAT":
            is_ardupilot = component == AUTOPILOT and message.autopilot == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
            if (is_ardupilot or message.type == mavlink.MAV_TYPE_CAMERA) and len(self._requests) < MAX_CAMERAS:
                self._requests.setdefault(component, _Request(now_s))

    def cameras(self, now_s: float) -> list[ReportedCamera]:
        """Return the cameras that still answer, once where an autopilot and the camera itself have reported the same."""
        own = [camera for camera, at_s in self._reported.values() if now_s - at_s <= FORGOTTEN_S]
        answered = {camera.component for camera in own}
        if now_s - self.began_s <= EARLIER_VALID_S:
            own += [camera for camera in self.earlier if camera.component not in answered]
        return list({replace(camera, component=0): camera for camera in own}.values())

    def requests(self, system: int, now_s: float) -> list[Message]:
        """Return the requests that are due."""
        due = [component for component, request in self._requests.items() if request.due_s <= now_s]
        for component in due:
            request = self._requests[component]
            request.due_s = now_s + request.delay_s
            request.delay_s = min(2.0 * request.delay_s, MAX_RETRY_DELAY_S)
        number, information = mavlink.MAV_CMD_REQUEST_MESSAGE, float(mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION)
        return [
            mavlink.MAVLink_command_long_message(system, component, number, 0, information, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            for component in due
        ]


def _length(value: float, most: float) -> float | None:
    return round(float(value), 4) if math.isfinite(value) and MIN_LENGTH_MM <= value <= most else None


def _text(letters: Any) -> str:
    """Return the printable characters of a name of up to 32 bytes that ends with a null."""
    text = bytes(letters).split(b"\0")[0].decode("utf-8", "replace")
    return "".join(letter for letter in text if letter.isprintable()).strip()
