"""Places on lines, stretches between them, and parts of about one length."""

import itertools
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat, distance_m, path_length_m
from inspection.geodesy.stretches import (
    MAX_PARTS,
    nearest_on_line,
    newest_along,
    parts_of_line,
    place_along,
    stretch_between,
    vertex_lengths_m,
)

LINE = np.array([[10.0, 56.0], [10.01, 56.0], [10.01, 56.01], [10.03, 56.01]])


def test_a_point_beside_a_line_is_put_on_it() -> None:
    place = nearest_on_line(LINE, LonLat(10.004, 56.001))
    assert place.position == pytest.approx((10.004, 56.0), abs=1e-9)
    assert place.distance_m == pytest.approx(111.3, abs=0.3)
    assert (place.segment, place.share) == (0, pytest.approx(0.4, abs=1e-9))


def test_a_stretch_runs_in_the_lines_direction_whichever_end_is_named_first() -> None:
    first, second = nearest_on_line(LINE, LonLat(10.02, 56.01)), nearest_on_line(LINE, LonLat(10.005, 56.0))
    forward, backward = stretch_between(LINE, second, first), stretch_between(LINE, first, second)
    assert forward == backward
    assert forward[1:-1] == ((10.01, 56.0), (10.01, 56.01))


def test_a_stretch_from_vertex_to_vertex_repeats_no_point() -> None:
    ends = nearest_on_line(LINE, LonLat(10.01, 56.0)), nearest_on_line(LINE, LonLat(10.01, 56.01))
    assert stretch_between(LINE, *ends) == ((10.01, 56.0), (10.01, 56.01))


def test_both_ends_at_one_place_leave_a_single_point() -> None:
    place = nearest_on_line(LINE, LonLat(10.005, 56.0))
    assert len(stretch_between(LINE, place, place)) == 1


@given(lon=st.floats(9.99, 10.04), lat=st.floats(55.99, 56.02))
def test_no_sample_of_the_line_is_nearer_than_the_place_found(lon: float, lat: float) -> None:
    place = nearest_on_line(LINE, LonLat(lon, lat))
    share = np.linspace(0, 1, 50)[:, None]
    samples = np.concatenate([start + share * (end - start) for start, end in itertools.pairwise(LINE)])
    nearest_m = distance_m(np.broadcast_to([lon, lat], samples.shape), samples).min()
    assert place.distance_m <= nearest_m * 1.002 + 0.01


STRAIGHT = np.array([[10.0 + 0.004 * number, 56.0] for number in range(41)])  # 40 spans of 250 m


def test_a_line_is_cut_at_its_vertices_into_parts_of_about_the_length() -> None:
    parts = parts_of_line(STRAIGHT, 1_000.0)
    assert len(parts) == 10
    assert {round(part.length_m) for part in parts} == {998}
    assert all(one.end == other.start and one.to_m == other.from_m for one, other in pairwise(parts))
    assert (parts[0].start, parts[-1].end) == ((10.0, 56.0), (10.16, 56.0))
    assert parts[-1].to_m == pytest.approx(path_length_m(STRAIGHT))


def test_it_is_cut_where_the_supports_are() -> None:
    parts = parts_of_line(STRAIGHT, 1_000.0, at=[0, 7, 21, 40])
    ends = [part.end.lon for part in parts]
    assert len(ends) == 10
    assert ends[0] == pytest.approx(10.016)  # no support is near
    assert ends[1] == pytest.approx(10.028) and ends[4] == pytest.approx(10.084)


def test_it_is_cut_where_it_goes_straight_on_rather_than_at_a_bend() -> None:
    bends = {4, 12, 20}  # spans of 250 m, and a bend where each fourth part would end
    north = np.cumsum([0.0, *(0.0005 if number % 8 >= 4 else 0.0 for number in range(40))])
    zigzag = np.column_stack([10.0 + 0.004 * np.arange(41), 56.0 + north])
    ends = {round((part.end.lon - 10.0) / 0.004) for part in parts_of_line(zigzag, 1_000.0)[:-1]}
    assert len(ends) == 9 and not ends & bends
    every = np.column_stack([zigzag[:, 0], 56.0 + 0.0005 * (np.arange(41) % 2)])
    assert [round((part.end.lon - 10.0) / 0.004) for part in parts_of_line(every, 1_000.0)[:-1]] == list(range(4, 40, 4))


