"""One UAV's shortest routes over every set of targets (Held and Karp 1962), also where range or battery limits them beside the objective.

The shortest tour over a set may take more Wh than the battery has while another keeps it. Most sets are settled without a search: where
their shortest tour keeps every limit, it is the best; where even the tour of the least Wh does not, there is none. For those between,
labels are kept: of each set and last visit all tours of which none is shorter and takes less (as in resource constrained shortest paths,
M. Desrochers and F. Soumis, INFOR 26, 1988). Their number is bounded; where the bound is met, the tours are good but not proven.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from planning.problem import BoolArray, FloatArray, IntArray
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.problem_arrays import Arcs
from planning.solver.reach import least_paths

MAX_LABELS = 96  # of one set and last visit
ALL_LABELS = 300_000  # some tenths of a second; beyond, each set and last visit keeps but the shortest tour and those that take least
ALIKE = 1e-10  # the share of a limit by which tours may differ and count as taking the same: rounding


class UavArcs(NamedTuple):
    """One UAV's arcs, as in Arcs: first_m (v,), back_m (v, v) to the row's visit, end_m (v,); target (v,), allowed (v,)."""

    first_m: FloatArray
    back_m: FloatArray
    end_m: FloatArray
    target: IntArray
    allowed: BoolArray


@njit(cache=True, nogil=True)
def shortest_tours(arcs: UavArcs, reach_m: FloatArray, length_m: FloatArray) -> None:
    """Fill in one UAV's shortest routes: over a set, ending with a visit (sets, v), and over a set (sets,)."""
    first_m, back_m, end_m, target, allowed = arcs
    visits = len(target)
    length_m[0] = 0.0
    reach_m[0] = np.inf
    for members in range(1, len(length_m)):
        row = reach_m[members]
        closed_m = np.inf
        for visit in range(visits):
            row[visit] = np.inf
            bit = 1 << target[visit]
            if members & bit == 0 or not allowed[visit]:
                continue
            rest = members ^ bit
            if rest == 0:
                least_m = first_m[visit]
            else:
                least_m = np.inf
                before, arc_m = reach_m[rest], back_m[visit]
                for other in range(visits):
                    least_m = min(least_m, before[other] + arc_m[other])
            if least_m < NO_PATH_M:
                row[visit] = least_m
                closed_m = min(closed_m, least_m + end_m[visit])
        length_m[members] = closed_m if closed_m < NO_PATH_M else np.inf


@njit(cache=True, nogil=True)
def walk_back(members: int, reach_m: FloatArray, arcs: UavArcs, order: IntArray) -> int:
    """Write one UAV's shortest route over the set; returns how many visits it has."""
    back_m, end_m, target = arcs.back_m, arcs.end_m, arcs.target
    if members == 0:
        return 0
    visits = len(target)
    last, least_m = 0, np.inf
    for visit in range(visits):
        if reach_m[members, visit] + end_m[visit] < least_m:
            last, least_m = visit, reach_m[members, visit] + end_m[visit]
    count = 0
    for number in range(len(order)):
        if members >> number & 1:
            count += 1
    for place in range(count - 1, -1, -1):
        order[place] = last
        members ^= 1 << target[last]
        before, least_m = 0, np.inf
        for other in range(visits):
            if reach_m[members, other] + back_m[last, other] < least_m:
                before, least_m = other, reach_m[members, other] + back_m[last, other]
        last = before
    return count


@dataclass(frozen=True, eq=False)
class Tours:
    """The least length over each set that keeps every limit, (sets,), inf if none does; the tours of some sets are labels."""

    length_m: FloatArray
    is_whole: bool
    _reach_m: FloatArray
    _arcs: UavArcs
    _label_of: IntArray
    _parent: IntArray
    _visit: IntArray

    def route(self, members: int) -> tuple[int, ...]:
        """Visits in order of the best tour over a set that has one."""
        label = int(self._label_of[members])
        if label < 0:
            order = np.empty(len(self._arcs.target), dtype=np.int64)
            count = walk_back(members, self._reach_m, self._arcs, order)
            return tuple(order[:count].tolist())
        visits = []
        while label >= 0:
            visits.append(int(self._visit[label]))
            label = int(self._parent[label])
        return tuple(reversed(visits))


