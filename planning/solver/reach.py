"""How far each target is for each UAV at best, and why a target has to be left out."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from operation.reasons import Reason
from planning.problem import RANGE_RESERVE, BoolArray, End, FloatArray, IntArray, Problem, Routes, Unassigned, UnassignedReason
from planning.solver.cheapest_route import LeastRoutes
from planning.solver.cost_matrices import NO_PATH_M, QuantityKind, classes_of, quantities_of


class Cause(NamedTuple):
    """A reason with what it tells; what is missing, and which row of the problem comes so near."""

    reason: UnassignedReason
    why: Reason
    missing: float | None = None
    uav: int | None = None


THERE = {End.OPEN: Reason("there"), End.RETURN: Reason("there_and_back"), End.ANY_BASE: Reason("there_and_to_base")}
RANGE_ALONE = Cause(UnassignedReason.BEYOND_RANGE, Reason("in_range_alone"), 0.0)
NOT_ON_ONE_ROUTE = Cause(UnassignedReason.NO_PATH, Reason("not_on_one_route"))


def needed_range_m(problem: Problem) -> FloatArray:
    """The least range (u, v) with which a UAV can fly a visit, and on to where it ends; inf where there is no way at all or it may not.

    Other targets may lie on the way: a place between two networks can join them.
    """
    visits, uavs = len(problem.visits), len(problem.uavs)
    needed_m = np.full((uavs, visits), np.inf)
    if not visits or not uavs:
        return needed_m
    if problem.seconds is not None or problem.wh is not None:
        return _needed(problem, QuantityKind.METRES)
    along_m = np.array([visit.length_m for visit in problem.visits])
    first_m, end_m = problem.from_start_m + along_m, problem.end_m
    allowed = np.ones((uavs, visits), dtype=bool) if problem.allowed is None else problem.allowed
    for flown, alike in _by_allowed_visits(allowed):
        onward_m = least_paths(problem.between_m[np.ix_(flown, flown)] + along_m[flown])
        for uav in alike:
            out_m = (first_m[uav, flown][:, None] + onward_m).min(axis=0)
            needed_m[uav, flown] = out_m + (onward_m + end_m[flown, uav]).min(axis=1)
    return needed_m


def needed_wh(problem: Problem) -> FloatArray | None:
    """The least Wh (u, v) with which a UAV can fly a visit, and on to where it ends; as `needed_range_m`. None if none is limited."""
    if problem.wh is None or not any(uav.limit_wh < math.inf for uav in problem.uavs):
        return None
    return _needed(problem, QuantityKind.WH)


def _needed(problem: Problem, kind: QuantityKind) -> FloatArray:
    classes = classes_of(problem)
    found = quantities_of(problem, classes, [kind])
    first, end = found.first[0], found.end[0]
    needed = np.full(first.shape, np.inf)
    allowed = np.ones(needed.shape, dtype=bool) if problem.allowed is None else problem.allowed
    for number, onward_of_class in enumerate(found.onward[0]):
        of_class = np.flatnonzero(classes.of_uav == number)
        for flown, alike in _by_allowed_visits(allowed[of_class]):
            onward = np.minimum(least_paths(onward_of_class[np.ix_(flown, flown)]), NO_PATH_M)
            for uav in of_class[alike].tolist():
                out = (first[uav, flown][:, None] + onward).min(axis=0)
                needed[uav, flown] = out + (onward + end[uav, flown]).min(axis=1)
    needed[needed >= NO_PATH_M] = np.inf
    return needed


def _by_allowed_visits(allowed: BoolArray) -> list[tuple[IntArray, list[int]]]:
    """Sets of visits, and the UAVs that may fly just these."""
    alike: dict[bytes, list[int]] = {}
    for uav, row in enumerate(allowed):
        if row.any():
            alike.setdefault(row.tobytes(), []).append(uav)
    return [(np.flatnonzero(allowed[group[0]]), group) for group in alike.values()]


def least_paths(onward_m: FloatArray) -> FloatArray:
    """Least metres between all pairs of visits, over others if that is shorter (Floyd 1962); 0 from a visit to itself."""
    paths_m: FloatArray = np.array(onward_m, dtype=np.float64)
    np.fill_diagonal(paths_m, 0.0)
    _shorten(paths_m)
    return paths_m


@njit(cache=True, nogil=True)
def _shorten(paths_m: FloatArray) -> None:
    for over in range(len(paths_m)):
        onward_m = paths_m[over]
        for start in range(len(paths_m)):
            there_m = paths_m[start, over]
            if there_m < np.inf:
                row_m = paths_m[start]
                for end in range(len(paths_m)):
                    row_m[end] = min(row_m[end], there_m + onward_m[end])


def reachable(problem: Problem, needed_m: FloatArray) -> BoolArray:
    """Whether each UAV can fly each visit within its limits, (u, v)."""
    most = np.array([uav.most for uav in problem.uavs])
    done = np.array([visit.done for visit in problem.visits])
    within: BoolArray = _within(problem, needed_m) & (done <= most[:, None])
    used_wh = needed_wh(problem)
    return within if used_wh is None else within & _within_battery(problem, used_wh)


def _within(problem: Problem, needed_m: FloatArray) -> BoolArray:
    limit_m = np.array([uav.limit_m for uav in problem.uavs])
    within: BoolArray = np.isfinite(needed_m) & (needed_m <= limit_m[:, None])
    return within


def _within_battery(problem: Problem, used_wh: FloatArray) -> BoolArray:
    limit_wh = np.array([uav.limit_wh for uav in problem.uavs])
    within: BoolArray = used_wh <= limit_wh[:, None]
    return within


def reasons(problem: Problem, needed_m: FloatArray, routes: Routes) -> tuple[Unassigned, ...]:
    """The true reason for each target that the routes leave out."""
    visited = {problem.visits[visit].target for route in routes for visit in route}
    left_out = [target for target in range(problem.target_count) if target not in visited]
    if not left_out:
        return ()
    visits_of = problem.visits_of_target()
    needed_m, used_wh = least_needs(problem, needed_m, [visit for target in left_out for visit in visits_of[target]])
    within_range = _within(problem, needed_m)
    owner = problem.owner or tuple(range(len(routes)))
    done_by = dict.fromkeys(owner, 0)
    for uav, route in zip(owner, routes, strict=True):
        done_by[uav] += sum(problem.visits[visit].done for visit in route)
    done = [done_by[uav] for uav in owner]
    found = []
    for target in left_out:
        visits = visits_of[target]
        reported = _beyond_reach(problem, needed_m, within_range, visits)
        able = within_range[:, visits]
        if reported is None and used_wh is not None:
            able = able & _within_battery(problem, used_wh[:, visits])
            if not able.any():
                reported = _beyond_battery(problem, used_wh, within_range, visits)
        reported = reported or _beyond_rest(problem, able, done, visits)
        nearest = None if reported.uav is None else list(dict.fromkeys(owner)).index(owner[reported.uav])
        found.append(Unassigned(target, reported.reason, reported.why, reported.missing, nearest))
    return tuple(found)


def least_needs(problem: Problem, needed_m: FloatArray, visits: Sequence[int]) -> tuple[FloatArray, FloatArray | None]:
    """Metres and Wh (u, v) that each UAV needs at least, exact for these visits; Wh are None if none are limited."""
    used_wh = needed_wh(problem)
    exact_wh = None if used_wh is None else _on_one_route(problem, QuantityKind.WH, used_wh, visits)
    return _on_one_route(problem, QuantityKind.METRES, needed_m, visits), exact_wh


def _on_one_route(problem: Problem, kind: QuantityKind, needed: FloatArray, visits: Sequence[int]) -> FloatArray:
    """What these visits need where the ways there and back may lead over others, but not both over the same."""
    if not len(problem.uavs):
        return needed
    routes, exact = LeastRoutes(problem, kind), needed.copy()
    for visit in visits:
        by_others = np.isfinite(needed[:, visit]) & (needed[:, visit] < routes.alone[:, visit] * (1.0 - RANGE_RESERVE))
        for uav in np.flatnonzero(by_others).tolist():
            exact[uav, visit] = max(routes.route(uav, visit).amount, needed[uav, visit])
    return exact


def _beyond_reach(problem: Problem, needed_m: FloatArray, within_range: BoolArray, visits: Sequence[int]) -> Cause | None:
    """Why no UAV gets there at all; None if one does, if its battery lasts."""
    needed_m, within = needed_m[:, visits], within_range[:, visits]
    if not len(problem.uavs):
        return Cause(UnassignedReason.NO_PATH, Reason("no_uav_takes_off"))
    if visits and problem.allowed is not None and not problem.allowed[:, visits].any():
        return Cause(UnassignedReason.NOT_ALLOWED, Reason("no_uav_allowed"))
    if not np.isfinite(needed_m).any():
        return Cause(UnassignedReason.NO_PATH, Reason("no_path"))
    if within.any():
        return None
    limit_m = np.array([uav.limit_m for uav in problem.uavs])
    missing_m = np.where(np.isfinite(needed_m), needed_m, np.inf) - np.where(np.isfinite(needed_m), limit_m[:, None], 0.0)
    uav, visit = np.unravel_index(np.argmin(missing_m), needed_m.shape)
    figures = {"needed_m": float(needed_m[uav, visit]), "there": THERE[problem.uavs[uav].end], "missing_m": float(missing_m[uav, visit])}
    return Cause(UnassignedReason.BEYOND_RANGE, Reason("beyond_range", figures), float(missing_m[uav, visit]), int(uav))


def _beyond_battery(problem: Problem, used_wh: FloatArray, within_range: BoolArray, visits: Sequence[int]) -> Cause:
    """Of the UAVs that have the range, the one that lacks least."""
    limit_wh = np.array([uav.limit_wh for uav in problem.uavs])
    within = within_range[:, visits]
    missing_wh = np.where(within, used_wh[:, visits], np.inf) - np.where(within, limit_wh[:, None], 0.0)
    uav, visit = np.unravel_index(np.argmin(missing_wh), missing_wh.shape)
    needed_wh, missing = float(used_wh[uav, visits[int(visit)]]), float(missing_wh[uav, visit])
    figures = {"needed_wh": needed_wh, "there": THERE[problem.uavs[uav].end], "missing_wh": missing}
    return Cause(UnassignedReason.BEYOND_ENERGY, Reason("beyond_battery", figures), missing, int(uav))


def _beyond_rest(problem: Problem, able: BoolArray, done: Sequence[int], visits: Sequence[int]) -> Cause:
    """Why it is left out though some UAV could do it alone."""
    able_uavs = np.flatnonzero(able.any(axis=1)).tolist()
    if all(done[uav] + min(problem.visits[visit].done for visit in visits) > problem.uavs[uav].most for uav in able_uavs):
        return Cause(UnassignedReason.MAX_TARGETS, Reason("all_uavs_full"))
    has_range = any(problem.uavs[uav].max_range_m is not None for uav in able_uavs)
    if any(problem.uavs[uav].limit_wh < math.inf for uav in able_uavs):
        return Cause(UnassignedReason.BEYOND_ENERGY, Reason("in_reach_alone"), 0.0)
    if has_range:
        return RANGE_ALONE
    return NOT_ON_ONE_ROUTE
