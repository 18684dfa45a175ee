"""Small plans against every plan there is, with everything that a problem can hold; and how long they take."""

import math
from dataclasses import replace
from time import perf_counter

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from planning.problem import End, InvalidProblem, Objective, Priority, Problem, UavStart, Visit, merit
from planning.solver import exact
from planning.solver.problem_arrays import Arcs
from planning.solver.solver import solve
from tests.planning.solver.random_problems import BY_WAYS, best_merit, mixed_problem, random_problem

seeds = st.integers(0, 1_000_000)


@settings(max_examples=60)
@example(seed=247205, uavs=3)  # two targets weigh the same, and the longest route leads to neither
@given(seed=seeds, uavs=st.integers(1, 3))
def test_a_small_plan_is_the_best_there_is_whatever_the_problem_holds(seed: int, uavs: int) -> None:
    problem = mixed_problem(seed, uavs=uavs, targets=4 if uavs < 3 else 3)
    routes = exact.best_plan(problem)
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(routes))
    assert merit(problem, routes) == pytest.approx(best_merit(problem), rel=1e-9)


@settings(max_examples=20)
@given(seeds)
def test_uavs_that_are_alike_share_the_work_as_any_others(seed: int) -> None:
    problem = mixed_problem(seed, uavs=1, targets=4)
    problem = replace(
        problem,
        uavs=problem.uavs * 3,
        from_start_m=np.repeat(problem.from_start_m, 3, axis=0),
        to_start_m=np.repeat(problem.to_start_m, 3, axis=1),
        to_base_m=None if problem.to_base_m is None else np.repeat(problem.to_base_m, 3, axis=1),
        allowed=None if problem.allowed is None else np.repeat(problem.allowed, 3, axis=0),
    )
    assert merit(problem, exact.best_plan(problem)) == pytest.approx(best_merit(problem), rel=1e-9)


def on_a_road(places_km: list[float], uavs: tuple[UavStart, ...], objective: Objective, **more: object) -> Problem:
    """Every UAV stands at kilometre 0."""
    places = np.array(places_km) * 1_000.0
    problem = Problem(
        uavs=uavs,
        visits=tuple(Visit(target) for target in range(len(places))),
        target_count=len(places),
        from_start_m=np.tile(np.abs(places), (len(uavs), 1)),
        between_m=np.abs(places[:, None] - places[None]),
        to_start_m=np.tile(np.abs(places)[:, None], (1, len(uavs))),
        objective=objective,
    )
    return replace(problem, **more)  # type: ignore[arg-type]


def test_one_target_of_high_priority_comes_before_any_number_of_others() -> None:
    low, high = Priority.LOW, Priority.HIGH
    problem = on_a_road([-10, 1, 2, 3], (UavStart(10_500.0),), Objective.TOTAL, priorities=(high, low, low, low))
    assert solve(problem).routes == ((0,),)


def test_the_longest_route_is_the_one_that_takes_longest() -> None:
    """The slow UAV takes the near target, though it could go to the far one in the same metres."""
    problem = on_a_road([-10, 4], (UavStart(speed_mps=5.0), UavStart(speed_mps=20.0)), Objective.MAKESPAN)
    solution = solve(problem)
    assert solution.routes == ((1,), (0,))
    assert solution.longest_s == 800.0
    assert solution.longest_m == 10_000.0


def test_time_at_the_targets_counts_for_the_longest_route() -> None:
    problem = on_a_road([1, 2, 3], (UavStart(speed_mps=10.0), UavStart(speed_mps=10.0)), Objective.MAKESPAN)
    problem = replace(problem, visits=tuple(replace(visit, service_s=1_000.0 * (visit.target == 0)) for visit in problem.visits))
    assert sorted(solve(problem).routes) == [(0,), (1, 2)]


def test_a_route_may_end_at_the_nearest_base() -> None:
    """0 --- base 9 - target 10: there and on to the base are 11 km, there and back 20."""
    problem = on_a_road([10], (UavStart(12_000.0, End.ANY_BASE),), Objective.TOTAL, to_base_m=np.array([[1_000.0]]))
    assert solve(problem).total_m == 11_000.0
    assert solve(replace(problem, uavs=(UavStart(12_000.0, End.RETURN),))).unassigned != ()


def test_ending_at_any_base_needs_the_ways_to_the_bases() -> None:
    with pytest.raises(InvalidProblem, match="ways to the bases"):
        solve(on_a_road([10], (UavStart(end=End.ANY_BASE),), Objective.TOTAL))


def test_no_uav_gets_more_targets_than_it_may_have() -> None:
    solution = solve(on_a_road([1, 2, 3], (UavStart(most_targets=1), UavStart(most_targets=1)), Objective.TOTAL))
    assert sorted(len(route) for route in solution.routes) == [1, 1]
    (left_out,) = solution.unassigned
    assert left_out.reason == "most_targets"


def test_a_target_is_flown_by_none_but_the_uavs_that_may() -> None:
    allowed = np.array([[True, False, False], [False, True, False]])
    solution = solve(on_a_road([1, 2, 3], (UavStart(), UavStart()), Objective.TOTAL, allowed=allowed))
    assert solution.routes == ((0,), (1,))
    assert [item.reason for item in solution.unassigned] == ["not_allowed"]


@pytest.mark.parametrize(("uavs", "targets", "limit_ms"), [(2, 4, 0.1), (3, 12, 30.0)])
@pytest.mark.parametrize("objective", BY_WAYS)
def test_a_small_plan_takes_no_time(objective: Objective, uavs: int, targets: int, limit_ms: float) -> None:
    """The limits are ten times what two idle cores need."""
    arcs = Arcs.of(random_problem(1, uavs=uavs, targets=targets, objective=objective))
    least_s = math.inf
    for _ in range(20):
        began_s = perf_counter()
        exact.best_routes(arcs)
        least_s = min(least_s, perf_counter() - began_s)
    assert least_s * 1_000 < limit_ms
