"""A plan under change, as arrays: what the compiled searches read and write."""

from typing import NamedTuple, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planning.problem import BoolArray, FloatArray, IntArray, Problem, Routes
from planning.solver.cost_matrices import NO_PATH_M
from planning.solver.problem_arrays import Arcs

RandomState = NDArray[np.uint64]  # one number

# numba compiles a function once more for an argument that is a literal; these have its plain types.
NO, YES = cast(bool, np.bool_(False)), cast(bool, np.bool_(True))
FIRST, ABSENT = cast(int, np.int64(0)), cast(int, np.int64(-1))
MAX_NEIGHBOURS = 60
MAX_JOINED = 12
ALIKE_M = 1e-7  # what arcs may differ by and count as the same: rounding
NO_LIMIT_M = NO_PATH_M / 4  # a route that is longer than its limit, whatever it is, has no way somewhere


class Ground(NamedTuple):
    """What does not change. The first arrays are those of Arcs.

    back_m   (c, v, v) the arcs that lead to a visit in one row
    twin     (v,) the same target the other way round; a visit that has none is its own
    is_alike whether an arc is as long as its reverse, and nothing has a twin
    class_of (u,) the class of each UAV, of which the arcs are its own
    more_*   what else is limited, as in Burden
    first_of, end_of  (u,) the first of the sorties of the same UAV, and one past its last: a row of the plan is one sortie
    option   (v,) the visits of each target one after another, option_from (t + 1,) where each target's begin
    usable   (u, v) whether the UAV can and may fly the visit at all
    near     (t, k) the nearest targets of each, itself first
    joined   (t, k) those that a tree of the least metres joins it to, or would at the least detour, itself first
    far_m    (t,) from the nearest start
    """

    first_m: FloatArray
    onward_m: FloatArray
    end_m: FloatArray
    target: IntArray
    service_s: FloatArray
    done: IntArray
    limit_m: FloatArray
    speed_mps: FloatArray
    ready_s: FloatArray
    most: IntArray
    weight: FloatArray
    is_makespan: bool
    back_m: FloatArray
    reversed_visit: IntArray
    is_alike: bool
    option: IntArray
    option_from: IntArray
    usable: BoolArray
    near: IntArray
    joined: IntArray
    far_m: FloatArray
    class_of: IntArray
    is_limited: bool
    more_first: FloatArray
    more_onward: FloatArray
    more_end: FloatArray
    more_limit: FloatArray
    has_sorties: bool
    first_of: IntArray
    end_of: IntArray


class Plan(NamedTuple):
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

    plan: Plan
    best: Plan
    saved: Plan
    is_saved: BoolArray  # (u,)
    is_removed: BoolArray  # (t,)
    waiting: IntArray  # (t,) targets to be put in
    key: FloatArray  # (t,) their order
    random: RandomState
    beside_s: FloatArray  # (u,) of the other sorties of the same UAV, and what an empty sortie begins with; 0 where each flies once
    opened_s: FloatArray


def ground_of(problem: Problem, arcs: Arcs, usable: BoolArray) -> Ground:
    option, option_from = arcs.visits_of_target
    apart_m = _apart_m(arcs)
    near = np.argsort(apart_m, axis=1, kind="stable")[:, : MAX_NEIGHBOURS + 1]
    far_m = np.full(len(arcs.weight), NO_PATH_M)
    reversed_visit = _reversed_visits(problem)
    turned_m = arcs.onward_m.transpose(0, 2, 1)
    is_alike = np.allclose(arcs.onward_m, turned_m, rtol=0.0, atol=ALIKE_M)
    first_of, end_of = np.searchsorted(arcs.owner, arcs.owner), np.searchsorted(arcs.owner, arcs.owner, side="right")
    is_later = first_of < np.arange(len(first_of))
    if len(arcs.first_m):
        np.minimum.at(far_m, arcs.target, arcs.first_m.min(axis=0))
    return Ground(
        arcs.first_m,
        arcs.onward_m,
        arcs.end_m,
        arcs.target,
        arcs.service_s,
        arcs.done,
        arcs.limit_m,
        arcs.speed_mps,
        arcs.ready_s + np.where(is_later, arcs.turnaround_s, 0.0),
        arcs.most,
        arcs.weight,
        arcs.is_makespan,
        arcs.onward_m if is_alike else np.ascontiguousarray(turned_m),
        reversed_visit,
        is_alike and bool((reversed_visit == np.arange(len(reversed_visit))).all()),
        option,
        option_from,
        np.ascontiguousarray(usable),
        np.ascontiguousarray(near),
        _joined(apart_m),
        far_m,
        arcs.class_of,
        bool(len(arcs.burden)),
        np.ascontiguousarray(arcs.burden.first),
        np.ascontiguousarray(arcs.burden.onward),
        np.ascontiguousarray(arcs.burden.end),
        np.ascontiguousarray(arcs.burden.limit),
        arcs.has_sorties,
        first_of,
        end_of,
    )


def _reversed_visits(problem: Problem) -> IntArray:
    reversed_visit = np.arange(len(problem.visits))
    for visits in problem.visits_of_target():
        if len(visits) == 2 and problem.visits[visits[0]].is_reversed != problem.visits[visits[1]].is_reversed:
            reversed_visit[visits] = visits[::-1]
    return reversed_visit


def _apart_m(arcs: Arcs) -> FloatArray:
    """Metres between targets, over their nearest visits and the better direction, (t, t); below 0 from each to itself."""
    targets = len(arcs.weight)
    apart_m = np.full((targets, targets), NO_PATH_M)
    np.minimum.at(apart_m, (arcs.target[:, None], arcs.target[None, :]), arcs.onward_m.min(axis=0))
    apart_m = np.asarray(np.minimum(apart_m, apart_m.T), dtype=np.float64)
    np.fill_diagonal(apart_m, -1.0)
    return apart_m


