"""The nodes of a graph by place: a balanced k-d tree in plain arrays, which processes share memory-mapped."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from inspection.geodesy import LonLat
from inspection.network.nearness import on_unit_sphere
from inspection.network.paths.contracted_graph import FloatArray, NumberArray
from inspection.network.paths.hub_labels import IntArray

LEAF = 12  # nodes of a leaf are looked at one by one


class NodeTree(NamedTuple):
    """n nodes on the unit sphere (Bentley 1975). The middle of each range splits it; a range of LEAF nodes or fewer is a leaf.

    order  int32   (n,)    the graph's number of each node
    point  float64 (n, 3)  where it lies on the unit sphere
    axis   uint8   (n,)    along which the range with this middle is split
    """

    order: NumberArray
    point: FloatArray
    axis: NDArray[np.uint8]

    def nearest(self, position: LonLat, count: int, within: float = np.inf) -> IntArray:
        """Up to `count` nodes nearest to a position, no farther than the chord `within` on the unit sphere, the nearest first."""
        nodes: IntArray = nearest_in_tree(_point(position), count, float(within * within), self)
        return nodes

    def around(self, position: LonLat, within: float) -> IntArray:
        """All nodes no farther from a position than the chord `within` on the unit sphere, sorted."""
        nodes: IntArray = around_in_tree(_point(position), float(within * within), self)
        return np.sort(nodes)

    def nearest_of_each(self, positions: FloatArray) -> tuple[IntArray, FloatArray]:
        """For each position (q, 2) the nearest node, and how far away it is as a chord on the unit sphere; the tree has nodes."""
        node, chord = _nearest_of_each(on_unit_sphere(positions), self)
        return node, chord


def build_node_tree(position: FloatArray) -> NodeTree:
    """The tree of nodes at positions (n, 2), lon, lat [deg]."""
    position = np.asarray(position, dtype=np.float64).reshape(-1, 2)
    return tree_of(np.ascontiguousarray(position[:, 0]), np.ascontiguousarray(position[:, 1]))


def tree_of(lon: FloatArray, lat: FloatArray) -> NodeTree:
    """The same from columns."""
    arrays = _build(lon, lat)
    for array in arrays:
        array.setflags(write=False)
    return NodeTree(*arrays)


def _point(position: LonLat) -> FloatArray:
    point: FloatArray = on_unit_sphere(np.array([position], dtype=np.float64))[0]
    return point


@njit(cache=True, nogil=True)
def point_on_sphere(lon: float, lat: float) -> FloatArray:
    """As nearness.on_unit_sphere, for compiled code: shape (3,)."""
    x, y = np.radians(lon), np.radians(lat)
    return np.array([np.cos(y) * np.cos(x), np.cos(y) * np.sin(x), np.sin(y)])


@njit(cache=True, nogil=True)
def points_on_sphere(position: FloatArray) -> FloatArray:
    """The same of several positions (n, 2): shape (n, 3)."""
    points = np.empty((len(position), 3))
    for number in range(len(position)):
        points[number] = point_on_sphere(position[number, 0], position[number, 1])
    return points


@njit(cache=True, nogil=True)
def _build(lon: FloatArray, lat: FloatArray) -> tuple[NumberArray, FloatArray, NDArray[np.uint8]]:
    count = len(lon)
    point = np.empty((count, 3))
    for node in range(count):
        x, y = np.radians(lon[node]), np.radians(lat[node])
        point[node, 0], point[node, 1], point[node, 2] = np.cos(y) * np.cos(x), np.cos(y) * np.sin(x), np.sin(y)
    order = np.arange(count).astype(np.int32)
    axis = np.zeros(count, dtype=np.uint8)
    stack = np.empty((128, 2), dtype=np.int64)
    stack[0, 0], stack[0, 1] = 0, count
    height = 1
    while height:
        height -= 1
        begin, end = stack[height, 0], stack[height, 1]
        if end - begin <= LEAF:
            continue
        widest, width = 0, -1.0
        for number in range(3):
            low, high = np.inf, -np.inf
            for at in range(begin, end):
                value = point[order[at], number]
                low, high = min(low, value), max(high, value)
            if high - low > width:
                widest, width = number, high - low
        middle = (begin + end) // 2
        # Hoare's selection (1961): the middle gets the node that belongs there, smaller ones before it, larger ones behind.
        low_at, high_at = begin, end - 1
        while low_at < high_at:
            pivot = point[order[(low_at + high_at) // 2], widest]
            left, right = low_at, high_at
            while left <= right:
                while point[order[left], widest] < pivot:
                    left += 1
                while point[order[right], widest] > pivot:
                    right -= 1
                if left <= right:
                    order[left], order[right] = order[right], order[left]
                    left += 1
                    right -= 1
            if middle <= right:
                high_at = right
            elif middle >= left:
                low_at = left
            else:
                break
        axis[middle] = widest
        stack[height, 0], stack[height, 1] = begin, middle
        stack[height + 1, 0], stack[height + 1, 1] = middle + 1, end
        height += 2
    # Points go to their nodes' places in the order one ring of exchanges after the other, in the memory that they have.
    is_placed = np.zeros(count, dtype=np.bool_)
    for begin in range(count):
        if is_placed[begin]:
            continue
        x, y, z = point[begin]
        at = begin
        while order[at] != begin:
            point[at] = point[order[at]]
            is_placed[at] = True
            at = order[at]
        point[at, 0], point[at, 1], point[at, 2] = x, y, z
        is_placed[at] = True
    return order, point, axis


@njit(cache=True, nogil=True)
def nearest_in_tree(here: FloatArray, count: int, within_2: float, tree: NodeTree) -> IntArray:
    """Up to `count` nodes nearest to a point on the unit sphere, no farther than the root of within_2, the nearest first."""
    order, point, axis = tree.order, tree.point, tree.axis
    best_2 = np.full(count, np.inf)
    best = np.full(count, -1, dtype=np.int64)
    ranges = np.empty((128, 2), dtype=np.int64)
    away_2 = np.empty(128)  # no node of the range is nearer
    ranges[0, 0], ranges[0, 1], away_2[0] = 0, len(order), 0.0
    height = 1
    while height:
        height -= 1
        begin, end, least_2 = ranges[height, 0], ranges[height, 1], away_2[height]
        if least_2 > within_2 or least_2 >= best_2[count - 1]:
            continue
        middle = (begin + end) // 2
        is_leaf = end - begin <= LEAF
        for at in range(begin, end) if is_leaf else range(middle, middle + 1):
            gap_2 = (point[at, 0] - here[0]) ** 2 + (point[at, 1] - here[1]) ** 2 + (point[at, 2] - here[2]) ** 2
            if gap_2 <= within_2 and gap_2 < best_2[count - 1]:
                rank = count - 1
                while rank > 0 and best_2[rank - 1] > gap_2:
                    best_2[rank], best[rank] = best_2[rank - 1], best[rank - 1]
                    rank -= 1
                best_2[rank], best[rank] = gap_2, order[at]
        if not is_leaf:
            over = here[axis[middle]] - point[middle, axis[middle]]
            far, near = (0, 1) if over > 0 else (1, 0)
            for side, bound in ((far, max(least_2, over * over)), (near, least_2)):
                ranges[height, 0] = begin if side == 0 else middle + 1
                ranges[height, 1] = middle if side == 0 else end
                away_2[height] = bound
                height += 1
    found = 0
    while found < count and best[found] >= 0:
        found += 1
    return best[:found].copy()


@njit(cache=True, nogil=True)
def around_in_tree(here: FloatArray, within_2: float, tree: NodeTree) -> IntArray:
    """All nodes no farther from a point on the unit sphere than the root of within_2."""
    order, point, axis = tree.order, tree.point, tree.axis
    nodes = np.empty(64, dtype=np.int64)
    found = 0
    ranges = np.empty((128, 2), dtype=np.int64)
    ranges[0, 0], ranges[0, 1] = 0, len(order)
    height = 1
    while height:
        height -= 1
        begin, end = ranges[height, 0], ranges[height, 1]
        middle = (begin + end) // 2
        is_leaf = end - begin <= LEAF
        for at in range(begin, end) if is_leaf else range(middle, middle + 1):
            if (point[at, 0] - here[0]) ** 2 + (point[at, 1] - here[1]) ** 2 + (point[at, 2] - here[2]) ** 2 <= within_2:
                if found == len(nodes):
                    larger = np.empty(2 * found, dtype=np.int64)
                    larger[:found] = nodes
                    nodes = larger
                nodes[found] = order[at]
                found += 1
        if not is_leaf:
            over = here[axis[middle]] - point[middle, axis[middle]]
            if over <= 0 or over * over <= within_2:
                ranges[height, 0], ranges[height, 1] = begin, middle
                height += 1
            if over >= 0 or over * over <= within_2:
                ranges[height, 0], ranges[height, 1] = middle + 1, end
                height += 1
    return nodes[:found].copy()


@njit(cache=True, nogil=True)
def _nearest_of_each(here: FloatArray, tree: NodeTree) -> tuple[IntArray, FloatArray]:
    order, point, axis = tree.order, tree.point, tree.axis
    node = np.empty(len(here), dtype=np.int64)
    chord = np.empty(len(here))
    ranges = np.empty((128, 2), dtype=np.int64)
    away_2 = np.empty(128)
    for number in range(len(here)):
        x, y, z = here[number]
        best_2, best = np.inf, -1
        ranges[0, 0], ranges[0, 1], away_2[0] = 0, len(order), 0.0
        height = 1
        while height:
            height -= 1
            begin, end, least_2 = ranges[height, 0], ranges[height, 1], away_2[height]
            if least_2 >= best_2:
                continue
            middle = (begin + end) // 2
            is_leaf = end - begin <= LEAF
            for at in range(begin, end) if is_leaf else range(middle, middle + 1):
                gap_2 = (point[at, 0] - x) ** 2 + (point[at, 1] - y) ** 2 + (point[at, 2] - z) ** 2
                if gap_2 < best_2:
                    best_2, best = gap_2, at
            if not is_leaf:
                over = here[number, axis[middle]] - point[middle, axis[middle]]
                far, near = (0, 1) if over > 0 else (1, 0)
                for side, bound in ((far, max(least_2, over * over)), (near, least_2)):
                    ranges[height, 0] = begin if side == 0 else middle + 1
                    ranges[height, 1] = middle if side == 0 else end
                    away_2[height] = bound
                    height += 1
        node[number], chord[number] = order[best], np.sqrt(best_2)
    return node, chord
