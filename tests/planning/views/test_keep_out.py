"""The keep-out: distances by voltage, columns of supports and spans, and ways that meet them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from planning.views.ground_band import GroundBand
from planning.views.keep_out import ClearanceRules, KeepOut, Obstacle, Span, clearance_m, keep_out, vicinity_m
from planning.views.site import StandingSupport, tower_site
from tests.planning.views.geometry_oracle import to_triangles_m, to_wires_m
from tests.planning.views.towers import MAX_HEIGHT_M, MIN_HEIGHT_M, TOWERS, standing

LEVEL = GroundBand.level(MIN_HEIGHT_M, MAX_HEIGHT_M)
places = arrays(np.float64, (2, 3), elements=st.floats(-60.0, 60.0))


@pytest.mark.parametrize(
    ("voltage_v", "limit_m"), [(10_000, 1.15), (11_000, 1.22), (110_000, 2.0), (132_000, 3.0), (380_000, 4.0), (400_000, 6.1), (None, 3.0)]
)
def test_a_voltage_between_classes_counts_as_the_next_class_up(voltage_v: int | None, limit_m: float) -> None:
    assert vicinity_m(voltage_v) == limit_m


def test_a_higher_voltage_is_never_kept_less_from() -> None:
    kept_m = [clearance_m(voltage_v, ClearanceRules()) for voltage_v in range(1_000, 1_200_000, 1_000)]
    assert kept_m == sorted(kept_m)
    assert kept_m[0] >= ClearanceRules().floor_m
    assert clearance_m(10_000, ClearanceRules(floor_m=30.0)) == 30.0


@settings(max_examples=100)
@given(places, st.sampled_from(sorted(TOWERS)), st.sampled_from([0.0, 40.0, 200.0]))
def test_a_way_meets_the_keep_out_where_one_of_its_places_is_in_it(way: np.ndarray, tower: str, bearing_deg: float) -> None:
    kept = standing(TOWERS[tower], bearing_deg).keep_out
    between = way[0] + (way[1] - way[0]) * np.linspace(0.0, 1.0, 2_000)[:, None]
    inside = bool(kept.holds(between).any())
    meets = bool(kept.meets(way[:1], way[1:])[0])
    assert meets or not inside
    deeper = KeepOut(kept.bound + 0.05, kept.top_m + 0.05, kept.band)
    assert not meets or deeper.holds(between).any(), "a way that meets it comes at least near a place that is inside"


@settings(max_examples=60, deadline=None)
@given(
    arrays(np.float64, (60, 3), elements=st.floats(-120.0, 120.0)),
    st.sampled_from(sorted(TOWERS)),
    st.floats(0.0, 360.0),
    st.floats(-0.4, 0.4),
)
def test_no_place_outside_is_nearer_than_the_clearance(points: np.ndarray, tower: str, bearing_deg: float, slope: float) -> None:
    stands = standing(TOWERS[tower], bearing_deg, lambda at: slope * at[:, 0])
    points[:, 2] = np.abs(points[:, 2]) + slope * points[:, 0]
    outside = points[~stands.keep_out.holds(points)]
    if not len(outside):
        return
    assert (outside[:, 2] >= slope * outside[:, 0] + MIN_HEIGHT_M).all()
    assert (outside[:, 2] <= slope * outside[:, 0] + MAX_HEIGHT_M).all()
    assert (to_triangles_m(outside, stands.solid.triangles) >= stands.clearance_m - 1e-9).all()
    for start, end in ((0, 1), (2, 0)):
        assert (to_wires_m(outside, stands.supports, start, end) >= stands.clearance_m - 0.01).all()


def test_wires_are_kept_clear_of_far_from_their_supports() -> None:
    """A line beside the tower, whose supports stand 200 m away on both sides."""
    own = TOWERS["lattice, 110 kV, triangle"]
    supports = [StandingSupport(own, 0.0, 0.0), StandingSupport(own, 25.0, -200.0), StandingSupport(own, 25.0, 200.0)]
    site = tower_site(supports, [(1, 2)], ClearanceRules(), LEVEL)
    assert site.keep_out.holds(np.array([[25.0, 0.0, 20.0], [20.0, 30.0, 10.0], [30.0, -60.0, 25.0]])).all()
    east, north, up = np.meshgrid(np.arange(5.0, 45.0), (-60.0, 0.0, 30.0), (5.0, 12.0, 20.0, 35.0))
    around = np.column_stack([east.ravel(), north.ravel(), up.ravel()])
    outside = around[~site.keep_out.holds(around)]
    assert (to_wires_m(outside, supports, 1, 2) >= site.clearance_m - 0.01).all()


def test_a_support_of_unknown_height_is_kept_clear_of_as_high_as_planners_count_it() -> None:
    pole = replace(TOWERS["wooden pole, 20 kV"], height_m=45.0, height_source="assumed")
    site = tower_site([StandingSupport(pole, 0.0, 0.0)], [], ClearanceRules(), LEVEL)
    assert site.keep_out.holds(np.array([[0.0, 0.0, 44.0]])).all()
    assert site.solid.box[1][2] < 13.0, "its photos are planned as high as it likely is"


def test_other_things_on_the_map_are_kept_clear_of() -> None:
    track = Obstacle(np.array([[20.0, -200.0], [20.0, 200.0]]), 6.0, 8.0)
    kept = tower_site([StandingSupport(TOWERS["wooden pole, 20 kV"], 0.0, 0.0)], [], ClearanceRules(), LEVEL, [track]).keep_out
    assert kept.holds(np.array([[20.0, 0.0, 9.0], [15.0, 90.0, 5.0]])).all()
    assert not kept.holds(np.array([[20.0, 60.0, 20.0], [35.0, 0.0, 5.0]])).any()


def test_unknown_ground_counts_as_the_highest_from_below_and_the_lowest_from_above() -> None:
    band = GroundBand.over(lambda at: np.where(at[:, 0] > 50.0, np.nan, np.where(at[:, 0] < -50.0, 30.0, -10.0)), 4.0, 120.0)
    heights_m = np.array([33.0, 35.0, 109.0, 111.0])
    points = np.column_stack([np.full(4, 80.0), np.zeros(4), heights_m])
    assert band.leaves_out(points).tolist() == [True, False, False, True]


@given(arrays(np.float64, (2, 3), elements=st.floats(-100.0, 100.0)), st.integers(0, 100))
def test_a_way_through_the_ground_is_seen(way: np.ndarray, seed: int) -> None:
    waves = np.random.default_rng(seed).uniform(-0.08, 0.08, (3, 2))

    def ground_m(at: np.ndarray) -> np.ndarray:
        return 12.0 * np.sin(at @ waves.T).sum(axis=1)

    band = GroundBand.over(ground_m, 4.0, 120.0)
    between = way[0] + (way[1] - way[0]) * np.linspace(0.0, 1.0, 400)[:, None]
    over_m = between[:, 2] - ground_m(between[:, :2])
    assert band.left_between(way[:1], way[1:])[0] or (over_m.min() >= 3.5 and over_m.max() <= 120.5)


def test_a_bend_and_a_branch_bar_all_their_directions() -> None:
    spans = [Span((0.0, 0.0), end, -5.0, 5.0, 30.0, 30.0) for end in ((0.0, 200.0), (150.0, -150.0), (-200.0, 0.0))]
    kept = keep_out([], spans, 6.0, LEVEL)
    under = np.array([[0.0, 50.0, 5.0], [40.0, -40.0, 12.0], [-50.0, 0.0, 29.0], [0.0, 50.0, 35.9]])
    assert kept.holds(under).all()
    free = np.array([[0.0, 50.0, 36.1], [60.0, 60.0, 20.0], [-60.0, -60.0, 20.0]])
    assert not kept.holds(free).any()


def test_a_span_without_length_bars_nothing() -> None:
    assert len(keep_out([], [Span((1.0, 1.0), (1.0, 1.0), -1.0, 1.0, 10.0, 10.0)], 5.0, LEVEL)) == 0
