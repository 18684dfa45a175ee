"""Which of very many boxes may meet one of some others: a coarse look that is never wrong about a no."""

import numpy as np
from numpy.typing import NDArray

CELLS = 512  # along each side

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


class BoxGrid:
    """Boxes (z, 4), west, south, east, north, marked on a grid over all of them; any rectangle of cells is counted by four look-ups."""

    def __init__(self, boxes: FloatArray) -> None:
        self._low, self._high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        self._step = np.maximum(self._high - self._low, 1e-12) / CELLS
        marked = np.zeros((CELLS, CELLS), dtype=np.int32)
        for west, south, east, north in np.hstack([self._cells(boxes[:, :2]), self._cells(boxes[:, 2:])]).tolist():
            marked[west : east + 1, south : north + 1] = 1
        self._until = np.zeros((CELLS + 1, CELLS + 1), dtype=np.int32)
        self._until[1:, 1:] = marked.cumsum(axis=0).cumsum(axis=1)

    def may_meet(self, low: FloatArray, high: FloatArray) -> BoolArray:
        """Whether a box with these corners, each (n, 2), shares a cell with a marked one, touching included."""
        begin, end = self._cells(low), self._cells(high) + 1
        until = self._until
        count = (
            until[end[:, 0], end[:, 1]] - until[begin[:, 0], end[:, 1]] - until[end[:, 0], begin[:, 1]] + until[begin[:, 0], begin[:, 1]]
        )
        is_beside = ((high < self._low) | (low > self._high)).any(axis=1)
        may_meet: BoolArray = (count > 0) & ~is_beside
        return may_meet

    def _cells(self, position: FloatArray) -> NDArray[np.int64]:
        cells: NDArray[np.int64] = np.clip(np.floor((position - self._low) / self._step), 0, CELLS - 1).astype(np.int64)
        return cells
