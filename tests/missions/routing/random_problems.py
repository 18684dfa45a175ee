"""Small random problems, and their optimum by trying everything."""

import math
from itertools import permutations, product

import numpy as np

from missions.routing.problem import End, Objective, Problem, UavStart, Visit, merit


def random_problem(
    seed: int,
    *,
    uavs: int = 2,
    targets: int = 4,
    stretches: int = 0,
    objective: Objective = Objective.TOTAL,
    range_m: float | None = None,
    returns: bool = False,
    networks: int = 1,
) -> Problem:
    """Places in a square of 50 km, ways up to 40 % longer than straight and not alike in both directions; the last targets are stretches.

    With several networks each place stands on one or two of them, and there is a way between places that have one in common.
    """
    draw = np.random.default_rng(seed)
    starts = draw.uniform(0, 50_000, (uavs, 2))
    start_networks = [_some_networks(draw, networks) for _ in range(uavs)]
    visits, entries, exits, visit_networks = [], [], [], []
    for target in range(targets):
        here = draw.uniform(0, 50_000, 2)
        on_networks = _some_networks(draw, networks)
        if target < targets - stretches:
            visits.append(Visit(target))
            entries.append(here)
            exits.append(here)
            visit_networks.append(on_networks)
        else:
            there = here + draw.uniform(-8_000, 8_000, 2)
            length_m = 1.1 * float(np.hypot(*(there - here)))
            visits += [Visit(target, False, length_m), Visit(target, True, length_m)]
            entries += [here, there]
            exits += [there, here]
            visit_networks += [on_networks, on_networks]

    def ways(rows: list[np.ndarray], columns: list[np.ndarray], row_on: list[set[int]], column_on: list[set[int]]) -> np.ndarray:
        straight = np.hypot(*(np.array(rows)[:, None] - np.array(columns)[None]).transpose(2, 0, 1))
        joined = np.array([[bool(row & column) for column in column_on] for row in row_on])
        return np.where(joined, straight * draw.uniform(1.0, 1.4, straight.shape), np.inf)

    return Problem(
        uavs=tuple(UavStart(range_m, End.RETURN if returns else End.OPEN) for _ in range(uavs)),
        visits=tuple(visits),
        target_count=targets,
        from_start_m=ways(list(starts), entries, start_networks, visit_networks),
        between_m=ways(exits, entries, visit_networks, visit_networks),
        to_start_m=ways(exits, list(starts), visit_networks, start_networks),
        objective=objective,
    )


def _some_networks(draw: np.random.Generator, networks: int) -> set[int]:
    return {int(number) for number in draw.integers(0, networks, 2)}


def best_merit(problem: Problem) -> tuple[float, float, float]:
    """The merit of the best plan there is: every choice of targets, directions, UAVs and orders. For up to five targets and two UAVs."""
    best = (math.inf, math.inf, math.inf)
    alternatives = [[None, *visits] for visits in problem.visits_of_target()]
    for choice in product(*alternatives):
        chosen = [visit for visit in choice if visit is not None]
        for order in permutations(chosen):
            for cut in range(len(order) + 1) if len(problem.uavs) == 2 else (len(order),):
                routes = (order[:cut], order[cut:])[: len(problem.uavs)]
                lengths_m = [problem.route_length_m(uav, route) for uav, route in enumerate(routes)]
                if all(length_m <= uav.limit_m and math.isfinite(length_m) for length_m, uav in zip(lengths_m, problem.uavs, strict=True)):
                    best = min(best, merit(problem, routes))
    return best
