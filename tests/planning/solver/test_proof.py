"""Proofs in the background: CP-SAT and larger tables against every plan there is, and against each other."""

import itertools
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.problem import End, Objective, Problem, Routes, UavStart, Visit, merit
from planning.solver import exact, proof
from planning.solver.exact import best_plan, proven_routes
from planning.solver.problem_arrays import Arcs
from planning.solver.reach import needed_range_m, reachable
from planning.solver.solver import MAX_PROVEN_TARGETS, BoundedPlan, Proof, never, solve
from planning.solver.sorties import unfolded
from tests.cases import long
from tests.planning.solver.random_problems import mixed_problem, windy_problem

seeds = st.integers(0, 1_000_000)
MANY = [24, *long(1_000)]  # random problems


def bounded(problem: Problem, routes: Routes = (), bound: float = 0.0) -> BoundedPlan:
    """Without routes nothing is visited: the worst plan to begin with."""
    needed_m = needed_range_m(problem)
    return BoundedPlan(problem, reachable(problem, needed_m), needed_m, routes or ((),) * len(problem.uavs), bound)


def proven(problem: Problem, routes: Routes = (), *, time_s: float = 20.0, stop: Callable[[], bool] = never) -> Proof | None:
    return proof.prove(bounded(problem, routes), time_s=time_s, stop=stop, on_look=lambda share, routes, bound: None, seed=7)


@pytest.fixture
def without_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proof, "_has_table", lambda arcs: False)


def plain(places: int, uavs: int, objective: Objective, *, seed: int = 3) -> Problem:
    """Places of a plane and UAVs that return to where they start."""
    at = np.random.default_rng(seed).random((places + uavs, 2)) * 20_000.0
    apart_m = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1))
    return Problem(
        uavs=(UavStart(end=End.RETURN, speed_mps=12.0),) * uavs,
        visits=tuple(Visit(target) for target in range(places)),
        target_count=places,
        from_start_m=apart_m[places:, :places],
        between_m=apart_m[:places, :places],
        to_start_m=apart_m[:places, places:],
        objective=objective,
    )


def is_best(problem: Problem) -> None:
    """CP-SAT finds a plan as good as the best one, proves no better bound, and breaks no limit."""
    found = proven(problem)
    missed, value, _ = merit(problem, best_plan(problem))
    if found is None:
        assert missed == problem.left_out_weights.sum()
        return
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(found.routes))
    assert merit(problem, found.routes)[:2] == pytest.approx((missed, value), rel=1e-6, abs=0.05)
    assert found.bound is None or found.bound <= value * (1 + 1e-9)


