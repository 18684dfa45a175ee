"""Lower bounds: never above the best plan, and near it where that is known."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from planning.problem import Objective, Problem, Routes, merit
from planning.solver.exact import best_plan
from planning.solver.lower_bounds import lower_bound
from planning.solver.reach import needed_range_m, reachable
from planning.solver.solver import solve
from tests.planning.solver.random_problems import BY_WAYS, mixed_problem, random_problem


def bound_of(problem: Problem, routes: Routes) -> float:
    needed_m = needed_range_m(problem)
    return lower_bound(problem, reachable(problem, needed_m), needed_m, routes, seed=7)


def worse(problem: Problem, routes: Routes, leave_out: int) -> Routes:
    """Without the last visits of each route, so far as that keeps the limits."""
    shorter = tuple(route[: max(0, len(route) - leave_out)] for route in routes)
    return shorter if all(problem.keeps_limits(uav, route) for uav, route in enumerate(shorter)) else routes


@settings(max_examples=120)
@example(seed=1739, uavs=3, targets=1, leave_out=0)  # a UAV that can do nothing
@given(seed=st.integers(0, 1_000_000), uavs=st.integers(1, 3), targets=st.integers(1, 8), leave_out=st.integers(0, 2))
def test_no_plan_is_better_than_the_bound(seed: int, uavs: int, targets: int, leave_out: int) -> None:
    problem = mixed_problem(seed, uavs=uavs, targets=targets)
    best = best_plan(problem)
    assert bound_of(problem, worse(problem, best, leave_out)) <= merit(problem, best)[1]


@pytest.mark.parametrize("objective", BY_WAYS)
def test_the_bound_is_near_the_best_plan(objective: Objective) -> None:
    gaps = []
    for seed in range(8):
        problem = random_problem(seed, uavs=3, targets=11, returns=True, objective=objective)
        best = best_plan(problem)
        gaps.append(1 - bound_of(problem, best) / merit(problem, best)[1])
    assert np.mean(gaps) < 0.08


def test_a_large_plan_tells_its_bound_and_a_small_one_is_proven() -> None:
    large, small = solve(random_problem(5, uavs=4, targets=40)), solve(random_problem(5, uavs=4, targets=8))
    assert 0.8 * large.total_m < large.lower_bound < large.total_m
    assert large.gap == pytest.approx(1 - large.lower_bound / large.total_m)
    assert not large.is_proven
    assert (small.lower_bound, small.gap, small.is_proven) == (small.total_m, 0.0, True)


def test_a_target_that_only_one_far_route_reaches_proves_the_longest_route() -> None:
    problem = random_problem(5, uavs=20, targets=30, objective=Objective.MAKESPAN)
    problem.from_start_m[:, 3] = problem.between_m[:, 3] = 200_000.0
    solution = solve(problem)
    assert solution.longest_s == 200_000.0
    assert solution.is_proven
