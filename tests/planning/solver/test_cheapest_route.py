"""The least route to one visit, against every order of every choice of others."""

from itertools import permutations

import numpy as np
import pytest

from planning.problem import End, Objective, Problem, UavStart, Visit
from planning.solver import cheapest_route
from planning.solver.cheapest_route import LeastRoutes
from planning.solver.cost_matrices import QuantityKind

TARGETS = 5


def drawn(seed: int) -> Problem:
    """Five targets, the last a stretch that may be flown from either end; half of the ways are missing, and going round may be shorter."""
    draw = np.random.default_rng(seed)
    visits = [Visit(target) for target in range(TARGETS)] + [Visit(TARGETS - 1, is_reversed=True)]
    count = len(visits)
    between_m = np.where(draw.random((count, count)) < 0.5, np.inf, draw.uniform(10.0, 100.0, (count, count)))
    there_m, back_m = (np.where(draw.random((1, count)) < 0.5, np.inf, draw.uniform(10.0, 100.0, (1, count))) for _ in range(2))
    return Problem((UavStart(end=End.RETURN),), tuple(visits), TARGETS, there_m, between_m, back_m.T, Objective.TOTAL)


def by_trying(problem: Problem, visit: int) -> float:
    target = problem.visits[visit].target
    orders = (order for number in range(TARGETS) for order in permutations(range(len(problem.visits)), number + 1))
    fitting = (
        order
        for order in orders
        if len({problem.visits[one].target for one in order}) == len(order) and target in {problem.visits[one].target for one in order}
    )
    return min(problem.route_length_m(0, order) for order in fitting)


@pytest.mark.parametrize("seed", range(12))
def test_each_order_is_tried_where_there_are_few_targets(seed: int) -> None:
    problem = drawn(seed)
    routes = LeastRoutes(problem, QuantityKind.METRES)
    for visit in range(len(problem.visits)):
        found = routes.route(0, visit)
        assert found.amount == pytest.approx(by_trying(problem, visit))
        if np.isfinite(found.amount):
            assert problem.route_length_m(0, found.order) == pytest.approx(found.amount)
            assert problem.visits[visit].target in {problem.visits[one].target for one in found.order}


@pytest.mark.parametrize("seed", range(12))
def test_of_many_targets_a_route_is_found_that_is_one(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cheapest_route, "MAX_TRIED", 0)
    problem = drawn(seed)
    routes = LeastRoutes(problem, QuantityKind.METRES)
    for visit in range(len(problem.visits)):
        found = routes.route(0, visit)
        assert found.amount >= by_trying(problem, visit) - 1e-9
        if np.isfinite(found.amount):
            assert visit in found.order
            assert len({problem.visits[one].target for one in found.order}) == len(found.order)
            assert problem.route_length_m(0, found.order) == pytest.approx(found.amount)
