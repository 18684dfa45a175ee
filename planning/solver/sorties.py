"""UAVs that fly several times: each sortie is a row of its own for the solvers, and belongs to its UAV again afterwards."""

from dataclasses import replace

import numpy as np

from planning.problem import Problem, Routes, merit


def unfolded(problem: Problem) -> Problem:
    """The problem with a row for each sortie, the rows of a UAV one after another and of one owner; itself if each flies once.

    A UAV with a locked run at the start or the end of its route flies once.
    """
    bound = {lock.uav for lock in problem.locks if lock.at_start or lock.at_end}
    most = [1 if uav in bound else max(1, min(start.sorties, start.most, problem.target_count)) for uav, start in enumerate(problem.uavs)]
    if max(most, default=1) == 1:
        return problem
    rows = np.repeat(np.arange(len(most)), most)
    first_row = np.cumsum([0, *most]).tolist()
    return replace(
        problem,
        uavs=tuple(replace(problem.uavs[uav], sorties=1) for uav in rows.tolist()),
        from_start_m=problem.from_start_m[rows],
        to_start_m=problem.to_start_m[:, rows],
        to_base_m=None if problem.to_base_m is None else problem.to_base_m[:, rows],
        allowed=None if problem.allowed is None else problem.allowed[rows],
        cannot_end=None if problem.cannot_end is None else problem.cannot_end[:, rows],
        locks=tuple(replace(lock, uav=first_row[lock.uav] if 0 <= lock.uav < len(most) else len(rows)) for lock in problem.locks),
        seconds=None if problem.seconds is None else problem.seconds.of_uavs(rows),
        wh=None if problem.wh is None else problem.wh.of_uavs(rows),
        class_of=tuple(problem.class_of[uav] for uav in rows.tolist()) if problem.class_of else (),
        owner=tuple(rows.tolist()),
    )


def by_uav(rows: Problem, routes: Routes) -> tuple[Routes, ...]:
    """The routes of each UAV's sorties, those without a visit left out."""
    owner = rows.owner or tuple(range(len(rows.uavs)))
    flown: dict[int, list[tuple[int, ...]]] = {uav: [] for uav in owner}
    for uav, route in zip(owner, routes, strict=True):
        if route:
            flown[uav].append(route)
    return tuple(tuple(sorties) for sorties in flown.values())


def merit_of(problem: Problem, sorties: tuple[Routes, ...]) -> tuple[float, float, float]:
    """The merit of the plan with these sorties of each UAV; see `merit`."""
    rows = unfolded(replace(problem, locks=()))
    rest = [list(flown) for flown in sorties]
    owner = rows.owner or tuple(range(len(rows.uavs)))
    return merit(rows, tuple(rest[uav].pop(0) if rest[uav] else () for uav in owner))


def joined(sorties: tuple[Routes, ...]) -> Routes:
    """The visits of each UAV one after another, over all its sorties."""
    return tuple(tuple(visit for route in flown for visit in route) for flown in sorties)
