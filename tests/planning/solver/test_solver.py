"""The solver against every plan there is, and against what it promises."""

import math
from time import perf_counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.problem import End, Objective, Problem, Routes, UavStart, Unassigned, UnassignedReason, Visit, merit
from planning.solver.exact import best_plan
from planning.solver.reach import needed_range_m, reachable
from planning.solver.search import Progress
from planning.solver.solver import never, no_report, searched_plan, solve
from tests.cases import long
from tests.planning.solver.random_problems import BY_WAYS, best_merit, mixed_problem, random_problem


def by_search(problem: Problem) -> Routes:
    needed_m = needed_range_m(problem)
    usable = reachable(problem, needed_m)
    return searched_plan(problem, usable, needed_m, stop=never, on_progress=no_report, seed=7, search_s=0.0).routes


def on_a_line(places_km: list[float], uavs: tuple[UavStart, ...], objective: Objective = Objective.TOTAL, start_km: float = 0.0) -> Problem:
    """Point targets on a straight road; every UAV starts at the same place."""
    places, starts = np.array(places_km) * 1_000.0, np.full(len(uavs), start_km * 1_000)
    return Problem(
        uavs=uavs,
        visits=tuple(Visit(target) for target in range(len(places))),
        target_count=len(places),
        from_start_m=np.abs(starts[:, None] - places[None]),
        between_m=np.abs(places[:, None] - places[None]),
        to_start_m=np.abs(places[:, None] - starts[None]),
        objective=objective,
    )


