"""Supports and spans of mapped lines, with the same positions and heights as the planners' network."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inspection.geodesy import distance_m
from inspection.geodesy.local_frame import LocalFrame
from inspection.network.build.joining import join_vertices
from inspection.network.build.network import support_heights_m
from inspection.network.infrastructure import InfrastructurePlaces, InfrastructureWays
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import asset_heights_m

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Box = tuple[float, float, float, float]  # west, south, east, north [deg]

HALF_TURN_DEG = 180.0


@dataclass(frozen=True, eq=False)
class Overhead:
    """n supports, or vertices of lines without one, and k spans.

    position (n, 2) lon, lat [deg]; support (n,) primary key, -1 for a vertex; height_m (n,) above ground, and whether it comes from the
    support's own tag or a line's. span (k, 2) places in these; span_lines: the lines of the span, in ascending order; length_m (k,).
    """

    position: FloatArray
    support: IntArray
    height_m: FloatArray
    is_tagged: NDArray[np.bool_]
    is_by_line: NDArray[np.bool_]
    span: IntArray
    span_lines: tuple[tuple[int, ...], ...]
    length_m: FloatArray

    def where(self, supports: NDArray[np.bool_], spans: NDArray[np.bool_]) -> "Overhead":
        """Return only these supports, and the given spans between them."""
        spans = spans & supports[self.span].all(axis=1)
        place = np.cumsum(supports) - 1
        return Overhead(
            self.position[supports], self.support[supports], self.height_m[supports], self.is_tagged[supports], self.is_by_line[supports],
            place[self.span[spans]], tuple(self.span_lines[row] for row in np.flatnonzero(spans).tolist()), self.length_m[spans],
        )  # fmt: skip


def overhead(supports: InfrastructurePlaces, lines: InfrastructureWays, box: Box) -> Overhead:
    """Return the supports in a box, and every span that touches it, with both its ends.

    The lines must include all that lead to any of these supports.
    """
    joined = join_vertices(supports, lines)
    tagged_m = support_heights_m(supports, lines, joined)
    count = len(supports)
    node_height_m = np.full(len(joined.position), np.nan)
    node_height_m[:count] = tagged_m
    vertex_way = joined.way[count:]
    node_height_m[count:] = lines.height_m[vertex_way]
    kind = np.where(np.arange(len(joined.position)) < count, NodeKind.SUPPORT, NodeKind.LINE_VERTEX).astype(np.uint8)
    height_m = asset_heights_m(kind, node_height_m)
    is_tagged = np.zeros(len(kind), dtype=bool)
    is_tagged[:count] = ~np.isnan(supports.height_m)

    start = lines.leg_start
    pair = np.sort(np.column_stack([joined.node_of_vertex[start], joined.node_of_vertex[start + 1]]), axis=1)
    line = lines.asset[lines.way_of_vertex[start]]
    ends = joined.position[pair]
    is_span = (pair[:, 0] != pair[:, 1]) & (np.abs(ends[:, 0, 0] - ends[:, 1, 0]) <= HALF_TURN_DEG) & _touches(ends, box)
    is_span &= (ends[:, 0] != ends[:, 1]).any(axis=1)
    span, number = np.unique(pair[is_span], axis=0, return_inverse=True)
    carried: list[set[int]] = [set() for _ in range(len(span))]
    for row, own in zip(number.ravel().tolist(), line[is_span].tolist(), strict=True):
        carried[row].add(own)
    found = Overhead(
        position=joined.position,
        support=np.concatenate([supports.asset, np.full(len(vertex_way), -1, dtype=np.int64)]),
        height_m=height_m,
        is_tagged=is_tagged,
        is_by_line=~is_tagged & ~np.isnan(node_height_m),
        span=span.reshape(-1, 2),
        span_lines=tuple(tuple(sorted(own)) for own in carried),
        length_m=distance_m(joined.position[span[:, 0]], joined.position[span[:, 1]]) if len(span) else np.zeros(0),
    )
    west, south, east, north = box
    lon, lat = joined.position.T
    stays = (lon >= west) & (lon <= east) & (lat >= south) & (lat <= north) & (found.support >= 0)
    stays[span.ravel()] = True
    return found.where(stays, np.ones(len(span), dtype=bool))


def _touches(ends: FloatArray, box: Box) -> NDArray[np.bool_]:
    """Whether the bounding box of each leg, ends (k, 2, 2), meets the box."""
    low, high = ends.min(axis=1), ends.max(axis=1)
    west, south, east, north = box
    touches: NDArray[np.bool_] = (low[:, 0] <= east) & (high[:, 0] >= west) & (low[:, 1] <= north) & (high[:, 1] >= south)
    return touches


def bearings_deg(found: Overhead, weight: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return the line's direction at each support (n,), the number of its spans (n,), and the bend where there are two (n,).

    weight (k,) of the spans: the heavier line decides. The bearing bisects a bend; 0 where no span is. Along a line it keeps its
    orientation from support to support.
    """
    count = len(found.position)
    if not len(found.span):
        return np.zeros(count), np.zeros(count, dtype=np.int64), np.zeros(count)
    frame = LocalFrame.around(*found.position.mean(axis=0).tolist())
    place = frame.to_metres(found.position)
    along = place[found.span[:, 1]] - place[found.span[:, 0]]
    angle = np.arctan2(along[:, 0], along[:, 1])
    doubled = np.zeros((count, 2))
    turned = np.zeros((count, 2))  # unit vectors away from the support
    for side, sign in ((0, 1.0), (1, -1.0)):
        np.add.at(doubled, found.span[:, side], weight[:, None] * np.column_stack([np.sin(2 * angle), np.cos(2 * angle)]))
        np.add.at(turned, found.span[:, side], sign * np.column_stack([np.sin(angle), np.cos(angle)]))
    ways = np.bincount(found.span.ravel(), minlength=count)
    bearing = _one_way(found.span, np.degrees(np.arctan2(doubled[:, 0], doubled[:, 1])) / 2.0)
    # The sum of two unit vectors that point away from a place is 2 cos of half the angle between them.
    half = np.arccos(np.clip(np.hypot(turned[:, 0], turned[:, 1]) / 2.0, 0.0, 1.0))
    bend = np.where(ways == 2, HALF_TURN_DEG - np.degrees(2.0 * half), 0.0)
    return bearing, ways.astype(np.int64), bend


