"""Small networks of spans, shared among UAVs and flights: the plan equals the best of all, found by going through every one of them.

The oracle shares nothing with the planner but the statement of the problem: it goes through all sets of spans, orders and directions.
"""

import random
from collections.abc import Iterator
from functools import cache
from math import dist, inf

import numpy as np
import pytest

from planning.problem import End, Objective, Problem, UavStart, Visit
from planning.solver.solver import solve

MORE = [(1_000, 500, 7), (2_000, 480, 8), (3_000, 20, 10)]  # first seed, networks, spans at most
CLOSE = 1e-6


class Network:
    """Spans between places of a plane, 1 km wide; UAVs at places of their own, each with a range and a number of flights."""

    def __init__(self, seed: int, most_spans: int) -> None:
        dice = random.Random(seed)
        places = [(dice.uniform(0.0, 1_000.0), dice.uniform(0.0, 1_000.0)) for _ in range(dice.randint(3, most_spans))]
        tree = [(dice.randrange(number), number) for number in range(1, len(places))]
        more = [tuple(dice.sample(range(len(places)), 2)) for _ in range(most_spans - len(tree))]
        self.spans = [(places[one], places[other]) for one, other in dice.sample([*tree, *more], dice.randint(2, most_spans))]
        self.along_m = [dist(*ends) * dice.uniform(1.0, 1.2) for ends in self.spans]
        self.depots = [(dice.uniform(0.0, 1_000.0), dice.uniform(0.0, 1_000.0)) for _ in range(dice.randint(1, 3))]
        self.flights = [dice.randint(1, 3) for _ in self.depots]
        there_m = [2.0 * max(dist(depot, place) for ends in self.spans for place in ends) for depot in self.depots]
        reaches = [dice.choice([inf, dice.uniform(1.2, 3.0)]) for _ in self.depots]
        self.range_m = [most_m * reach for most_m, reach in zip(there_m, reaches, strict=True)]

    def problem(self, objective: Objective) -> Problem:
        directed = [(number, ends, False) for number, ends in enumerate(self.spans)]
        directed += [(number, ends[::-1], True) for number, ends in enumerate(self.spans)]
        begin, end = (np.array([ends[side] for _number, ends, _is_reversed in directed]) for side in (0, 1))
        depots = np.array(self.depots)

        def apart_m(one: np.ndarray, other: np.ndarray) -> np.ndarray:
            return np.hypot(*(one[:, None] - other[None]).transpose(2, 0, 1))

        return Problem(
            uavs=tuple(
                UavStart(max_range_m=None if range_m == inf else range_m, end=End.RETURN, sorties=flights)
                for range_m, flights in zip(self.range_m, self.flights, strict=True)
            ),
            visits=tuple(Visit(number, is_reversed, self.along_m[number]) for number, _ends, is_reversed in directed),
            target_count=len(self.spans),
            from_start_m=apart_m(depots, begin),
            between_m=apart_m(end, begin),
            to_start_m=apart_m(end, depots),
            objective=objective,
        )

    def least(self, objective: Objective) -> float:
        """The least value of all plans that inspect every span once; inf where there is none."""
        everything = frozenset(range(len(self.spans)))
        add = max if objective is Objective.MAKESPAN else lambda one, other: one + other

        @cache
        def shared(uav: int, spans: frozenset[int]) -> float:
            """By this UAV and those after it."""
            if uav == len(self.depots):
                return inf if spans else 0.0
            return min(add(self._of_uav(uav)(own, self.flights[uav]), shared(uav + 1, spans - own)) for own in subsets(spans))

        return shared(0, everything)

    @cache  # noqa: B019 - a network lives as long as its test
    def _of_uav(self, uav: int):
        depot = self.depots[uav]

        @cache
        def flown(spans: frozenset[int], place: tuple[float, float]) -> float:
            """From a place through all of these spans to the depot."""
            if not spans:
                return dist(place, depot)
            return min(
                dist(place, begin) + self.along_m[span] + flown(spans - {span}, end)
                for span in spans
                for begin, end in (self.spans[span], self.spans[span][::-1])
            )

        def one_flight(spans: frozenset[int]) -> float:
            length_m = flown(spans, depot) if spans else 0.0
            return length_m if length_m <= self.range_m[uav] * (1.0 - 1e-6) else inf

        @cache
        def in_flights(spans: frozenset[int], flights: int) -> float:
            if not spans:
                return 0.0
            if flights == 0:
                return inf
            first = min(spans)
            return min(one_flight(own | {first}) + in_flights(spans - own - {first}, flights - 1) for own in subsets(spans - {first}))

        return in_flights


def subsets(spans: frozenset[int]) -> Iterator[frozenset[int]]:
    known = sorted(spans)
    for chosen in range(1 << len(known)):
        yield frozenset(span for place, span in enumerate(known) if chosen >> place & 1)


@pytest.mark.parametrize("objective", [Objective.TOTAL, Objective.MAKESPAN, Objective.TIME])
@pytest.mark.parametrize(("first", "count", "most_spans"), [(0, 40, 6), *(pytest.param(*case, marks=pytest.mark.long) for case in MORE)])
def test_the_plan_of_a_small_network_is_the_best_of_all(first: int, count: int, most_spans: int, objective: Objective) -> None:
    compared = 0
    for seed in range(first, first + count):
        network = Network(seed, most_spans)
        least, plan = network.least(objective), solve(network.problem(objective))
        if least == inf:
            assert plan.unassigned, seed
            continue
        value = plan.longest_s if objective is Objective.MAKESPAN else plan.total_m
        assert not plan.unassigned, seed
        assert plan.is_proven, seed
        assert value == pytest.approx(least, rel=CLOSE), seed
        compared += 1
    assert compared > 0.5 * count
