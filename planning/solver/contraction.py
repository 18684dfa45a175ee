"""Runs of targets as one visit each of a smaller problem: locked runs, and lines that are divided into parts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from planning.problem import BoolArray, FloatArray, IntArray, Problem, Resources, Routes, Unassigned, Visit

JOINED_M = 1e-6  # from the end of a part to the begin of the next
HAIR = 1e-6  # metres, seconds or Wh: rounding


@dataclass(frozen=True)
class Run:
    """One way of flying a run: its visits in order, and what it takes from the first one's begin to the last one's end.

    `taken` are metres, then seconds and Wh by class where the problem has them.
    """

    visits: tuple[int, ...]
    taken: tuple[float, ...]
    is_reversed: bool = False  # the other way round of a run with two

    @property
    def length_m(self) -> float:
        return self.taken[0]


@dataclass(frozen=True, eq=False)
class Reduced:
    """A problem in which every run is one target; `visits_of` and `targets_of` lead back to the visits and targets of the whole one.

    `is_whole` tells whether every way through the runs that could be the best is in it.
    """

    problem: Problem
    visits_of: tuple[tuple[int, ...], ...]
    targets_of: tuple[tuple[int, ...], ...]
    is_whole: bool

    def expanded(self, routes: Routes) -> Routes:
        return tuple(tuple(visit for reduced in route for visit in self.visits_of[reduced]) for route in routes)

    def expanded_reasons(self, unassigned: Sequence[Unassigned]) -> tuple[Unassigned, ...]:
        spread = [replace(item, target=target) for item in unassigned for target in self.targets_of[item.target]]
        return tuple(sorted(spread, key=lambda item: item.target))

    def contracted(self, routes: Routes) -> Routes | None:
        """Return routes of the whole problem in visits of this one; None where a run is not flown at one go."""
        run_of = {visits[0]: number for number, visits in enumerate(self.visits_of)}
        found = []
        for route in routes:
            own, at = [], 0
            while at < len(route):
                number = run_of.get(route[at], -1)
                if number < 0 or route[at : at + len(self.visits_of[number])] != self.visits_of[number]:
                    return None
                own.append(number)
                at += len(self.visits_of[number])
            found.append(tuple(own))
        return tuple(found)


def alone(problem: Problem, visit: int) -> Run:
    """Return the run of a target that is in no other."""
    return replace(begun(problem, visit), is_reversed=problem.visits[visit].is_reversed)


def begun(problem: Problem, visit: int) -> Run:
    more = [float(amount) for resources in _resources(problem) for amount in resources.at_visit[:, visit]]
    return Run((visit,), (problem.visits[visit].length_m, *more))


def onward(problem: Problem, run: Run, visit: int) -> Run:
    last = run.visits[-1]
    length_m = run.length_m + float(problem.between_m[last, visit]) + problem.visits[visit].length_m
    more = [
        float(amount) for resources in _resources(problem) for amount in resources.onward[:, last, visit] + resources.at_visit[:, visit]
    ]
    return replace(
        run,
        visits=(*run.visits, visit),
        taken=(length_m, *(own + added for own, added in zip(run.taken[1:], more, strict=True))),
    )


def _resources(problem: Problem) -> list[Resources]:
    return [resources for resources in (problem.seconds, problem.wh) if resources is not None]


def reduced_to(
    problem: Problem, runs: Sequence[Run], target_of: Sequence[int], targets_of: Sequence[tuple[int, ...]], weights: FloatArray
) -> Reduced:
    """Return the problem in which each run is a visit of its target. Raises InvalidProblem.

    target_of: of each run, by its number in targets_of; weights: of leaving out each target.
    """
    first = np.array([run.visits[0] for run in runs], dtype=np.int64)
    last = np.array([run.visits[-1] for run in runs], dtype=np.int64)
    visits = [_as_visit(problem, run, target) for run, target in zip(runs, target_of, strict=True)]
    return Reduced(
        replace(
            problem,
            visits=tuple(visits),
            target_count=len(targets_of),
            from_start_m=problem.from_start_m[:, first],
            between_m=problem.between_m[np.ix_(last, first)],
            to_start_m=problem.to_start_m[last],
            to_base_m=None if problem.to_base_m is None else problem.to_base_m[last],
            allowed=_allowed(problem, runs),
            cannot_end=None if problem.cannot_end is None else problem.cannot_end[last],
            priorities=(),
            locks=(),
            weights=weights,
            seconds=None if problem.seconds is None else _of_runs(problem.seconds, runs),
            wh=None if problem.wh is None else _of_runs(problem.wh, runs),
        ),
        tuple(run.visits for run in runs),
        tuple(targets_of),
        is_whole=True,
    )


def _as_visit(problem: Problem, run: Run, target: int) -> Visit:
    own = [problem.visits[visit] for visit in run.visits]
    return Visit(target, run.is_reversed, run.length_m, sum(visit.service_s for visit in own), sum(visit.done for visit in own))


def _allowed(problem: Problem, runs: Sequence[Run]) -> BoolArray:
    allowed = np.ones((len(problem.uavs), len(problem.visits)), dtype=bool) if problem.allowed is None else problem.allowed
    return np.array([allowed[:, list(run.visits)].all(axis=1) for run in runs], dtype=bool).reshape(len(runs), len(problem.uavs)).T


def _of_runs(resources: Resources, runs: Sequence[Run]) -> Resources:
    """What whole runs take, along the ways between their visits too."""
    inside = [
        resources.at_visit[:, list(run.visits)].sum(axis=1) + resources.onward[:, list(run.visits[:-1]), list(run.visits[1:])].sum(axis=1)
        for run in runs
    ]
    first, last = np.array([run.visits[0] for run in runs], dtype=np.int64), np.array([run.visits[-1] for run in runs], dtype=np.int64)
    return resources.taken(first, last, np.array(inside, dtype=np.float64).reshape(len(runs), len(resources.onward)).T)


@dataclass(frozen=True)
class Chain:
    """Parts of a line, each beginning where the one before ends: their visits in one direction and in the other."""

    forward: tuple[int, ...]
    backward: tuple[int, ...]


def chains_of(problem: Problem) -> list[Chain]:
    """Return the chains of two and more stretches that weigh the same and that the same UAVs may fly."""
    both = {target: tuple(visits) for target, visits in enumerate(problem.visits_of_target()) if _is_stretch(problem, visits)}
    if len(both) < 2:
        return []
    other_way = {visit: other for pair in both.values() for visit, other in (pair, pair[::-1])}
    ways = np.array(sorted(other_way), dtype=np.int64)
    joins = problem.between_m[np.ix_(ways, ways)] <= JOINED_M
    target_of = np.array([problem.visits[visit].target for visit in ways.tolist()])
    joins &= (target_of[:, None] != target_of) & _alike(problem, ways, target_of)
    joins &= (joins.sum(axis=1) == 1)[:, None] & (joins.sum(axis=0) == 1)  # where several lines meet, a chain ends
    next_of = {int(ways[left]): int(ways[right]) for left, right in np.argwhere(joins).tolist()}
    next_of = {left: right for left, right in next_of.items() if next_of.get(other_way[right]) == other_way[left]}
    found: list[Chain] = []
    seen: set[int] = set()
    before = {right: left for left, right in next_of.items()}
    open_ends = [way for way in next_of if way not in before]
    for begin in (*open_ends, *next_of):  # what is left after those that begin somewhere is closed, and begins anywhere
        if problem.visits[begin].target in seen:
            continue
        forward = [begin]
        while forward[-1] in next_of and next_of[forward[-1]] != begin:
            forward.append(next_of[forward[-1]])
        seen.update(problem.visits[visit].target for visit in forward)
        found.append(Chain(tuple(forward), tuple(other_way[visit] for visit in reversed(forward))))
    return found


def _is_stretch(problem: Problem, visits: Sequence[int]) -> bool:
    return len(visits) == 2 and {problem.visits[visit].is_reversed for visit in visits} == {False, True}


def _alike(problem: Problem, ways: IntArray, target_of: IntArray) -> BoolArray:
    """Whether two ways weigh the same and are allowed to the same UAVs, (ways, ways)."""
    asked = problem.left_out_weights[target_of][None]
    if problem.allowed is not None:
        asked = np.vstack([asked, problem.allowed[:, ways]])
    _columns, number = np.unique(asked, axis=1, return_inverse=True)
    alike: BoolArray = number.reshape(-1, 1) == number.reshape(1, -1)
    return alike


def in_pieces(problem: Problem, chains: Sequence[Chain], most: int) -> Reduced:
    """Return the problem with each chain cut into at most so many runs of about as many parts, flown in either direction.

    The cuts of a number of pieces are among those of twice as many.
    """
    in_chain = {problem.visits[visit].target for chain in chains for visit in chain.forward}
    runs: list[Run] = []
    target_of: list[int] = []
    targets_of: list[tuple[int, ...]] = []
    for target, visits in enumerate(problem.visits_of_target()):
        if target not in in_chain:
            runs += [alone(problem, visit) for visit in visits]
            target_of += [len(targets_of)] * len(visits)
            targets_of.append((target,))
    for chain in chains:
        count = len(chain.forward)
        cuts = sorted({round(count * number / most) for number in range(most + 1)})
        for begin, end in pairwise(cuts):
            ways = (chain.forward[begin:end], chain.backward[count - end : count - begin])
            runs += [replace(_through(problem, way), is_reversed=number > 0) for number, way in enumerate(ways)]
            target_of += [len(targets_of)] * len(ways)
            targets_of.append(tuple(problem.visits[visit].target for visit in ways[0]))
    weights = np.array([problem.left_out_weights[list(targets)].sum() for targets in targets_of])
    return reduced_to(problem, runs, target_of, targets_of, weights)


def _through(problem: Problem, way: Sequence[int]) -> Run:
    run = begun(problem, way[0])
    for visit in way[1:]:
        run = onward(problem, run, visit)
    return run


def with_runs(problem: Problem, chains: Sequence[Chain], routes: Routes) -> Routes:
    """Return the routes with neighbouring parts of a line one after the other where that costs nothing.

    Out along a line and back it is all the same to metres which part is done on which way; in flight each turn costs time.
    """
    return tuple(_with_runs(problem, chains, uav, route) for uav, route in enumerate(routes))


def _with_runs(problem: Problem, chains: Sequence[Chain], uav: int, route: tuple[int, ...]) -> tuple[int, ...]:
    for chain in chains:
        place_of = {problem.visits[visit].target: place for place, visit in enumerate(chain.forward)}
        done = sorted(place_of[target] for visit in route if (target := problem.visits[visit].target) in place_of)
        runs = np.split(done, np.flatnonzero(np.diff(done) > 1) + 1) if done else []
        for begin, end in ((int(run[0]), int(run[-1]) + 1) for run in runs if len(run) > 1):
            route = _with_run(problem, chain, uav, route, begin, end)
    return route


def _with_run(problem: Problem, chain: Chain, uav: int, route: tuple[int, ...], begin: int, end: int) -> tuple[int, ...]:
    """Return the route with the parts from begin to before end of a chain at one go, where the first or the last of them was."""
    count = len(chain.forward)
    ways = chain.forward[begin:end], chain.backward[count - end : count - begin]
    own = {*ways[0], *ways[1]}
    rest = [visit for visit in route if visit not in own]
    places = [place for place, visit in enumerate(route) if visit in own]
    slots = {places[0], places[-1] + 1 - len(places)}
    candidates = [(*rest[:slot], *way, *rest[slot:]) for slot in sorted(slots) for way in ways]
    most = _taken(problem, uav, route)
    equal = [one for one in candidates if all(own <= limit + HAIR for own, limit in zip(_taken(problem, uav, one), most, strict=True))]
    return min((route, *equal), key=lambda one: _turns(problem, one))


def _taken(problem: Problem, uav: int, route: tuple[int, ...]) -> tuple[float, float, float]:
    """Return what a route takes: metres, seconds and Wh."""
    return problem.route_length_m(uav, route), problem.route_duration_s(uav, route), problem.route_wh(uav, route) or 0.0


def _turns(problem: Problem, route: tuple[int, ...]) -> int:
    """Return how often the next visit does not begin where the one before ends."""
    return sum(bool(problem.between_m[left, right] > JOINED_M) for left, right in pairwise(route))
