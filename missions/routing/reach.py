"""How far each target is for each UAV at best, and why a target has to be left out."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from missions.routing.problem import FloatArray, Problem, Reason, Routes, Unassigned


def needed_range_m(problem: Problem) -> FloatArray:
    """The least range (u, v) with which a UAV can fly a visit, and home if it returns; inf where there is no way at all.

    Other targets may lie on the way: a place between two networks can join them.
    """
    visits, uavs = len(problem.visits), len(problem.uavs)
    along_m = np.array([visit.length_m for visit in problem.visits])
    out_m = np.full((uavs, visits), np.inf)
    home_m = np.zeros((uavs, visits))
    if not visits or not uavs:
        return out_m
    onward = _least_ways(problem.between_m + along_m[None, :])  # from the end of a visit to the end of another
    first = problem.from_start_m + along_m[None, :]
    for uav, start in enumerate(problem.uavs):
        out_m[uav] = (first[uav][:, None] + onward).min(axis=0)
        if start.returns:
            home_m[uav] = (onward + problem.to_start_m[:, uav][None, :]).min(axis=1)
    return out_m + home_m


def _least_ways(between_m: FloatArray) -> FloatArray:
    """Least metres between all pairs of a dense matrix in which inf means no arc; 0 from a visit to itself."""
    visits = len(between_m)
    tail, head = np.nonzero(np.isfinite(between_m))
    arcs = csr_array((between_m[tail, head], (tail, head)), shape=(visits, visits))
    ways: FloatArray = dijkstra(arcs)  # arcs of 0 m are stored, and count as arcs
    return ways


def reachable(problem: Problem, needed_m: FloatArray) -> NDArray[np.bool_]:
    """Whether each UAV can fly each visit within its range, (u, v)."""
    limit_m = np.array([uav.limit_m for uav in problem.uavs])
    within: NDArray[np.bool_] = np.isfinite(needed_m) & (needed_m <= limit_m[:, None])
    return within


def reasons(problem: Problem, needed_m: FloatArray, routes: Routes) -> tuple[Unassigned, ...]:
    """The true reason for each target that the routes leave out."""
    visited = {problem.visits[visit].target for route in routes for visit in route}
    within = reachable(problem, needed_m)
    unassigned = []
    for target, visits in enumerate(problem.visits_of_target()):
        if target not in visited:
            reason, message = _reason(problem, needed_m[:, visits], within[:, visits])
            unassigned.append(Unassigned(target, reason, message))
    return tuple(unassigned)


def _reason(problem: Problem, needed_m: FloatArray, within: NDArray[np.bool_]) -> tuple[Reason, str]:
    if not len(problem.uavs):
        return Reason.NO_PATH, "There is no UAV that can take off."
    if not np.isfinite(needed_m).any():
        return Reason.NO_PATH, "No UAV can get there: no way on the network keeps clear of every zone."
    if not within.any():
        limit_m = np.array([uav.limit_m for uav in problem.uavs])
        missing_m = np.where(np.isfinite(needed_m), needed_m, np.inf) - np.where(np.isfinite(needed_m), limit_m[:, None], 0.0)
        uav, visit = np.unravel_index(np.argmin(missing_m), needed_m.shape)
        there = "there and back" if problem.uavs[uav].returns else "there"
        needed, missing = _km(needed_m[uav, visit]), _km(missing_m[uav, visit])
        return Reason.BEYOND_RANGE, f"It is {needed} {there}, {missing} more than the range of the UAV that comes nearest to it."
    limited = [problem.uavs[uav].max_range_m is not None for uav in np.flatnonzero(within.any(axis=1))]
    if any(limited):
        return Reason.BEYOND_RANGE, "It is within range alone, but not within the range that is left after the other targets."
    return Reason.NO_PATH, "A UAV can get there, but not on one route with its other targets. Add a UAV."


def _km(length_m: float) -> str:
    return f"{length_m:,.0f} m" if length_m < 1_000 else f"{length_m / 1_000:,.1f} km"
