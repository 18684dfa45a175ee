"""Legs of routes that meet a zone."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from planning.clearance.zone_clearance import RouteMeetsZone, legs_that_meet, refuse_legs_in_zones
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
