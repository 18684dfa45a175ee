"""Moves cost what they are measured to cost."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.problem import Objective, Problem
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.exchanges import NONE, added_m, draw_move, make, measured
from planning.solver.plan_state import copy_plan, empty_plan, settle, workspace
from planning.solver.problem_arrays import Arcs, problem_arrays_of
from planning.solver.reach import needed_range_m, reachable
from planning.solver.ruin_and_recreate import construct
from tests.planning.solver.random_problems import mixed_problem, random_problem, windy_problem


def alike(problem: Problem) -> Problem:
    between_m = np.minimum(problem.between_m, problem.between_m.T)
    return Problem(
        problem.uavs, problem.visits, problem.target_count, problem.from_start_m, between_m, problem.to_start_m, problem.objective
    )


def moved_as_measured(problem: Problem, seed: int) -> int:
    """How many moves were made and found to change the plan by what had been measured; each is drawn for the plan before."""
    usable = reachable(problem, needed_range_m(problem))
    arrays = problem_arrays_of(problem, Arcs.of(problem), usable)
    work = workspace(len(problem.uavs), problem.target_count, seed, len(arrays.more_limit))
    construct(arrays, work, 3, 1)
    plan, old, made = work.plan, empty_plan(len(problem.uavs), problem.target_count, len(arrays.more_limit)), 0
    for _ in range(300):
        move = draw_move(arrays, plan, work.random, -1)
        if move.kind == NONE:
            continue
        new, longer_m = measured(arrays, plan, move), added_m(arrays, plan, move)
        if max(new.length_m, new.other_length_m) >= NO_PATH_M / 2:
            continue
        copy_plan(plan, old)
        make(arrays, plan, old, move)
        for uav in (move.uav, move.other_uav):
            settle(arrays, plan, uav)
        assert new.length_m == pytest.approx(plan.length_m[move.uav], abs=1e-4)
        assert new.other_length_m == pytest.approx(plan.length_m[move.other_uav], abs=1e-4)
        assert longer_m == pytest.approx(plan.length_m.sum() - old.length_m.sum(), abs=1e-4)
        assert (new.service_s, new.other_service_s) == pytest.approx((plan.service_s[move.uav], plan.service_s[move.other_uav]))
        assert (new.done, new.other_done) == (plan.done[move.uav], plan.done[move.other_uav])
        flown = [visit for uav, count in enumerate(plan.size) for visit in plan.visit[uav, :count].tolist()]
        assert sorted(arrays.target[flown].tolist()) == sorted(np.flatnonzero(plan.uav_of >= 0).tolist())
        assert all(usable[uav, visit] for uav, count in enumerate(plan.size) for visit in plan.visit[uav, :count].tolist())
        made += 1
    return made


@settings(max_examples=40)
@given(st.integers(0, 1_000_000), st.integers(1, 4), st.integers(2, 14))
def test_a_move_changes_a_plan_by_what_was_measured(seed: int, uavs: int, targets: int) -> None:
    moved_as_measured(mixed_problem(seed, uavs=uavs, targets=targets), seed)


@settings(max_examples=40)
@given(st.integers(0, 1_000_000), st.sampled_from(list(Objective)), st.integers(1, 4), st.integers(2, 14))
def test_so_it_does_in_the_wind_between_uavs_that_fly_otherwise(seed: int, objective: Objective, uavs: int, targets: int) -> None:
    moved_as_measured(windy_problem(seed, objective, uavs=uavs, targets=targets), seed)


def test_so_it_does_where_the_ways_back_are_as_long() -> None:
    assert moved_as_measured(alike(random_problem(3, uavs=4, targets=30)), 3) > 100
    assert moved_as_measured(random_problem(3, uavs=4, targets=30, stretches=10, returns=True), 3) > 100
