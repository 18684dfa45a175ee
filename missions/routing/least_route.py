"""The least route that does one visit, by way of others where that is less: each target is done at most once on it."""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from missions.routing.problem import BoolArray, FloatArray, IntArray, Problem
from missions.routing.quantities import NO_WAY_M, Classes, Kind, Quantities, classes_of, quantities_of


@dataclass(frozen=True)
class LeastRoute:
    """The visits in order, and what they and the way to where the UAV ends take; inf where there is no way."""

    amount: float
    order: tuple[int, ...]


class LeastRoutes:
    """Of the UAVs and visits of a problem, in one quantity.

    The best way there and the best way back may both lead over the same visit, which no route does: then one of the two goes round it,
    whichever makes the route the lesser.
    """

    def __init__(self, problem: Problem, kind: Kind) -> None:
        self._classes: Classes = classes_of(problem)
        self._found: Quantities = quantities_of(problem, self._classes, [kind])
        self._target = np.array([visit.target for visit in problem.visits], dtype=np.int64)
        self._allowed = problem.allowed
        self.alone: FloatArray = self._found.first[0] + self._found.end[0]  # (u, v), without any other visit

    def route(self, uav: int, visit: int) -> LeastRoute:
        """Whether the UAV may fly the visit itself is not looked at."""
        first, end = self._found.first[0, uav], self._found.end[0, uav]
        onward = self._found.onward[0, self._classes.of_uav[uav]]
        others = self._target != self._target[visit]
        if self._allowed is not None:
            others &= self._allowed[uav]
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
        there, before = least_way(from_here, onward, visit, others)
        free = others & ~np.isin(self._target, self._target[before])
        back, after = least_way(to_end, np.ascontiguousarray(onward.T), visit, free)
        return _closed(there + back), before.tolist(), after.tolist()


def least_way(from_here: FloatArray, onward: FloatArray, visit: int, others: BoolArray) -> tuple[float, IntArray]:
    """To a visit over some of the others (Dijkstra 1959): what it takes, and those visits in order."""
    return _least_way(np.ascontiguousarray(from_here), np.ascontiguousarray(onward), visit, others)


def _closed(amount: float) -> float:
    return math.inf if amount >= NO_WAY_M else amount


@njit(cache=True, nogil=True)
def _least_way(from_here: FloatArray, onward: FloatArray, visit: int, others: BoolArray) -> tuple[float, IntArray]:
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
