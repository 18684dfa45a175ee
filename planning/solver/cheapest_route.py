"""The least route that does one visit, by way of others where that is less: each target is done at most once on it."""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from planning.problem import BoolArray, FloatArray, IntArray, Problem
from planning.solver.cost_matrices import NO_PATH_M, Classes, Quantities, QuantityKind, classes_of, quantities_of

MAX_TRIED = 8


@dataclass(frozen=True)
class LeastRoute:
    """The visits in order, and what they and the way to where the UAV ends take; inf where there is no way."""

    amount: float
    order: tuple[int, ...]


class LeastRoutes:
    """Of the UAVs and visits of a problem, in one quantity.

    Of up to MAX_TRIED targets each order is tried. Of more, the best way there and the best way back may both lead over the same visit,
    which no route does: then one of the two goes round it, whichever makes the route the lesser.
    """

    def __init__(self, problem: Problem, kind: QuantityKind) -> None:
        self._classes: Classes = classes_of(problem)
        self._found: Quantities = quantities_of(problem, self._classes, [kind])
        self._target = np.array([visit.target for visit in problem.visits], dtype=np.int64)
        self._allowed = problem.allowed
        self.alone: FloatArray = self._found.first[0] + self._found.end[0]  # (u, v), without any other visit

    def route(self, uav: int, visit: int) -> LeastRoute:
        """Whether the UAV may fly the visit itself is not looked at; in place of it another of its target may be flown."""
        first, end = self._found.first[0, uav], self._found.end[0, uav]
        onward = self._found.onward[0, self._classes.of_uav[uav]]
        others = self._target != self._target[visit]
        if self._allowed is not None:
            others &= self._allowed[uav]
        if self._target.max() < MAX_TRIED:
            others |= self._target == self._target[visit]
            amount, order = _least_of_all_orders(first, onward, end, self._target, others, self._target[visit])
            return LeastRoute(_closed(amount), tuple(order.tolist()) or (visit,))
        alone = LeastRoute(_closed(float(first[visit] + end[visit])), (visit,))
        ways = self._one_round_the_other(first, onward, end, visit, others)
        swapped = self._one_round_the_other(end, onward.T, first, visit, others)
        there_first = LeastRoute(ways[0], (*ways[1], visit, *reversed(ways[2])))
        back_first = LeastRoute(swapped[0], (*swapped[2], visit, *reversed(swapped[1])))
        return min((alone, there_first, back_first), key=lambda one: (one.amount, len(one.order)))

    def _one_round_the_other(
        self, from_here: FloatArray, onward: FloatArray, to_end: FloatArray, visit: int, others: BoolArray
    ) -> tuple[float, list[int], list[int]]:
        """The best way to the visit, then the best on to the end over none of its targets: amount, and the visits of both from outside."""
        there, before = least_path(from_here, onward, visit, others)
        free = others & ~np.isin(self._target, self._target[before])
        back, after = least_path(to_end, np.ascontiguousarray(onward.T), visit, free)
        passed = self._target[np.concatenate([before, after])]
        is_route = len(np.unique(passed)) == len(passed)  # a stretch is not flown from both of its ends
        return _closed(there + back) if is_route else math.inf, before.tolist(), after.tolist()


def least_path(from_here: FloatArray, onward: FloatArray, visit: int, others: BoolArray) -> tuple[float, IntArray]:
    """To a visit over some of the others (Dijkstra 1959): what it takes, and those visits in order."""
    return _least_path(np.ascontiguousarray(from_here), np.ascontiguousarray(onward), visit, others)


def _closed(amount: float) -> float:
    return math.inf if amount >= NO_PATH_M else amount


@njit(cache=True, nogil=True)
def _least_path(from_here: FloatArray, onward: FloatArray, visit: int, others: BoolArray) -> tuple[float, IntArray]:
    count = len(from_here)
    amount, before = from_here.copy(), np.full(count, -1, dtype=np.int64)
    is_done = np.zeros(count, dtype=np.bool_)
    for _ in range(count):
        nearest = -1
        for place in range(count):
            if (others[place] or place == visit) and not is_done[place] and (nearest < 0 or amount[place] < amount[nearest]):
                nearest = place
        if nearest < 0 or nearest == visit:
            break
        is_done[nearest] = True
        for place in range(count):
            if amount[nearest] + onward[nearest, place] < amount[place]:
                amount[place], before[place] = amount[nearest] + onward[nearest, place], nearest
    way = [0 for _ in range(0)]
    place = before[visit]
    while place >= 0:
        way.append(place)
        place = before[place]
    return amount[visit], np.array(way[::-1], dtype=np.int64)


@njit(cache=True, nogil=True)
def _least_of_all_orders(
    first: FloatArray, onward: FloatArray, end: FloatArray, target: IntArray, may: BoolArray, wanted: int
) -> tuple[float, IntArray]:
    """Over any visits, one of each target at most and one of the wanted (Held and Karp 1962): what it takes, and the visits in order."""
    visits = len(first)
    done = 1 << (target.max() + 1)
    amount, before = np.full((done, visits), np.inf), np.full((done, visits), -1, dtype=np.int64)
    for visit in range(visits):
        if may[visit]:
            amount[1 << target[visit], visit] = first[visit]
    least, least_done, last = np.inf, 0, -1
    for own in range(1, done):
        for here in range(visits):
            so_far = amount[own, here]
            if so_far == np.inf:
                continue
            if own >> wanted & 1 and so_far + end[here] < least:
                least, least_done, last = so_far + end[here], own, here
            for onto in range(visits):
                more = own | 1 << target[onto]
                if more != own and may[onto] and so_far + onward[here, onto] < amount[more, onto]:
                    amount[more, onto], before[more, onto] = so_far + onward[here, onto], here
    order = [0 for _ in range(0)]
    while last >= 0:
        order.append(last)
        least_done, last = least_done & ~(1 << target[last]), before[least_done, last]
    return least, np.array(order[::-1], dtype=np.int64)
