"""Seconds and Wh that do not follow from the metres: every objective, with ranges and batteries, against every plan there is."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.problem import End, InvalidProblem, Lock, Objective, Problem, Resources, Routes, UavStart, UnassignedReason, Visit, merit
from planning.solver.exact import best_plan, proven_routes
from planning.solver.lower_bounds import lower_bound
from planning.solver.problem_arrays import Arcs
from planning.solver.reach import needed_range_m, reachable
from planning.solver.search import best_found
from planning.solver.solver import never, solve
from planning.solver.tours import limited_tours
from tests.cases import long
from tests.planning.solver.random_problems import best_merit, honours, windy_problem

seeds = st.integers(0, 1_000_000)
objectives = st.sampled_from(list(Objective))


def by_search(problem: Problem) -> Routes:
    needed_m = needed_range_m(problem)
    usable = reachable(problem, needed_m)
    if not usable.any():
        return ((),) * len(problem.uavs)
    found = best_found(problem, usable, needed_m, seed=7, search_s=0.0, stop=never, on_look=lambda share, found: None)
    return found.routes


@settings(max_examples=80)
@given(seed=seeds, objective=objectives, uavs=st.integers(1, 3))
def test_a_small_plan_is_the_best_there_is_by_every_objective_and_limit(seed: int, objective: Objective, uavs: int) -> None:
    problem = windy_problem(seed, objective, uavs=uavs, targets=4 if uavs < 3 else 3)
    routes, is_proven = proven_routes(Arcs.of(problem))
    assert is_proven
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(routes))
    assert merit(problem, routes)[:2] == pytest.approx(best_merit(problem)[:2], rel=1e-9)


@settings(max_examples=30)
@given(seed=seeds, objective=objectives, uavs=st.integers(1, 3), targets=st.integers(1, 6))
def test_no_plan_is_better_than_the_bound(seed: int, objective: Objective, uavs: int, targets: int) -> None:
    problem = windy_problem(seed, objective, uavs=uavs, targets=targets)
    best = best_plan(problem)
    needed_m = needed_range_m(problem)
    assert lower_bound(problem, reachable(problem, needed_m), needed_m, best, seed=7) <= merit(problem, best)[1] * (1 + 1e-12)


@settings(max_examples=8)
@given(seed=seeds, objective=objectives, uavs=st.integers(1, 4))
def test_the_search_keeps_every_limit_and_finds_no_more_than_there_is(seed: int, objective: Objective, uavs: int) -> None:
    problem = windy_problem(seed, objective, uavs=uavs, targets=9)
    found = by_search(problem)
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(found))
    missed, value, _ = merit(problem, found)
    least_missed, least, _ = merit(problem, best_plan(problem))
    assert missed > least_missed or (missed == least_missed and value >= least * (1 - 1e-9))


@pytest.mark.long
@pytest.mark.parametrize("objective", [Objective.ENERGY, *long(*(other for other in Objective if other != Objective.ENERGY))])
def test_the_search_finds_the_best_of_nearly_all_small_problems(objective: Objective) -> None:
    problems = [windy_problem(seed, objective, uavs=3, targets=10) for seed in range(5)]
    best = [merit(problem, best_plan(problem)) for problem in problems]
    found = [merit(problem, by_search(problem)) for problem in problems]
    as_good = [new[0] == old[0] and new[1] <= old[1] * 1.01 for new, old in zip(found, best, strict=True)]
    assert sum(as_good) >= 4


@settings(max_examples=20)
@given(seed=seeds, objective=objectives)
def test_locked_runs_are_flown_as_wished_within_every_limit(seed: int, objective: Objective) -> None:
    problem = windy_problem(seed, objective, uavs=2, targets=5, locks=2)
    solution = solve(problem)
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(solution.routes))
    flown = {problem.visits[visit].target for route in solution.routes for visit in route}
    assert all(honours(problem, solution.routes, lock) for lock in problem.locks if flown & set(lock.targets))


def test_in_the_wind_a_locked_run_is_flown_in_the_directions_that_are_quickest() -> None:
    """A stretch between two places: flown one way round it is shorter, the other way quicker."""
    visits = (Visit(0), Visit(1, False, 100.0), Visit(1, True, 90.0), Visit(2))
    zero = np.zeros((4, 4))
    problem = Problem(
        uavs=(UavStart(),),
        visits=visits,
        target_count=3,
        from_start_m=np.zeros((1, 4)),
        between_m=zero,
        to_start_m=np.zeros((4, 1)),
        objective=Objective.TOTAL,
        locks=(Lock(0, (0, 1, 2)),),
        seconds=Resources(np.zeros((1, 4)), zero[None], np.zeros((4, 1)), along=np.array([[0.0, 10.0, 20.0, 0.0]])),
    )
    assert solve(problem).routes == ((0, 2, 3),)
    quickest = solve(replace(problem, objective=Objective.TIME))
    assert (quickest.routes, quickest.total_s, quickest.is_proven) == (((0, 1, 3),), 10.0, True)


def on_a_road(places_km: list[float], uavs: tuple[UavStart, ...], objective: Objective, *, wind: float = 0.0) -> Problem:
    """Every UAV stands at kilometre 0 and flies 10 m/s, so much more with the wind to the right; 1 Wh are 36 s of flying."""
    places = np.array(places_km) * 1_000.0

    def seconds(from_m: np.ndarray, to_m: np.ndarray) -> np.ndarray:
        way_m = to_m[None, :] - from_m[:, None]
        return np.abs(way_m) / (10.0 + wind * np.sign(way_m))

    start = np.zeros(len(uavs))
    returns = np.array([uav.end is End.RETURN for uav in uavs])
    first_s, onward_s, end_s = seconds(start, places), seconds(places, places)[None], np.where(returns, seconds(places, start), 0.0)
    return Problem(
        uavs=uavs,
        visits=tuple(Visit(target) for target in range(len(places))),
        target_count=len(places),
        from_start_m=np.tile(np.abs(places), (len(uavs), 1)),
        between_m=np.abs(places[:, None] - places[None]),
        to_start_m=np.tile(np.abs(places)[:, None], (1, len(uavs))),
        objective=objective,
        seconds=Resources(first_s, onward_s, end_s),
        wh=Resources(first_s / 36.0, onward_s / 36.0, end_s / 36.0),
    )


def test_with_the_wind_the_route_ends_where_it_blows_to() -> None:
    """-1 --- 0 --- 1, wind 5 m/s to the right: left first takes 200 + 133 s, right first 67 + 400 s."""
    solution = solve(on_a_road([-1, 1], (UavStart(),), Objective.TIME, wind=5.0))
    assert solution.routes == ((0, 1),)
    assert solution.total_s == pytest.approx(1_000 / 5 + 2_000 / 15)
    assert solution.is_proven


def test_the_least_energy_and_the_fewest_metres_are_not_the_same_plan() -> None:
    """Both UAVs stand as near; the other takes half the Wh."""
    problem = on_a_road([1, 2], (UavStart(usable_wh=math.inf), UavStart(usable_wh=math.inf)), Objective.ENERGY)
    assert problem.wh is not None
    wh = Resources(problem.wh.first, np.concatenate([problem.wh.onward, problem.wh.onward / 2]), problem.wh.end)
    wh.first[1] /= 2
    solution = solve(replace(problem, seconds=None, wh=wh, class_of=(0, 1)))
    assert solution.routes == ((), (0, 1))
    assert solution.total_wh == pytest.approx(200.0 / 36.0 / 2)


def test_a_target_beyond_the_battery_says_how_many_wh_are_missing() -> None:
    """3 km there and back at 10 m/s are 600 s, 16.7 Wh."""
    (left_out,) = solve(on_a_road([3], (UavStart(end=End.RETURN, usable_wh=10.0),), Objective.TOTAL)).unassigned
    assert left_out.reason is UnassignedReason.BEYOND_ENERGY
    assert left_out.missing == pytest.approx(600.0 / 36.0 - 10.0, abs=1e-4)
    assert (left_out.why.code, left_out.why.params["there"].code) == ("beyond_battery", "there_and_back")
    assert left_out.why.params["needed_wh"] == pytest.approx(600.0 / 36.0)


def test_a_target_that_the_battery_would_reach_alone_says_so() -> None:
    (left_out,) = solve(on_a_road([-3, 3], (UavStart(usable_wh=10.0),), Objective.TIME)).unassigned
    assert left_out.reason is UnassignedReason.BEYOND_ENERGY
    assert left_out.why.code == "in_reach_alone"
    assert left_out.missing == 0.0


def test_the_battery_may_choose_a_longer_way() -> None:
    """The near one first is 2 km and takes 6 Wh, the far one first 3 km and 2 Wh."""
    problem = on_a_road([1, 2], (UavStart(usable_wh=5.9),), Objective.TOTAL)
    assert problem.wh is not None
    wh = Resources(np.array([[3.0, 1.0]]), np.array([[[0.0, 3.0], [1.0, 0.0]]]), np.zeros((2, 1)))
    assert solve(problem).total_m == 2_000.0
    solution = solve(replace(problem, wh=wh))
    assert (solution.routes, solution.total_m, solution.is_proven) == (((1, 0),), 3_000.0, True)


def test_the_least_energy_of_uavs_of_whose_energy_nothing_is_known_is_refused() -> None:
    with pytest.raises(InvalidProblem, match="nothing is known"):
        on_a_road([1], (UavStart(usable_wh=50.0), UavStart()), Objective.ENERGY)
    with pytest.raises(InvalidProblem, match="Wh are missing"):
        replace(on_a_road([1], (UavStart(usable_wh=50.0),), Objective.TOTAL), wh=None)


def test_what_is_not_known_is_no_way() -> None:
    problem = on_a_road([1, 2], (UavStart(usable_wh=50.0),), Objective.TOTAL)
    assert problem.wh is not None
    problem.wh.first[0, 1] = problem.wh.onward[0, 0, 1] = np.nan
    (left_out,) = solve(problem).unassigned
    assert (left_out.target, left_out.reason) == (1, UnassignedReason.NO_PATH)


def test_where_too_many_tours_would_have_to_be_weighed_the_plan_is_not_called_proven() -> None:
    """Each way that is shorter takes more: nearly all tours over the six places are worth keeping."""
    arcs = Arcs.of(tight_problem())
    counts = np.array([number.bit_count() for number in range(64)])
    whole, cut = limited_tours(arcs, 0, counts), limited_tours(arcs, 0, counts, most_labels=2)
    assert whole.is_whole
    assert not cut.is_whole
    assert (np.isfinite(cut.length_m) == np.isfinite(whole.length_m)).all()
    assert (cut.length_m >= whole.length_m).all()
    assert cut.length_m[63] > whole.length_m[63]
    assert tight_problem().keeps_limits(0, cut.route(63))


def tight_problem() -> Problem:
    """Six places, of which the shortest tour takes too much energy and longer ones do not."""
    draw = np.random.default_rng(5)
    onward = draw.uniform(1.0, 3.0, (6, 6))
    wh = 4.0 - onward
    return Problem(
        uavs=(UavStart(usable_wh=10.0),),
        visits=tuple(Visit(target) for target in range(6)),
        target_count=6,
        from_start_m=np.full((1, 6), 1.0),
        between_m=onward,
        to_start_m=np.zeros((6, 1)),
        objective=Objective.TOTAL,
        wh=Resources(np.full((1, 6), 1.0), wh[None], np.zeros((6, 1))),
    )
