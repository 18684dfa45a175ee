"""Lines in parts: their chains are found, in pieces they are smaller problems, and a plan of parts is no worse than one of whole lines."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from planning.problem import End, Objective, Problem, UavStart, Visit
from planning.solver.contraction import chains_of, in_pieces, with_runs
from planning.solver.solver import SEARCH, solve

PART_M = 1_000.0


def lines_problem(
    seed: int, *, lines: int = 3, parts: int = 8, uavs: int = 3, towers: int = 0, range_m: float | None = None, is_whole: bool = False
) -> Problem:
    """Straight lines in any direction in a square of 20 km, ways as the crow flies; every second part is drawn the other way round."""
    draw = np.random.default_rng(seed)
    begin, course = draw.uniform(0, 20_000, (lines, 2)), draw.uniform(0, 2 * math.pi, lines)
    entries, exits, visits = [], [], []
    for line in range(lines):
        ahead = np.array([math.sin(course[line]), math.cos(course[line])])
        count = 1 if is_whole else parts
        length_m = parts * PART_M / count
        for part in range(count):
            ends = [begin[line] + ahead * length_m * part, begin[line] + ahead * length_m * (part + 1)]
            if part % 2:
                ends.reverse()
            target = line * count + part
            visits += [Visit(target, False, length_m), Visit(target, True, length_m)]
            entries += ends
            exits += ends[::-1]
    first = visits[-1].target + 1
    for number, place in enumerate(draw.uniform(0, 20_000, (towers, 2))):
        visits.append(Visit(first + number))
        entries.append(place)
        exits.append(place)
    starts = draw.uniform(0, 20_000, (uavs, 2))

    def ways(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        found = np.hypot(*(rows[:, None] - columns[None]).transpose(2, 0, 1))
        return np.where(found < 1e-6, 0.0, found)

    return Problem(
        uavs=tuple(UavStart(range_m, End.RETURN) for _ in range(uavs)),
        visits=tuple(visits),
        target_count=first + towers,
        from_start_m=ways(starts, np.array(entries)),
        between_m=ways(np.array(exits), np.array(entries)),
        to_start_m=ways(np.array(exits), starts),
        objective=Objective.MAKESPAN,
    )


def test_the_parts_of_each_line_are_a_chain_in_both_directions() -> None:
    problem = lines_problem(1, lines=3, parts=8, towers=4)
    chains = chains_of(problem)
    assert sorted(len(chain.forward) for chain in chains) == [8, 8, 8]
    for chain in chains:
        for way in (chain.forward, chain.backward):
            assert all(problem.between_m[left, right] == 0.0 for left, right in pairwise(way))
        targets = [problem.visits[visit].target for visit in chain.forward]
        assert targets == [problem.visits[visit].target for visit in reversed(chain.backward)]
        assert targets in (sorted(targets), sorted(targets, reverse=True))


def test_parts_that_other_uavs_may_fly_or_that_weigh_more_are_in_no_chain_with_the_others() -> None:
    problem = lines_problem(1, lines=1, parts=8)
    allowed = np.ones((3, 16), dtype=bool)
    allowed[0, 8:] = False
    tied = replace(problem, allowed=allowed)
    assert sorted(len(chain.forward) for chain in chains_of(tied)) == [4, 4]
    weights = np.ones(8)
    weights[2:4] = 100.0
    heavier = replace(problem, weights=weights)
    assert sorted(len(chain.forward) for chain in chains_of(heavier)) == [2, 2, 4]


def test_towers_alone_are_in_no_chain() -> None:
    assert chains_of(lines_problem(1, lines=1, parts=1, towers=8)) == []


@pytest.mark.parametrize("most", [1, 2, 4])
def test_pieces_take_what_their_parts_take_and_lead_back_to_them(most: int) -> None:
    problem = lines_problem(2, lines=2, parts=8, towers=3)
    coarse = in_pieces(problem, chains_of(problem), most)
    assert coarse.problem.target_count == 2 * most + 3
    assert sorted(target for targets in coarse.targets_of for target in targets) == list(range(problem.target_count))
    routes = solve(coarse.problem).routes
    flown = coarse.expanded(routes)
    assert coarse.contracted(flown) == routes
    for uav, (own, parts) in enumerate(zip(routes, flown, strict=True)):
        assert problem.route_length_m(uav, parts) == pytest.approx(coarse.problem.route_length_m(uav, own))


@pytest.mark.parametrize("seed", range(4))
def test_shared_lines_are_done_no_later_than_whole_ones(seed: int) -> None:
    whole = solve(lines_problem(seed, is_whole=True))
    shared = solve(lines_problem(seed))
    assert shared.method == SEARCH and not shared.unassigned
    assert shared.longest_s <= whole.longest_s + 1e-6


def test_a_line_that_is_too_long_for_every_uav_is_shared_where_its_parts_are_in_reach() -> None:
    """Two UAVs, one at each end of the line of 16 km, of which each flies 20 km."""
    problem = lines_problem(3, lines=1, parts=16, uavs=2, range_m=20_000.0)
    [chain] = chains_of(problem)
    ends = (chain.forward, chain.backward)
    near = replace(
        problem,
        from_start_m=np.vstack([problem.between_m[way[-1]] for way in reversed(ends)]),
        to_start_m=np.column_stack([problem.between_m[:, way[0]] for way in ends]),
    )
    found = solve(near)
    assert found.unassigned == ()
    assert [len(route) for route in found.routes] == [8, 8]
    assert found.longest_m == pytest.approx(16_000.0)


def test_parts_are_done_one_after_the_other_where_that_costs_nothing() -> None:
    """Out along a line and back: first two parts on the way out, one on the way back, the next before the end."""
    problem = lines_problem(5, lines=1, parts=8, uavs=1, towers=2)
    [chain] = chains_of(problem)
    start = replace(
        problem,
        from_start_m=problem.between_m[chain.backward[-1]][None],
        to_start_m=problem.between_m[:, chain.forward[0]][:, None],
    )
    back = {problem.visits[visit].target: visit for visit in chain.backward}
    out = chain.forward
    route = (out[0], out[2], out[3], out[5], back[problem.visits[out[4]].target], back[problem.visits[out[1]].target])
    [found] = with_runs(start, [chain], (route,))
    assert found in (out[:6], tuple(back[problem.visits[visit].target] for visit in reversed(out[:6])))
    assert start.route_length_m(0, found) == pytest.approx(start.route_length_m(0, route))
    costly = (*out[:2], len(problem.visits) - 1, *out[2:4])
    [kept] = with_runs(start, [chain], (costly,))
    assert start.route_length_m(0, kept) <= start.route_length_m(0, costly) + 1e-6
    assert sorted(kept) == sorted(costly) or {problem.visits[one].target for one in kept} == {problem.visits[one].target for one in costly}
