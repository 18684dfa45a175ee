"""Cameras that state their figures: read, asked for until they answer, and compared with the planned one."""

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding.cameras import MAX_CAMERAS, MAX_REQUESTS, CameraDifference, CameraReader, ReportedCamera, camera_differences
from planning.views.camera import Camera
from planning.views.catalogue import catalogue
from tests.mavlink.decoding.photos import CAMERA, sent

ZOOM = catalogue()["dji-m30t-zoom"].camera
STATED = ReportedCamera(
    CAMERA, "DJI M30T", ZOOM.focal_lengths_mm[0], ZOOM.sensor_width_mm, ZOOM.sensor_height_mm, ZOOM.pixels_wide, ZOOM.pixels_high
)


def information(
    *, vendor: bytes = b"DJI", model: bytes = b"M30T", focal_mm: float = 8.8, sensor_mm: tuple[float, float] = (13.2, 8.8),
    pixels: tuple[int, int] = (5472, 3648), component: int = CAMERA, device: int = 0,
) -> Any:  # fmt: skip
    message = mavlink.MAVLink_camera_information_message(
        0, list(vendor.ljust(32, b"\0")), list(model.ljust(32, b"\0")), 0, focal_mm, *sensor_mm, *pixels, 0, 0, 0, b"", 0, device
    )
    return sent(message, component)


def beat(component: int, kind: int, autopilot: int = mavlink.MAV_AUTOPILOT_INVALID) -> Any:
    return sent(mavlink.MAVLink_heartbeat_message(kind, autopilot, 0, 0, 4, 3), component)


def read(*messages: Any) -> list[ReportedCamera]:
    reader = CameraReader()
    for message in messages:
        reader.receive(message, 0.0)
    return reader.cameras


def asked(reader: CameraReader, now_s: float) -> list[int]:
    messages = reader.requests(7, now_s)
    assert all(message.target_system == 7 and message.param1 == mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION for message in messages)
    return [message.target_component for message in messages]


def test_what_a_camera_states_is_read() -> None:
    (stated,) = read(information())
    assert stated == ReportedCamera(CAMERA, "DJI M30T", 8.8, 13.2, 8.8, 5472, 3648)
    assert ReportedCamera.from_json(stated.to_json()) == stated


def test_the_newest_statement_of_each_device_counts() -> None:
    found = read(information(), information(focal_mm=24.0), information(component=101), information(component=1, device=2, focal_mm=35.0))
    assert [(one.component, one.focal_length_mm) for one in found] == [(CAMERA, 24.0), (101, 8.8), (1, 35.0)]
    assert len(read(*(information(device=number, focal_mm=number + 1) for number in range(50)))) == MAX_CAMERAS


def test_a_camera_for_which_its_autopilot_answers_too_is_one() -> None:
    assert len(read(information(component=1), information())) == 1


@given(
    st.binary(max_size=32),
    st.floats(width=32),
    st.tuples(st.floats(width=32), st.floats(width=32)),
    st.tuples(st.integers(0, 65_535), st.integers(0, 65_535)),
)
def test_figures_that_cannot_be_are_unknown(name: bytes, focal_mm: float, sensor_mm: tuple[float, float], pixels: tuple[int, int]) -> None:
    (stated,) = read(information(vendor=name, focal_mm=focal_mm, sensor_mm=sensor_mm, pixels=pixels))
    figures = (stated.focal_length_mm, stated.sensor_width_mm, stated.sensor_height_mm, stated.pixels_wide, stated.pixels_high)
    assert all(value is None or (math.isfinite(value) and value > 0) for value in figures)
    assert (stated.sensor_width_mm is None) == (stated.sensor_height_mm is None)
    assert stated.name.isprintable() and len(stated.name) <= 65
    camera_differences(stated, ZOOM)


def test_a_camera_without_figures_differs_in_nothing() -> None:
    (stated,) = read(information(focal_mm=math.nan, sensor_mm=(0.0, 0.0), pixels=(0, 0)))
    assert not stated.has_figures
    assert camera_differences(stated, ZOOM) == []


@pytest.mark.parametrize("focal_mm", [ZOOM.focal_lengths_mm[0], ZOOM.focal_lengths_mm[-1], ZOOM.focal_lengths_mm[0] * 0.97])
def test_the_planned_camera_differs_in_nothing_at_any_step_of_its_zoom_and_on_its_side(focal_mm: float) -> None:
    assert camera_differences(replace(STATED, focal_length_mm=focal_mm), ZOOM) == []
    turned = replace(STATED, sensor_width_mm=STATED.sensor_height_mm, sensor_height_mm=STATED.sensor_width_mm)
    assert camera_differences(replace(turned, pixels_wide=ZOOM.pixels_high, pixels_high=ZOOM.pixels_wide), ZOOM) == []


def test_each_figure_that_differs_is_named_with_both() -> None:
    planned = Camera("planned", 13.2, 8.8, 5472, 3648, (8.8, 24.0))
    (stated,) = read(information(focal_mm=35.0, sensor_mm=(36.0, 24.0), pixels=(6000, 4000)))
    assert camera_differences(stated, planned) == [
        CameraDifference("focal_length", (35.0,), (24.0,)),
        CameraDifference("sensor", (36.0, 24.0), (13.2, 8.8)),
        CameraDifference("pixels", (6000, 4000), (5472, 3648)),
    ]


def test_each_camera_is_asked_until_it_answers_and_not_for_ever() -> None:
    reader = CameraReader()
    assert asked(reader, 0.0) == [], "nobody has announced a camera"
    for component in (100, 101):
        reader.receive(beat(component, mavlink.MAV_TYPE_CAMERA), 0.0)
    assert asked(reader, 0.0) == [100, 101]
    assert asked(reader, 1.0) == []
    reader.receive(information(component=100), 1.0)
    found = [asked(reader, float(second)) for second in range(2, 600)]
    assert [one for one in found if one] == [[101]] * (MAX_REQUESTS - 1)


def test_of_autopilots_only_ardupilot_is_asked_as_it_answers_for_its_cameras() -> None:
    reader = CameraReader()
    reader.receive(beat(1, mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4), 0.0)
    reader.receive(beat(191, mavlink.MAV_TYPE_ONBOARD_CONTROLLER), 0.0)
    assert asked(reader, 0.0) == []
    reader.receive(beat(1, mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA), 0.0)
    assert asked(reader, 0.0) == [1]
