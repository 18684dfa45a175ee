"""The keep-out: distances by voltage, columns of supports and spans, and ways that meet them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from planning.views.keep_out import SWING_DEG, ClearanceRules, KeepOut, Span, clearance_m, keep_out, vicinity_m
from tests.planning.views.geometry_oracle import to_triangles_m, to_wires_m
from tests.planning.views.towers import TOWERS, standing

places = arrays(np.float64, (2, 3), elements=st.floats(-60.0, 60.0))


@pytest.mark.parametrize(
    ("voltage_v", "limit_m"), [(10_000, 1.15), (11_000, 1.22), (110_000, 2.0), (132_000, 3.0), (380_000, 4.0), (400_000, 6.1), (None, 3.0)]
)
def test_a_voltage_between_classes_counts_as_the_next_class_up(voltage_v: int | None, limit_m: float) -> None:
    assert vicinity_m(voltage_v) == limit_m


def test_a_higher_voltage_is_never_kept_less_from() -> None:
    kept_m = [clearance_m(voltage_v, ClearanceRules()) for voltage_v in range(1_000, 1_200_000, 1_000)]
    assert kept_m == sorted(kept_m)
    assert kept_m[0] == ClearanceRules().floor_m


@settings(max_examples=200)
@given(places, st.sampled_from(sorted(TOWERS)))
def test_a_way_meets_the_keep_out_where_one_of_its_places_is_in_it(way: np.ndarray, tower: str) -> None:
    kept = standing(TOWERS[tower]).keep_out
    between = way[0] + (way[1] - way[0]) * np.linspace(0.0, 1.0, 2_000)[:, None]
    inside = bool(kept.holds(between).any())
    meets = bool(kept.meets(way[:1], way[1:])[0])
    assert meets or not inside
    deeper = KeepOut(kept.bound + 0.05, kept.top_m + 0.05)
    assert not meets or deeper.holds(between).any(), "a way that meets it comes at least near a place that is inside"


@settings(max_examples=60, deadline=None)
@given(arrays(np.float64, (40, 3), elements=st.floats(-50.0, 70.0)), st.sampled_from(sorted(TOWERS)))
def test_no_place_outside_is_nearer_than_the_clearance(points: np.ndarray, tower: str) -> None:
    stands = standing(TOWERS[tower])
    outside = points[~stands.keep_out.holds(points)]
    if not len(outside):
        return
    outside = outside[outside[:, 2] >= 0.0]
    assert (to_triangles_m(outside, stands.solid.triangles) >= stands.clearance_m - 1e-9).all()
    for span in stands.spans:
        wires = (*stands.support.arms.slots, *stands.support.arms.earth)
        # of a span that leads back, left and right change sides, as its wires do
        turned = tuple((across * (1.0 if span.end[1] > 0 else -1.0), height) for across, height in wires)
        assert (to_wires_m(outside, span, turned, SWING_DEG, 100.0) >= stands.clearance_m - 1e-6).all()


def test_a_bend_and_a_branch_bar_all_their_directions() -> None:
    spans = [Span((0.0, 0.0), end, -5.0, 5.0, 30.0, 30.0) for end in ((0.0, 200.0), (150.0, -150.0), (-200.0, 0.0))]
    kept = keep_out([], spans, 6.0)
    under = np.array([[0.0, 50.0, 5.0], [40.0, -40.0, 12.0], [-50.0, 0.0, 29.0], [0.0, 50.0, 35.9]])
    assert kept.holds(under).all()
    free = np.array([[0.0, 50.0, 36.1], [60.0, 60.0, 20.0], [-60.0, -60.0, 20.0]])
    assert not kept.holds(free).any()


def test_a_span_without_length_bars_nothing() -> None:
    assert len(keep_out([], [Span((1.0, 1.0), (1.0, 1.0), -1.0, 1.0, 10.0, 10.0)], 5.0)) == 0
