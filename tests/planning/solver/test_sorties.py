"""Several sorties of one UAV: against every plan there is, and what they promise."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.problem import End, InvalidProblem, Lock, Objective, Problem, Solution, UavStart, UnassignedReason, Visit, merit
from planning.solver.exact import best_plan
from planning.solver.reach import needed_range_m, reachable
from planning.solver.search import best_found
from planning.solver.solver import never, solve
from planning.solver.sorties import by_uav, merit_of, unfolded
from tests.cases import long
from tests.planning.solver.random_problems import best_merit, windy_problem

seeds = st.integers(0, 1_000_000)


def on_a_road(places_km: list[float], uavs: tuple[UavStart, ...], objective: Objective = Objective.TOTAL) -> Problem:
    """Every UAV stands at kilometre 0."""
    places = np.array(places_km) * 1_000.0
    return Problem(
        uavs=uavs,
        visits=tuple(Visit(target) for target in range(len(places))),
        target_count=len(places),
        from_start_m=np.tile(np.abs(places), (len(uavs), 1)),
        between_m=np.abs(places[:, None] - places[None]),
        to_start_m=np.tile(np.abs(places)[:, None], (1, len(uavs))),
        objective=objective,
    )


def returning(range_km: float, **more: float) -> UavStart:
    return UavStart(range_km * 1_000.0, End.RETURN, **more)  # type: ignore[arg-type]


@settings(max_examples=40)
@given(seed=seeds, objective=st.sampled_from(list(Objective)), uavs=st.integers(1, 2))
def test_a_small_plan_of_sorties_is_the_best_there_is(seed: int, objective: Objective, uavs: int) -> None:
    rows = unfolded(windy_problem(seed, objective, uavs=uavs, targets=4 - uavs // 2, sorties=3))
    routes = best_plan(rows)
    assert all(rows.keeps_limits(uav, route) for uav, route in enumerate(routes))
    assert merit(rows, routes)[:2] == pytest.approx(best_merit(rows)[:2], rel=1e-9)


def check(problem: Problem, solution: Solution) -> None:
    """Every sortie keeps range and battery, all together the number of targets; nothing is done twice."""
    targets = [problem.visits[visit].target for flown in solution.sorties for route in flown for visit in route]
    assert sorted([*targets, *(item.target for item in solution.unassigned)]) == list(range(problem.target_count))
    for uav, flown in enumerate(solution.sorties):
        assert len(flown) <= problem.uavs[uav].sorties
        assert all(route and problem.keeps_limits(uav, route) for route in flown)
        assert sum(problem.visits[visit].done for route in flown for visit in route) <= problem.uavs[uav].most
        assert solution.routes[uav] == tuple(visit for route in flown for visit in route)


@settings(max_examples=20)
@given(seed=seeds, objective=st.sampled_from(list(Objective)), uavs=st.integers(1, 3), locks=st.integers(0, 2))
def test_every_sortie_keeps_the_limits(seed: int, objective: Objective, uavs: int, locks: int) -> None:
    problem = windy_problem(seed, objective, uavs=uavs, targets=6, sorties=3, locks=locks)
    solution = solve(problem)
    check(problem, solution)
    missed, value, _ = merit_of(problem, solution.sorties)
    assert missed == pytest.approx(sum(problem.left_out_weights[item.target] for item in solution.unassigned))
    assert solution.lower_bound <= value * (1 + 1e-12)


@pytest.mark.long
@settings(max_examples=6)
@given(seed=seeds, objective=st.sampled_from(list(Objective)), uavs=st.integers(1, 3))
def test_so_does_the_search_and_its_bound_is_one(seed: int, objective: Objective, uavs: int) -> None:
    rows = unfolded(windy_problem(seed, objective, uavs=uavs, targets=8, sorties=3))
    needed_m = needed_range_m(rows)
    usable = reachable(rows, needed_m)
    if not usable.any():
        return
    found = best_found(rows, usable, needed_m, seed=7, search_s=0.0, stop=never, on_look=lambda share, found: None)
    assert all(rows.keeps_limits(uav, route) for uav, route in enumerate(found.routes))
    owner = rows.owner or tuple(range(len(rows.uavs)))
    for own, flown in zip(dict.fromkeys(owner), by_uav(rows, found.routes), strict=True):
        assert sum(rows.visits[visit].done for route in flown for visit in route) <= rows.uavs[owner.index(own)].most
    best = merit(rows, best_plan(rows))
    assert merit(rows, found.routes)[0] > best[0] or merit(rows, found.routes)[1] >= best[1] * (1 - 1e-9)
    assert found.bound is not None
    if merit(rows, found.routes)[0] == best[0]:
        assert found.bound <= best[1] * (1 + 1e-12)


def test_what_does_not_fit_in_one_flight_is_flown_in_two() -> None:
    """-10 --- 0 --- 10 with a range of 21 km."""
    problem = on_a_road([-10, 10], (returning(21, sorties=2),))
    solution = solve(problem)
    assert sorted(solution.sorties[0]) == [(0,), (1,)]
    assert (solution.total_m, solution.unassigned, solution.is_proven) == (40_000.0, (), True)
    (left_out,) = solve(replace(problem, uavs=(returning(21),))).unassigned
    assert left_out.reason is UnassignedReason.BEYOND_RANGE


def test_the_time_between_sorties_counts() -> None:
    problem = on_a_road([-10, 10], (returning(21, sorties=2, turnaround_s=300.0, speed_mps=10.0, ready_s=50.0),), Objective.MAKESPAN)
    assert solve(problem).longest_s == pytest.approx(4_000.0 + 300.0 + 100.0)
    assert solve(replace(problem, objective=Objective.TIME)).lower_bound == pytest.approx(4_400.0)


def test_where_one_flight_does_it_there_is_one() -> None:
    solution = solve(on_a_road([-10, 10], (returning(41, sorties=3),)))
    assert len(solution.sorties[0]) == 1


def test_the_other_uav_is_quicker_than_a_second_sortie() -> None:
    uav = returning(21, sorties=2, turnaround_s=100.0)
    solution = solve(on_a_road([-10, 10], (uav, uav), Objective.MAKESPAN))
    assert [len(flown) for flown in solution.sorties] == [1, 1]


def test_the_number_of_targets_is_that_of_all_sorties() -> None:
    (left_out,) = solve(on_a_road([-10, 10], (returning(21, sorties=2, most_targets=1),))).unassigned
    assert left_out.reason is UnassignedReason.MAX_TARGETS


def test_a_route_that_has_to_begin_with_a_run_is_one_flight() -> None:
    problem = on_a_road([-10, 10], (returning(21, sorties=2),))
    assert solve(replace(problem, locks=(Lock(0, (0,), at_start=True),))).sorties == (((0,),),)
    assert len(solve(replace(problem, locks=(Lock(0, (0,)),))).sorties[0]) == 2


def test_a_uav_that_does_not_return_flies_once() -> None:
    with pytest.raises(InvalidProblem, match="returns"):
        on_a_road([1], (UavStart(sorties=2),))


@pytest.mark.parametrize("objective", [Objective.TOTAL, *long(Objective.MAKESPAN, Objective.TIME)])
def test_many_targets_are_shared_out_among_sorties(objective: Objective) -> None:
    """Twenty places on a circle of 10 km: two UAVs of 50 km range reach all in several sorties, which one each does not allow."""
    angle = np.linspace(0.0, 2.0 * math.pi, 20, endpoint=False)
    x, y = 10_000.0 * np.cos(angle), 10_000.0 * np.sin(angle)
    between_m = np.hypot(x[:, None] - x, y[:, None] - y)
    problem = Problem(
        uavs=(returning(30, sorties=3, turnaround_s=60.0),) * 2,
        visits=tuple(Visit(target) for target in range(20)),
        target_count=20,
        from_start_m=np.full((2, 20), 10_000.0),
        between_m=between_m,
        to_start_m=np.full((20, 2), 10_000.0),
        objective=objective,
    )
    solution = solve(problem)
    check(problem, solution)
    assert solution.unassigned == ()
    assert 0.0 <= solution.gap < 0.5
    assert solve(replace(problem, uavs=(returning(30),) * 2)).unassigned != ()
