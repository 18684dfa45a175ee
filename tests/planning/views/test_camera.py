"""Cameras: what a pixel shows, how far away one may be, and which figures no camera has."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.views.camera import (
    Camera,
    Gimbal,
    InvalidCamera,
    blur_px,
    camera_from_json,
    camera_to_json,
    field_of_view_deg,
    footprint_m,
    gsd_m,
    max_speed_mps,
    oblique_gsd_m,
    spacing_m,
    standoff_m,
)
from tests.planning.views.towers import FULL_FRAME, WIDE, ZOOM

ONE_INCH = Camera("20 MP, one inch", 13.2, 8.8, 5472, 3648, (8.8,))  # as of the Phantom 4 Pro

lengths = st.floats(0.1, 500.0)
cameras = st.builds(
    lambda width, wide, ratio, focal: Camera("any", width, width * ratio, wide, max(round(wide * ratio), 1), (focal,)),
    st.floats(5.0, 60.0), st.integers(320, 15_000), st.sampled_from([0.75, 2 / 3, 0.5625, 0.8]), st.floats(20.0, 150.0),
)  # fmt: skip


@pytest.mark.parametrize(("gsd_mm", "distance_m"), [(1.0, 3.6), (2.0, 7.3), (4.0, 14.6)])
def test_a_one_inch_camera_stands_where_published_tables_have_it(gsd_mm: float, distance_m: float) -> None:
    assert standoff_m(ONE_INCH, gsd_mm / 1000.0, 8.8) == pytest.approx(distance_m, abs=0.06)


def test_half_a_pixel_of_blur_at_a_five_hundredth_is_a_slow_flight() -> None:
    assert blur_px(0.25, 1 / 500, 0.001) == pytest.approx(0.5)
    camera = Camera("slow", 13.2, 8.8, 5472, 3648, (8.8,), shutter_s=1 / 500)
    assert max_speed_mps(camera, 0.004, math.inf) == pytest.approx(1.0)
    assert max_speed_mps(camera, 0.004, 0.5) == pytest.approx(0.25), "photos follow each other after two seconds"


@given(cameras, lengths)
def test_the_standoff_for_a_gsd_gives_that_gsd(camera: Camera, distance_m: float) -> None:
    focal_mm = camera.focal_lengths_mm[0]
    assert standoff_m(camera, gsd_m(camera, distance_m, focal_mm), focal_mm) == pytest.approx(distance_m)


@given(cameras, lengths)
def test_a_footprint_is_what_the_angle_of_view_opens(camera: Camera, distance_m: float) -> None:
    focal_mm = camera.focal_lengths_mm[0]
    for size_m, angle_deg in zip(footprint_m(camera, distance_m, focal_mm), field_of_view_deg(camera, focal_mm), strict=True):
        assert size_m == pytest.approx(2.0 * distance_m * math.tan(math.radians(angle_deg / 2.0)))


@given(cameras, lengths, st.floats(0.0, 89.0), st.floats(0.0, 89.0))
def test_a_flatter_view_is_coarser(camera: Camera, distance_m: float, one_deg: float, other_deg: float) -> None:
    low, high = sorted((one_deg, other_deg))
    focal_mm = camera.focal_lengths_mm[0]
    assert oblique_gsd_m(camera, distance_m, focal_mm, low) <= oblique_gsd_m(camera, distance_m, focal_mm, high)
    assert oblique_gsd_m(camera, distance_m, focal_mm, 90.0) == math.inf


def test_spacing_refuses_an_overlap_of_everything() -> None:
    assert spacing_m(10.0, 0.7) == pytest.approx(3.0)
    for overlap in (1.0, -0.1, math.nan):
        with pytest.raises(ValueError, match="overlap"):
            spacing_m(10.0, overlap)


@pytest.mark.parametrize(
    ("field", "value"),
    [("sensor_width_mm", 0.0), ("sensor_height_mm", math.nan), ("pixels_wide", -1), ("focal_lengths_mm", ()),
     ("focal_lengths_mm", (math.inf,)),
     ("focal_lengths_mm", (20.0, 10.0)), ("min_interval_s", 0.0), ("nearest_focus_m", -1.0), ("gimbal", Gimbal(10.0, -10.0)),
     ("gimbal", Gimbal(math.nan, 0.0)), ("offset_m", (math.nan, 0.0, 0.0)), ("focal_lengths_mm", (2_000.0,)), ("pixels_high", 100)],
)  # fmt: skip
def test_figures_that_no_camera_has_are_refused_by_name(field: str, value: object) -> None:
    figures: dict[str, object] = {
        "name": "any", "sensor_width_mm": 13.2, "sensor_height_mm": 8.8, "pixels_wide": 5472, "pixels_high": 3648,
        "focal_lengths_mm": (8.8,), field: value,
    }  # fmt: skip
    with pytest.raises(InvalidCamera) as refused:
        Camera(**figures)  # type: ignore[arg-type]
    assert list(refused.value.faults) == [field]


@pytest.mark.parametrize("camera", [ZOOM, FULL_FRAME, WIDE, ONE_INCH])
def test_a_stored_camera_is_the_same(camera: Camera) -> None:
    assert camera_from_json(camera_to_json(camera)) == camera
