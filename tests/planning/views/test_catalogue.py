"""The catalogue of cameras: complete, plausible, and each figure with a source."""

import pytest

from planning.views.camera import field_of_view_deg
from planning.views.catalogue import catalogue

FIGURES = ("sensor_width_mm", "sensor_height_mm", "pixels_wide", "pixels_high", "focal_lengths_mm")


def test_it_has_the_cameras_that_inspections_use() -> None:
    cameras = catalogue()
    assert len({own.payload for own in cameras.values()}) >= 20
    assert any(own.camera.is_thermal for own in cameras.values())
    assert {"DJI", "Parrot", "Skydio", "Sony"} <= {own.maker for own in cameras.values()}


@pytest.mark.parametrize("key", sorted(catalogue()))
def test_its_figures_are_plausible_and_sourced(key: str) -> None:
    own = catalogue()[key]
    assert 0.0007 <= own.camera.pixel_mm <= 0.02
    wide_deg, high_deg = field_of_view_deg(own.camera, own.camera.focal_lengths_mm[0])
    assert 2.0 <= high_deg <= wide_deg <= 120.0
    told = {figure for source in own.sources for figure in source["figures"]} | set(own.derived)
    assert told >= set(FIGURES)
    assert all(source["title"] and source["date"] for source in own.sources)
