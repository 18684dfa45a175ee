"""Small random problems, and their optimum by trying everything."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations, product

import numpy as np

from planning.problem import End, Lock, Objective, Priority, Problem, Resources, Routes, UavStart, Visit, merit

BY_WAYS = (Objective.TOTAL, Objective.MAKESPAN, Objective.TIME)  # what can be asked for without knowing anything of energy


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


def mixed_problem(seed: int, *, uavs: int = 2, targets: int = 4, locks: int = 0) -> Problem:
    """A random problem with a bit of everything: ends, speeds, ranges, services, priorities, who may fly what, stretches, networks."""
    draw = np.random.default_rng(seed)
    objective = Objective.MAKESPAN if seed % 2 else Objective.TOTAL
    stretches = int(draw.integers(0, 3))
    plain = random_problem(seed, uavs=uavs, targets=targets, stretches=stretches, objective=objective, networks=int(draw.integers(1, 4)))
    service_s = draw.uniform(0, 400, targets) * draw.integers(0, 2)
    several = bool(draw.integers(0, 2))
    starts = tuple(
        UavStart(
            max_range_m=float(draw.uniform(20_000, 120_000)) if draw.integers(0, 2) else None,
            end=list(End)[draw.integers(0, 3)],
            speed_mps=float(draw.uniform(8, 20)) if several else 12.0,
            most_targets=int(draw.integers(1, targets + 1)) if draw.integers(0, 4) == 0 else None,
            ready_s=float(draw.uniform(0, 300)) if several else 40.0 * (seed % 3),
        )
        for _ in range(uavs)
    )
    allowed = draw.random((uavs, len(plain.visits))) < 0.8 if draw.integers(0, 3) == 0 else None
    return replace(
        plain,
        uavs=starts,
        visits=tuple(replace(visit, service_s=float(service_s[visit.target])) for visit in plain.visits),
        to_base_m=plain.to_start_m * draw.uniform(0.2, 1.0, plain.to_start_m.shape),
        allowed=allowed,
        priorities=tuple(Priority(int(level)) for level in draw.integers(0, 3, targets)) if draw.integers(0, 2) else (),
        locks=_some_locks(draw, uavs, targets, locks),
    )


def windy_problem(seed: int, objective: Objective, *, uavs: int = 2, targets: int = 4, locks: int = 0, sorties: int = 1) -> Problem:
    """A mixed problem with seconds and Wh of its own, of one or two classes: neither follows from the metres, nor is there as back.

    Batteries and ranges are such that some of the targets fit. With sorties some UAVs that return may fly several times.
    """
    draw = np.random.default_rng((seed, 1))
    plain = mixed_problem(seed, uavs=uavs, targets=targets, locks=locks)
    classes = int(draw.integers(1, 3))
    class_of = tuple(int(number) for number in draw.integers(0, classes, uavs))
    visits = len(plain.visits)
    along_m = np.array([visit.length_m for visit in plain.visits])

    def uneven(shape: tuple[int, ...]) -> np.ndarray:
        return draw.uniform(0.6, 1.8, shape)

    def amounts(per_m: float, per_service: float, ready: float) -> Resources:
        return Resources(
            first=plain.from_start_m * per_m * uneven((uavs, visits)),
            onward=plain.between_m * per_m * uneven((classes, visits, visits)),
            end=plain.end_m * per_m * uneven((visits, uavs)),
            along=along_m * per_m * uneven((classes, visits)),
            service=per_service * uneven((classes, 1)) * np.ones((1, visits)),
            ready=ready * uneven((uavs,)),
        )

    has_seconds = bool(draw.integers(0, 4))
    knows_all = objective is Objective.ENERGY or bool(draw.integers(0, 2))
    is_limited = bool(draw.integers(0, 4))
    starts = []
    for start in plain.uavs:
        usable_wh = float(draw.uniform(10.0, 100.0)) if is_limited else np.inf
        most_sorties = int(draw.integers(1, sorties + 1)) if start.end is End.RETURN else 1
        starts.append(
            replace(
                start,
                usable_wh=usable_wh if knows_all or draw.integers(0, 2) else None,
                sorties=most_sorties,
                turnaround_s=float(draw.uniform(0, 600)) * (most_sorties > 1),
            )
        )
    return replace(
        plain,
        uavs=tuple(starts),
        objective=objective,
        seconds=amounts(1 / 12.0, 0.0, 30.0) if has_seconds else None,
        wh=amounts(1e-3, 0.5, 1.0),
        class_of=class_of,
    )


def _some_locks(draw: np.random.Generator, uavs: int, targets: int, locks: int) -> tuple[Lock, ...]:
    order = draw.permutation(targets).tolist()
    chosen: list[Lock] = []
    for _ in range(locks):
        run = tuple(order.pop() for _ in range(min(len(order), int(draw.integers(1, 4)))))
        uav = int(draw.integers(0, uavs))
        at_start = bool(draw.integers(0, 2)) and not any(lock.uav == uav and lock.at_start for lock in chosen)
        at_end = bool(draw.integers(0, 2)) and not any(lock.uav == uav and lock.at_end for lock in chosen)
        if run:
            chosen.append(Lock(uav, run, at_start, at_end))
    return tuple(chosen)


def honours(problem: Problem, routes: Routes, lock: Lock) -> bool:
    """Whether the routes fly the locked run as it is wished."""
    order = [problem.visits[visit].target for visit in routes[lock.uav]]
    places = [order.index(target) for target in lock.targets if target in order]
    return (
        len(places) == len(lock.targets)
        and places == list(range(places[0], places[0] + len(places)))
        and (not lock.at_start or places[0] == 0)
        and (not lock.at_end or places[-1] == len(order) - 1)
    )


def every_plan(problem: Problem) -> Iterator[Routes]:
    """All plans that keep every UAV's limits, those over all its sorties too. For up to five targets."""
    choices: list[list[tuple[int, int] | None]] = [
        [None, *((uav, visit) for uav in range(len(problem.uavs)) for visit in visits)] for visits in problem.visits_of_target()
    ]
    orders: dict[tuple[int, tuple[int, ...]], list[tuple[int, ...]]] = {}
    for choice in product(*choices):
        flown: list[list[tuple[int, ...]]] = []
        for uav in range(len(problem.uavs)):
            own = tuple(item[1] for item in choice if item is not None and item[0] == uav)
            if (uav, own) not in orders:
                orders[uav, own] = [order for order in permutations(own) if problem.keeps_limits(uav, order)]
            flown.append(orders[uav, own])
        if _keeps_most(problem, choice):
            yield from product(*flown)


def _keeps_most(problem: Problem, choice: tuple[tuple[int, int] | None, ...]) -> bool:
    if not problem.owner:
        return True
    done = dict.fromkeys(problem.owner, 0)
    for item in choice:
        if item is not None:
            done[problem.owner[item[0]]] += problem.visits[item[1]].done
    return all(done[owner] <= problem.uavs[uav].most for uav, owner in enumerate(problem.owner))


def best_merit(problem: Problem) -> tuple[float, float, float]:
    """The merit of the best plan there is, by trying them all; locks are not looked at. For up to five targets."""
    return min(merit(problem, routes) for routes in every_plan(problem))
