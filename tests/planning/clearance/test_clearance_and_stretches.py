"""The last look at the zones, and places on lines."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from inspection.geodesy import LonLat, distance_m
from planning.clearance.zone_clearance import RouteMeetsZone, legs_that_meet, refuse_legs_in_zones
from planning.trajectory.stretches import nearest_on_line, stretch_between
from tests.exact_geometry import segment_meets_polygon

SQUARE = shapely.box(1.0, 1.0, 2.0, 2.0)
coordinate = st.integers(-40, 40).map(lambda number: number / 8)
position = st.tuples(coordinate, coordinate)


def test_touching_a_corner_is_meeting() -> None:
    assert legs_that_meet(np.array([[0.0, 2.0], [2.0, 0.0], [3.0, 0.0]]), [SQUARE]) == [(0, 0)]


def test_a_leg_inside_a_zone_meets_it_and_one_in_its_hole_does_not() -> None:
    ring = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 3, 3))
    assert legs_that_meet(np.array([[0.2, 0.2], [0.4, 0.4]]), [ring]) == [(0, 0)]
    assert legs_that_meet(np.array([[1.5, 1.5], [2.5, 2.5]]), [ring]) == []


def test_the_first_leg_on_the_way_is_named() -> None:
    with pytest.raises(RouteMeetsZone) as caught:
        refuse_legs_in_zones(np.array([[0.0, 0.0], [0.5, 0.5], [1.5, 1.5], [5.0, 1.5]]), [shapely.box(4, 1, 5, 2), SQUARE])
    assert caught.value.zone == 1
    assert caught.value.start == (0.5, 0.5)


@given(line=st.lists(position, min_size=2, max_size=5), corners=st.lists(position, min_size=3, max_size=6))
def test_it_agrees_with_exact_arithmetic(line: list[tuple[float, float]], corners: list[tuple[float, float]]) -> None:
    zone = shapely.Polygon(corners)
    if not zone.is_valid or zone.area == 0:
        return
    exact = [(leg, 0) for leg in range(len(line) - 1) if segment_meets_polygon(line[leg], line[leg + 1], [corners])]
    assert legs_that_meet(np.array(line), [zone]) == exact


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
