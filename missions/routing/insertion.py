"""Plans made by putting one target after another where it costs least: quick, and strong for the shortest longest route."""

import random
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from missions.routing.problem import Objective, Problem, Routes, merit

SPAN_POWER = 8  # the sum of lengths to this power grows with the longest route and still sees the others (findings/routing.md, C)
SHUFFLES = 4
MOST_TAKEN = 25

BoolArray = NDArray[np.bool_]


class ArcTable:
    """All arcs in one matrix: rows are starts, then visits; columns are visits, then ends. An open route ends anywhere at no cost."""

    def __init__(self, problem: Problem) -> None:
        uavs, visits = len(problem.uavs), len(problem.visits)
        self.uavs = uavs
        self.end = visits  # column of the first end
        self.along_m = np.array([visit.length_m for visit in problem.visits], dtype=np.float64)
        self.arc_m = np.full((uavs + visits, visits + uavs), np.inf)
        self.arc_m[:uavs, :visits] = problem.from_start_m
        self.arc_m[uavs:, :visits] = problem.between_m
        for uav in range(uavs):
            self.arc_m[uavs:, visits + uav] = problem.end_m[:, uav]
            self.arc_m[uav, visits + uav] = 0.0
        self.limit_m = np.array([start.limit_m for start in problem.uavs], dtype=np.float64)


def insertion_plans(problem: Problem, usable: BoolArray, *, seed: int) -> list[Routes]:
    """Plans from several orders of insertion, the best first. usable (u, v) says which UAV can fly which visit at all."""
    table = ArcTable(problem)
    visits_of = [[visit for visit in visits if usable[:, visit].any()] for visits in problem.visits_of_target()]
    targets = [target for target, visits in enumerate(visits_of) if visits]
    nearest_m = {target: float(problem.from_start_m[:, visits_of[target]].min()) for target in targets}
    orders = [
        sorted(targets, key=lambda target: (nearest_m[target], target)),
        sorted(targets, key=lambda target: (-nearest_m[target], target)),
    ]
    shuffler = random.Random(seed)
    orders.extend(shuffler.sample(targets, len(targets)) for _ in range(SHUFFLES))
    empty: Routes = ((),) * len(problem.uavs)
    plans = {_insert(problem, table, empty, [visits_of[target] for target in order], usable) for order in orders}
    return sorted(plans, key=lambda routes: (merit(problem, routes), routes))


def ruin_and_recreate(
    problem: Problem,
    routes: Routes,
    usable: BoolArray,
    *,
    seed: int,
    rounds: int,
    stop: Callable[[], bool],
    on_round: Callable[[float, Routes], None],
) -> Routes:
    """Take neighbouring targets out of the routes and put them back where they cost least, over and over; worse plans are dropped.

    The neighbourhood lies around a target of the longest route, so that others can take over from it.
    """
    table = ArcTable(problem)
    draw = random.Random(seed)
    gap_m = np.minimum(problem.between_m, problem.between_m.T)
    visits_of = problem.visits_of_target()
    best, best_merit = routes, merit(problem, routes)
    for number in range(rounds):
        if stop():
            break
        on_round(number / rounds, best)
        longest = max(range(len(best)), key=lambda uav: problem.route_length_m(uav, best[uav]))
        if not best[longest]:
            break
        flown = [visit for route in best for visit in route]
        from_here_m = gap_m[draw.choice(best[longest])]
        taken = set(sorted(flown, key=from_here_m.__getitem__)[: draw.randint(2, min(MOST_TAKEN, max(2, len(flown) // 3)))])
        kept = tuple(tuple(visit for visit in route if visit not in taken) for route in best)
        if not all(np.isfinite(problem.route_length_m(uav, route)) for uav, route in enumerate(kept)):
            continue  # what was taken out had joined two networks
        back = [visits_of[problem.visits[visit].target] for visit in draw.sample(sorted(taken), len(taken))]
        plan = _insert(problem, table, kept, back, usable)
        plan_merit = merit(problem, plan)
        if plan_merit < best_merit:
            best, best_merit = plan, plan_merit
    return best


def with_missing_inserted(problem: Problem, routes: Routes, usable: BoolArray) -> Routes:
    """The routes, and in them what they leave out and still fits."""
    visited = {problem.visits[visit].target for route in routes for visit in route}
    missing = [visits for target, visits in enumerate(problem.visits_of_target()) if target not in visited]
    return _insert(problem, ArcTable(problem), routes, missing, usable) if missing else routes


def _insert(problem: Problem, table: ArcTable, routes: Routes, alternatives: Sequence[Sequence[int]], usable: BoolArray) -> Routes:
    """Put in one visit of each group of alternatives, in this order, where it costs least; skip a group that fits nowhere.

    What did not fit is tried once more at the end: a target that came later may have joined two networks.
    """
    plan = [list(route) for route in routes]
    length_m = np.array([problem.route_length_m(uav, route) for uav, route in enumerate(plan)])
    skipped = [visits for visits in alternatives if not _insert_one(problem, table, plan, length_m, visits, usable)]
    while skipped:
        again = [visits for visits in skipped if not _insert_one(problem, table, plan, length_m, visits, usable)]
        if len(again) == len(skipped):
            break
        skipped = again
    return tuple(tuple(route) for route in plan)


def _insert_one(
    problem: Problem, table: ArcTable, plan: list[list[int]], length_m: NDArray[np.float64], visits: Sequence[int], usable: BoolArray
) -> bool:
    tail = np.concatenate([[uav, *(table.uavs + visit for visit in route)] for uav, route in enumerate(plan)])
    head = np.concatenate([[*route, table.end + uav] for uav, route in enumerate(plan)])
    owner = np.repeat(np.arange(len(plan)), [len(route) + 1 for route in plan])
    gap_m = table.arc_m[tail, head]
    best: tuple[float, int, int] | None = None
    for visit in visits:
        added_m = table.arc_m[tail, visit] + table.along_m[visit] + table.arc_m[table.uavs + visit, head] - gap_m
        longer_m = length_m[owner] + added_m
        fits = (longer_m <= table.limit_m[owner]) & usable[owner, visit] & np.isfinite(added_m)
        if not fits.any():
            continue
        price = added_m if problem.objective is Objective.TOTAL else _span_price(length_m[owner], longer_m, fits)
        place = int(np.argmin(np.where(fits, price, np.inf)))
        if best is None or price[place] < best[0]:
            best = (float(price[place]), place, visit)
    if best is None:
        return False
    _, place, visit = best
    uav = int(owner[place])
    plan[uav].insert(place - int(np.searchsorted(owner, uav)), visit)
    length_m[uav] = problem.route_length_m(uav, plan[uav])
    return True


def _span_price(length_m: NDArray[np.float64], longer_m: NDArray[np.float64], fits: BoolArray) -> NDArray[np.float64]:
    """Growth of the sum of lengths to a high power, in kilometres so that the numbers stay small."""
    return np.asarray((np.where(fits, longer_m, 0.0) / 1_000) ** SPAN_POWER - (length_m / 1_000) ** SPAN_POWER, dtype=np.float64)
