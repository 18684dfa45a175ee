"""The network of flyable lines: nodes, legs, lengths of connected parts, and nearness."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order
from shapely import STRtree

from inspection.geodesy import distance_m
from inspection.network.build.edges import component_labels
from inspection.network.build.joining import JoinedVertices, join_vertices
from inspection.network.nearness import EARTH_RADIUS_M
from inspection.quality.infrastructure import IssueSearchData

IntArray = NDArray[np.int64]
FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

METRES_PER_DEGREE = np.radians(1.0) * EARTH_RADIUS_M
_HASH_STEP = np.uint64(0x9E3779B97F4A7C15)  # splitmix64's increment: mixed numbers do not cancel each other


@dataclass(frozen=True)
class NearLegs:
    """Legs near places, one row per pair, sorted by place, then metres."""

    place: IntArray
    leg: IntArray
    metres: FloatArray
    fraction: FloatArray  # of the nearest point along the leg, 0 at its start
    position: FloatArray  # of that point, lon lat [deg]


def metres_by(owner: IntArray, metres: FloatArray, count: int) -> FloatArray:
    """Return the sum of metres of each owner."""
    return np.bincount(owner, weights=metres, minlength=count).astype(np.float64)


class SupportNetwork:
    """Nodes are those of the graph (join_vertices): supports first, then vertices without one. A leg joins two vertices of one line."""

    def __init__(self, ground: IssueSearchData) -> None:
        self.ground = ground
        lines = ground.lines
        joined: JoinedVertices = join_vertices(ground.supports, lines)
        self.support_count = len(ground.supports)
        self.node_of_vertex = joined.node_of_vertex
        self.node_position = joined.position
        self.way_of_vertex = lines.way_of_vertex
        self.leg_start = lines.leg_start  # vertex numbers; a leg ends at the next vertex
        self.leg_way = self.way_of_vertex[self.leg_start]
        self.leg_node = np.column_stack([self.node_of_vertex[self.leg_start], self.node_of_vertex[self.leg_start + 1]])
        self.leg_m = distance_m(lines.position[self.leg_start], lines.position[self.leg_start + 1])

    @property
    def node_count(self) -> int:
        return len(self.node_position)

    @cached_property
    def is_carried(self) -> BoolArray:
        """Whether each support is on a line."""
        carried = np.zeros(self.support_count, dtype=bool)
        nodes = self.node_of_vertex
        carried[nodes[nodes < self.support_count]] = True
        return carried

    @cached_property
    def way_m(self) -> FloatArray:
        return metres_by(self.leg_way, self.leg_m, len(self.ground.lines))

    @cached_property
    def pairs(self) -> tuple[IntArray, FloatArray, IntArray]:
        """Return distinct pairs of nodes, the metres of the shortest leg between them, and the pair of each leg (-1 for a loop)."""
        ends = np.sort(self.leg_node, axis=1)
        is_edge = ends[:, 0] != ends[:, 1]
        pair, number = np.unique(ends[is_edge], axis=0, return_inverse=True)
        metres = np.full(len(pair), np.inf)
        np.minimum.at(metres, number.ravel(), self.leg_m[is_edge])
        pair_of_leg = np.full(len(ends), -1, dtype=np.int64)
        pair_of_leg[is_edge] = number.ravel()
        return pair.reshape(-1, 2), metres, pair_of_leg

    @cached_property
    def degree(self) -> IntArray:
        """Return for each node the number of other nodes to which legs lead."""
        return np.bincount(self.pairs[0].ravel(), minlength=self.node_count).astype(np.int64)

    @cached_property
    def component(self) -> IntArray:
        return component_labels(self.node_count, self.pairs[0])[1]

    @cached_property
    def component_m(self) -> FloatArray:
        """Return the metres of each component's legs; two lines between one pair of nodes count once."""
        pair, metres, _ = self.pairs
        count = int(self.component.max(initial=-1)) + 1
        return metres_by(self.component[pair[:, 0]], metres, count)

    def joining_m(self, one: IntArray, other: IntArray) -> FloatArray:
        """Return the length of the smaller of the two components that joining the nodes would connect; 0 if already connected."""
        first, second = self.component[one], self.component[other]
        return np.where(first == second, 0.0, np.minimum(self.component_m[first], self.component_m[second]))

    @cached_property
    def smaller_side_m(self) -> FloatArray:
        """Return for each pair the metres on its smaller side if it is the only link between its sides, else 0.

        It is the only link if it is in the breadth-first forest and no pair outside the forest spans it: each of those gets a number, which
        its two ends cancel wherever both are on one side.
        """
        pair, metres, _ = self.pairs
        side = np.zeros(len(pair))
        if not len(pair):
            return side
        order, parent, edge_above = self._forest()
        below = np.zeros(self.node_count + 1)
        reach = np.zeros(self.node_count + 1, dtype=np.uint64)
        outside = np.ones(len(pair), dtype=bool)
        outside[edge_above[edge_above >= 0]] = False
        over = np.flatnonzero(outside)
        number = _mixed(over.astype(np.uint64) + np.uint64(1))
        for end in (0, 1):
            np.bitwise_xor.at(reach, pair[over, end], number)
        np.add.at(below, pair[over, 0], metres[over])
        below_list, reach_list = below.tolist(), reach.tolist()
        parents, edges, metres_list = parent.tolist(), edge_above.tolist(), metres.tolist()
        for node in reversed(order.tolist()):
            above = parents[node]
            if above >= 0:
                edge = edges[node]
                below_list[above] += below_list[node] + (metres_list[edge] if edge >= 0 else 0.0)
                reach_list[above] ^= reach_list[node]
        node = np.flatnonzero(edge_above >= 0)
        node = node[np.array(reach_list, dtype=np.uint64)[node] == 0]
        edge = edge_above[node]
        inner = np.array(below_list)[node]
        outer = self.component_m[self.component[node]] - inner - metres[edge]
        side[edge] = np.maximum(np.minimum(inner, outer), 0.0)
        return side

    def _forest(self) -> tuple[IntArray, IntArray, IntArray]:
        """Return nodes in breadth-first order from a root above all components, their parents, and the pairs to them (or -1)."""
        pair = self.pairs[0]
        root = self.node_count
        _, first = np.unique(self.component, return_index=True)
        start = np.concatenate([pair[:, 0], np.full(len(first), root)])
        end = np.concatenate([pair[:, 1], first])
        value = np.arange(1, len(start) + 1)
        links = csr_array((value, (start, end)), shape=(root + 1, root + 1))
        links = links + links.T
        order, parent = breadth_first_order(links, root, directed=True)
        parent = np.where(parent < 0, -1, parent).astype(np.int64)
        node = np.flatnonzero(parent[:root] >= 0)
        low, high = np.minimum(node, parent[node]), np.maximum(node, parent[node])
        lookup = pair[:, 0] * (root + 1) + pair[:, 1]
        wanted = low * (root + 1) + high
        slot = np.minimum(np.searchsorted(lookup, wanted), len(lookup) - 1)
        edge = np.full(root + 1, -1, dtype=np.int64)
        is_pair = (lookup[slot] == wanted) & (high < root)
        edge[node[is_pair]] = slot[is_pair]
        return order.astype(np.int64), parent.astype(np.int64), edge.astype(np.int64)

    @cached_property
    def _leg_tree(self) -> tuple[STRtree, IntArray]:
        """Return a tree of the legs that do not cross the antimeridian, and the number of each in it."""
        start = self.ground.lines.position[self.leg_start]
        end = self.ground.lines.position[self.leg_start + 1]
        plain = np.flatnonzero(np.abs(start[:, 0] - end[:, 0]) <= 180.0)
        return STRtree(np.asarray(shapely.linestrings(np.stack([start[plain], end[plain]], axis=1)))), plain

    def legs_near(self, places: FloatArray, radius_m: float) -> NearLegs:
        """Return all legs within the radius of the places; a plane is accurate enough within a few hundred metres."""
        tree, number = self._leg_tree
        if not len(places) or not len(number):
            none = np.zeros(0, dtype=np.int64)
            return NearLegs(none, none, np.zeros(0), np.zeros(0), np.zeros((0, 2)))
        east = METRES_PER_DEGREE * np.maximum(np.cos(np.radians(places[:, 1])), 1e-3)
        reach = 1.01 * radius_m / np.column_stack([east, np.full(len(places), METRES_PER_DEGREE)])
        boxes = shapely.box(*(places - reach).T, *(places + reach).T)
        place, found = tree.query(boxes, predicate="intersects")
        leg = number[found]
        start = self.ground.lines.position[self.leg_start[leg]]
        step = self.ground.lines.position[self.leg_start[leg] + 1] - start
        scale = np.column_stack([east[place], np.full(len(place), METRES_PER_DEGREE)])
        way = step * scale
        to_place = (places[place] - start) * scale
        square = (way**2).sum(axis=1)
        fraction = np.clip((way * to_place).sum(axis=1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
        metres = np.hypot(*(to_place - way * fraction[:, None]).T)
        near = np.flatnonzero(metres <= radius_m)
        near = near[np.lexsort((leg[near], metres[near], place[near]))]
        position = start[near] + step[near] * fraction[near, None]
        return NearLegs(place[near].astype(np.int64), leg[near], metres[near], fraction[near], position)


def _mixed(number: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return splitmix64 of each number: the same in every run, and small sets do not cancel by exclusive or."""
    with np.errstate(over="ignore"):
        mixed = number * _HASH_STEP
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return mixed ^ (mixed >> np.uint64(31))
