"""Locked parts of routes: each run becomes one visit, so that every solver sees an ordinary problem."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from planning.problem import FloatArray, InvalidProblem, Lock, Problem, Resources, Routes, Unassigned, Visit

MAX_PATHS = 16  # through a locked run between the same two visits, of which none beats another


@dataclass(frozen=True)
class _Run:
    """One way of flying a locked run: its visits in order, and what it takes from the first one's begin to the last one's end.

    `taken` are metres, then seconds and Wh by class where the problem has them.
    """

    visits: tuple[int, ...]
    taken: tuple[float, ...]

    @property
    def length_m(self) -> float:
        return self.taken[0]


@dataclass(frozen=True, eq=False)
class Reduced:
    """A problem in which every lock is one target; `visits_of` and `targets_of` lead back to the visits and targets of the whole one.

    `is_whole` tells whether every way through the locked runs that could be the best is in it.
    """

    problem: Problem
    visits_of: tuple[tuple[int, ...], ...]
    targets_of: tuple[tuple[int, ...], ...]
    is_whole: bool

    def expanded(self, routes: Routes) -> Routes:
        return tuple(tuple(visit for reduced in route for visit in self.visits_of[reduced]) for route in routes)

    def expanded_reasons(self, unassigned: Sequence[Unassigned]) -> tuple[Unassigned, ...]:
        spread = [replace(item, target=target) for item in unassigned for target in self.targets_of[item.target]]
        return tuple(sorted(spread, key=lambda item: item.target))


def reduced(problem: Problem) -> Reduced:
    """The problem without its locks: a run is a target of one visit for each pair of its first and its last visit.

    Inside, stretches are flown in the directions that are shortest together; where seconds or Wh are not as the metres, each way that
    takes less of something is a visit. Leaving out what is locked weighs more than leaving out
    everything free of its priority, and less than anything of a higher one. Raises InvalidProblem if the locks contradict each other.
    """
    _refuse_contradictions(problem)
    visits_of_target = problem.visits_of_target()
    locked = {target for lock in problem.locks for target in lock.targets}
    free = [target for target in range(problem.target_count) if target not in locked]
    ways: list[_Run] = []
    visits: list[Visit] = []
    owner: list[Lock | None] = []
    for number, target in enumerate(free):
        for visit in visits_of_target[target]:
            ways.append(_Run((visit,), (problem.visits[visit].length_m,)))
            visits.append(replace(problem.visits[visit], target=number))
            owner.append(None)
    is_whole = True
    for number, lock in enumerate(problem.locks, start=len(free)):
        runs, has_all = _runs(problem, [visits_of_target[target] for target in lock.targets])
        is_whole = is_whole and has_all
        for run in runs:
            ways.append(run)
            service_s = sum(problem.visits[visit].service_s for visit in run.visits)
            done = sum(problem.visits[visit].done for visit in run.visits)
            visits.append(Visit(number, False, run.length_m, service_s, done))
            owner.append(lock)

    first = np.array([run.visits[0] for run in ways], dtype=np.int64)
    last = np.array([run.visits[-1] for run in ways], dtype=np.int64)
    between_m = problem.between_m[np.ix_(last, first)]
    allowed = np.ones((len(problem.uavs), len(problem.visits)), dtype=bool) if problem.allowed is None else problem.allowed
    owner_of = np.array(problem.owner) if problem.owner else np.arange(len(problem.uavs))
    allowed = np.array([allowed[:, list(run.visits)].all(axis=1) for run in ways], dtype=bool).reshape(len(ways), len(problem.uavs)).T
    for index, wish in enumerate(owner):
        if wish is not None:
            allowed[:, index] &= owner_of == owner_of[wish.uav]
            if wish.at_start:
                between_m[:, index] = np.inf
            if wish.at_end:
                between_m[index, :] = np.inf
    targets_of = (*((target,) for target in free), *(lock.targets for lock in problem.locks))
    return Reduced(
        replace(
            problem,
            visits=tuple(visits),
            target_count=len(targets_of),
            from_start_m=problem.from_start_m[:, first],
            between_m=between_m,
            to_start_m=problem.to_start_m[last],
            to_base_m=None if problem.to_base_m is None else problem.to_base_m[last],
            allowed=allowed,
            cannot_end=None if problem.cannot_end is None else problem.cannot_end[last],
            priorities=(),
            locks=(),
            weights=_weights(problem, targets_of, len(free)),
            seconds=None if problem.seconds is None else _of_runs(problem.seconds, ways),
            wh=None if problem.wh is None else _of_runs(problem.wh, ways),
        ),
        tuple(run.visits for run in ways),
        targets_of,
        is_whole,
    )


def _of_runs(resources: Resources, ways: Sequence[_Run]) -> Resources:
    """What whole runs take, along the ways between their visits too."""
    inside = [
        resources.at_visit[:, list(run.visits)].sum(axis=1) + resources.onward[:, list(run.visits[:-1]), list(run.visits[1:])].sum(axis=1)
        for run in ways
    ]
    first, last = np.array([run.visits[0] for run in ways], dtype=np.int64), np.array([run.visits[-1] for run in ways], dtype=np.int64)
    return resources.taken(first, last, np.array(inside, dtype=np.float64).reshape(len(ways), len(resources.onward)).T)


def _weights(problem: Problem, targets_of: Sequence[tuple[int, ...]], free: int) -> FloatArray:
    """(reduced targets,): whole numbers, for some hundred targets below 2^53: sums are exact. A run weighs what its parts do."""
    is_locked = np.zeros(problem.target_count, dtype=bool)
    is_locked[[target for targets in targets_of[free:] for target in targets]] = True
    weights, heavier = np.zeros(problem.target_count), 1.0
    for level in np.unique(problem.left_out_weights):
        of_level = problem.left_out_weights == level
        weights[of_level] = np.where(is_locked[of_level], heavier * (1.0 + float((of_level & ~is_locked).sum())), heavier)
        heavier += float(weights[of_level].sum())
    return np.array([weights[list(targets)].sum() for targets in targets_of])


def _runs(problem: Problem, alternatives: Sequence[Sequence[int]]) -> tuple[list[_Run], bool]:
    """The best ways through one visit of each target, for each first and each last visit that has one, and whether these are all."""
    runs: list[_Run] = []
    is_whole = True
    for first in alternatives[0]:
        ways = {first: [_begun(problem, first)]}
        for visits in alternatives[1:]:
            before = [run for found in ways.values() for run in found]
            ways = {visit: _unbeaten([_onward(problem, run, visit) for run in before]) for visit in visits}
            is_whole = is_whole and all(len(found) <= MAX_PATHS for found in ways.values())
            ways = {visit: found[:MAX_PATHS] for visit, found in ways.items()}
        runs += [run for found in ways.values() for run in found if np.isfinite(run.length_m)]
    return runs, is_whole


def _unbeaten(runs: Sequence[_Run]) -> list[_Run]:
    """Those of which no other takes as little of everything, the shortest first."""
    kept: list[_Run] = []
    for run in sorted(runs, key=lambda run: run.taken):
        if not any(all(own <= other for own, other in zip(better.taken, run.taken, strict=True)) for better in kept):
            kept.append(run)
    return kept


def _begun(problem: Problem, visit: int) -> _Run:
    more = [float(amount) for resources in _resources(problem) for amount in resources.at_visit[:, visit]]
    return _Run((visit,), (problem.visits[visit].length_m, *more))


def _onward(problem: Problem, run: _Run, visit: int) -> _Run:
    last = run.visits[-1]
    length_m = run.length_m + float(problem.between_m[last, visit]) + problem.visits[visit].length_m
    more = [
        float(amount) for resources in _resources(problem) for amount in resources.onward[:, last, visit] + resources.at_visit[:, visit]
    ]
    return _Run((*run.visits, visit), (length_m, *(own + added for own, added in zip(run.taken[1:], more, strict=True))))


def _resources(problem: Problem) -> list[Resources]:
    return [resources for resources in (problem.seconds, problem.wh) if resources is not None]


def _refuse_contradictions(problem: Problem) -> None:
    targets = [target for lock in problem.locks for target in lock.targets]
    if len(targets) != len(set(targets)):
        raise InvalidProblem("a target is locked twice")
    if not all(lock.targets and 0 <= lock.uav < len(problem.uavs) for lock in problem.locks):
        raise InvalidProblem("a lock names no target, or a UAV that is not there")
    if not all(0 <= target < problem.target_count for target in targets):
        raise InvalidProblem("a lock names a target that is not there")
    for ends in ([lock.uav for lock in problem.locks if lock.at_start], [lock.uav for lock in problem.locks if lock.at_end]):
        if len(ends) != len(set(ends)):
            raise InvalidProblem("two locks want the same end of a route")
