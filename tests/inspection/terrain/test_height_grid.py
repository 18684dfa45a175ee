"""Heights between the posts of a grid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inspection.terrain.errors import TerrainFileError
from inspection.terrain.height_grid import HeightGrid, packed, unpacked, without_voids
from inspection.terrain.hgt import read_hgt


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


def test_blocks_cover_the_grid_and_answer_as_the_whole_does():
    source = np.random.default_rng(3)
    whole = grid(source.uniform(0, 1_000, (23, 31)))
    blocks = list(whole.blocks(size=8))
    assert max(max(block.heights_m.shape) for block in blocks) <= 8
    positions = np.column_stack([source.uniform(9.0, 9.03, 500), source.uniform(46.978, 47.0, 500)])
    answers = np.array([block.sample(positions) for block in blocks])
    assert np.isfinite(answers).any(axis=0).all()
    assert np.nanmax(np.abs(answers - whole.sample(positions))) < 1e-2


def test_a_block_of_voids_alone_is_left_out():
    heights = np.full((8, 15), 5.0)
    heights[:, 8:] = np.nan
    heights[:, 7] = np.nan
    assert len(list(grid(heights).blocks(size=8))) == 1


def test_heights_that_cannot_be_are_voids():
    heights = without_voids(np.array([[-32768, -9999, 12_000, 300, 77]], dtype=np.int32), 77.0)
    assert np.isnan(heights).tolist() == [[True, True, True, False, True]]


def test_packing_is_lossless_and_unpacking_bounded():
    heights = np.array([[1.5, np.nan], [-3.25, 8_848.0]], dtype=np.float32)
    assert np.array_equal(unpacked(packed(heights), 2, 2), heights, equal_nan=True)


def test_an_hgt_file_stands_where_its_name_says(tmp_path):
    heights = np.zeros((1201, 1201), dtype=">i2")
    heights[0, 0], heights[1200, 1200], heights[0, 1] = 700, 300, -32768
    path = tmp_path / "S12W078.hgt"
    path.write_bytes(heights.tobytes())
    model = read_hgt(path)
    assert model.extent == pytest.approx((-78.0, -12.0, -77.0, -11.0))
    assert at(model, (-78.0, -11.0), (-77.0, -12.0)) == [700.0, 300.0]
    assert np.isnan(model.heights_m[0, 1])


@pytest.mark.parametrize(("name", "size"), [("N47E009.hgt", 100), ("somewhere.hgt", 1201 * 1201 * 2), ("N95E009.hgt", 1201 * 1201 * 2)])
def test_a_file_that_is_no_hgt_is_refused(name, size, tmp_path):
    path = tmp_path / name
    path.write_bytes(b"\0" * size)
    with pytest.raises(TerrainFileError):
        read_hgt(path)