@pytest.mark.parametrize("objective", BY_WAYS)
@pytest.mark.parametrize("returns", [False, True])
@pytest.mark.parametrize("stretches", [0, 2])
def test_a_small_plan_is_the_best_of_all_plans(stretches: int, returns: bool, objective: Objective) -> None:
    for seed in range(15):
        problem = random_problem(seed, stretches=stretches, returns=returns, objective=objective)
        found, best = merit(problem, solve(problem).routes), best_merit(problem)
        assert found[:2] == pytest.approx(best[:2], rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("returns", [False, True])
@pytest.mark.parametrize(("objective", "tolerance"), [(Objective.TOTAL, 1.02), (Objective.MAKESPAN, 1.06)])
def test_the_search_for_large_problems_comes_close_to_the_best_plan_of_a_small_one(
    objective: Objective, tolerance: float, returns: bool
) -> None:
    for seed in range(3):
        problem = random_problem(seed, uavs=3, targets=10, stretches=3, returns=returns, objective=objective)
        found, best = merit(problem, by_search(problem)), merit(problem, best_plan(problem))
        assert found[0] == best[0] == 0
        assert best[1] - 1e-6 <= found[1] <= tolerance * best[1]


@pytest.mark.parametrize("objective", [Objective.TOTAL, *long(Objective.MAKESPAN, Objective.TIME)])
@pytest.mark.parametrize("returns", [False, True])
def test_range_is_never_exceeded_and_as_many_targets_are_visited_as_can_be(objective: Objective, returns: bool) -> None:
    left_out = 0
    for seed in range(25):
        problem = random_problem(seed, stretches=1, range_m=45_000.0, returns=returns, objective=objective)
        solution = solve(problem)
        for uav, route in [*enumerate(solution.routes), *(enumerate(by_search(problem)) if seed < 5 else ())]:
            assert problem.route_length_m(uav, route) <= 45_000.0
        assert len(solution.unassigned) == best_merit(problem)[0]
        assert {item.reason for item in solution.unassigned} <= {UnassignedReason.BEYOND_RANGE}
        left_out += len(solution.unassigned)
    assert left_out > 0


@pytest.mark.parametrize("objective", BY_WAYS)
@pytest.mark.parametrize("returns", [False, True])
def test_on_separate_networks_as_many_targets_are_visited_as_can_be(objective: Objective, returns: bool) -> None:
    left_out = 0
    for seed in range(25):
        problem = random_problem(seed, targets=5, networks=5, returns=returns, objective=objective)
        solution = solve(problem)
        assert all(math.isfinite(problem.route_length_m(uav, route)) for uav, route in enumerate(solution.routes))
        visited = [problem.visits[visit].target for route in solution.routes for visit in route]
        assert sorted([*visited, *(item.target for item in solution.unassigned)]) == list(range(5))
        assert len(solution.unassigned) == best_merit(problem)[0]
        left_out += len(solution.unassigned)
    assert left_out > 0


def test_two_uavs_share_the_work_when_the_longest_route_counts() -> None:
    problem = on_a_line([-10, 10], (UavStart(), UavStart()), Objective.MAKESPAN)
    assert sorted(solve(problem).routes) == [(0,), (1,)]
    assert solve(problem).longest_m == 10_000


def test_one_uav_does_all_when_that_is_shortest() -> None:
    problem = on_a_line([1, 2, 3], (UavStart(), UavStart()))
    solution = solve(problem)
    assert sorted(solution.routes) == [(), (0, 1, 2)]
    assert solution.total_m == 3_000


def test_a_stretch_is_flown_from_the_end_that_is_nearer() -> None:
    """start 0 --- 5 ==== 8, and the list names the far end first."""
    problem = Problem(
        uavs=(UavStart(),),
        visits=(Visit(0, False, 3_000.0), Visit(0, True, 3_000.0)),
        target_count=1,
        from_start_m=np.array([[8_000.0, 5_000.0]]),
        between_m=np.zeros((2, 2)),
        to_start_m=np.zeros((2, 1)),
        objective=Objective.TOTAL,
    )
    solution = solve(problem)
    assert solution.routes == ((1,),)
    assert solution.total_m == 8_000


def test_a_target_that_the_range_just_reaches_is_visited() -> None:
    assert solve(on_a_line([10], (UavStart(10_001.0),))).unassigned == ()
    assert solve(on_a_line([10], (UavStart(20_001.0, end=End.RETURN),))).unassigned == ()


def facts_of(left_out: Unassigned) -> tuple[float, str, float]:
    params = left_out.why.params
    return params["needed_m"], params["there"].code, params["missing_m"]


def test_a_target_beyond_every_range_says_how_much_is_missing() -> None:
    (left_out,) = solve(on_a_line([10], (UavStart(9_000.0), UavStart(4_000.0)))).unassigned
    assert left_out.reason is UnassignedReason.BEYOND_RANGE
    assert left_out.why.code == "beyond_range"
    assert facts_of(left_out) == (10_000.0, "there", pytest.approx(1_000.0, abs=0.1))


def test_the_missing_range_is_that_of_a_uav_that_has_a_way() -> None:
    """The UAV without a limit stands on another network."""
    problem = on_a_line([10], (UavStart(), UavStart(9_000.0)))
    problem.from_start_m[0] = np.inf
    (left_out,) = solve(problem).unassigned
    assert facts_of(left_out) == (10_000.0, "there", pytest.approx(1_000.0, abs=0.1))


def test_the_way_back_counts_for_a_uav_that_returns() -> None:
    (left_out,) = solve(on_a_line([10], (UavStart(15_000.0, end=End.RETURN),))).unassigned
    assert left_out.reason is UnassignedReason.BEYOND_RANGE
    assert facts_of(left_out) == (20_000.0, "there_and_back", pytest.approx(5_000.0, abs=0.1))


def test_a_target_that_would_fit_alone_says_so() -> None:
    (left_out,) = solve(on_a_line([-10, 10], (UavStart(12_000.0),))).unassigned
    assert left_out.reason is UnassignedReason.BEYOND_RANGE
    assert left_out.why.code == "in_range_alone"


def test_without_a_way_the_reason_is_no_path() -> None:
    problem = on_a_line([5, 10], (UavStart(1_000.0),))
    problem.from_start_m[:, 1] = problem.between_m[:, 1] = np.inf
    reasons = {item.target: item.reason for item in solve(problem).unassigned}
    assert reasons == {0: UnassignedReason.BEYOND_RANGE, 1: UnassignedReason.NO_PATH}


def test_targets_of_two_networks_cannot_be_on_one_route() -> None:
    problem = on_a_line([5, 10], (UavStart(),))
    problem.between_m[:] = np.inf
    (left_out,) = solve(problem).unassigned
    assert left_out.reason is UnassignedReason.NO_PATH
    assert left_out.why.code == "not_on_one_route"


def test_a_target_behind_another_one_is_reached() -> None:
    """start --- 0 --- 1, and no way straight from the start to 1."""
    problem = on_a_line([5, 10], (UavStart(),))
    problem.from_start_m[0, 1] = np.inf
    assert solve(problem).routes == ((0, 1),)


def test_without_uavs_everything_is_left_out() -> None:
    assert [item.reason for item in solve(on_a_line([1, 2], ())).unassigned] == [UnassignedReason.NO_PATH, UnassignedReason.NO_PATH]


def test_same_problem_and_seed_give_the_same_plan() -> None:
    problem = random_problem(3, uavs=3, targets=20, stretches=4, objective=Objective.MAKESPAN)
    assert solve(problem, seed=11).routes == solve(problem, seed=11).routes


@pytest.mark.long
@pytest.mark.parametrize("objective", [Objective.MAKESPAN, *long(Objective.TOTAL, Objective.TIME)])
def test_a_large_plan_keeps_every_range_and_leaves_out_only_what_does_not_fit(objective: Objective) -> None:
    problem = random_problem(9, uavs=4, targets=40, stretches=5, range_m=60_000.0, returns=True, objective=objective)
    solution = solve(problem)
    lengths_m = [problem.route_length_m(uav, route) for uav, route in enumerate(solution.routes)]
    assert max(lengths_m) <= 60_000.0
    assert solution.total_m == pytest.approx(sum(lengths_m))
    visited = [problem.visits[visit].target for route in solution.routes for visit in route]
    assert sorted([*visited, *(item.target for item in solution.unassigned)]) == list(range(40))
    assert len(visited) >= 25


def test_a_search_improves_the_plan_and_reports_progress() -> None:
    problem = random_problem(5, uavs=4, targets=40, objective=Objective.MAKESPAN)
    longest_m = 1.02 * solve(problem).longest_m  # first, so that loading the compiled functions takes nothing from the search's time
    for search_s in (1.5, 6.0, 24.0):  # the first is enough, unless other programs take the processors
        reported: list[Progress] = []
        searched = solve(problem, on_progress=reported.append, search_s=search_s)
        if searched.longest_m <= longest_m:
            break
    assert searched.longest_m <= longest_m
    shares = [progress.share for progress in reported]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert any(0.3 < share < 1.0 for share in shares)
    assert reported[-1].message.code == "longest_route"
    merits = [merit(problem, progress.best_routes) for progress in reported if progress.best_routes is not None]
    assert len(merits) > 3
    assert merits == sorted(merits, reverse=True)
    assert merits[-1] == merit(problem, searched.routes)


@settings(max_examples=8)
@given(st.integers(0, 1_000_000), st.integers(1, 4))
def test_the_search_keeps_every_limit_whatever_the_problem_holds(seed: int, uavs: int) -> None:
    problem = mixed_problem(seed, uavs=uavs, targets=9)
    found = by_search(problem)
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(found))
    missed, value, _ = merit(problem, found)
    least_missed, least, _ = merit(problem, best_plan(problem))
    assert missed > least_missed or (missed == least_missed and value >= least * (1 - 1e-9))


@pytest.mark.long
@pytest.mark.parametrize("objective", [Objective.TOTAL, *long(Objective.MAKESPAN, Objective.TIME)])
def test_the_search_finds_the_best_plan_of_nearly_all_small_problems(objective: Objective) -> None:
    problems = [random_problem(seed, uavs=3, targets=12, stretches=4, objective=objective) for seed in range(6)]
    exact = [merit(problem, best_plan(problem))[1] for problem in problems]
    found = [merit(problem, by_search(problem))[1] for problem in problems]
    assert found == pytest.approx(exact, rel=0.01)
    assert sum(value <= least * (1 + 1e-9) for value, least in zip(found, exact, strict=True)) >= 5


def test_stop_ends_a_long_search_and_keeps_the_best_plan() -> None:
    problem = random_problem(6, uavs=5, targets=60, objective=Objective.MAKESPAN)
    asked: list[float] = []

    def stop() -> bool:
        asked.append(perf_counter())
        return asked[-1] - asked[0] > 1.0

    solution = solve(problem, stop=stop, search_s=60.0)
    assert perf_counter() - asked[0] < 30.0  # half of what it was given: the search has ended because it was told to
    assert solution.unassigned == ()
