"""The best plan of a small problem, by dynamic programming over sets of targets."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from missions.routing.problem import FloatArray, Objective, Problem, Routes

MAX_TARGETS = 12  # 4,096 sets and 531,441 pairs of a set and a part of it: milliseconds per UAV

IntArray = NDArray[np.int64]


def best_plan(problem: Problem) -> Routes:
    """The plan that visits the most targets and, among these, is best by the objective; ranges are kept.

    Held and Karp's recursion gives each UAV's shortest route over every set of targets; the sets are then shared out among the UAVs.
    With the longest route as the objective, equal plans are told apart by total length only as far as the recursion sees it.
    """
    uavs = len(problem.uavs)
    tours = [_Tours(problem, uav) for uav in range(uavs)]
    parts = _parts_of_sets(problem.target_count)
    longest_m, total_m = [tours[0].length_m], [tours[0].length_m]
    for tour in tours[1:]:
        rest = parts.whole ^ parts.part
        sum_m = total_m[-1][rest] + tour.length_m[parts.part]
        span_m = np.maximum(longest_m[-1][rest], tour.length_m[parts.part])
        chosen = parts.best(sum_m if problem.objective is Objective.TOTAL else span_m, sum_m)
        longest_m.append(span_m[chosen])
        total_m.append(sum_m[chosen])

    visited = _best_set(problem, longest_m[-1], total_m[-1])
    routes: list[tuple[int, ...]] = []
    for uav in range(uavs - 1, 0, -1):
        part = parts.parts_of(visited)
        sum_m = total_m[uav - 1][visited ^ part] + tours[uav].length_m[part]
        span_m = np.maximum(longest_m[uav - 1][visited ^ part], tours[uav].length_m[part])
        key = (sum_m, span_m) if problem.objective is Objective.TOTAL else (span_m, sum_m)
        own = int(part[np.lexsort((key[1], key[0]))[0]])
        routes.append(tours[uav].route(own))
        visited ^= own
    routes.append(tours[0].route(visited))
    return tuple(reversed(routes))


def _best_set(problem: Problem, longest_m: FloatArray, total_m: FloatArray) -> int:
    sizes = np.array([number.bit_count() for number in range(len(total_m))])
    first, second = (total_m, longest_m) if problem.objective is Objective.TOTAL else (longest_m, total_m)
    most = sizes[np.isfinite(total_m)].max()
    order = np.lexsort((second, first, np.where(np.isfinite(total_m), most - sizes, most + 1)))
    return int(order[0])


class _Tours:
    """One UAV's shortest routes: `length_m` for each set of targets, inf where it has no way or not the range."""

    def __init__(self, problem: Problem, uav: int) -> None:
        self.target = np.array([visit.target for visit in problem.visits], dtype=np.int64)
        along_m = np.array([visit.length_m for visit in problem.visits])
        sets = 1 << problem.target_count
        visits = len(problem.visits)
        self.reach_m = np.full((sets, visits), np.inf)  # over the set, ending with the visit
        self.before = np.full((sets, visits), -1, dtype=np.int64)
        self.reach_m[1 << self.target, np.arange(visits)] = problem.from_start_m[uav] + along_m
        for members in _sets_by_size(problem.target_count)[1:-1]:
            onward_m = self.reach_m[members][:, :, None] + problem.between_m[None]
            last = onward_m.argmin(axis=1)
            least_m = np.take_along_axis(onward_m, last[:, None, :], axis=1)[:, 0, :] + along_m
            for visit in range(visits):
                open_to = (members >> self.target[visit]) & 1 == 0
                grown = members[open_to] | (1 << int(self.target[visit]))
                self.reach_m[grown, visit] = least_m[open_to, visit]
                self.before[grown, visit] = last[open_to, visit]
        home_m = problem.to_start_m[:, uav] if problem.uavs[uav].returns else np.zeros(visits)
        closed_m = self.reach_m + home_m
        self.last = closed_m.argmin(axis=1)
        self.length_m: FloatArray = closed_m.min(axis=1)
        self.length_m[self.length_m > problem.uavs[uav].limit_m] = np.inf
        self.length_m[0] = 0.0

    def route(self, members: int) -> tuple[int, ...]:
        route: list[int] = []
        visit = int(self.last[members])
        while members:
            route.append(visit)
            members, visit = members ^ (1 << int(self.target[visit])), int(self.before[members, visit])
        return tuple(reversed(route))


class _Parts:
    """All pairs of a set and a part of it, grouped by the set."""

    def __init__(self, targets: int) -> None:
        parts = [_submasks(number) for number in range(1 << targets)]
        counts = np.array([len(submasks) for submasks in parts])
        self.first: IntArray = np.concatenate([[0], np.cumsum(counts)[:-1]])
        self.part: IntArray = np.concatenate(parts)
        self.whole: IntArray = np.repeat(np.arange(1 << targets), counts)

    def parts_of(self, whole: int) -> IntArray:
        return self.part[self.first[whole] : self.first[whole] + (1 << whole.bit_count())]

    def best(self, key: FloatArray, second: FloatArray) -> IntArray:
        """For each set the index of the pair with the least key; among equals, with the least second key."""
        least = np.minimum.reduceat(key, self.first)
        tied = np.where(key <= least[self.whole], second, np.inf)
        least_tied = np.minimum.reduceat(tied, self.first)
        hit = np.flatnonzero((key <= least[self.whole]) & (tied <= least_tied[self.whole]))
        return hit[np.searchsorted(self.whole[hit], np.arange(len(self.first)))]


def _submasks(number: int) -> IntArray:
    submasks = np.zeros(1, dtype=np.int64)
    while number:
        bit = number & -number
        submasks = np.concatenate([submasks, submasks | bit])
        number ^= bit
    return submasks


@lru_cache(maxsize=MAX_TARGETS + 1)
def _parts_of_sets(targets: int) -> _Parts:
    return _Parts(targets)


@lru_cache(maxsize=MAX_TARGETS + 1)
def _sets_by_size(targets: int) -> list[IntArray]:
    numbers = np.arange(1 << targets, dtype=np.int64)
    sizes = np.array([int(number).bit_count() for number in numbers])
    return [numbers[sizes == size] for size in range(targets + 1)]
