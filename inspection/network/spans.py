"""What stands and hangs over the ground of a network: wires and catenaries from node to node, decks of bridges, what stands alone."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.network.build.decks import NO_DECKS, Decks
from inspection.network.build.network import Network
from inspection.network.inspection_graph import EdgeKind
from inspection.network.rules import asset_heights_m

BESIDE_M = 25.0  # across the ground: arms of a tower, wires in the wind, and what a UAV strays
MAX_CELLS = 512  # of the grid, along each side
NO_ASSET = NO_NODE = NO_BRIDGE = -1
DECK = -2
MIN_CELL_DEG = 0.005  # some 500 m: a span lies in few cells

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Spans:
    """k spans: straight from top to top, so never lower than the wire. What stands alone is a span from its place to its place.

    start, end (k, 2) lon, lat [deg]; start_height_m, end_height_m and the greater of both, (k,), above ground, guessed where no tag
    states one; asset (k,): primary key of the line or railway that hangs there, NO_ASSET for what stands alone, DECK for bridges: nothing
    is inspected from below a deck. bridge (k,): whose deck it is, by its number in decks, NO_BRIDGE for none. They are found on a grid:
    cell c has the spans member[first[c]] to member[first[c + 1] - 1]; low and step (2,) [deg] and shape (2,) tell the grid.
    """

    start: FloatArray
    end: FloatArray
    start_height_m: FloatArray
    end_height_m: FloatArray
    highest_m: FloatArray
    asset: IntArray
    bridge: IntArray
    decks: Decks
    low: FloatArray
    step: FloatArray
    shape: IntArray
    first: NDArray[np.int32]
    member: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.start)

    def where(self, chosen: IntArray) -> "Spans":
        """Return some of them, on a grid of their own."""
        heights_m = self.start_height_m[chosen], self.end_height_m[chosen]
        return spans_between(self.start[chosen], self.end[chosen], *heights_m, self.asset[chosen], self.bridge[chosen], self.decks)

    def tops_m(self, chosen: IntArray, ground_heights_m: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Return the heights above the sea of chosen spans at their starts and ends, (n, 2); NaN in both where the ground is not known.

        A deck counts from the highest ground at the banks of its group, of which the two that are farthest apart have to be known, and
        from the ground at its bridge's centre where that is known.
        """
        tops_m = np.column_stack([self.start_height_m[chosen], self.end_height_m[chosen]])
        hung = self.bridge[chosen] == NO_BRIDGE
        own = chosen[hung]
        tops_m[hung] += ground_heights_m(np.concatenate([self.start[own], self.end[own]])).reshape(2, -1).T
        if not hung.all():
            bridge, row = np.unique(self.bridge[chosen[~hung]], return_inverse=True)
            tops_m[~hung] = self._deck_tops_m(bridge, ground_heights_m)[row, None]
        tops_m[np.isnan(tops_m).any(axis=1)] = np.nan
        return tops_m

    def _deck_tops_m(self, bridge: IntArray, ground_heights_m: Callable[[FloatArray], FloatArray]) -> FloatArray:
        decks = self.decks
        group, of_bridge = np.unique(decks.group[bridge], return_inverse=True)
        begin, end = (np.searchsorted(decks.corner_group, group, side=side) for side in ("left", "right"))
        corners = np.concatenate([np.arange(first, last) for first, last in zip(begin.tolist(), end.tolist(), strict=True)])
        reported_m = ground_heights_m(np.concatenate([decks.centre[bridge], decks.corner[corners]]))
        at_centre_m, at_corner_m = reported_m[: len(bridge)], reported_m[len(bridge) :]
        first = np.concatenate([[0], np.cumsum(end - begin)[:-1]])
        banks_m = np.fmax.reduceat(at_corner_m, first)
        banks_m[np.isnan(at_corner_m[first]) | np.isnan(at_corner_m[np.minimum(first + 1, len(corners) - 1)])] = np.nan
        over_banks_m: FloatArray = banks_m[of_bridge] + decks.over_banks_m[bridge]
        return np.where(np.isnan(over_banks_m), np.nan, np.fmax(over_banks_m, at_centre_m + decks.over_centre_m[bridge]))


_made: WeakKeyDictionary[Network, Spans] = WeakKeyDictionary()


def spans_of(network: Network) -> Spans:
    """All that stands on the network, whether a zone is there or not; made once per network."""
    spans = _made.get(network)
    if spans is None:
        spans = _made[network] = _spans(network)
    return spans


class Hung(NamedTuple):
    """k spans of a network: the nodes at their ends (k, 2), for what stands alone twice the same, and for decks of bridges NO_NODE.

    line (k, 2, 2): from lon, lat [deg] to lon, lat; heights_m (k, 2), asset and bridge as in Spans.
    """

    nodes: IntArray
    line: FloatArray
    heights_m: FloatArray
    asset: IntArray
    bridge: IntArray


def _spans(network: Network) -> Spans:
    _nodes, line, heights_m, asset, bridge = hung_between(network)
    return spans_between(line[:, 0], line[:, 1], heights_m[:, 0], heights_m[:, 1], asset, bridge, network.decks)


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
    decks = network.decks
    deck_m = np.maximum(decks.over_centre_m, decks.over_banks_m)[decks.bridge]
    deck = np.flatnonzero(deck_m > taller_than_m)
    return Hung(
        nodes=np.concatenate([pairs, np.full((len(deck), 2), NO_NODE)]),
        line=np.concatenate([network.position[pairs], decks.line[deck]]),
        heights_m=np.concatenate([heights_m[pairs], deck_m[deck, None].repeat(2, axis=1)]),
        asset=np.concatenate([asset, np.full(len(alone), NO_ASSET), np.full(len(deck), DECK)]),
        bridge=np.concatenate([np.full(len(pairs), NO_BRIDGE), decks.bridge[deck]]),
    )


def spans_between(
    start: FloatArray,
    end: FloatArray,
    start_height_m: FloatArray,
    end_height_m: FloatArray,
    asset: IntArray | None = None,
    bridge: IntArray | None = None,
    decks: Decks = NO_DECKS,
) -> Spans:
    """With their grid. Without assets none of them belongs to one, and without bridges none is of a deck."""
    if not len(start):
        start, end = np.zeros((0, 2)), np.zeros((0, 2))
    start, end, start_height_m, end_height_m = map(np.ascontiguousarray, (start, end, start_height_m, end_height_m))
    west_south, east_north = np.minimum(start, end), np.maximum(start, end)
    low = west_south.min(axis=0, initial=180.0)
    extent = np.maximum(east_north.max(axis=0, initial=-180.0) - low, 0.0)
    step = np.maximum(extent / MAX_CELLS, MIN_CELL_DEG)
    shape = (extent // step).astype(np.int64) + 1
    first, member = _on_grid(west_south, east_north, low, step, shape)
    highest_m = np.maximum(start_height_m, end_height_m)
    asset = np.full(len(start), NO_ASSET) if asset is None else asset
    bridge = np.full(len(start), NO_BRIDGE) if bridge is None else bridge
    return Spans(start, end, start_height_m, end_height_m, highest_m, asset, bridge, decks, low, step, shape, first, member)


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