@pytest.mark.usefixtures("without_tables")
@pytest.mark.parametrize("count", MANY)
@pytest.mark.parametrize("objective", list(Objective))
def test_cp_sat_finds_and_proves_the_best_plan_by_every_objective_and_limit(objective: Objective, count: int) -> None:
    for seed in range(count // 4):
        is_best(unfolded(windy_problem(seed, objective, uavs=1 + seed % 3, targets=1 + seed % 6)))


@pytest.mark.usefixtures("without_tables")
@pytest.mark.parametrize("count", MANY)
def test_cp_sat_keeps_what_metres_and_priorities_ask_for(count: int) -> None:
    for seed in range(count):
        is_best(unfolded(mixed_problem(seed, uavs=1 + seed % 4, targets=1 + seed % 8)))


@settings(max_examples=10)
@given(seed=seeds, objective=st.sampled_from([Objective.TOTAL, Objective.MAKESPAN]))
def test_tables_of_more_targets_and_cp_sat_find_plans_of_the_same_value(seed: int, objective: Objective) -> None:
    problem = plain(13, 2, objective, seed=seed)
    routes, is_proven = proven_routes(Arcs.of(problem))
    assert is_proven
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(proof, "_has_table", lambda arcs: False)
        found = proven(problem, routes)
    assert found is not None and found.bound is None
    assert problem.value(found.routes) == pytest.approx(problem.value(routes), abs=0.05)


def patient(found: BoundedPlan, *, time_s: float, **options: Any) -> Proof | None:
    return proof.prove(found, time_s=120.0, **options)


def test_a_plan_of_more_targets_than_tables_hold_is_proven_the_shortest() -> None:
    problem = plain(24, 3, Objective.TOTAL)
    before, after = solve(problem), solve(problem, search_s=0.1, prover=patient)
    assert not before.is_proven
    assert (after.is_proven, after.method) == (True, proof.CP_SAT)
    assert after.total_m <= before.total_m + 0.05


def test_tables_that_do_not_keep_the_tours_of_every_uav_give_the_best_plan() -> None:
    problem = plain(17, 4, Objective.MAKESPAN)
    assert exact.MAX_REACH_BYTES < 4 * (1 << 17) * 17 * 8
    found = proven(problem)
    assert found is not None and (found.bound, found.method) == (None, exact_method())
    searched = solve(problem)
    assert searched.lower_bound <= problem.value(found.routes) <= searched.longest_s + 1e-6
    assert sorted(visit for route in found.routes for visit in route) == list(range(17))


def exact_method() -> str:
    return solve(plain(3, 1, Objective.TOTAL)).method


def test_the_bound_of_the_longest_route_comes_from_the_best_plans_for_some_targets() -> None:
    problem = plain(24, 2, Objective.MAKESPAN, seed=50)
    searched = solve(problem)
    assert not searched.is_proven
    found = proof.prove(
        bounded(problem, searched.routes, searched.lower_bound), time_s=4.0, stop=never, on_look=lambda share, routes, bound: None, seed=7
    )
    assert found is not None and problem.value(found.routes) <= searched.longest_s
    assert found.bound is None or searched.lower_bound <= found.bound <= problem.value(found.routes)


@pytest.mark.parametrize("places", [20, 24])
def test_a_proof_ends_when_it_is_stopped(places: int) -> None:
    problem, asked = plain(places, 3, Objective.MAKESPAN), itertools.count()
    searched = solve(problem)
    found = proven(problem, searched.routes, time_s=3_600.0, stop=lambda: next(asked) > 5)  # half a second
    assert found is None or problem.value(found.routes) <= searched.longest_s


@pytest.mark.usefixtures("without_tables")
@pytest.mark.parametrize("objective", [Objective.TOTAL, Objective.MAKESPAN, Objective.TIME])
def test_the_targets_of_a_uav_are_limited_over_all_of_its_flights(objective: Objective) -> None:
    problem = plain(7, 2, objective)
    uavs = tuple(replace(uav, max_range_m=60_000.0, sorties=2, most_targets=2) for uav in problem.uavs)
    rows = unfolded(replace(problem, uavs=uavs))
    found = proven(rows)
    assert found is not None
    done = [sum(len(route) for route, owner in zip(found.routes, rows.owner, strict=True) if owner == uav) for uav in range(2)]
    assert done == [2, 2]
    assert found.bound is None


def test_a_plan_that_leaves_out_more_than_might_be_needed_is_not_called_the_best() -> None:
    """A tour of four is longer than the range by less than the model rounds: CP-SAT takes it, the checks do not."""
    problem = plain(4, 1, Objective.TOTAL)
    (tour,) = proven_routes(Arcs.of(problem))[0]
    length_m = problem.route_length_m(0, tour)
    tight = replace(problem, uavs=(replace(problem.uavs[0], max_range_m=length_m * (1 + 1e-6 - 3e-8)),))
    found = proven(tight)
    best = best_plan(tight)
    assert found is not None
    assert all(tight.keeps_limits(uav, route) for uav, route in enumerate(found.routes))
    assert found.bound is not None or merit(tight, found.routes)[0] == merit(tight, best)[0]


def test_too_many_targets_are_left_as_they_are() -> None:
    assert proven(plain(MAX_PROVEN_TARGETS + 1, 2, Objective.TOTAL)) is None