def limited_tours(arcs: Arcs, uav: int, counts: IntArray, most_labels: int = MAX_LABELS) -> Tours:
    """counts (sets,) are the targets done by each set; most_labels those kept of each set and last visit."""
    burden, number = arcs.burden, int(arcs.class_of[uav])
    back_m = np.ascontiguousarray(arcs.onward_m[number].T)
    own = UavArcs(arcs.first_m[uav], back_m, arcs.end_m[uav], arcs.target, arcs.allowed[uav])
    more = len(burden)
    home = np.empty((more, len(arcs.target)))
    back = np.empty((more, *back_m.shape))
    for at in range(more):
        back[at] = burden.onward[at, number].T
        home[at] = (least_paths(np.where(arcs.allowed[uav], burden.onward[at, number], np.inf)) + burden.end[at, uav]).min(axis=1)
    first, end = np.ascontiguousarray(burden.first[:, uav]), np.ascontiguousarray(burden.end[:, uav])
    limits = TourLimits(float(arcs.limit_m[uav]), int(arcs.most[uav]), counts, first, back, end, burden.limit[:, uav].copy())
    found = _limited(own, limits, home, most_labels)
    length_m, reach_m, label_of, parent, visit, is_whole = found
    return Tours(length_m, is_whole, reach_m, own, label_of, parent, visit)


class TourLimits(NamedTuple):
    """What is limited of one UAV's tours: the length, the targets done, counts (sets,), and r quantities more.

    Of these first (r, v), back (r, v, v) to the row's visit, end (r, v) and limit (r,).
    """

    limit_m: float
    most: int
    counts: IntArray
    first: FloatArray
    back: FloatArray
    end: FloatArray
    limit: FloatArray


@njit(cache=True, nogil=True)
def settled_tours(arcs: UavArcs, limits: TourLimits, reach_m: FloatArray, length_m: FloatArray, is_contested: BoolArray) -> bool:
    """Fill in reach and lengths as `shortest_tours`, inf for the sets of which no tour keeps every limit. Whether any set is contested.

    Of a contested one the shortest tour breaks a limit that another of its tours keeps.
    """
    first, back, end, limit = limits.first, limits.back, limits.end, limits.limit
    sets, visits, more = len(limits.counts), len(arcs.target), len(limit)
    shortest_tours(arcs, reach_m, length_m)
    can_be = np.ones(sets, dtype=np.bool_)
    reach, least = np.empty((sets, visits)), np.empty(sets)
    for at in range(more):
        shortest_tours(UavArcs(first[at], back[at], end[at], arcs.target, arcs.allowed), reach, least)
        for members in range(sets):
            can_be[members] &= least[members] <= limit[at]
    order = np.empty(visits, dtype=np.int64)
    any_contested = False
    for members in range(1, sets):
        if not can_be[members] or length_m[members] > limits.limit_m or limits.counts[members] > limits.most:
            length_m[members] = np.inf
            continue
        if not more:
            continue
        count = walk_back(members, reach_m, arcs, order)
        for at in range(more):
            taken = first[at, order[0]] + end[at, order[count - 1]]
            for place in range(1, count):
                taken += back[at, order[place], order[place - 1]]
            if taken > limit[at]:
                is_contested[members] = any_contested = True
    return any_contested


@njit(cache=True, nogil=True)
def _limited(
    arcs: UavArcs, limits: TourLimits, home: FloatArray, most_labels: int
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray, bool]:
    """Lengths (sets,), reach as of `shortest_tours`, each set's label or -1, parents and visits of labels, whether all are there.

    home (r, v): what the least way on from each visit takes.
    """
    sets, visits = len(limits.counts), len(arcs.target)
    reach_m, length_m = np.empty((sets, visits)), np.empty(sets)
    label_of = np.full(sets, -1, dtype=np.int64)
    is_contested = np.zeros(sets, dtype=np.bool_)
    if not settled_tours(arcs, limits, reach_m, length_m, is_contested):
        nothing = np.empty(0, dtype=np.int64)
        return length_m, reach_m, label_of, nothing, nothing, True
    is_wanted = is_contested.copy()
    for members in range(sets - 1, 0, -1):
        if is_wanted[members]:
            rest = members
            while rest:
                is_wanted[members ^ (rest & -rest)] = True
                rest &= rest - 1
    parent, visit, is_whole = _labels(arcs, limits, home, is_wanted, is_contested, length_m, label_of, most_labels)
    return length_m, reach_m, label_of, parent, visit, is_whole


