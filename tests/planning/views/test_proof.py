"""What poses prove of a tower, and which are not counted."""

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from inspection.geodesy.local_frame import LocalFrame
from planning.views.limits import DetailRules
from planning.views.proof import MAX_AWAY_M, NotCounted, ProofSurface, TakenPhoto, flown_camera, proof_surface, why_not_counted
from planning.views.view_plan import ViewPlan, ViewSpeeds, detail_plan
from tests.planning.views.towers import TOWERS, ZOOM, standing

TOWER = next(name for name in TOWERS if "lattice" in name)
FRAME, BASE_M, GSD_M = LocalFrame.around(10.0, 56.0), 412.0, 0.004
THERE = TakenPhoto(10.0, 56.0, BASE_M + 20.0, 90.0, -20.0)


@cache
def planned() -> tuple[ViewPlan, ProofSurface]:
    site = standing(TOWERS[TOWER]).site
    return detail_plan(site, ZOOM, DetailRules(GSD_M), ViewSpeeds()), proof_surface(site, flown_camera(ZOOM), GSD_M)


def photos_of(plan: ViewPlan) -> list[TakenPhoto]:
    places = FRAME.to_degrees(plan.poses.position[:, :2]).tolist()
    return [
        TakenPhoto(lon, lat, height_m + BASE_M, yaw_deg, pitch_deg)
        for (lon, lat), height_m, yaw_deg, pitch_deg in zip(
            places, plan.poses.position[:, 2].tolist(), plan.poses.yaw_deg.tolist(), plan.poses.pitch_deg.tolist(), strict=True
        )
    ]


def test_the_plans_poses_prove_what_the_plan_says() -> None:
    plan, surface = planned()
    proof = surface.proof(photos_of(plan), plan.lens.focal_mm, FRAME, BASE_M)
    assert (proof.counted, proof.not_counted) == (len(plan.poses), {})
    assert proof.coverage.share == pytest.approx(plan.coverage.share, abs=1e-3)
    for own, of_plan in zip(proof.components, plan.components, strict=True):
        assert (own.component, own.area_m2, own.limit) == (of_plan.component, of_plan.area_m2, of_plan.limit)
        assert own.shown == pytest.approx(of_plan.shown, abs=0.02)


def test_each_photo_less_shows_no_more() -> None:
    plan, surface = planned()
    photos = photos_of(plan)
    before = surface.proof(photos, plan.lens.focal_mm, FRAME, BASE_M).coverage
    while photos:
        photos.pop()
        after = surface.proof(photos, plan.lens.focal_mm, FRAME, BASE_M).coverage
        assert not (after.shown & ~before.shown).any()
        before = after
    assert not before.shown.any()


def test_without_the_height_of_the_tower_no_photo_counts() -> None:
    plan, surface = planned()
    proof = surface.proof(photos_of(plan), plan.lens.focal_mm, FRAME, None)
    assert (proof.counted, proof.not_counted) == (0, {NotCounted.HEIGHT: len(plan.poses)})


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({}, None),
        ({"roll_deg": 2.9}, None),
        ({"roll_deg": -3.1}, NotCounted.TILTED),
        ({"roll_deg": math.nan}, NotCounted.TILTED),
        ({"lon": None}, NotCounted.POSITION),
        ({"lat": 90.1}, NotCounted.POSITION),
        ({"lon": math.inf}, NotCounted.POSITION),
        ({"amsl_m": None}, NotCounted.HEIGHT),
        ({"amsl_m": -math.inf}, NotCounted.HEIGHT),
        ({"yaw_deg": None}, NotCounted.ATTITUDE),
        ({"pitch_deg": math.nan}, NotCounted.ATTITUDE),
        ({"pitch_deg": 91.0}, NotCounted.ATTITUDE),
        ({"is_taken": False, "lon": None}, NotCounted.FAILED),
    ],
)
def test_what_is_unknown_or_cannot_be_is_not_counted(changed: dict[str, Any], reason: NotCounted | None) -> None:
    assert why_not_counted(replace(THERE, **changed)) is reason


@pytest.mark.parametrize(("away_m", "counted"), [(MAX_AWAY_M - 1.0, 1), (MAX_AWAY_M + 1.0, 0)])
def test_photos_of_something_else_are_left_out(away_m: float, counted: int) -> None:
    plan, surface = planned()
    ((lon, lat),) = FRAME.to_degrees(np.array([[away_m, 0.0]])).tolist()
    proof = surface.proof([replace(THERE, lon=lon, lat=lat, amsl_m=BASE_M)], plan.lens.focal_mm, FRAME, BASE_M)
    assert (proof.counted, proof.not_counted.get(NotCounted.FAR, 0)) == (counted, 1 - counted)
