"""Locked runs: flown as they were locked, and no dearer than they must be."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from planning.problem import InvalidProblem, Lock, Objective, Priority, Problem, Routes, UavStart, Visit, merit
from planning.solver.locks import reduced
from planning.solver.solver import solve
from tests.planning.solver.random_problems import every_plan, honours, mixed_problem, random_problem

seeds = st.integers(0, 1_000_000)


def is_flown(problem: Problem, routes: Routes, lock: Lock) -> bool:
    return any(problem.visits[visit].target in lock.targets for route in routes for visit in route)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])  # locks that cannot be kept
@given(seeds)
def test_a_plan_with_locks_is_the_best_of_all_that_honour_them(seed: int) -> None:
    problem = mixed_problem(seed, targets=4, locks=2)
    solution = solve(problem)
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(solution.routes))
    kept = [lock for lock in problem.locks if honours(problem, solution.routes, lock)]
    assert not any(is_flown(problem, solution.routes, lock) for lock in problem.locks if lock not in kept)
    assume(len(kept) == len(problem.locks))
    best = min(merit(problem, plan) for plan in every_plan(problem) if all(honours(problem, plan, lock) for lock in kept))
    assert merit(problem, solution.routes) == pytest.approx(best, rel=1e-9)


@settings(max_examples=15)
@given(seeds, st.integers(6, 25))
def test_every_lock_is_honoured_or_left_out_whole(seed: int, targets: int) -> None:
    problem = mixed_problem(seed, uavs=3, targets=targets, locks=3)
    solution = solve(problem)
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(solution.routes))
    for lock in problem.locks:
        assert honours(problem, solution.routes, lock) or not is_flown(problem, solution.routes, lock)
    visited = [problem.visits[visit].target for route in solution.routes for visit in route]
    assert sorted([*visited, *(item.target for item in solution.unassigned)]) == list(range(targets))


@settings(max_examples=30)
@given(seeds, st.data())
def test_locking_what_the_best_plan_has_anyway_costs_nothing(seed: int, data: st.DataObject) -> None:
    problem = mixed_problem(seed, uavs=2, targets=7)
    free = solve(problem)
    locks = []
    for uav, route in enumerate(free.routes):
        if route:
            first = data.draw(st.integers(0, len(route) - 1))
            last = data.draw(st.integers(first + 1, len(route)))
            run = tuple(problem.visits[visit].target for visit in route[first:last])
            locks.append(Lock(uav, run, at_start=first == 0, at_end=last == len(route)))
    locked = solve(replace(problem, locks=tuple(locks)))
    assert merit(problem, locked.routes) == pytest.approx(merit(problem, free.routes), rel=1e-9)


@pytest.mark.parametrize("locks", [(), (Lock(0, (0,)), Lock(0, (1,)), Lock(0, (2,))), (Lock(0, (1, 2)),)])
def test_what_is_locked_is_left_out_before_anything_of_a_higher_priority(locks: tuple[Lock, ...]) -> None:
    problem = Problem(
        uavs=(UavStart(max_range_m=60.0),),
        visits=tuple(Visit(target) for target in range(3)),
        target_count=3,
        from_start_m=np.array([[50.0, 1.0, 1.0]]),
        between_m=np.array([[1.0, 100.0, 100.0], [100.0, 1.0, 1.0], [100.0, 1.0, 1.0]]),
        to_start_m=np.ones((3, 1)),
        objective=Objective.TOTAL,
        priorities=(Priority.HIGH, Priority.LOW, Priority.LOW),
        locks=locks,
    )
    assert [item.target for item in solve(problem).unassigned] == [1, 2]


def test_of_one_priority_what_is_locked_stays() -> None:
    problem = replace(random_problem(5, uavs=1, targets=6), priorities=())
    most = replace(problem, uavs=(replace(problem.uavs[0], max_range_m=None, most_targets=2),), locks=(Lock(0, (4,)),))
    assert 4 not in [item.target for item in solve(most).unassigned]


def test_a_run_of_stretches_keeps_one_visit_for_each_pair_of_ends() -> None:
    problem = replace(random_problem(3, targets=4, stretches=4), locks=(Lock(0, (2, 0, 1)),))
    composites = [visits for visits in reduced(problem).visits_of if len(visits) == 3]
    assert len(composites) == 4
    assert len({(visits[0], visits[-1]) for visits in composites}) == 4


@pytest.mark.parametrize(
    "locks",
    [
        (Lock(0, (0, 1)), Lock(1, (1,))),
        (Lock(0, (0,), at_start=True), Lock(0, (1,), at_start=True)),
        (Lock(7, (0,)),),
        (Lock(0, (9,)),),
        (Lock(0, ()),),
    ],
)
def test_locks_that_contradict_each_other_are_refused(locks: tuple[Lock, ...]) -> None:
    with pytest.raises(InvalidProblem):
        solve(replace(random_problem(1), locks=locks))
