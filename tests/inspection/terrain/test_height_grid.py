"""Heights between the posts of a grid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.terrain.heights import HeightGrid, packed, unpacked


def grid(rows, west=9.0, north=47.0, step=0.001):
    return HeightGrid(west, north, step, step, np.array(rows, dtype=np.float32))


def at(heights, *positions):
    return heights.sample(np.array(positions, dtype=np.float64)).tolist()


def test_heights_between_posts_are_bilinear():
    """10 -- 20
    |     |
    30 -- 40    the middle is 25, a quarter of the way east on the north side 12.5"""
    square = grid([[10, 20], [30, 40]])
    assert at(square, (9.0005, 46.9995), (9.00025, 47.0), (9.0, 46.9995)) == pytest.approx([25.0, 12.5, 20.0], abs=1e-3)


@given(st.floats(0, 1), st.floats(0, 1))
def test_a_plane_is_reproduced_exactly(east, south):
    x, y = np.meshgrid(np.arange(7), np.arange(5))
    plane = grid(100 + 3 * x + 5 * y)
    (height,) = at(plane, (9.0 + east * 0.006, 47.0 - south * 0.004))
    assert height == pytest.approx(100 + 3 * east * 6 + 5 * south * 4, abs=1e-3)


def test_outside_the_grid_nothing_is_known():
    square = grid([[10, 20], [30, 40]])
    assert np.isnan(at(square, (8.9999, 47.0), (9.0005, 47.0001), (9.0011, 47.0), (9.0, 46.9989))).all()


def test_beside_a_void_nothing_is_known_but_on_a_post_its_height():
    square = grid([[10, np.nan], [30, 40]])
    heights = at(square, (9.0005, 46.9995), (9.0, 47.0), (9.0, 46.9995))
    assert np.isnan(heights[0])
    assert heights[1:] == pytest.approx([10.0, 20.0], abs=1e-3)


def test_packing_is_lossless_and_unpacking_bounded():
    heights = np.array([[1.5, np.nan], [-3.25, 8_848.0]], dtype=np.float32)
    assert np.array_equal(unpacked(packed(heights), 2, 2), heights, equal_nan=True)
