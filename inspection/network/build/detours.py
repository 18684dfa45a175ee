"""Detours round the zones that cut lines and railways, and links that no straight leg can make."""

from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.edges import NO_ASSET, Edges, component_labels
from inspection.network.build.flown_nodes import FlownNodes
from inspection.network.inspection_graph import EdgeKind
from inspection.network.nearness import on_unit_sphere
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_detours import Errand, WayRound, ways_round
from inspection.network.zones.zone_index import ZoneIndex

ALL_PAIRS = 6  # up to so many stumps of a gap each is joined to each; of more
NEAREST = 3  # each to the nearest, and to its neighbours all round

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Detours:
    """Legs between nodes and bends: pair (m, 2) holds nodes, and for bend b its place behind all nodes; bend (k, 2) lon, lat [deg]."""

    pair: IntArray
    bend: FloatArray

    def edges(self) -> Edges:
        pair = np.sort(self.pair, axis=1)
        return Edges(pair, np.full(len(pair), EdgeKind.DETOUR, dtype=np.uint8), np.full(len(pair), NO_ASSET, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class NetworkBreak:
    """Nodes, (s,), that have lost a way to one another, and which pairs of these nodes, (p, 2) by their places, are to get one round."""

    node: IntArray
    pair: IntArray
    is_one_enough: bool = False  # the shortest of the ways then makes all of them up


def gaps(edges: Edges, out: BoolArray, inside: BoolArray, position: FloatArray) -> list[NetworkBreak]:
    """What zones take out of lines and railways: each connected piece is a gap between the nodes that are left at its ends."""
    taken = edges.where(out & np.isin(edges.kind, [kind for kind in EdgeKind if kind.is_on_network])).pair
    if not len(taken):
        return []
    is_in = inside[taken]
    _, label = component_labels(len(inside), taken[is_in.all(axis=1)])
    piece = np.where(is_in[:, 0], label[taken[:, 0]], label[taken[:, 1]])
    alone = ~is_in.any(axis=1)
    piece[alone] = len(inside) + np.arange(int(alone.sum()))
    row, side = np.nonzero(~is_in)
    stumps = np.unique(np.column_stack([piece[row], taken[row, side]]), axis=0)
    _, first = np.unique(stumps[:, 0], return_index=True)
    return [NetworkBreak(node, _pairs(position[node])) for node in np.split(stumps[:, 1], first[1:]) if len(node) > 1]


def detours(wanted: list[NetworkBreak], flown: FlownNodes, zones: ZoneIndex, rules: LinkingRules, heights: FlownHeights) -> Detours:
    """The shortest ways round, none longer than rules.detour_m. Bends are flown at transit height; ways by the same bend share it."""
    low_m, high_m = (float(limit_m[0]) for limit_m in heights.band_m(np.zeros(1)))
    errands = [
        Errand(
            flown.position[gap.node],
            gap.pair,
            min(low_m, float(flown.low_m[gap.node].min())),
            max(high_m, float(flown.high_m[gap.node].max())),
        )
        for gap in wanted
    ]
    found = ways_round(zones, errands, rules.zone_clearance_m, rules.detour_m) if rules.detour_m > 0 else []
    number: dict[tuple[float, ...], int] = {}
    pairs: list[tuple[int, int]] = []
    for gap, ways in zip(wanted, found, strict=False):
        for (one, other), way in _chosen(gap, ways):
            bends = [len(flown.position) + number.setdefault(tuple(bend), len(number)) for bend in way.bend.tolist()]
            chain = [int(gap.node[one]), *bends, int(gap.node[other])]
            pairs += pairwise(chain)
    return Detours(np.array(pairs, dtype=np.int64).reshape(-1, 2), np.array(list(number), dtype=np.float64).reshape(-1, 2))


def _chosen(gap: NetworkBreak, ways: list[WayRound | None]) -> list[tuple[tuple[int, int], WayRound]]:
    there_are = [((int(one), int(other)), way) for (one, other), way in zip(gap.pair, ways, strict=True) if way is not None]
    return [min(there_are, key=lambda found: found[1].length_m)] if gap.is_one_enough and there_are else there_are


def _pairs(position: FloatArray) -> IntArray:
    """Few pairs of these places over which each can be got to from each."""
    count = len(position)
    if count <= ALL_PAIRS:
        return np.array(list(combinations(range(count), 2)), dtype=np.int64)
    middle = position.mean(axis=0)
    around = np.argsort(np.arctan2(*(position - middle).T), kind="stable")
    apart = ((on_unit_sphere(position)[:, None] - on_unit_sphere(position)[None]) ** 2).sum(axis=2)
    nearest = np.argsort(apart, axis=1, kind="stable")[:, 1 : 1 + NEAREST]
    pairs = np.concatenate(
        [np.column_stack([around, np.roll(around, -1)]), np.column_stack([np.repeat(np.arange(count), NEAREST), nearest.ravel()])]
    )
    return np.unique(np.sort(pairs, axis=1), axis=0)
