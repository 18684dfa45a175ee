"""A plan under change, as arrays: what the compiled searches read and write."""

from typing import NamedTuple, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planning.problem import BoolArray, FloatArray, IntArray, Routes
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.problem_arrays import ProblemArrays, raw_view

RandomState = NDArray[np.uint64]  # one number

# numba compiles a function once more for an argument that is a literal; these have its plain types.
NO, YES = cast(bool, np.bool_(False)), cast(bool, np.bool_(True))
FIRST, ABSENT = cast(int, np.int64(0)), cast(int, np.int64(-1))
NO_LIMIT_M = NO_PATH_M / 4  # a route that is longer than its limit, whatever it is, has no way somewhere


class PlanState(NamedTuple):
    """Routes and what follows from them; `size` (u,) is how many visits each has, `uav_of` (t,) is -1 for a target that is left out.

    gap_m (u, t + 1) holds the arc that leads to each place of a route, and at last on to its end. service_s (u,) begins with what
    take-off and landing take, also where there is no visit; all else is 0 there. taken (u, r) is what the route takes of further limits.
    """

    visit: IntArray
    size: IntArray
    gap_m: FloatArray
    length_m: FloatArray
    service_s: FloatArray
    done: IntArray
    uav_of: IntArray
    place: IntArray
    taken: FloatArray


class Workspace(NamedTuple):
    """The current plan, the best one, and room to work in."""

    plan: PlanState
    best: PlanState
    saved: PlanState
    is_saved: BoolArray  # (u,)
    is_removed: BoolArray  # (t,)
    waiting: IntArray  # (t,) targets to be put in
    key: FloatArray  # (t,) their order
    random: RandomState
    beside_s: FloatArray  # (u,) of the other sorties of the same UAV, and what an empty sortie begins with; 0 where each flies once
    opened_s: FloatArray


def empty_plan(uavs: int, targets: int, limits: int = 0) -> PlanState:
    """Limits are those beside what the objective counts."""
    return PlanState(
        np.zeros((uavs, targets), dtype=np.int64),
        np.zeros(uavs, dtype=np.int64),
        np.zeros((uavs, targets + 1)),
        np.zeros(uavs),
        np.zeros(uavs),
        np.zeros(uavs, dtype=np.int64),
        np.full(targets, -1, dtype=np.int64),
        np.zeros(targets, dtype=np.int64),
        np.zeros((uavs, limits)),
    )


def workspace(uavs: int, targets: int, seed: int, limits: int = 0) -> Workspace:
    return Workspace(
        empty_plan(uavs, targets, limits),
        empty_plan(uavs, targets, limits),
        empty_plan(uavs, targets, limits),
        np.zeros(uavs, dtype=np.bool_),
        np.zeros(targets, dtype=np.bool_),
        np.zeros(targets, dtype=np.int64),
        np.zeros(targets),
        np.array([(seed * 2 + 1) * 0x9E3779B97F4A7C15 & 0xFFFFFFFFFFFFFFFF], dtype=np.uint64),
        np.zeros(uavs),
        np.zeros(uavs),
    )


@njit(cache=True, nogil=True)
def raw_workspace(work: Workspace) -> Workspace:
    """Return raw views of all arrays; see `raw_view`."""
    return Workspace(
        _raw_plan(work.plan),
        _raw_plan(work.best),
        _raw_plan(work.saved),
        raw_view(work.is_saved),
        raw_view(work.is_removed),
        raw_view(work.waiting),
        raw_view(work.key),
        raw_view(work.random),
        raw_view(work.beside_s),
        raw_view(work.opened_s),
    )


@njit(cache=True, nogil=True)
def _raw_plan(plan: PlanState) -> PlanState:
    return PlanState(
        raw_view(plan.visit),
        raw_view(plan.size),
        raw_view(plan.gap_m),
        raw_view(plan.length_m),
        raw_view(plan.service_s),
        raw_view(plan.done),
        raw_view(plan.uav_of),
        raw_view(plan.place),
        raw_view(plan.taken),
    )


def routes_of(plan: PlanState) -> Routes:
    return tuple(tuple(route[:count]) for route, count in zip(plan.visit.tolist(), plan.size.tolist(), strict=True))


