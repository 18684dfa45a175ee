"""How far each target is for each UAV at best, and why a target has to be left out."""

from collections.abc import Sequence

import numpy as np
from numba import njit

from missions.routing.arcs import IntArray
from missions.routing.problem import BoolArray, End, FloatArray, Problem, Reason, Routes, Unassigned

_THERE = {End.OPEN: "there", End.RETURN: "there and back", End.ANY_BASE: "there and on to the nearest base"}


def needed_range_m(problem: Problem) -> FloatArray:
    """The least range (u, v) with which a UAV can fly a visit, and on to where it ends; inf where there is no way at all or it may not.

    Other targets may lie on the way: a place between two networks can join them.
    """
    visits, uavs = len(problem.visits), len(problem.uavs)
    needed_m = np.full((uavs, visits), np.inf)
    if not visits or not uavs:
        return needed_m
    along_m = np.array([visit.length_m for visit in problem.visits])
    first_m, end_m = problem.from_start_m + along_m, problem.end_m
    allowed = np.ones((uavs, visits), dtype=bool) if problem.allowed is None else problem.allowed
    for flown, alike in _by_allowed_visits(allowed):
        onward_m = least_ways(problem.between_m[np.ix_(flown, flown)] + along_m[flown])
        for uav in alike:
            out_m = (first_m[uav, flown][:, None] + onward_m).min(axis=0)
            needed_m[uav, flown] = out_m + (onward_m + end_m[flown, uav]).min(axis=1)
    return needed_m


def _by_allowed_visits(allowed: BoolArray) -> list[tuple[IntArray, list[int]]]:
    """Sets of visits, and the UAVs that may fly just these."""
    alike: dict[bytes, list[int]] = {}
    for uav, row in enumerate(allowed):
        if row.any():
            alike.setdefault(row.tobytes(), []).append(uav)
    return [(np.flatnonzero(allowed[group[0]]), group) for group in alike.values()]


def least_ways(onward_m: FloatArray) -> FloatArray:
    """Least metres between all pairs of visits, over others if that is shorter (Floyd 1962); 0 from a visit to itself."""
    ways_m: FloatArray = np.array(onward_m, dtype=np.float64)
    np.fill_diagonal(ways_m, 0.0)
    _shorten(ways_m)
    return ways_m


@njit(cache=True, nogil=True)
def _shorten(ways_m: FloatArray) -> None:
    for over in range(len(ways_m)):
        onward_m = ways_m[over]
        for start in range(len(ways_m)):
            there_m = ways_m[start, over]
            if there_m < np.inf:
                row_m = ways_m[start]
                for end in range(len(ways_m)):
                    row_m[end] = min(row_m[end], there_m + onward_m[end])


def reachable(problem: Problem, needed_m: FloatArray) -> BoolArray:
    """Whether each UAV can fly each visit within its limits, (u, v)."""
    limit_m = np.array([uav.limit_m for uav in problem.uavs])
    most = np.array([uav.most for uav in problem.uavs])
    done = np.array([visit.done for visit in problem.visits])
    within: BoolArray = np.isfinite(needed_m) & (needed_m <= limit_m[:, None]) & (done <= most[:, None])
    return within


def reasons(problem: Problem, needed_m: FloatArray, routes: Routes) -> tuple[Unassigned, ...]:
    """The true reason for each target that the routes leave out."""
    visited = {problem.visits[visit].target for route in routes for visit in route}
    left_out = [target for target in range(problem.target_count) if target not in visited]
    if not left_out:
        return ()
    limit_m = np.array([uav.limit_m for uav in problem.uavs])
    within_range = np.isfinite(needed_m) & (needed_m <= limit_m[:, None])
    done = [sum(problem.visits[visit].done for visit in route) for route in routes]
    visits_of = problem.visits_of_target()
    return tuple(Unassigned(target, *_reason(problem, needed_m, within_range, done, visits_of[target])) for target in left_out)


def _reason(
    problem: Problem, needed_m: FloatArray, within_range: BoolArray, done: Sequence[int], visits: Sequence[int]
) -> tuple[Reason, str]:
    needed_m, within = needed_m[:, visits], within_range[:, visits]
    if not len(problem.uavs):
        return Reason.NO_PATH, "There is no UAV that can take off."
    if visits and problem.allowed is not None and not problem.allowed[:, visits].any():
        return Reason.NOT_ALLOWED, "No UAV of the plan is allowed to do it: none has the sensor or is the UAV that it is tied to."
    if not np.isfinite(needed_m).any():
        return Reason.NO_PATH, "No UAV can get there: no way on the network keeps clear of every zone."
    if not within.any():
        limit_m = np.array([uav.limit_m for uav in problem.uavs])
        missing_m = np.where(np.isfinite(needed_m), needed_m, np.inf) - np.where(np.isfinite(needed_m), limit_m[:, None], 0.0)
        uav, visit = np.unravel_index(np.argmin(missing_m), needed_m.shape)
        there = _THERE[problem.uavs[uav].end]
        needed, missing = _km(needed_m[uav, visit]), _km(missing_m[uav, visit])
        return Reason.BEYOND_RANGE, f"It is {needed} {there}, {missing} more than the range of the UAV that comes nearest to it."
    able = np.flatnonzero(within.any(axis=1)).tolist()
    if all(done[uav] + min(problem.visits[visit].done for visit in visits) > problem.uavs[uav].most for uav in able):
        return Reason.MOST_TARGETS, "Each UAV that can do it has as many targets as it may have."
    if any(problem.uavs[uav].max_range_m is not None for uav in able):
        return Reason.BEYOND_RANGE, "It is within range alone, but not within the range that is left after the other targets."
    return Reason.NO_PATH, "A UAV can get there, but not on one route with its other targets. Add a UAV."


def _km(length_m: float) -> str:
    return f"{length_m:,.0f} m" if length_m < 1_000 else f"{length_m / 1_000:,.1f} km"
