"""The rival's plans keep the same limits as ours: a comparison with plans that nobody may fly would tell nothing."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.planning.ortools_plans import routes_by_ortools
from planning.problem import Objective, Problem, UavStart, Visit, merit
from planning.solver.exact import best_plan
from planning.solver.reach import needed_range_m, reachable
from tests.planning.solver.random_problems import mixed_problem


@settings(max_examples=25)
@given(st.integers(0, 1_000_000), st.integers(1, 4), st.integers(1, 9))
def test_a_plan_of_ortools_keeps_every_limit_and_is_no_better_than_the_best(seed: int, uavs: int, targets: int) -> None:
    problem = mixed_problem(seed, uavs=uavs, targets=targets)
    routes = routes_by_ortools(problem, reachable(problem, needed_range_m(problem)), 0.05)
    assert routes is not None
    assert all(problem.keeps_limits(uav, route) for uav, route in enumerate(routes))
    flown = [problem.visits[visit].target for route in routes for visit in route]
    assert len(flown) == len(set(flown))
    missed, value, _ = merit(problem, routes)
    least_missed, least, _ = merit(problem, best_plan(problem))
    assert missed > least_missed or (missed == least_missed and value >= least * (1 - 1e-9))


def test_ortools_counts_take_off_and_landing_of_the_uavs_that_fly_alone() -> None:
    """Two places at 10 s and 20 s: one UAV is ready at once, of the other take-off and landing take 50 s."""
    places_m = np.array([10.0, 20.0])
    problem = Problem(
        uavs=(UavStart(ready_s=50.0), UavStart()),
        visits=(Visit(0), Visit(1)),
        target_count=2,
        from_start_m=np.stack([places_m, places_m]),
        between_m=np.abs(places_m[:, None] - places_m),
        to_start_m=np.stack([places_m, places_m], axis=1),
        objective=Objective.MAKESPAN,
    )
    assert routes_by_ortools(problem, np.ones((2, 2), dtype=bool), 0.05) == ((), (0, 1))