@njit(cache=True, nogil=True)
def settle(problem: ProblemArrays, plan: PlanState, uav: int) -> None:
    """Work out everything that follows from a UAV's visits."""
    count = plan.size[uav]
    visit, gap_m = plan.visit[uav], plan.gap_m[uav]
    length_m, service_s, done = 0.0, problem.ready_s[uav], 0
    if count:
        gap_m[0] = problem.first_m[uav, visit[0]]
        for place in range(1, count):
            gap_m[place] = problem.onward_m[problem.class_of[uav], visit[place - 1], visit[place]]
        gap_m[count] = problem.end_m[uav, visit[count - 1]]
        for place in range(count):
            length_m += gap_m[place]
            service_s += problem.service_s[visit[place]]
            done += problem.done[visit[place]]
            plan.uav_of[problem.target[visit[place]]] = uav
            plan.place[problem.target[visit[place]]] = place
        length_m += gap_m[count]
    plan.length_m[uav], plan.service_s[uav], plan.done[uav] = length_m, service_s, done
    if problem.is_limited:
        for at in range(len(problem.more_limit)):
            taken = 0.0
            if count:
                taken = problem.more_first[at, uav, visit[0]] + problem.more_end[at, uav, visit[count - 1]]
                for place in range(1, count):
                    taken += problem.more_onward[at, problem.class_of[uav], visit[place - 1], visit[place]]
            plan.taken[uav, at] = taken


@njit(cache=True, nogil=True)
def keeps_further_limits(problem: ProblemArrays, plan: PlanState, uav: int) -> bool:
    """Whether a settled route keeps what is limited beside what the objective counts."""
    keeps = True
    for at in range(len(problem.more_limit)):
        keeps = keeps and plan.taken[uav, at] <= problem.more_limit[at, uav]
    return keeps


@njit(cache=True, nogil=True)
def done_on_other_sorties(problem: ProblemArrays, plan: PlanState, uav: int) -> int:
    """Targets that the same UAV does on its other sorties."""
    done = -plan.done[uav]
    for other in range(problem.first_of[uav], problem.end_of[uav]):
        done += plan.done[other]
    return int(done)


@njit(cache=True, nogil=True)
def duration_s(length_m: float, speed_mps: float, service_s: float) -> float:
    """Seconds of a route; service_s has take-off and landing in it."""
    return length_m / speed_mps + service_s


@njit(cache=True, nogil=True)
def copy_plan(source: PlanState, copy: PlanState) -> None:
    for uav in range(len(source.size)):
        copy_route(source, copy, uav)
    copy.uav_of[:] = source.uav_of
    copy.place[:] = source.place


@njit(cache=True, nogil=True)
def copy_route(source: PlanState, copy: PlanState, uav: int) -> None:
    count = source.size[uav]
    copy.size[uav] = count
    copy.visit[uav, :count] = source.visit[uav, :count]
    copy.gap_m[uav, : count + 1] = source.gap_m[uav, : count + 1]
    copy.length_m[uav] = source.length_m[uav]
    copy.service_s[uav] = source.service_s[uav]
    copy.done[uav] = source.done[uav]
    for at in range(source.taken.shape[1]):
        copy.taken[uav, at] = source.taken[uav, at]


@njit(cache=True, nogil=True)
def save(work: Workspace, uav: int) -> None:
    if not work.is_saved[uav]:
        work.is_saved[uav] = True
        copy_route(work.plan, work.saved, uav)


@njit(cache=True, nogil=True)
def values(problem: ProblemArrays, plan: PlanState) -> tuple[float, float, float]:
    """What is left out by weight, the total [m], the longest route [s]."""
    missed, total_m, longest_s, own_s = 0.0, 0.0, 0.0, 0.0
    for target in range(len(plan.uav_of)):
        if plan.uav_of[target] < 0:
            missed += problem.weight[target]
    for uav in range(len(plan.size)):
        total_m += plan.length_m[uav]
        if uav == problem.first_of[uav]:
            own_s = 0.0
        if plan.size[uav]:
            own_s += duration_s(plan.length_m[uav], problem.speed_mps[uav], plan.service_s[uav])
            longest_s = max(longest_s, own_s)
    return missed, total_m, longest_s


@njit(cache=True, nogil=True)
def draw(state: RandomState) -> float:
    """A number from 0 up to 1 (xorshift64*, Vigna 2016)."""
    number = state[0]
    number ^= number >> np.uint64(12)
    number ^= number << np.uint64(25)
    number ^= number >> np.uint64(27)
    state[0] = number
    return float((number * np.uint64(0x2545F4914F6CDD1D)) >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@njit(cache=True, nogil=True)
def draw_below(state: RandomState, bound: int) -> int:
    return int(draw(state) * bound)