def _one_way(span: IntArray, bearing_deg: FloatArray) -> FloatArray:
    """Return each bearing, or the opposite one, so that neighbours differ by less than a right angle; 0 to 360."""
    neighbours: list[list[int]] = [[] for _ in range(len(bearing_deg))]
    for one, other in span.tolist():
        neighbours[one].append(other)
        neighbours[other].append(one)
    turned = bearing_deg.copy()
    is_met = np.zeros(len(bearing_deg), dtype=bool)
    for first in range(len(bearing_deg)):
        waiting = [] if is_met[first] else [first]
        is_met[first] = True
        while waiting:
            here = waiting.pop()
            for other in neighbours[here]:
                if not is_met[other]:
                    is_met[other] = True
                    if np.cos(np.radians(turned[other] - turned[here])) < 0.0:
                        turned[other] += HALF_TURN_DEG
                    waiting.append(other)
    opposite: FloatArray = turned % (2 * HALF_TURN_DEG)
    return opposite


CATENARY_M = 1_500.0  # horizontal tension over weight per length: usual for aluminium-steel conductors on a mild day without wind
MAX_SAG_SHARE = 0.5  # of the lower end's height above ground: very long spans are tighter, or have unmapped towers
EARTH_SHARE = 0.85  # an earth wire is tighter than the phases below it


def sag_m(length_m: float, lowest_slot_m: float) -> float:
    """Return the sag of a phase in the middle, below the straight line between its ends.

    lowest_slot_m: above ground, the lower of both ends' lowest slots. A catenary is never above the straight line between its ends, so a
    wire is never higher than planners assume.
    """
    return min(length_m**2 / (8.0 * CATENARY_M), MAX_SAG_SHARE * max(lowest_slot_m, 0.0))
