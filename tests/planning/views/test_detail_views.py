"""Photos of whole towers: clear of wires, within the camera's limits, of nearly all that can be shown, and proven by other means."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from planning.views.camera import Camera, Gimbal, standoff_m
from planning.views.coverage import Coverage, by_component, coverage_of
from planning.views.detail_views import MAX_CANDIDATES, DetailViews, TooManyPhotos, detail_views, reach_m
from planning.views.ground_band import GroundBand
from planning.views.keep_out import KeepOut
from planning.views.limits import LIMITS, DetailRules, Limit, limits_of
from planning.views.solids import Component, patches_of
from planning.views.view_flight import NO_PHOTO, NoWay, ViewFlight, view_flight
from planning.views.visibility import MAX_ANGLE_DEG, RayCaster, axes_of
from tests.planning.views.geometry_oracle import first_hit, flown_places, to_triangles_m, to_wires_m
from tests.planning.views.towers import FULL_FRAME, MAX_HEIGHT_M, MIN_HEIGHT_M, TOWERS, WIDE, ZOOM, StandingTower, standing

CASES = [
    ("lattice, 380 kV, barrel", ZOOM, 0.002),
    ("lattice, 110 kV, triangle", FULL_FRAME, 0.004),
    ("guyed, 220 kV, one level", FULL_FRAME, 0.004),
    ("H-frame, 66 kV, anchor", WIDE, 0.006),
    ("wooden pole, 20 kV", ZOOM, 0.002),
]
QUICK = CASES[1], CASES[4]
FRAME_PIXELS = (1600, 1200)  # of rendered pictures

each_case = pytest.mark.parametrize(
    ("tower", "camera", "gsd_m"),
    [pytest.param(*case, marks=() if case in QUICK else pytest.mark.long, id=f"{case[0]}, {case[1].name}") for case in CASES],
)


@cache
def planned(tower: str, camera: Camera, gsd_m: float) -> DetailViews:
    stands = standing(TOWERS[tower])
    return detail_views(stands.site, camera, DetailRules(gsd_m))


@cache
def proven(tower: str, camera: Camera, gsd_m: float, patch_m: float = 0.8) -> Coverage:
    stands, views = standing(TOWERS[tower]), planned(tower, camera, gsd_m)
    patches, caster = patches_of(stands.solid, patch_m), RayCaster([stands.solid])
    farthest_m = reach_m(camera, gsd_m)
    limits = limits_of(patches, stands.keep_out, caster, camera, farthest_m)
    return coverage_of(views.poses, views.lens, camera, patches, caster, limits.limit)


@each_case
def test_poses_keep_clear_and_within_what_gimbal_and_heights_allow(tower: str, camera: Camera, gsd_m: float) -> None:
    stands, poses = standing(TOWERS[tower]), planned(tower, camera, gsd_m).poses
    assert len(poses)
    assert not stands.keep_out.holds(poses.position).any()
    assert poses.pitch_deg.min() >= camera.gimbal.pitch_min_deg
    assert poses.pitch_deg.max() <= camera.gimbal.pitch_max_deg
    assert poses.position[:, 2].min() >= MIN_HEIGHT_M
    assert poses.position[:, 2].max() <= MAX_HEIGHT_M


@each_case
def test_finer_patches_prove_what_the_plan_promises(tower: str, camera: Camera, gsd_m: float) -> None:
    coverage, views = proven(tower, camera, gsd_m), planned(tower, camera, gsd_m)
    assert coverage.share >= 0.95
    assert coverage.gsd_m[coverage.shown].max() <= gsd_m + 1e-12
    assert coverage.angle_deg[coverage.shown].max() <= MAX_ANGLE_DEG + 1e-6
    assert views.bound <= len(views.poses) <= 1.3 * views.bound + 1.0
    reached = coverage.patches.area_m2[coverage.limit == 0].sum() / coverage.patches.area_m2.sum()
    assert reached > 0.8, "nearly all of a tower can be photographed with these lenses"


def keeps_clear(stands: StandingTower, flight: ViewFlight) -> None:
    places = flown_places(flight, 0.3)  # 0.1 s at 3 m/s
    assert to_triangles_m(places, stands.solid.triangles).min() >= stands.clearance_m - 1e-6
    for start, end in ((0, 1), (2, 0)):
        assert to_wires_m(places, stands.supports, start, end).min() >= stands.clearance_m - 0.01


@each_case
def test_the_flight_keeps_the_clearance_from_structures_and_swinging_wires(tower: str, camera: Camera, gsd_m: float) -> None:
    stands, views = standing(TOWERS[tower]), planned(tower, camera, gsd_m)
    flight = view_flight(views.poses, stands.keep_out, stands.entry, stands.entry)
    assert sorted(flight.photo[flight.photo != NO_PHOTO].tolist()) == list(range(len(views.poses)))
    np.testing.assert_array_equal(flight.position[flight.photo != NO_PHOTO], views.poses.position[flight.photo[flight.photo != NO_PHOTO]])
    np.testing.assert_array_equal(flight.position[[0, -1]], [stands.entry, stands.entry])
    keeps_clear(stands, flight)
    assert flight.position[:, 2].max() <= MAX_HEIGHT_M


@pytest.mark.long
@pytest.mark.parametrize("bearing_deg", [0.0, 75.0])
def test_over_hills_no_part_of_a_flight_is_too_low_or_too_high(bearing_deg: float) -> None:
    def hills_m(at: np.ndarray) -> np.ndarray:
        def knoll_m(east: float, north: float) -> np.ndarray:
            return 25.0 * np.exp(-((at[:, 0] - east) ** 2 + (at[:, 1] - north) ** 2) / 400.0)

        return knoll_m(35.0, 20.0) + knoll_m(-40.0, -10.0) + 0.2 * at[:, 1]

    stands = standing(TOWERS["lattice, 110 kV, triangle"], bearing_deg, lambda at: hills_m(at) - hills_m(np.zeros((1, 2))))
    views = detail_views(stands.site, ZOOM, DetailRules(0.002))
    flight = view_flight(views.poses, stands.keep_out, stands.entry, stands.entry)
    places = flown_places(flight, 0.3)
    over_m = places[:, 2] - hills_m(places[:, :2]) + hills_m(np.zeros((1, 2)))
    assert over_m.min() >= MIN_HEIGHT_M - 0.1
    assert over_m.max() <= MAX_HEIGHT_M
    keeps_clear(stands, flight)


def test_a_flight_that_would_lead_above_the_limit_is_refused() -> None:
    stands, views = standing(TOWERS["lattice, 380 kV, barrel"]), planned(*CASES[0])
    low = KeepOut(stands.keep_out.bound, stands.keep_out.top_m, GroundBand.level(MIN_HEIGHT_M, 62.0))
    with pytest.raises(NoWay):
        view_flight(views.poses, low, views.poses.position[0])
    with pytest.raises(NoWay):
        view_flight(views.poses, stands.keep_out, np.array([0.0, 0.0, 130.0]))


@pytest.mark.long
def test_hostile_cameras_are_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    stands = standing(TOWERS["lattice, 380 kV, barrel"])
    tiny = Camera("tiny", 6.4, 4.8, 320, 240, (400.0,))
    with pytest.raises(TooManyPhotos):
        detail_views(stands.site, tiny, DetailRules(0.002))
    narrow = Camera("narrow", 6.4, 4.8, 8000, 6000, (500.0,))
    monkeypatch.setattr("planning.views.detail_views.MAX_PHOTOS", 1_000)
    assert detail_views(stands.site, narrow, DetailRules(0.1)).candidates <= MAX_CANDIDATES + 1_000


@pytest.mark.long
def test_more_photos_than_the_limit_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    tower, camera, gsd_m = CASES[4]
    needed, stands = len(planned(tower, camera, gsd_m).poses), standing(TOWERS[tower])
    monkeypatch.setattr("planning.views.detail_views.MAX_PHOTOS", needed - 1)
    with pytest.raises(TooManyPhotos):
        detail_views(stands.site, camera, DetailRules(gsd_m))


@pytest.mark.long
@pytest.mark.parametrize(("tower", "camera", "gsd_m", "patch_m"), [(*CASES[1], 0.25), (*CASES[4], 0.08)], ids=["lattice", "pole"])
def test_coverage_equals_that_of_rendered_pictures_in_which_each_face_has_its_number(
    tower: str, camera: Camera, gsd_m: float, patch_m: float
) -> None:
    views, coverage = planned(tower, camera, gsd_m), proven(tower, camera, gsd_m, patch_m)
    patches = coverage.patches
    scene = EmbreeScene()
    mesh = TriangleMesh(scene, patches.corners.astype(np.float32))
    assert mesh is not None, "kept as long as the scene"
    drawn = np.zeros(len(patches), dtype=bool)
    right, up, forward = axes_of(views.poses.yaw_deg, views.poses.pitch_deg)
    wide, high = FRAME_PIXELS
    columns = (np.arange(wide) + 0.5) / wide * 2.0 - 1.0
    lines = (np.arange(high) + 0.5) / high * 2.0 - 1.0
    across = columns * camera.sensor_width_mm / (2.0 * views.lens.focal_mm)
    upward = lines * camera.sensor_height_mm / (2.0 * views.lens.focal_mm)
    for number, position in enumerate(views.poses.position):
        rays = forward[number] + across[None, :, None] * right[number] + upward[:, None, None] * up[number]
        rays = rays.reshape(-1, 3)
        start = np.broadcast_to(position, rays.shape)
        which = np.asarray(scene.run(start.astype(np.float32), rays.astype(np.float32)))
        depth_m = np.einsum("ri,i->r", patches.centre[which] - position, forward[number])
        cosine = -np.einsum("ri,ri->r", rays, patches.normal[which]) / np.linalg.norm(rays, axis=1)
        fine = (which >= 0) & (depth_m <= views.lens.farthest_m) & (cosine >= np.cos(np.radians(MAX_ANGLE_DEG)))
        drawn[which[fine]] = True
    area_m2 = patches.area_m2
    assert area_m2[drawn].sum() / area_m2.sum() == pytest.approx(area_m2[coverage.shown].sum() / area_m2.sum(), abs=0.02)


def test_rays_meet_what_plain_formulas_say_they_meet() -> None:
    solid = standing(TOWERS["lattice, 110 kV, flag, anchor"]).solid
    random = np.random.default_rng(4)
    start = random.uniform((-30.0, -30.0, 0.0), (30.0, 30.0, 40.0), (3_000, 3))
    end = random.uniform((-8.0, -3.0, 0.0), (8.0, 3.0, 28.0), (3_000, 3))
    _, distance_m = first_hit(start, end - start, solid.triangles)
    surely = np.abs(distance_m - 1.0) > 1e-4
    np.testing.assert_array_equal(RayCaster([solid]).is_free(start, end)[surely], distance_m[surely] > 1.0)


def test_what_cannot_be_shown_has_its_reason() -> None:
    tower, camera, _ = CASES[0]
    stands = standing(TOWERS[tower])
    patches, caster = patches_of(stands.solid, 2.0), RayCaster([stands.solid])

    def limits(camera: Camera, kept: KeepOut = stands.keep_out) -> set[Limit]:
        farthest_m = standoff_m(camera, 0.002, camera.focal_lengths_mm[-1])
        return {LIMITS[own] for own in limits_of(patches, kept, caster, camera, farthest_m).limit.tolist()}

    assert limits(WIDE) == {Limit.HIDDEN, Limit.DISTANCE, Limit.HEIGHT}, "its lens is too wide for 2 mm from outside"
    level = Camera("level", 6.4, 4.8, 8000, 6000, (28.4,), gimbal=Gimbal(-5.0, 5.0))
    assert Limit.GIMBAL in limits(level)
    assert Limit.NONE not in limits(replace(ZOOM, nearest_focus_m=100.0)), "it is sharp from 100 m, and fine enough up to 71 m"
    high = KeepOut(stands.keep_out.bound, stands.keep_out.top_m, GroundBand.level(40.0, MAX_HEIGHT_M))
    assert Limit.HEIGHT in limits(camera, high)


@pytest.mark.long
def test_a_camera_that_shows_nothing_gets_no_photo_and_no_error() -> None:
    stands = standing(TOWERS["lattice, 765 kV, delta"])
    views = detail_views(stands.site, WIDE, DetailRules(0.003))
    assert len(views.poses) == 0
    assert views.bound == 0


def test_components_add_up_to_the_whole() -> None:
    coverage, stands = proven(*CASES[0]), standing(TOWERS[CASES[0][0]])
    rows = by_component(stands.solid, coverage)
    assert sum(row.area_m2 for row in rows) == pytest.approx(coverage.patches.area_m2.sum())
    assert sum(row.area_m2 * row.shown for row in rows) == pytest.approx(coverage.patches.area_m2[coverage.shown].sum())
    strings = [row for row in rows if row.component is Component.STRING]
    assert [row.number for row in strings] == list(range(6))
    assert all(row.shown <= row.reachable and (row.gsd_m or 0.0) <= 0.002 for row in rows)
