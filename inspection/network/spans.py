"""What stands and hangs over the ground of a network: wires and catenaries from node to node, and whatever stands alone."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.network.build.network import Network
from inspection.network.inspection_graph import EdgeKind
from inspection.network.rules import asset_heights_m

BESIDE_M = 25.0  # across the ground: arms of a tower, wires in the wind, and what a UAV strays
MAX_CELLS = 512  # of the grid, along each side
NO_ASSET = -1
MIN_CELL_DEG = 0.005  # some 500 m: a span lies in few cells

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Spans:
    """k spans: straight from top to top, so never lower than the wire. What stands alone is a span from its place to its place.

    start, end (k, 2) lon, lat [deg]; start_height_m, end_height_m and the greater of both, (k,), above ground, guessed where no tag
    states one; asset (k,): primary key of the line or railway that hangs there, NO_ASSET for what stands alone. They are found on a
    grid: cell c has the spans member[first[c]] to member[first[c + 1] - 1]; low and step (2,) [deg] and shape (2,) tell the grid.
    """

    start: FloatArray
    end: FloatArray
    start_height_m: FloatArray
    end_height_m: FloatArray
    highest_m: FloatArray
    asset: IntArray
    low: FloatArray
    step: FloatArray
    shape: IntArray
    first: NDArray[np.int32]
    member: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.start)


_made: WeakKeyDictionary[Network, Spans] = WeakKeyDictionary()


def spans_of(network: Network) -> Spans:
    """All that stands on the network, whether a zone is there or not; made once per network."""
    spans = _made.get(network)
    if spans is None:
        spans = _made[network] = _spans(network)
    return spans


def _spans(network: Network) -> Spans:
    pairs, heights_m, asset = hung_between(network)
    return spans_between(network.position[pairs[:, 0]], network.position[pairs[:, 1]], heights_m[:, 0], heights_m[:, 1], asset)


def hung_between(network: Network, taller_than_m: float = -1.0) -> tuple[IntArray, FloatArray, IntArray]:
    """Nodes at the ends of each span, (k, 2), twice the same for what stands alone, their heights, and Spans.asset; with an end so tall."""
    heights_m = asset_heights_m(network.node_kind, network.node_height_m)
    is_tall = heights_m > taller_than_m
    if not is_tall.any():
        return np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2)), np.zeros(0, dtype=np.int64)
    hangs = np.isin(network.edge_kind, (EdgeKind.LINE, EdgeKind.RAILWAY)) & is_tall[network.edge].any(axis=1)
    pairs, asset = network.edge[hangs].astype(np.int64), network.edge_asset[hangs]
    is_short = np.abs(network.position[pairs[:, 0], 0] - network.position[pairs[:, 1], 0]) <= 180.0
    pairs, asset = pairs[is_short], asset[is_short]
    is_tall[pairs.ravel()] = False
    alone = np.flatnonzero(is_tall)
    pairs = np.concatenate([pairs, alone[:, None].repeat(2, axis=1)])
    return pairs, heights_m[pairs], np.concatenate([asset, np.full(len(alone), NO_ASSET)])


def spans_between(
    start: FloatArray, end: FloatArray, start_height_m: FloatArray, end_height_m: FloatArray, asset: IntArray | None = None
) -> Spans:
    """With their grid. Without assets none of them belongs to one."""
    if not len(start):
        start, end = np.zeros((0, 2)), np.zeros((0, 2))
    west_south, east_north = np.minimum(start, end), np.maximum(start, end)
    low = west_south.min(axis=0, initial=180.0)
    extent = np.maximum(east_north.max(axis=0, initial=-180.0) - low, 0.0)
    step = np.maximum(extent / MAX_CELLS, MIN_CELL_DEG)
    shape = (extent // step).astype(np.int64) + 1
    first, member = _on_grid(west_south, east_north, low, step, shape)
    highest_m = np.maximum(start_height_m, end_height_m)
    asset = np.full(len(start), NO_ASSET) if asset is None else asset
    return Spans(start, end, start_height_m, end_height_m, highest_m, asset, low, step, shape, first, member)


@njit(cache=True, nogil=True)
def cell_of(lon: float, lat: float, low: FloatArray, step: FloatArray, shape: IntArray) -> tuple[int, int]:
    """Column and row of the grid; of a place beside it, the nearest."""
    column, row = int(np.floor((lon - low[0]) / step[0])), int(np.floor((lat - low[1]) / step[1]))
    return min(max(column, 0), shape[0] - 1), min(max(row, 0), shape[1] - 1)


@njit(cache=True, nogil=True)
def _on_grid(
    west_south: FloatArray, east_north: FloatArray, low: FloatArray, step: FloatArray, shape: IntArray
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Each span in all cells that its box touches."""
    first = np.zeros(shape[0] * shape[1] + 1, dtype=np.int32)
    for span in range(len(west_south)):
        column, row = cell_of(west_south[span, 0], west_south[span, 1], low, step, shape)
        last_column, last_row = cell_of(east_north[span, 0], east_north[span, 1], low, step, shape)
        for own_row in range(row, last_row + 1):
            for own_column in range(column, last_column + 1):
                first[own_row * shape[0] + own_column + 1] += 1
    for cell in range(len(first) - 1):
        first[cell + 1] += first[cell]
    at = first[:-1].copy()
    member = np.empty(first[-1], dtype=np.int32)
    for span in range(len(west_south)):
        column, row = cell_of(west_south[span, 0], west_south[span, 1], low, step, shape)
        last_column, last_row = cell_of(east_north[span, 0], east_north[span, 1], low, step, shape)
        for own_row in range(row, last_row + 1):
            for own_column in range(column, last_column + 1):
                cell = own_row * shape[0] + own_column
                member[at[cell]] = span
                at[cell] += 1
    return first, member