@njit(cache=True, nogil=True)
def _labels(
    arcs: UavArcs,
    limits: TourLimits,
    home: FloatArray,
    is_wanted: BoolArray,
    is_contested: BoolArray,
    length_m: FloatArray,
    label_of: IntArray,
    most_labels: int,
) -> tuple[IntArray, IntArray, bool]:
    """Fill in lengths and labels of the contested sets.

    A label is a tour up to its last visit: its length, then what it takes of each limit. Returns parents, last visits, and whether no
    label had to be dropped.
    """
    end_m, end, limit = arcs.end_m, limits.end, limits.limit
    sets, visits, more = len(length_m), len(arcs.target), len(limit)
    label = np.empty((1024, 1 + more))
    parent, last = np.empty(1024, dtype=np.int64), np.empty(1024, dtype=np.int64)
    begin, count = np.zeros((sets, visits), dtype=np.int64), np.zeros((sets, visits), dtype=np.int64)
    tried, tried_from = np.empty((64, 1 + more)), np.empty(64, dtype=np.int64)
    total, is_whole = 0, True
    for members in range(1, sets):
        if not is_wanted[members]:
            continue
        best_m = np.inf
        for visit in range(visits):
            if members & 1 << arcs.target[visit] == 0 or not arcs.allowed[visit]:
                continue
            labels = (label, begin, count)
            trials, tried, tried_from = _longer_tours(members, visit, arcs, limits, home, labels, tried, tried_from)
            if trials == 0:
                continue
            most = max(most_labels, 1 + more) if total < ALL_LABELS else 1 + more
            begin[members, visit] = total
            kept = 0
            for at in np.argsort(tried[:trials, 0]):
                if _is_beaten(tried[at], label[total : total + kept], limit):
                    continue
                if kept == most:
                    is_whole = False
                    for place in range(1, 1 + more):  # the last places are for those that take least
                        if tried[at, place] < label[total + kept - place, place]:
                            label[total + kept - place], parent[total + kept - place] = tried[at], tried_from[at]
                            break
                    continue
                if total + kept == len(last):
                    label, parent, last = np.append(label, label, axis=0), np.append(parent, parent), np.append(last, last)
                label[total + kept], parent[total + kept], last[total + kept] = tried[at], tried_from[at], visit
                kept += 1
            count[members, visit] = kept
            if is_contested[members]:
                for number in range(total, total + kept):
                    closed_m = label[number, 0] + end_m[visit]
                    may = closed_m < best_m
                    for at in range(more):
                        may = may and label[number, 1 + at] + end[at, visit] <= limit[at]
                    if may:
                        best_m, label_of[members] = closed_m, number
            total += kept
        if is_contested[members]:
            length_m[members] = best_m if best_m <= limits.limit_m else np.inf
            if length_m[members] == np.inf:
                label_of[members] = -1
    return parent, last, is_whole


@njit(cache=True, nogil=True)
def _longer_tours(
    members: int,
    visit: int,
    arcs: UavArcs,
    limits: TourLimits,
    home: FloatArray,
    labels: tuple[FloatArray, IntArray, IntArray],
    tried: FloatArray,
    tried_from: IntArray,
) -> tuple[int, FloatArray, IntArray]:
    """The labels of a set without a visit, longer by that visit, and still within the limits: how many, and the two arrays, grown.

    labels: all of them, and where those of each set and last visit begin and how many they are, (sets, v).
    """
    label, begin, count = labels
    back_m, first, back, limit = arcs.back_m, limits.first, limits.back, limits.limit
    rest, trials = members ^ 1 << arcs.target[visit], 0
    for other in range(len(arcs.target) if rest else 1):
        if rest and (count[rest, other] == 0 or back_m[visit, other] >= NO_PATH_M):
            continue
        for number in range(count[rest, other] if rest else 1):
            before = begin[rest, other] + number if rest else -1
            if trials == len(tried):
                tried, tried_from = np.append(tried, tried, axis=0), np.append(tried_from, tried_from)
            tried[trials, 0] = label[before, 0] + back_m[visit, other] if rest else arcs.first_m[visit]
            may = tried[trials, 0] < NO_PATH_M
            for at in range(len(limit)):
                tried[trials, 1 + at] = label[before, 1 + at] + back[at, visit, other] if rest else first[at, visit]
                may = may and tried[trials, 1 + at] + home[at, visit] <= limit[at]
            if may:
                tried_from[trials] = before
                trials += 1
    return trials, tried, tried_from


@njit(cache=True, nogil=True)
def _is_beaten(tour: FloatArray, shorter: FloatArray, limit: FloatArray) -> bool:
    """Whether one of the shorter tours takes no more of any limit."""
    for number in range(len(shorter)):
        is_beaten = True
        for place in range(1, len(tour)):
            if shorter[number, place] > tour[place] + ALIKE * limit[place - 1]:
                is_beaten = False
                break
        if is_beaten:
            return True
    return False
