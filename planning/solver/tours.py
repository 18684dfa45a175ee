"""One UAV's shortest routes over every set of targets (Held and Karp 1962)."""

from typing import NamedTuple

import numpy as np
from numba import njit

from planning.problem import BoolArray, FloatArray, IntArray
from planning.solver.cost_matrices import NO_PATH_M


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