def _joined(apart_m: FloatArray) -> IntArray:
    """The targets that cost the least to join to each, if the least spanning tree loses its longest arc between them for it.

    Alpha-nearness: K. Helsgaun, European Journal of Operational Research 126 (2000). Unlike the nearest, they lead out of every cluster.
    """
    detour_m = apart_m - _longest_between(apart_m)
    np.fill_diagonal(detour_m, -1.0)
    order = np.lexsort((apart_m, np.round(detour_m, 3)), axis=1)
    return np.ascontiguousarray(order[:, : MAX_JOINED + 1])


@njit(cache=True, nogil=True)
def _longest_between(apart_m: FloatArray) -> FloatArray:
    """The longest arc between any two targets in the least spanning tree (Prim 1957), (t, t)."""
    targets = len(apart_m)
    longest_m = np.zeros((targets, targets))
    key_m = np.full(targets, np.inf)
    parent = np.full(targets, -1, dtype=np.int64)
    is_in = np.zeros(targets, dtype=np.bool_)
    order = np.empty(targets, dtype=np.int64)
    for count in range(targets):
        next_one = -1
        for target in range(targets):
            if not is_in[target] and (next_one < 0 or key_m[target] < key_m[next_one]):
                next_one = target
        for at in range(count):
            other = order[at]
            reach_m = max(longest_m[parent[next_one], other], key_m[next_one])
            longest_m[next_one, other] = longest_m[other, next_one] = reach_m
        order[count], is_in[next_one] = next_one, True
        for target in range(targets):
            if not is_in[target] and apart_m[next_one, target] < key_m[target]:
                key_m[target], parent[target] = apart_m[next_one, target], next_one
    return longest_m


def empty_plan(uavs: int, targets: int, limits: int = 0) -> Plan:
    """Limits are those beside what the objective counts."""
    return Plan(
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


def routes_of(plan: Plan) -> Routes:
    return tuple(tuple(route[:count]) for route, count in zip(plan.visit.tolist(), plan.size.tolist(), strict=True))


@njit(cache=True, nogil=True)
def settle(ground: Ground, plan: Plan, uav: int) -> None:
    """Work out everything that follows from a UAV's visits."""
    count = plan.size[uav]
    visit, gap_m = plan.visit[uav], plan.gap_m[uav]
    length_m, service_s, done = 0.0, ground.ready_s[uav], 0
    if count:
        gap_m[0] = ground.first_m[uav, visit[0]]
        for place in range(1, count):
            gap_m[place] = ground.onward_m[ground.class_of[uav], visit[place - 1], visit[place]]
        gap_m[count] = ground.end_m[uav, visit[count - 1]]
        for place in range(count):
            length_m += gap_m[place]
            service_s += ground.service_s[visit[place]]
            done += ground.done[visit[place]]
            plan.uav_of[ground.target[visit[place]]] = uav
            plan.place[ground.target[visit[place]]] = place
        length_m += gap_m[count]
    plan.length_m[uav], plan.service_s[uav], plan.done[uav] = length_m, service_s, done
    if ground.is_limited:
        for at in range(len(ground.more_limit)):
            taken = 0.0
            if count:
                taken = ground.more_first[at, uav, visit[0]] + ground.more_end[at, uav, visit[count - 1]]
                for place in range(1, count):
                    taken += ground.more_onward[at, ground.class_of[uav], visit[place - 1], visit[place]]
            plan.taken[uav, at] = taken


@njit(cache=True, nogil=True)
def keeps_further_limits(ground: Ground, plan: Plan, uav: int) -> bool:
    """Whether a settled route keeps what is limited beside what the objective counts."""
    keeps = True
    for at in range(len(ground.more_limit)):
        keeps = keeps and plan.taken[uav, at] <= ground.more_limit[at, uav]
    return keeps


@njit(cache=True, nogil=True)
def done_on_other_sorties(ground: Ground, plan: Plan, uav: int) -> int:
    """Targets that the same UAV does on its other sorties."""
    done = -plan.done[uav]
    for other in range(ground.first_of[uav], ground.end_of[uav]):
        done += plan.done[other]
    return int(done)


@njit(cache=True, nogil=True)
def duration_s(length_m: float, speed_mps: float, service_s: float) -> float:
    """Seconds of a route; service_s has take-off and landing in it."""
    return length_m / speed_mps + service_s


@njit(cache=True, nogil=True)
def copy_plan(source: Plan, copy: Plan) -> None:
    for uav in range(len(source.size)):
        copy_route(source, copy, uav)
    copy.uav_of[:] = source.uav_of
    copy.place[:] = source.place


@njit(cache=True, nogil=True)
def copy_route(source: Plan, copy: Plan, uav: int) -> None:
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
def values(ground: Ground, plan: Plan) -> tuple[float, float, float]:
    """What is left out by weight, the total [m], the longest route [s]."""
    missed, total_m, longest_s, own_s = 0.0, 0.0, 0.0, 0.0
    for target in range(len(plan.uav_of)):
        if plan.uav_of[target] < 0:
            missed += ground.weight[target]
    for uav in range(len(plan.size)):
        total_m += plan.length_m[uav]
        if uav == ground.first_of[uav]:
            own_s = 0.0
        if plan.size[uav]:
            own_s += duration_s(plan.length_m[uav], ground.speed_mps[uav], plan.service_s[uav])
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
