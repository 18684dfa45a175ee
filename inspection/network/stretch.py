"""The supports of a line in order, and the way along lines from one support to another."""

from collections.abc import Collection
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np

from inspection.geodesy import LonLat, distance_m
from inspection.network.build.joining import join_vertices
from inspection.network.infrastructure import InfrastructurePlaces, InfrastructureWays

DETOUR_COST = 3.0  # per metre of a line that is not of the circuit; so much longer may the way along the circuit be


@dataclass(frozen=True)
class StretchPart:
    """What is flown of one line."""

    line: int  # primary key
    start: LonLat
    end: LonLat
    length_m: float


@dataclass(frozen=True)
class Stretch:
    """The way from a support to another: the supports that it passes, both ends included, and the lines that it follows."""

    supports: tuple[int, ...]  # primary keys
    parts: tuple[StretchPart, ...]

    @property
    def length_m(self) -> float:
        return sum(part.length_m for part in self.parts)


@dataclass(frozen=True)
class _StretchLeg:
    node: int
    length_m: float
    line: int


def supports_in_order(supports: InfrastructurePlaces, line: InfrastructureWays) -> tuple[int, ...]:
    """Primary keys of the supports of one line, in its direction; one that it comes by twice counts where it comes first."""
    nodes = join_vertices(supports, line).node_of_vertex
    passed = dict.fromkeys(int(node) for node in nodes if node < len(supports))
    return tuple(int(supports.asset[node]) for node in passed)


def stretch_between(
    supports: InfrastructurePlaces, lines: InfrastructureWays, start: int, end: int, circuit: Collection[int]
) -> Stretch | None:
    """The shortest way along lines from one support to another; None where none leads there.

    `circuit` names the lines to stay on where that is no more than three times as far. Zones count for nothing: this is what is
    inspected, not what is flown there.
    """
    nodes = join_vertices(supports, lines)
    legs = _legs(lines, nodes.node_of_vertex, nodes.position)
    index = {int(asset): node for node, asset in enumerate(supports.asset)}
    if start not in index or end not in index:
        return None
    way = _cheapest_way(legs, index[start], index[end], frozenset(circuit))
    if way is None:
        return None
    passed = tuple(int(supports.asset[node]) for node in way if node < len(supports))
    return Stretch(passed, _parts(legs, way, nodes.position))


def _legs(lines: InfrastructureWays, node_of_vertex: np.ndarray, position: np.ndarray) -> dict[int, list[_StretchLeg]]:
    first = lines.leg_start
    tail, head = node_of_vertex[first], node_of_vertex[first + 1]
    length_m = distance_m(position[tail], position[head])
    asset = lines.asset[lines.way_of_vertex[first]]
    legs: dict[int, list[_StretchLeg]] = {}
    for a, b, metres, line in zip(tail.tolist(), head.tolist(), length_m.tolist(), asset.tolist(), strict=True):
        if a != b:
            legs.setdefault(a, []).append(_StretchLeg(b, metres, line))
            legs.setdefault(b, []).append(_StretchLeg(a, metres, line))
    return legs


def _cheapest_way(legs: dict[int, list[_StretchLeg]], start: int, end: int, circuit: frozenset[int]) -> list[int] | None:
    cost_of = {start: 0.0}
    before: dict[int, int] = {}
    queue = [(0.0, start)]
    while queue:
        cost, node = heappop(queue)
        if node == end:
            break
        if cost > cost_of[node]:
            continue
        for leg in legs.get(node, []):
            further = cost + leg.length_m * (1.0 if leg.line in circuit else DETOUR_COST)
            if further < cost_of.get(leg.node, np.inf):
                cost_of[leg.node] = further
                before[leg.node] = node
                heappush(queue, (further, leg.node))
    if end not in cost_of:
        return None
    way = [end]
    while way[-1] != start:
        way.append(before[way[-1]])
    return way[::-1]


def _parts(legs: dict[int, list[_StretchLeg]], way: list[int], position: np.ndarray) -> tuple[StretchPart, ...]:
    """The way cut into as few lines as it can be: of lines on the same supports the one that goes on for longest."""
    steps = [{leg.line: leg.length_m for leg in legs[a] if leg.node == b} for a, b in pairwise(way)]
    parts = []
    at = 0
    while at < len(steps):
        end, line = max((_end_of_run(steps, at, line), -line) for line in steps[at])
        length_m = sum(step[-line] for step in steps[at:end])
        start, stop = position[way[at]], position[way[end]]
        parts.append(StretchPart(-line, LonLat(float(start[0]), float(start[1])), LonLat(float(stop[0]), float(stop[1])), length_m))
        at = end
    return tuple(parts)


def _end_of_run(steps: list[dict[int, float]], at: int, line: int) -> int:
    while at < len(steps) and line in steps[at]:
        at += 1
    return at