def test_a_stretch_is_cut_between_its_ends_alone() -> None:
    ends = nearest_on_line(STRAIGHT, LonLat(10.061, 56.0)), nearest_on_line(STRAIGHT, LonLat(10.021, 56.0))
    parts = parts_of_line(STRAIGHT, 1_000.0, ends=ends)
    assert len(parts) == 2
    assert (parts[0].start.lon, parts[-1].end.lon) == pytest.approx((10.021, 10.061))
    assert sum(part.length_m for part in parts) == pytest.approx(0.04 / 0.004 * 249.5, rel=1e-3)


def test_a_short_line_and_one_without_a_vertex_stay_whole() -> None:
    assert len(parts_of_line(STRAIGHT[:5], 1_000.0)) == 1
    assert len(parts_of_line(STRAIGHT[[0, 40]], 1_000.0)) == 1


def test_a_long_line_has_longer_parts() -> None:
    assert len(parts_of_line(STRAIGHT, 250.0)) == MAX_PARTS


def test_a_line_that_ends_where_it_begins_stays_whole_as_its_ends_could_mean_another_part() -> None:
    ring = np.array([[10.0, 56.0], [10.02, 56.0], [10.02, 56.01], [10.0, 56.01], [10.0, 56.0]])
    [whole] = parts_of_line(ring, 500.0)
    assert whole.length_m == pytest.approx(path_length_m(ring))


@given(
    steps=st.lists(st.tuples(st.floats(-0.02, 0.02), st.floats(-0.02, 0.02)), min_size=1, max_size=40),
    part_m=st.floats(100.0, 5_000.0),
)
def test_each_part_is_found_again_by_its_ends_and_together_they_are_the_line(steps: list[tuple[float, float]], part_m: float) -> None:
    line = np.array([10.0, 56.0]) + np.concatenate([[[0.0, 0.0]], np.cumsum(np.array(steps), axis=0)])
    parts = parts_of_line(line, part_m)
    if len(parts) == 1:
        return
    found = [stretch_between(line, nearest_on_line(line, part.start), nearest_on_line(line, part.end)) for part in parts]
    joined = [place for number, course in enumerate(found) for place in course[1 if number else 0 :]]
    # Both are one line; a vertex that repeats the one before is left out of courses.
    distinct = [place for number, place in enumerate(map(tuple, line.tolist())) if number == 0 or place != tuple(line[number - 1])]
    assert np.allclose(joined, distinct, atol=1e-6)


def test_the_newest_part_is_on_top_and_what_none_covers_stays() -> None:
    assert newest_along([], 100.0) == [(0.0, 100.0, None)]
    assert newest_along([(10.0, 60.0), (80.0, 40.0)], 100.0) == [(0.0, 10.0, None), (10.0, 40.0, 0), (40.0, 80.0, 1), (80.0, 100.0, None)]
    assert newest_along([(0.0, 100.0), (40.0, 60.0), (-5.0, 200.0)], 100.0) == [(0.0, 100.0, 2)]
    assert newest_along([(0.05, 50.0)], 100.0) == [(0.0, 50.0, 0), (50.0, 100.0, None)]
    assert newest_along([(0.0, 0.0)], 0.0) == [(0.0, 0.0, 0)]
    assert newest_along([(0.0, 50.0), (50.05, 100.0)], 100.0) == [(0.0, 50.05, 0), (50.05, 100.0, 1)]


@given(parts=st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), max_size=12))
def test_each_place_has_its_newest_part(parts: list[tuple[int, int]]) -> None:
    pieces = newest_along(parts, 60.0)
    assert pieces[0][0] == 0.0 and pieces[-1][1] == 60.0
    assert all(one[1] == other[0] and one[2] != other[2] for one, other in pairwise(pieces))
    for middle_m in np.arange(0.5, 60.0):
        [found] = [number for from_m, to_m, number in pieces if from_m < middle_m < to_m]
        assert found == max((number for number, ends in enumerate(parts) if min(ends) < middle_m < max(ends)), default=None)


def test_a_place_along_a_line_is_found_again() -> None:
    vertex_m = vertex_lengths_m(LINE)
    assert place_along(LINE, vertex_m, 0.0) == (10.0, 56.0)
    assert place_along(LINE, vertex_m, float(vertex_m[-1])) == (10.03, 56.01)
    halfway = place_along(LINE, vertex_m, float(vertex_m[1] / 2.0))
    assert halfway == pytest.approx((10.005, 56.0))
