"""Cameras that report their figures: read, asked for until they answer, and compared with the planned one."""

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavlink.decoding.cameras import (
    ASK_AGAIN_S,
    EARLIER_VALID_S,
    FORGOTTEN_S,
    MAX_CAMERAS,
    CameraDifference,
    CameraReader,
    ReportedCamera,
    camera_differences,
)
from planning.views.camera import Camera
from planning.views.catalogue import catalogue
from tests.mavlink.decoding.photos import CAMERA, sent

ZOOM = catalogue()["dji-m30t-zoom"].camera
REPORTED = ReportedCamera(
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
    return reader.cameras(0.0)


def asked(reader: CameraReader, now_s: float) -> list[int]:
    messages = reader.requests(7, now_s)
    assert all(message.target_system == 7 and message.param1 == mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION for message in messages)
    return [message.target_component for message in messages]


def test_what_a_camera_reports_is_read() -> None:
    (reported,) = read(information())
    assert reported == ReportedCamera(CAMERA, "DJI M30T", 8.8, 13.2, 8.8, 5472, 3648)
    assert ReportedCamera.from_json(reported.to_json()) == reported


def test_the_newest_report_of_each_device_counts() -> None:
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
    (reported,) = read(information(vendor=name, focal_mm=focal_mm, sensor_mm=sensor_mm, pixels=pixels))
    figures = (reported.focal_length_mm, reported.sensor_width_mm, reported.sensor_height_mm, reported.pixels_wide, reported.pixels_high)
    assert all(value is None or (math.isfinite(value) and value > 0) for value in figures)
    assert (reported.sensor_width_mm is None) == (reported.sensor_height_mm is None)
    assert reported.name.isprintable() and len(reported.name) <= 65
    camera_differences(reported, ZOOM)


def test_a_camera_without_figures_differs_in_nothing() -> None:
    (reported,) = read(information(focal_mm=math.nan, sensor_mm=(0.0, 0.0), pixels=(0, 0)))
    assert not reported.has_sensor
    assert camera_differences(reported, ZOOM) == []


@pytest.mark.parametrize("focal_mm", [ZOOM.focal_lengths_mm[0], ZOOM.focal_lengths_mm[-1], ZOOM.focal_lengths_mm[0] * 0.97])
def test_the_planned_camera_differs_in_nothing_at_any_step_of_its_zoom_and_on_its_side(focal_mm: float) -> None:
    assert camera_differences(replace(REPORTED, focal_length_mm=focal_mm), ZOOM) == []
    turned = replace(REPORTED, sensor_width_mm=REPORTED.sensor_height_mm, sensor_height_mm=REPORTED.sensor_width_mm)
    assert camera_differences(replace(turned, pixels_wide=ZOOM.pixels_high, pixels_high=ZOOM.pixels_wide), ZOOM) == []


def test_each_figure_that_differs_is_named_with_both() -> None:
    planned = Camera("planned", 13.2, 8.8, 5472, 3648, (8.8, 24.0))
    (reported,) = read(information(focal_mm=35.0, sensor_mm=(36.0, 24.0), pixels=(6000, 4000)))
    assert camera_differences(reported, planned) == [
        CameraDifference("focal_length", (35.0,), (24.0,)),
        CameraDifference("sensor", (36.0, 24.0), (13.2, 8.8)),
        CameraDifference("pixels", (6000, 4000), (5472, 3648)),
    ]


def announced(*components: int) -> CameraReader:
    reader = CameraReader()
    for component in components:
        reader.receive(beat(component, mavlink.MAV_TYPE_CAMERA), 0.0)
    return reader


def test_a_camera_is_asked_until_it_answers_and_then_seldom() -> None:
    assert asked(CameraReader(), 0.0) == [], "no camera has announced itself"
    reader = announced(100, 101)
    assert asked(reader, 0.0) == [100, 101]
    assert asked(reader, 1.0) == []
    reader.receive(information(component=100), 1.0)
    times_s: dict[int, list[int]] = {100: [], 101: []}
    for second in range(2, 300):
        for component in asked(reader, float(second)):
            times_s[component].append(second)
    assert times_s[101] == [5, 15, 35, 75, 135, 195, 255]
    assert times_s[100][0] == 1 + ASK_AGAIN_S


def test_another_camera_at_the_same_place_is_noticed_and_one_that_is_gone_forgotten() -> None:
    reader = announced(100)
    reader.receive(information(), 0.0)
    reader.receive(information(model=b"Z30", focal_mm=24.0), ASK_AGAIN_S)
    (camera,) = reader.cameras(ASK_AGAIN_S)
    assert camera.name == "DJI Z30"
    assert reader.cameras(ASK_AGAIN_S + FORGOTTEN_S + 1.0) == []


def test_what_another_gateway_had_read_holds_until_its_camera_answers_or_for_a_while() -> None:
    wide, tele = read(information(component=100), information(component=101, focal_mm=24.0))
    reader = CameraReader([wide, tele], 50.0)
    assert reader.cameras(51.0) == [wide, tele]
    reader.receive(information(component=100, focal_mm=12.0), 52.0)
    assert [camera.focal_length_mm for camera in reader.cameras(53.0)] == [12.0, 24.0]
    assert [camera.focal_length_mm for camera in reader.cameras(51.0 + EARLIER_VALID_S)] == [12.0]


def test_a_camera_that_a_later_version_has_stored_is_read() -> None:
    assert ReportedCamera.from_json(REPORTED.to_json() | {"aperture": 2.8}) == REPORTED


def test_of_autopilots_only_ardupilot_is_asked_as_it_answers_for_its_cameras() -> None:
    reader = CameraReader()
    reader.receive(beat(1, mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4), 0.0)
    reader.receive(beat(191, mavlink.MAV_TYPE_ONBOARD_CONTROLLER), 0.0)
    assert asked(reader, 0.0) == []
    reader.receive(beat(1, mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA), 0.0)
    assert asked(reader, 0.0) == [1]
