"""What stands and hangs over the ground of a network: wires and catenaries from node to node, decks of bridges, what stands alone."""

from dataclasses import dataclass
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.network.build.network import Network
from inspection.network.inspection_graph import EdgeKind
from inspection.network.rules import asset_heights_m

BESIDE_M = 25.0  # across the ground: arms of a tower, wires in the wind, and what a UAV strays
MAX_CELLS = 512  # of the grid, along each side
NO_ASSET = NO_NODE = -1
DECK = -2
MIN_CELL_DEG = 0.005  # some 500 m: a span lies in few cells

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Spans:
    """k spans: straight from top to top, so never lower than the wire. What stands alone is a span from its place to its place.

    start, end (k, 2) lon, lat [deg]; start_height_m, end_height_m and the greater of both, (k,), guessed where no tag states one, above the
    ground at start_ground and end_ground, (k, 2), which are the ends themselves but for decks of bridges; asset (k,): primary key of the
    line or railway that hangs there, NO_ASSET for what stands alone, DECK for bridges: nothing is inspected from below a deck. They are
    found on a grid: cell c has the spans member[first[c]] to member[first[c + 1] - 1]; low and step (2,) [deg] and shape (2,) tell the
    grid.
    """

    start: FloatArray
    end: FloatArray
    start_height_m: FloatArray
    end_height_m: FloatArray
    highest_m: FloatArray
    asset: IntArray
    start_ground: FloatArray
    end_ground: FloatArray
    low: FloatArray
    step: FloatArray
    shape: IntArray
    first: NDArray[np.int32]
    member: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.start)

    def ground_places(self, chosen: IntArray) -> FloatArray:
        """Return the places over whose ground the heights of chosen spans count: (2 n, 2), first of their starts, then of their ends."""
        return np.concatenate([self.start_ground[chosen], self.end_ground[chosen]])


_made: WeakKeyDictionary[Network, Spans] = WeakKeyDictionary()


def spans_of(network: Network) -> Spans:
    """All that stands on the network, whether a zone is there or not; made once per network."""
    spans = _made.get(network)
    if spans is None:
        spans = _made[network] = _spans(network)
    return spans


class Hung(NamedTuple):
    """k spans of a network: the nodes at their ends (k, 2), for what stands alone twice the same, and for decks of bridges NO_NODE.

    line, ground (k, 2, 2): from lon, lat [deg] to lon, lat, and the places over whose ground heights_m, (k, 2), count; asset as in Spans.
    """

    nodes: IntArray
    line: FloatArray
    ground: FloatArray
    heights_m: FloatArray
    asset: IntArray


def _spans(network: Network) -> Spans:
    _nodes, line, ground, heights_m, asset = hung_between(network)
    return spans_between(line[:, 0], line[:, 1], heights_m[:, 0], heights_m[:, 1], asset, (ground[:, 0], ground[:, 1]))


def hung_between(network: Network, taller_than_m: float = -1.0) -> Hung:
    """Return what has an end that is taller."""
    heights_m = asset_heights_m(network.node_kind, network.node_height_m)
    is_tall = heights_m > taller_than_m
    hangs = np.isin(network.edge_kind, (EdgeKind.LINE, EdgeKind.RAILWAY)) & is_tall[network.edge].any(axis=1)
    pairs, asset = network.edge[hangs].astype(np.int64), network.edge_asset[hangs]
    is_short = np.abs(network.position[pairs[:, 0], 0] - network.position[pairs[:, 1], 0]) <= 180.0
    pairs, asset = pairs[is_short], asset[is_short]
    is_tall[pairs.ravel()] = False
    alone = np.flatnonzero(is_tall)
    pairs = np.concatenate([pairs, alone[:, None].repeat(2, axis=1)])
    deck = np.flatnonzero(network.deck_height_m > taller_than_m)
    line, on_deck = network.position[pairs], network.deck_line[deck]
    return Hung(
        nodes=np.concatenate([pairs, np.full((len(deck), 2), NO_NODE)]),
        line=np.concatenate([line, on_deck]),
        ground=np.concatenate([line, network.deck_ground[deck][:, None].repeat(2, axis=1)]),
        heights_m=np.concatenate([heights_m[pairs], network.deck_height_m[deck][:, None].repeat(2, axis=1)]),
        asset=np.concatenate([asset, np.full(len(alone), NO_ASSET), np.full(len(deck), DECK)]),
    )


def spans_between(
    start: FloatArray,
    end: FloatArray,
    start_height_m: FloatArray,
    end_height_m: FloatArray,
    asset: IntArray | None = None,
    ground: tuple[FloatArray, FloatArray] | None = None,
) -> Spans:
    """With their grid. Without assets none of them belongs to one; without ground heights count from that at the ends."""
    if not len(start):
        start, end = np.zeros((0, 2)), np.zeros((0, 2))
    start_ground, end_ground = ground or (start, end)
    west_south, east_north = np.minimum(start, end), np.maximum(start, end)
    low = west_south.min(axis=0, initial=180.0)
    extent = np.maximum(east_north.max(axis=0, initial=-180.0) - low, 0.0)
    step = np.maximum(extent / MAX_CELLS, MIN_CELL_DEG)
    shape = (extent // step).astype(np.int64) + 1
    first, member = _on_grid(west_south, east_north, low, step, shape)
    highest_m = np.maximum(start_height_m, end_height_m)
    asset = np.full(len(start), NO_ASSET) if asset is None else asset
    return Spans(start, end, start_height_m, end_height_m, highest_m, asset, start_ground, end_ground, low, step, shape, first, member)


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
