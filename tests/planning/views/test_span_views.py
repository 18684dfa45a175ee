"""Photos of wires: both sides of each half span without a gap, as fine as asked for, clear of wires however they swing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.views.camera import Camera, Gimbal
from planning.views.detail_views import MAX_PHOTOS, TooManyPhotos
from planning.views.ground_band import GroundBand
from planning.views.keep_out import KeepOut, Obstacle, keep_out
from planning.views.limits import Limit
from planning.views.proof import flown_camera
from planning.views.solids import Component, FloatArray
from planning.views.span_views import OVERLAP, SpanPhotos, span_photos, wires_solid
from planning.views.view_flight import NO_PHOTO
from planning.views.view_plan import ViewPlan, ViewSpeeds, spans_plan
from planning.views.visibility import axes_of
from tests.cases import long
from tests.planning.views.geometry_oracle import flown_places, to_triangles_m, to_wires_m
from tests.planning.views.towers import FULL_FRAME, MAX_HEIGHT_M, MIN_HEIGHT_M, SPAN_M, TOWERS, WIDE, ZOOM, StandingTower, standing

AROUND_M = SPAN_M / 2.0 + 80.0
GSD_M = 0.008
QUICK = ("lattice, 380 kV, danube", "wooden pole, 20 kV")
NAMES = [*QUICK, *long(*(name for name in TOWERS if name not in QUICK))]


def stand(name: str, bearing_deg: float = 0.0) -> StandingTower:
    return standing(TOWERS[name], bearing_deg, around_m=AROUND_M)


def wires_of(stands: StandingTower, step_m: float = 1.0) -> FloatArray:
    """Places of the axis of both half spans between the lowest wire at its hottest and the highest, (n, 3), by formulas of this test."""
    own = stands.support
    low_m, high_m = min(hangs for _, hangs in own.arms.slots), max(own.height_m, own.likely_m)
    bearing = np.radians(own.bearing_deg)
    found = []
    for along_m in np.arange(-SPAN_M / 2.0, SPAN_M / 2.0 + step_m / 2.0, step_m):
        if abs(along_m) < 5.0:
            continue  # there the tower hides them
        from_end_m = abs(along_m)
        hottest_m = low_m - from_end_m * (SPAN_M - from_end_m) / (2.0 * 800.0)  # a parabola of a catenary constant of 800 m
        heights_m = np.arange(hottest_m, high_m, step_m)
        found.append(
            np.column_stack(
                [np.full(len(heights_m), np.sin(bearing) * along_m), np.full(len(heights_m), np.cos(bearing) * along_m), heights_m]
            )
        )
    return np.concatenate(found)


def shown_by(plan: ViewPlan, camera: Camera, points: FloatArray, across: FloatArray) -> tuple[np.ndarray, FloatArray]:
    """By how many photos each point is in the picture, (2, n), from the left and from the right of a direction; and the worst GSD [m]."""
    counts, worst_m = np.zeros((2, len(points)), dtype=int), np.zeros(len(plan.poses))
    wide, high = camera.sensor_width_mm / 2.0 / plan.lens.focal_mm, camera.sensor_height_mm / 2.0 / plan.lens.focal_mm
    for number in range(len(plan.poses)):
        right, up, forward = (own[0] for own in axes_of(plan.poses.yaw_deg[number : number + 1], plan.poses.pitch_deg[number : number + 1]))
        away = points - plan.poses.position[number]
        depth_m = away @ forward
        inside = (depth_m > 0.0) & (np.abs(away @ right) <= wide * depth_m) & (np.abs(away @ up) <= high * depth_m)
        steep = np.abs(away[:, :2] @ across) >= 0.5 * np.linalg.norm(away, axis=1)  # at most 60 degrees from the normal of the wires' plane
        side = 0 if plan.poses.position[number, :2] @ across < 0.0 else 1
        counts[side] += inside & steep
        worst_m[number] = depth_m[inside & steep].max(initial=0.0) * camera.pixel_mm / plan.lens.focal_mm
    return counts, worst_m


@pytest.mark.parametrize("camera", [ZOOM, *long(FULL_FRAME)], ids=["zoom", "full frame"])
@pytest.mark.parametrize("tower", NAMES)
def test_every_place_of_the_wires_is_in_photos_from_both_sides(tower: str, camera: Camera) -> None:
    stands = stand(tower)
    plan = spans_plan(stands.site, camera, GSD_M, ViewSpeeds())
    assert 0 < len(plan.poses) <= MAX_PHOTOS
    counts, worst_m = shown_by(plan, flown_camera(camera), wires_of(stands), np.array([1.0, 0.0]))
    assert (counts > 0).mean() == 1.0
    assert worst_m.max() <= GSD_M
    assert plan.coverage.share >= 0.99
    assert {(row.component, row.number) for row in plan.components} == {(Component.WIRES, number) for number in range(4)}
    assert all(row.gsd_m is not None and row.gsd_m <= GSD_M for row in plan.components)


@pytest.mark.long
@given(
    st.floats(0.0, 360.0), st.sampled_from(sorted(TOWERS)), st.sampled_from([0.003, 0.006, 0.01]), st.sampled_from([ZOOM, FULL_FRAME, WIDE])
)
@settings(max_examples=6, deadline=None)
def test_the_flight_keeps_the_clearance_however_the_wires_swing(bearing_deg: float, tower: str, gsd_m: float, camera: Camera) -> None:
    stands = stand(tower, bearing_deg)
    try:
        plan = spans_plan(stands.site, camera, gsd_m, ViewSpeeds())
    except TooManyPhotos:
        return
    places = flown_places(plan.flight, 1.0)
    assert to_triangles_m(places, stands.solid.triangles).min() >= stands.clearance_m
    for start, end in ((0, 1), (2, 0)):
        assert to_wires_m(places, stands.supports, start, end).min() >= stands.clearance_m
    if len(plan.poses):
        assert places[:, 2].min() >= MIN_HEIGHT_M and places[:, 2].max() <= MAX_HEIGHT_M
    assert (plan.flight.photo != NO_PHOTO).sum() == len(plan.poses)
    assert not stands.keep_out.meets(plan.flight.position[:-1], plan.flight.position[1:]).any()


def photos_of(tower: str, camera: Camera = ZOOM, gsd_m: float = GSD_M) -> SpanPhotos:
    return span_photos(stand(tower).site, flown_camera(camera), gsd_m)


def test_neighbouring_photos_overlap() -> None:
    found = photos_of("wooden pole, 20 kV")
    one_side = found.poses.position[(found.poses.position[:, 0] < 0.0) & (found.poses.position[:, 1] > 0.0)]
    width_m = found.distance_m.min() * ZOOM.sensor_width_mm / found.focal_mm
    assert len(one_side) > 3
    assert np.diff(np.sort(one_side[:, 1])).max() <= width_m * (1.0 - OVERLAP)


def test_the_shortest_lens_that_does_is_used_and_each_photo_looks_at_the_axis() -> None:
    found = photos_of("wooden pole, 20 kV", gsd_m=0.002)
    assert found.focal_mm in ZOOM.focal_lengths_mm[:-1]
    _, _, forward = axes_of(found.poses.yaw_deg, found.poses.pitch_deg)
    seen = found.poses.position + forward * found.distance_m[:, None]
    assert np.abs(seen[:, 0]).max() < 1e-6


def test_a_lens_that_is_too_coarse_outside_the_clearance_takes_none_and_says_why() -> None:
    plan = spans_plan(stand("lattice, 380 kV, danube").site, WIDE, 0.002, ViewSpeeds())
    assert not len(plan.poses)
    assert {row.limit for row in plan.components} == {Limit.DISTANCE}
    assert all(row.shown == 0.0 for row in plan.components)


def test_what_takes_too_many_photos_is_refused_at_once() -> None:
    with pytest.raises(TooManyPhotos):
        photos_of("lattice, 380 kV, barrel", gsd_m=0.0015, camera=replace(ZOOM, focal_lengths_mm=(60.0,)))
    narrow = replace(ZOOM, pixels_wide=2, pixels_high=2, sensor_width_mm=4.8, focal_lengths_mm=(300.0,))  # a picture of half a metre
    with pytest.raises(TooManyPhotos):
        photos_of("lattice, 380 kV, barrel", gsd_m=0.25, camera=narrow)


def test_a_camera_that_is_too_coarse_even_at_the_clearance_takes_none_however_many_it_would_be() -> None:
    thermal = replace(WIDE, pixels_wide=640, pixels_high=480)
    assert not len(photos_of("lattice, 380 kV, barrel", thermal, gsd_m=0.002).poses)


def test_wires_are_looked_for_above_the_ground() -> None:
    site = stand("wooden pole, 20 kV").site
    long_span = replace(site.bands[0].span, end=(0.0, 1_000.0), sag_m=1_000.0**2 / (8.0 * 800.0))
    corners = wires_solid(replace(site, bands=(replace(site.bands[0], span=long_span),))).triangles
    assert corners[..., 2].min() >= 4.0


def test_where_the_least_height_is_great_photos_look_down_from_there() -> None:
    stands = stand("tubular, 110 kV, alternating")
    site = replace(stands.site, keep_out=replace(stands.keep_out, band=GroundBand.level(45.0, MAX_HEIGHT_M)))
    usual, higher = (span_photos(own, flown_camera(FULL_FRAME), 0.01) for own in (stands.site, site))
    assert len(higher.poses) and higher.poses.position[:, 2].min() >= 45.0 > usual.poses.position[:, 2].min()
    assert higher.poses.pitch_deg.mean() < usual.poses.pitch_deg.mean()


def test_where_another_line_runs_beside_it_photos_are_taken_from_nearer_or_over_it() -> None:
    stands = stand("tubular, 110 kV, alternating")
    beside = Obstacle(np.array([[x, y] for x in (55.0, 75.0) for y in (-AROUND_M, AROUND_M)]), 0.0, 40.0)
    other = keep_out([beside], [], stands.clearance_m, stands.keep_out.band, AROUND_M)
    both = KeepOut(
        np.concatenate([stands.keep_out.bound, other.bound]), np.concatenate([stands.keep_out.top_m, other.top_m]), stands.keep_out.band
    )
    plan = spans_plan(replace(stands.site, keep_out=both), ZOOM, GSD_M, ViewSpeeds())
    free, barred = (plan.poses.only(side * plan.poses.position[:, 0] > 0.0) for side in (-1.0, 1.0))
    assert set(free.pitch_deg.tolist()) == {-10.0} and barred.pitch_deg.max() < -10.0
    assert np.abs(barred.position[:, 0]).max() < np.abs(free.position[:, 0]).min()
    assert plan.coverage.share >= 0.99
    assert not other.in_column(plan.poses.position).any()


def test_a_gimbal_that_does_not_reach_takes_none_and_a_tower_without_spans_has_no_wires() -> None:
    site = stand("wooden pole, 20 kV").site
    assert not len(span_photos(site, flown_camera(replace(ZOOM, gimbal=Gimbal(-90.0, -70.0))), GSD_M).poses)
    alone = replace(site, bands=())
    assert not len(span_photos(alone, flown_camera(ZOOM), GSD_M).poses)
    assert len(wires_solid(alone)) == 0
