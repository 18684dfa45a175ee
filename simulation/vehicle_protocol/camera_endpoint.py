"""MAVLink of a simulated UAV's camera and gimbal, as the firmware of each autopilot type sends it.

Read in ArduPilot's AP_Camera_Backend.cpp and AP_Mount_Backend.cpp and in PX4's streams, 2026-11: on both the camera is a component of its
own (MAV_COMP_ID_CAMERA) that reports each photo. ArduPilot adds CAMERA_FEEDBACK, whose angles are those of the vehicle, and sends the
gimbal's attitude itself, with a yaw from the nose. PX4 passes on that of a gimbal component, which names its yaw from north.
"""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.frames import Message
from mavlink.mission_items import position_e7
from planning.views.camera import Camera
from simulation.flight.events import PhotoTaken
from simulation.vehicle_protocol.command_endpoint import ReceivedCommand
from simulation.vehicle_protocol.mode_numbers import SimulatedAutopilot
from simulation.vehicle_protocol.reports import FIRST_GIMBAL, SimulatedReport, quaternion
from simulation.vehicle_protocol.streams import AUTOPILOT, CAMERA, GIMBAL

MAX_KEPT = 500  # photos that can be asked for again
IDLE, UNKNOWN = 0, math.nan
STORAGE_MIB = 64_000.0


@dataclass
class CameraEndpoint:
    """The camera component. `photos` are the messages of those taken, by index."""

    camera: Camera
    autopilot_type: SimulatedAutopilot
    _kept: deque[Message] = field(default_factory=lambda: deque(maxlen=MAX_KEPT))

    def photo(self, event: PhotoTaken, report: SimulatedReport) -> list[tuple[int, Message]]:
        """Return the messages of a photo, each with the component that sends it."""
        captured = self._image_captured(event, report)
        self._kept.append(captured)
        sent = [(CAMERA, captured)]
        if self.autopilot_type is SimulatedAutopilot.ARDUPILOT:
            sent.insert(0, (AUTOPILOT, self._feedback(event, report)))
        return sent

    def heartbeat(self) -> Message:
        kind, none = mavlink.MAV_TYPE_CAMERA, mavlink.MAV_AUTOPILOT_INVALID
        return mavlink.MAVLink_heartbeat_message(kind, none, 0, 0, mavlink.MAV_STATE_ACTIVE, 3)

    def answer(self, command: ReceivedCommand, report: SimulatedReport) -> Message | None:
        """Return the requested message, of this camera; None for others."""
        number = command.number
        asked = command.whole(1) if number == mavlink.MAV_CMD_REQUEST_MESSAGE else _REQUESTS.get(number)
        if asked == mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED:
            index = command.whole(2)
            return next((message for message in self._kept if message.image_index == index), None)
        write = _ANSWERS.get(asked or 0)
        return None if write is None else write(self, report)

    def _image_captured(self, event: PhotoTaken, report: SimulatedReport) -> Message:
        longitude_e7, latitude_e7 = position_e7(event.position)
        pose = event.pose
        return mavlink.MAVLink_camera_image_captured_message(
            int(event.at_s * 1e3) & 0xFFFFFFFF, max(int(report.unix_s * 1e6), 0), 0, latitude_e7, longitude_e7,
            round(event.altitude_amsl_m * 1e3), round((event.altitude_amsl_m - report.state.home_amsl_m) * 1e3),
            quaternion(*map(math.radians, (pose.roll_deg, pose.pitch_deg, pose.yaw_deg))), event.number - 1, 1, b"",
        )  # fmt: skip

    def _feedback(self, event: PhotoTaken, report: SimulatedReport) -> Message:
        longitude_e7, latitude_e7 = position_e7(event.position)
        state = report.state
        return mavlink.MAVLink_camera_feedback_message(
            max(int(report.unix_s * 1e6), 0), 0, 0, event.number & 0xFFFF, latitude_e7, longitude_e7, event.altitude_amsl_m,
            event.altitude_amsl_m - state.home_amsl_m, state.roll_deg, state.pitch_deg, (state.heading_deg + 180.0) % 360.0 - 180.0, 0.0,
            mavlink.CAMERA_FEEDBACK_PHOTO, 0,
        )  # fmt: skip

    def _information(self, report: SimulatedReport) -> Message:
        camera = self.camera
        gimbal = GIMBAL if self.autopilot_type is SimulatedAutopilot.PX4 else FIRST_GIMBAL
        return mavlink.MAVLink_camera_information_message(
            report.boot_ms, list(b"Simulated".ljust(32, b"\0")), list(camera.name.encode("ascii", "replace")[:31].ljust(32, b"\0")), 0,
            camera.focal_lengths_mm[0], camera.sensor_width_mm, camera.sensor_height_mm, min(camera.pixels_wide, 0xFFFF),
            min(camera.pixels_high, 0xFFFF), 0, mavlink.CAMERA_CAP_FLAGS_CAPTURE_IMAGE, 0, b"", gimbal,
        )  # fmt: skip

    def _capture_status(self, report: SimulatedReport) -> Message:
        available_mib = STORAGE_MIB
        return mavlink.MAVLink_camera_capture_status_message(report.boot_ms, IDLE, IDLE, 0.0, 0, available_mib, report.state.photos)

    def _settings(self, report: SimulatedReport) -> Message:
        return mavlink.MAVLink_camera_settings_message(report.boot_ms, mavlink.CAMERA_MODE_IMAGE, UNKNOWN, UNKNOWN)

    def _storage(self, report: SimulatedReport) -> Message:
        return mavlink.MAVLink_storage_information_message(
            report.boot_ms, 1, 1, mavlink.STORAGE_STATUS_READY, STORAGE_MIB, 0.0, STORAGE_MIB, UNKNOWN, UNKNOWN
        )


_ANSWERS: dict[int, Callable[[CameraEndpoint, SimulatedReport], Message]] = {
    mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION: CameraEndpoint._information,
    mavlink.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS: CameraEndpoint._capture_status,
    mavlink.MAVLINK_MSG_ID_CAMERA_SETTINGS: CameraEndpoint._settings,
    mavlink.MAVLINK_MSG_ID_STORAGE_INFORMATION: CameraEndpoint._storage,
}
_REQUESTS = {  # commands from before REQUEST_MESSAGE
    mavlink.MAV_CMD_REQUEST_CAMERA_INFORMATION: mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION,
    mavlink.MAV_CMD_REQUEST_CAMERA_CAPTURE_STATUS: mavlink.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS,
    mavlink.MAV_CMD_REQUEST_CAMERA_SETTINGS: mavlink.MAVLINK_MSG_ID_CAMERA_SETTINGS,
    mavlink.MAV_CMD_REQUEST_STORAGE_INFORMATION: mavlink.MAVLINK_MSG_ID_STORAGE_INFORMATION,
}
