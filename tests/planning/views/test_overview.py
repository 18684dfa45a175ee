"""Overviews: the whole tower in each photo, from between the directions of its line, clear of wires and within heights and gimbal."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.views.camera import Camera, Gimbal
from planning.views.ground_band import GroundBand
from planning.views.proof import flown_camera
from planning.views.site import InspectionSite
from planning.views.view_flight import NO_PHOTO
from planning.views.view_plan import ViewSpeeds, overview_plan, overview_poses
from planning.views.visibility import axes_of
from tests.cases import long
from tests.planning.views.geometry_oracle import flown_places, to_triangles_m
from tests.planning.views.towers import FULL_FRAME, MAX_HEIGHT_M, MIN_HEIGHT_M, TOWERS, WIDE, ZOOM, standing

QUICK = ("lattice, 380 kV, danube", "tubular, 110 kV, alternating", "portal, 110 kV", "wooden pole, 20 kV")
CAMERAS = {"zoom": ZOOM, "full frame": FULL_FRAME, "wide": WIDE}


def shares_of_frame(site: InspectionSite, camera: Camera) -> np.ndarray:
    """How much of half the picture's width and height the asset takes in each photo, at the corner farthest from its middle; (n, 2)."""
    poses = overview_poses(site, flown_camera(camera))
    points = site.solid.triangles.reshape(-1, 3)
    found = []
    for number in range(len(poses)):
        right, up, forward = (own[0] for own in axes_of(poses.yaw_deg[number : number + 1], poses.pitch_deg[number : number + 1]))
        away = points - poses.position[number]
        depth = away @ forward
        assert depth.min() > 0.0
        wide, high = (side / (2.0 * camera.focal_lengths_mm[0]) for side in (camera.sensor_width_mm, camera.sensor_height_mm))
        found.append((np.abs(away @ right / depth).max() / wide, np.abs(away @ up / depth).max() / high))
    return np.array(found).reshape(-1, 2)


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
@pytest.mark.parametrize("tower", TOWERS)
def test_each_photo_has_the_whole_tower_and_hardly_more_than_heights_ask_for(tower: str, camera: Camera) -> None:
    stands = standing(TOWERS[tower])
    shares = shares_of_frame(stands.site, camera)
    assert len(shares) in (0, 4)
    assert (shares <= 0.901).all()
    if camera is WIDE:
        assert len(shares) == 4


@given(st.floats(0.0, 360.0), st.sampled_from(sorted(TOWERS)))
@settings(max_examples=20, deadline=None)
def test_a_side_of_each_corner_between_the_directions_of_the_line(bearing_deg: float, tower: str) -> None:
    stands = standing(TOWERS[tower], bearing_deg)
    poses = overview_poses(stands.site, flown_camera(WIDE))
    from_line_deg = (np.degrees(np.arctan2(poses.position[:, 0], poses.position[:, 1])) - stands.site.bearing_deg) % 360.0
    assert [int(own // 90.0) for own in from_line_deg] == [0, 1, 2, 3]
    assert np.abs(from_line_deg % 90.0 - 45.0).max() <= 31.0


@pytest.mark.parametrize("tower", [*QUICK, *long(*(name for name in TOWERS if name not in QUICK))])
def test_the_flight_keeps_the_clearance_and_its_heights(tower: str) -> None:
    stands = standing(TOWERS[tower])
    plan = overview_plan(stands.site, WIDE, 0.05, ViewSpeeds())
    assert len(plan.poses) == plan.bound == 4
    assert (plan.flight.photo != NO_PHOTO).sum() == 4
    places = flown_places(plan.flight, 0.5)
    assert to_triangles_m(places, stands.solid.triangles).min() >= stands.clearance_m
    assert places[:, 2].min() >= MIN_HEIGHT_M and places[:, 2].max() <= MAX_HEIGHT_M
    assert not stands.keep_out.meets(plan.flight.position[:-1], plan.flight.position[1:]).any()
    assert plan.coverage.share > 0.3, "each side of it is in a photo"


def test_where_heights_are_low_it_looks_up() -> None:
    stands = standing(TOWERS["lattice, 380 kV, barrel"])
    low = replace(stands.site, keep_out=replace(stands.keep_out, band=GroundBand.level(2.0, 30.0)))
    usual, lower = (overview_poses(site, flown_camera(WIDE)) for site in (stands.site, low))
    assert (usual.pitch_deg < 0.0).all()
    assert len(lower) == 4 and lower.position[:, 2].max() <= 30.0
    assert lower.pitch_deg.min() > usual.pitch_deg.min()


def test_a_gimbal_that_reaches_none_of_the_pitches_and_a_lens_that_is_too_long_have_no_photos() -> None:
    site = standing(TOWERS["lattice, 380 kV, barrel"]).site
    assert not len(overview_poses(site, replace(WIDE, gimbal=Gimbal(-90.0, -60.0))))
    assert not len(overview_poses(site, replace(WIDE, focal_lengths_mm=(400.0,))))
    assert overview_plan(site, replace(WIDE, focal_lengths_mm=(400.0,)), 0.05, ViewSpeeds()).coverage.share == 0.0
