"""Windows of posts, and the blocks that a raster is stored in."""

import numpy as np

from inspection.importers.terrain.raster import PostKind, PostSurvey, Window, blocks_of, window_of


class Drawn:
    """A raster in memory."""

    def __init__(self, raw, void=-9999.0):
        self.raw = np.array(raw, dtype=np.float32)
        self.void = void
        self.height, self.width = self.raw.shape
        self.west_deg, self.north_deg, self.step_lon_deg, self.step_lat_deg = 9.0, 47.0, 0.001, 0.001

    def window(self, row, column, rows, columns) -> Window:
        return window_of(self.raw[row : row + rows, column : column + columns], self.void)


def test_blocks_cover_a_raster_and_answer_as_the_whole_does():
    source = np.random.default_rng(3)
    drawn = Drawn(source.uniform(0, 1_000, (23, 31)))
    blocks = list(blocks_of(drawn, size=8))
    assert max(max(block.grid.heights_m.shape) for block in blocks) <= 8
    assert blocks[-1].share == 1.0
    (whole,) = (block.grid for block in blocks_of(drawn, size=64))
    positions = np.column_stack([source.uniform(9.0, 9.03, 500), source.uniform(46.978, 47.0, 500)])
    answers = np.array([block.grid.sample(positions) for block in blocks])
    assert np.isfinite(answers).any(axis=0).all()
    assert np.nanmax(np.abs(answers - whole.sample(positions))) < 1e-2


def test_every_post_and_every_void_counts_once_though_blocks_share_their_edges():
    raw = np.random.default_rng(4).uniform(0, 100, (50, 37))
    raw[7, :] = -9999.0  # the edge between two blocks of 8
    raw[:, 14] = 99_999.0
    raw[20:40, 20:36] = np.nan
    for size in (8, 16, 64):
        survey = PostSurvey()
        for block in blocks_of(Drawn(raw), size=size):
            survey.add(block)
        assert survey.posts == raw.size
        assert survey.declared_voids == int((raw == -9999.0).sum())
        assert survey.undeclared_voids == int(((raw == 99_999.0) | np.isnan(raw)).sum())


def test_a_block_of_voids_alone_has_no_grid_and_is_counted():
    raw = np.full((8, 15), 5.0)
    raw[:, 7:] = -9999.0
    blocks = list(blocks_of(Drawn(raw), size=8))
    assert [block.grid is None for block in blocks] == [False, True]
    assert [block.declared_voids for block in blocks] == [0, 64]


def test_a_declared_void_an_undeclared_one_and_a_height_are_told_apart():
    raw = np.array([[-32768, -9999, 12_000, 99_999, 300, 77]], dtype=np.int32)
    window = window_of(raw, 77.0)
    assert window.kinds.tolist() == [[PostKind.UNDECLARED_VOID] * 4 + [PostKind.HEIGHT, PostKind.DECLARED_VOID]]
    assert np.isnan(window.heights_m).tolist() == [[True] * 4 + [False, True]]


def test_a_void_is_met_though_float32_cannot_hold_the_declared_number():
    lowest = np.array([[np.finfo(np.float32).min, 412.5]], dtype=np.float32)
    assert window_of(lowest, -3.40282346638529e38).kinds.tolist() == [[PostKind.DECLARED_VOID, PostKind.HEIGHT]]
    assert window_of(lowest, float("nan")).kinds.tolist() == [[PostKind.UNDECLARED_VOID, PostKind.HEIGHT]]


def test_heights_become_metres_before_they_are_judged():
    window = window_of(np.array([[29_000, 1_000]], dtype=np.int16), None, scale=0.3048, offset_m=10.0)
    assert np.allclose(window.heights_m, [[8_849.2, 314.8]])
