"""Locked parts of routes: each run becomes one visit, so that every solver sees an ordinary problem."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from planning.problem import FloatArray, InvalidProblem, Lock, Problem
from planning.solver.contraction import Reduced, Run, alone, begun, onward, reduced_to

MAX_PATHS = 16  # through a locked run between the same two visits, of which none beats another


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
    runs: list[Run] = []
    target_of: list[int] = []
    owner: list[Lock | None] = []
    for number, target in enumerate(free):
        for visit in visits_of_target[target]:
            runs.append(alone(problem, visit))
            target_of.append(number)
            owner.append(None)
    is_whole = True
    for number, lock in enumerate(problem.locks, start=len(free)):
        found, has_all = _runs(problem, [visits_of_target[target] for target in lock.targets])
        is_whole = is_whole and has_all
        runs += found
        target_of += [number] * len(found)
        owner += [lock] * len(found)
    targets_of = (*((target,) for target in free), *(lock.targets for lock in problem.locks))
    whole = reduced_to(problem, runs, target_of, targets_of, _weights(problem, targets_of, len(free)))
    owner_of = np.array(problem.owner) if problem.owner else np.arange(len(problem.uavs))
    between_m, allowed = whole.problem.between_m.copy(), np.array(whole.problem.allowed)
    for index, wish in enumerate(owner):
        if wish is not None:
            allowed[:, index] &= owner_of == owner_of[wish.uav]
            if wish.at_start:
                between_m[:, index] = np.inf
            if wish.at_end:
                between_m[index, :] = np.inf
    return replace(whole, problem=replace(whole.problem, between_m=between_m, allowed=allowed), is_whole=is_whole)


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


def _runs(problem: Problem, alternatives: Sequence[Sequence[int]]) -> tuple[list[Run], bool]:
    """The best ways through one visit of each target, for each first and each last visit that has one, and whether these are all."""
    runs: list[Run] = []
    is_whole = True
    for first in alternatives[0]:
        ways = {first: [begun(problem, first)]}
        for visits in alternatives[1:]:
            before = [run for found in ways.values() for run in found]
            ways = {visit: _unbeaten([onward(problem, run, visit) for run in before]) for visit in visits}
            is_whole = is_whole and all(len(found) <= MAX_PATHS for found in ways.values())
            ways = {visit: found[:MAX_PATHS] for visit, found in ways.items()}
        runs += [run for found in ways.values() for run in found if np.isfinite(run.length_m)]
    return runs, is_whole


def _unbeaten(runs: Sequence[Run]) -> list[Run]:
    """Those of which no other takes as little of everything, the shortest first."""
    kept: list[Run] = []
    for run in sorted(runs, key=lambda run: run.taken):
        if not any(all(own <= other for own, other in zip(better.taken, run.taken, strict=True)) for better in kept):
            kept.append(run)
    return kept


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
