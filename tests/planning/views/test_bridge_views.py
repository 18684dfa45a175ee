"""Photos of bridges: solids with outward faces, never under or near the bridge, and finer patches prove what was promised."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

from planning.views.coverage import coverage_of
from planning.views.detail_views import candidate_positions
from planning.views.ground_band import GroundBand
from planning.views.keep_out import ClearanceRules, Obstacle
from planning.views.limits import DetailRules, Limit, limits_of
from planning.views.proof import flown_camera, reach_m
from planning.views.site import ON_DECK_M, InspectionSite, StandingSupport, bridge_site
from planning.views.solids import Component, patches_of
from planning.views.view_plan import ViewPlan, ViewSpeeds, detail_plan, overview_plan
from planning.views.visibility import MAX_ANGLE_DEG, RayCaster
from tests.cases import long
from tests.planning.views.bridges import BRIDGES, bridge, curved, level_m, site_of, straight
from tests.planning.views.geometry_oracle import flown_places, to_triangles_m, to_wires_m
from tests.planning.views.test_overview import shares_of_frame
from tests.planning.views.towers import MAX_HEIGHT_M, MIN_HEIGHT_M, TOWERS, WIDE, ZOOM

QUICK = ("road over road, 40 m", "footbridge, 25 m")
GSD_M = 0.002
each_bridge = pytest.mark.parametrize("name", [*QUICK, *long(*(name for name in BRIDGES if name not in QUICK))])


@cache
def planned(name: str) -> tuple[InspectionSite, ViewPlan]:
    site = site_of(BRIDGES[name])
    return site, detail_plan(site, ZOOM, DetailRules(GSD_M), ViewSpeeds())


@pytest.mark.parametrize("name", BRIDGES)
def test_faces_of_the_solid_look_outwards(name: str) -> None:
    own = BRIDGES[name]
    outline, solid = shapely.union_all(own.parts), own.solid()
    patches = patches_of(solid, 2.0)
    kind = np.array([component for component, _ in solid.components])[patches.component]
    up = patches.normal[:, 2]
    assert (up[kind == Component.DECK] > 0.999).all()
    assert (up[kind == Component.UNDERSIDE] < -0.999).all()
    assert np.abs(up[np.isin(kind, [Component.FACE, Component.PIER, Component.ABUTMENT])]).max() < 1e-9
    places = patches.centre[:, :2] + 0.05 * patches.normal[:, :2]
    assert not shapely.contains_xy(outline, places[kind == Component.FACE]).any()
    assert shapely.contains_xy(outline.buffer(1e-6), places[kind == Component.ABUTMENT]).all(), "they look under the deck"
    for flat in (Component.DECK, Component.UNDERSIDE):
        assert patches.area_m2[kind == flat].sum() == pytest.approx(sum(part.area for part in own.parts), rel=1e-6)
    for number in {number for component, number in solid.components if component is Component.PIER}:
        pier = solid.components.index((Component.PIER, number))
        middle = patches.centre[patches.component == pier].mean(axis=0)
        away = patches.centre[patches.component == pier] - middle
        assert (np.einsum("pi,pi->p", away[:, :2], patches.normal[patches.component == pier, :2]) > 0.0).all()


@pytest.mark.parametrize("name", BRIDGES)
def test_the_pieces_of_the_keep_out_cover_the_outline(name: str) -> None:
    own = BRIDGES[name]
    hulls = shapely.union_all([shapely.convex_hull(shapely.MultiPoint(corners)) for corners in own.pieces()])
    assert shapely.union_all(own.parts).difference(hulls).area < 1e-6


def test_ends_are_no_part_of_the_faces() -> None:
    own = bridge([straight(60.0, 12.0)], 6.5)
    solid = own.solid()
    patches = patches_of(solid, 1.0)
    face = np.isin(patches.component, [place for place, (kind, _) in enumerate(solid.components) if kind is Component.FACE])
    assert np.abs(patches.normal[face, 0]).max() < 1e-9, "the bridge leads east"
    assert patches.area_m2[face].sum() == pytest.approx(2 * 60.0 * 1.4)


@each_bridge
def test_the_flight_keeps_the_clearance_and_is_never_under_the_bridge(name: str) -> None:
    own, (site, plan) = BRIDGES[name], planned(name)
    assert len(plan.poses)
    places = flown_places(plan.flight, 0.3)
    assert to_triangles_m(places, site.solid.triangles).min() >= site.clearance_m - 1e-6
    over = shapely.contains_xy(shapely.union_all(own.parts).buffer(site.clearance_m - 0.01), places[:, :2])
    assert (places[over, 2] >= max(own.deck_m + ON_DECK_M, own.top_m) + site.clearance_m - 1e-6).all()
    over_ground_m = places[:, 2] - own.ground_m(places[:, :2])
    assert over_ground_m.min() >= MIN_HEIGHT_M - 1e-6
    assert over_ground_m.max() <= MAX_HEIGHT_M + 1e-6
    assert plan.poses.pitch_deg.min() >= flown_camera(ZOOM).gimbal.pitch_min_deg
    assert plan.poses.pitch_deg.max() <= ZOOM.gimbal.pitch_max_deg


@each_bridge
def test_finer_patches_prove_what_the_plan_promises(name: str) -> None:
    site, plan = planned(name)
    camera = flown_camera(ZOOM)
    patches, caster = patches_of(site.solid, 0.8), RayCaster([site.solid])
    limits = limits_of(patches, site.keep_out, caster, camera, reach_m(camera, GSD_M))
    coverage = coverage_of(plan.poses, plan.lens, camera, patches, caster, limits.limit)
    assert coverage.share >= 0.95
    assert coverage.gsd_m[coverage.shown].max() <= GSD_M + 1e-12
    assert coverage.angle_deg[coverage.shown].max() <= MAX_ANGLE_DEG + 1e-6
    assert plan.bound <= len(plan.poses) <= 1.3 * plan.bound + 1.0
    kinds = {row.component for row in plan.components if row.reachable > 0.9}
    assert {Component.DECK, Component.FACE} <= kinds


def test_the_underside_of_a_low_bridge_is_said_to_be_out_of_reach_and_of_a_high_one_is_shown() -> None:
    low = next(row for row in planned(QUICK[0])[1].components if row.component is Component.UNDERSIDE)
    assert (low.shown, low.reachable, low.limit) == (0.0, 0.0, Limit.HEIGHT)
    high = detail_plan(site_of(bridge([straight(25.0, 6.0)], 20.0)), ZOOM, DetailRules(0.004), ViewSpeeds())
    under = next(row for row in high.components if row.component is Component.UNDERSIDE)
    assert under.shown > 0.8


def test_a_line_beside_the_bridge_is_kept_clear_of() -> None:
    own = TOWERS["lattice, 110 kV, triangle"]
    supports = [StandingSupport(replace(own, bearing_deg=90.0), place, 22.0) for place in (-120.0, 150.0)]
    site = site_of(BRIDGES["road over road, 40 m"], supports, [(0, 1)])
    plan = detail_plan(site, ZOOM, DetailRules(0.004), ViewSpeeds())
    assert to_wires_m(flown_places(plan.flight, 0.3), supports, 0, 1).min() >= site.clearance_m - 0.01


def test_a_bridge_beside_it_is_kept_clear_of() -> None:
    beside = Obstacle(np.array([[-30.0, 20.0], [30.0, 20.0], [30.0, 30.0], [-30.0, 30.0]]), 0.0, 30.0)
    own = bridge([straight(40.0, 12.0)], 6.5)
    plain = site_of(own)
    site = bridge_site(own, [], [], ClearanceRules(), GroundBand.level(MIN_HEIGHT_M, MAX_HEIGHT_M), [beside])
    place = np.array([[0.0, 16.0, 8.0]])
    assert not plain.keep_out.holds(place).any()
    assert site.keep_out.holds(place).all()


def test_an_overview_has_the_whole_bridge_in_each_photo() -> None:
    for name in ("skewed, 60 m", "curved viaduct, 150 m"):
        site = site_of(BRIDGES[name])
        assert len(overview_plan(site, WIDE, 0.05, ViewSpeeds()).poses) == 4
        assert (shares_of_frame(site, WIDE) <= 0.901).all()


def test_a_bridge_of_any_outline_has_places_around_it() -> None:
    """A closed bend, whose middle is beside its outline, one with a hole, and a square."""
    bend = curved(30.0, 200.0, 8.0)
    ring = shapely.Polygon(straight(50.0, 30.0).exterior.coords, [straight(30.0, 10.0).exterior.coords])
    for outline in (bend, ring, straight(12.0, 12.0)):
        own = bridge([outline], 9.0, level_m)
        site = site_of(own)
        assert len(candidate_positions(site, 40.0)) > 50
        assert shapely.union_all([shapely.convex_hull(shapely.MultiPoint(piece)) for piece in own.pieces()]).covers(outline.buffer(-0.01))
        assert len(overview_plan(site, WIDE, 0.05, ViewSpeeds()).poses)
